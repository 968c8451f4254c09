//! How `reasoning` is sent, and what a model refuses of it.
//!
//! In: a request and the facts about its model. Out: the level or the number of tokens to send, or why it cannot be sent.
//! Each wire writes it into its own fields.

use crate::catalogue::{ReasoningKind, Wire};
use crate::remote::settings::{Parameter, Settings};
use fab_model::{Reasoning, Request};

/// Returns what is sent of a request's `reasoning`, if anything.
///
/// Fails if the model is known to refuse it, or its interface has no field for it.
pub(super) fn sent(request: &Request, settings: &Settings) -> Result<Option<Reasoning>, String> {
    let is_sent = settings.sends(Parameter::Reasoning);
    let Some(stated) = request.reasoning.filter(|_| is_sent) else {
        return Ok(None);
    };
    let facts = settings.profile.reasoning();
    let counts_tokens = match settings.profile.provider.wire {
        Wire::OpenaiResponses => false,
        Wire::OpenaiChat => facts.tokens_field.is_some(),
        Wire::Anthropic | Wire::Gemini => true,
    };
    let least = facts.least_tokens.unwrap_or(1);
    let refused = facts.refuses.as_deref().unwrap_or_default();
    let accepted = ReasoningKind::ALL.into_iter().filter(|kind| {
        !refused.contains(kind) && (*kind != ReasoningKind::Tokens || counts_tokens)
    });
    let (kind, is_enough) = match stated {
        Reasoning::Tokens(tokens) => (ReasoningKind::Tokens.name(), tokens >= least),
        Reasoning::Level(level) => (level.word(), true),
    };
    if is_enough && accepted.clone().any(|accepted| accepted.name() == kind) {
        let as_tokens = facts.levels_as_tokens == Some(true) && counts_tokens;
        return Ok(Some(if as_tokens {
            Reasoning::Tokens(stated.allowed_tokens())
        } else {
            stated
        }));
    }
    let accepted: Vec<String> = accepted
        .map(|kind| match kind {
            ReasoningKind::Tokens => format!("a number of tokens from {least}"),
            word => format!("`{}`", word.name()),
        })
        .collect();
    let accepted = if accepted.is_empty() {
        "none at all".to_owned()
    } else {
        accepted.join(", ")
    };
    Err(format!(
        "`reasoning` is `{stated}`, and it accepts {accepted}; give another one with `--reasoning`, or leave it out with `--omit reasoning`"
    ))
}

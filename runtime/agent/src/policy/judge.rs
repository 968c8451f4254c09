//! Interprets an answer: a text, an action with its verdict, or nothing readable.
//!
//! Every policy's action is judged here, and again by the rollout before it is executed.

use super::reach::out_of_reach;
use super::{Accepted, Finding, StepView};
use fab_program::Proposal;
use fab_program::facts::Facts;
use fab_program::render::RenderError;
use fab_program::reply::{self, Malformed, Reading, Stated};
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{Read, Stage};
use std::collections::BTreeMap;

/// Reads an answer and, if it proposes an action, lets the verifier judge it.
pub(super) fn judge(
    view: StepView<'_>,
    stage: &Stage,
    facts: Facts<'_>,
    text: &str,
) -> Result<Finding, RenderError> {
    let malformed = |Malformed {
                         field,
                         message,
                         stated,
                     }| Finding::Malformed {
        field,
        message,
        stated,
    };
    match &stage.read {
        Read::Text {
            name,
            before,
            after,
        } => Ok(match reply::read_text(before, after, text) {
            Ok(Reading {
                value,
                repairs,
                stated,
                ..
            }) => Finding::Text {
                name: name.clone(),
                value,
                repairs,
                stated: stated
                    .into_iter()
                    .map(|it| Stated {
                        field: name.clone(),
                        ..it
                    })
                    .collect(),
            },
            Err(error) => malformed(error),
        }),
        Read::Action => {
            match reply::read_action_in(view.program, &facts.notation(view.program), text) {
                Ok(Reading {
                    value,
                    repairs,
                    stated,
                    ..
                }) => {
                    let verdict = verdict(view, facts, &value, Strictness::Full)?;
                    Ok(Finding::Action {
                        fields: value.fields,
                        repairs,
                        stated,
                        verdict,
                    })
                }
                Err(error) => Ok(malformed(error)),
            }
        }
    }
}

/// Judges an action by the task's checks, and then by the world's reach.
pub(super) fn verdict(
    view: StepView<'_>,
    facts: Facts<'_>,
    proposal: &Proposal,
    strictness: Strictness,
) -> Result<Verdict, RenderError> {
    let program = view.program;
    Ok(
        match verify::verdict(program, facts, proposal, strictness)? {
            Verdict::Accept => {
                out_of_reach(view, &facts.notation(program), proposal).unwrap_or(Verdict::Accept)
            }
            refused => refused,
        },
    )
}

/// Judges refused actions again, newest first, without the checks that the task drops in the end.
///
/// Returns the first one that passes, with its number.
pub(super) fn relaxed(
    view: StepView<'_>,
    facts: Facts<'_>,
    refused: &[(u32, Proposal)],
) -> Result<Option<(u32, Proposal)>, RenderError> {
    if view.program.verify.relaxed.is_empty() {
        return Ok(None);
    }
    for (number, proposal) in refused.iter().rev() {
        if verdict(view, facts, proposal, Strictness::Relaxed)? == Verdict::Accept {
            return Ok(Some((*number, proposal.clone())));
        }
    }
    Ok(None)
}

/// Judges a decision before execution: no policy bypasses the checks.
pub(crate) fn is_accepted(
    view: StepView<'_>,
    proposal: &Proposal,
    accepted: &Accepted,
) -> Result<bool, RenderError> {
    let strictness = match accepted.without.is_empty() {
        true => Strictness::Full,
        false => Strictness::Relaxed,
    };
    let texts = BTreeMap::new();
    let facts = view.facts(&texts, view.pixels());
    Ok(verdict(view, facts, proposal, strictness)? == Verdict::Accept)
}

//! Answers that reasoning cut off: hidden, or written as thoughts into the answer itself.
//!
//! In: a failed reply, and the lengths that it was asked with. Out: what to say about it, and how many tokens to allow for
//! reasoning when the question is asked once more. The same request would be cut off again, so it is never repeated as
//! it was.

use super::settings::Lengths;
use super::wire::Failure;
use fab_model::Reasoning;
use fab_program::reply::{Aside, standing};

/// What is doubled if neither an allowance nor a count is known, tokens: that of `low`.
const LEAST_TOKENS: u32 = 1024;

/// An answer for which reasoning left too little.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Starved {
    /// What to say.
    pub why: String,
    /// The lengths to ask with once more; `None` if no limit was sent that could be raised.
    pub again: Option<Lengths>,
}

/// Judges a truncated answer; `None` if reasoning is not the reason.
pub(super) fn starved(failure: &Failure, lengths: Lengths) -> Option<Starved> {
    let text = failure.cut_text.as_ref()?;
    let is_blank = is_thought_alone(text);
    let usage = failure.usage.unwrap_or_default();
    // A server that does not count hidden tokens spent all of them on what cannot be seen, and so did one whose text is
    // nothing but thoughts.
    let whole = failure.usage.map(|usage| usage.output_tokens);
    let who = if text.trim().is_empty() || !is_blank {
        "hidden reasoning"
    } else {
        "thoughts in its text"
    };
    let spent = match (is_blank, usage.reasoning_tokens) {
        (true, Some(hidden)) if text.trim().is_empty() => Some(hidden),
        (true, _) => whole,
        (false, hidden) => Some(hidden?),
    };
    let visible = usage.output_tokens.saturating_sub(spent.unwrap_or(0));
    // Counts of single tokens differ by delimiters.
    let fills = |limit: u32| visible.saturating_mul(10) >= u64::from(limit) * 9;
    let got_its_length = !is_blank && lengths.visible.is_none_or(fills);
    if spent == Some(0) || got_its_length {
        return None;
    }
    let spent_words = match spent {
        Some(tokens) => format!("{tokens} tokens"),
        None => "an unknown number of tokens".to_owned(),
    };
    let allowed = match (lengths.visible, lengths.hidden) {
        (None, _) => "no limit was sent".to_owned(),
        (Some(limit), hidden) => {
            format!("{limit} were allowed for the answer, and {hidden} for reasoning")
        }
    };
    let spent = spent.map_or(0, |spent| u32::try_from(spent).unwrap_or(u32::MAX));
    let hidden = lengths.hidden.max(spent).max(LEAST_TOKENS);
    let hidden = hidden.saturating_mul(2).min(2 * Reasoning::MOST_TOKENS);
    let again = lengths.visible.filter(|_| hidden > lengths.hidden);
    Some(Starved {
        why: format!(
            "{who} took {spent_words} and left no room for the answer: {allowed}; `--reasoning none` or `low` makes the model think less, `high` or `--reasoning N` allows more"
        ),
        again: again.map(|visible| Lengths {
            visible: Some(visible),
            hidden,
        }),
    })
}

/// Returns whether a text has nothing beside thoughts, such as `<think>…</think>`, whether they end or not.
fn is_thought_alone(text: &str) -> bool {
    let (mut rest, mut end) = (String::new(), 0);
    for (span, kind) in standing(text).asides {
        if kind == Aside::Thought {
            rest.push_str(text.get(end..span.start).unwrap_or_default());
            end = end.max(span.end);
        }
    }
    rest.push_str(text.get(end..).unwrap_or_default());
    rest.trim().is_empty()
}

#[cfg(test)]
#[path = "tests/hidden.rs"]
mod tests;

//! Answers that were cut off: because they are too long, or because reasoning took their room.
//!
//! In: the text, its usage, and the lengths that it was asked with. Out: what to do about it, and how many tokens to allow
//! for reasoning when the question is asked once more. The same request would be cut off again, so it is never repeated
//! as it was.

use super::settings::Lengths;
use fab_model::Reasoning;
use fab_model::calls::Usage;
use fab_program::reply::{Aside, standing};

/// What is doubled if neither an allowance nor a count is known, tokens: that of `low`.
const LEAST_TOKENS: u32 = 1024;

/// Says what to do about a text that was cut off; with the lengths to ask with once more, if reasoning took its room.
pub(super) fn remedy(
    text: &str,
    usage: Option<Usage>,
    lengths: Lengths,
) -> (String, Option<Lengths>) {
    let usage = usage.unwrap_or_default();
    let is_blank = is_thought_alone(text);
    // A count of hidden tokens lacks the thoughts in the text.
    let hidden = usage.reasoning_tokens;
    let hidden = hidden.filter(|_| !is_blank || text.trim().is_empty());
    let spent = hidden.unwrap_or(if is_blank { usage.output_tokens } else { 0 });
    let left = usage.output_tokens.saturating_sub(spent);
    // Counts of single tokens differ by delimiters.
    let fills = |limit: u32| left.saturating_mul(10) >= u64::from(limit) * 9;
    let got_its_length = !is_blank && (spent == 0 || lengths.visible.is_none_or(fills));
    if got_its_length || hidden == Some(0) {
        return ("raise the stage's `tokens`".to_owned(), None);
    }
    let allowed = match lengths.visible {
        None => "no limit was sent".to_owned(),
        Some(limit) => {
            let hidden = lengths.hidden;
            format!("{limit} were allowed for the answer, and {hidden} for reasoning")
        }
    };
    let words = match spent {
        0 => "its".to_owned(),
        _ => format!("{spent}"),
    };
    let spent = u32::try_from(spent).unwrap_or(u32::MAX);
    let more = lengths.hidden.max(spent).max(LEAST_TOKENS);
    let more = more.saturating_mul(2).min(2 * Reasoning::MOST_TOKENS);
    let again = Lengths {
        hidden: more,
        ..lengths
    };
    (
        format!(
            "reasoning took {words} tokens: {allowed}; `--reasoning none` or `low` makes the model think less, `high` or `--reasoning N` allows more"
        ),
        Some(again).filter(|_| lengths.visible.is_some() && more > lengths.hidden),
    )
}

/// Returns whether a text has nothing beside thoughts, such as `<think>…</think>`, whether they end or not.
fn is_thought_alone(text: &str) -> bool {
    let asides = standing(text).asides.into_iter();
    let mut end = 0;
    for (span, _) in asides.filter(|(_, kind)| *kind == Aside::Thought) {
        let between = text.get(end..span.start).unwrap_or_default();
        if !between.trim().is_empty() {
            return false;
        }
        end = end.max(span.end);
    }
    text.get(end..).unwrap_or_default().trim().is_empty()
}

#[cfg(test)]
#[path = "tests/hidden.rs"]
mod tests;

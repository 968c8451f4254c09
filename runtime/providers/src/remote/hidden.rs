//! Answers that hidden reasoning cut off.
//!
//! In: a failed reply, and the lengths that it was asked with. Out: what to say about it, and how many hidden tokens to
//! allow when the question is asked once more. The same request would be cut off again, so it is never repeated as it
//! was.

use super::settings::Lengths;
use super::wire::Failure;
use fab_model::Reasoning;

/// An answer for which hidden reasoning left too little.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Starved {
    /// What to say.
    pub why: String,
    /// The lengths to ask with once more; `None` if no limit was sent that could be raised.
    pub again: Option<Lengths>,
}

/// Judges a truncated answer; `None` if hidden reasoning is not the reason.
pub(super) fn starved(failure: &Failure, lengths: Lengths) -> Option<Starved> {
    let is_blank = failure.cut_text.as_ref()?.trim().is_empty();
    let usage = failure.usage;
    // A server that does not count hidden tokens spent all of them on what cannot be seen.
    let spent = usage.and_then(|usage| {
        let whole = is_blank.then_some(usage.output_tokens);
        usage.reasoning_tokens.or(whole)
    });
    let lacks_room = |limit: u32| {
        // Counts of single tokens differ by delimiters.
        let visible = usage.map_or(0, |usage| usage.visible_tokens());
        visible.saturating_mul(10) < u64::from(limit) * 9
    };
    let is_starved = match (spent, lengths.visible) {
        (Some(0), _) => false,
        (Some(_), Some(limit)) => is_blank || lacks_room(limit),
        (Some(_) | None, _) => is_blank,
    };
    if !is_starved {
        return None;
    }
    let spent_words = match spent {
        Some(tokens) => format!("{tokens} tokens"),
        None => "an unknown number of tokens".to_owned(),
    };
    let limit = lengths.visible.map_or(String::new(), |limit| {
        format!(" beside {limit} for the answer")
    });
    let why = format!(
        "hidden reasoning took {spent_words} and left no room for the answer ({} were allowed{limit}); `--reasoning none` or `low` makes the model think less, `high` or `--reasoning N` allows more",
        lengths.hidden
    );
    let spent = spent.map_or(0, |spent| u32::try_from(spent).unwrap_or(u32::MAX));
    let most = 2 * Reasoning::MOST_TOKENS;
    let hidden = lengths.hidden.max(spent).max(LEAST_TOKENS);
    let hidden = hidden.saturating_mul(2).min(most);
    Some(Starved {
        why,
        again: lengths
            .visible
            .filter(|_| hidden > lengths.hidden)
            .map(|visible| Lengths {
                visible: Some(visible),
                hidden,
            }),
    })
}

/// What is doubled if neither an allowance nor a count is known, tokens: that of `low`.
const LEAST_TOKENS: u32 = 1024;

#[cfg(test)]
mod tests {
    use super::*;
    use fab_model::calls::{Fault, Usage};

    fn failure(text: &str, output: u64, hidden: Option<u64>) -> Failure {
        Failure {
            fault: Fault::Truncated,
            why: String::new(),
            usage: Some(Usage {
                output_tokens: output,
                reasoning_tokens: hidden,
                ..Usage::default()
            }),
            cut_text: Some(text.to_owned()),
        }
    }

    const LENGTHS: Lengths = Lengths {
        visible: Some(100),
        hidden: 1024,
    };

    #[test]
    fn an_answer_that_got_its_length_is_not_starved() {
        for (text, output, hidden) in [
            ("words", 100, None),
            ("words", 100, Some(0)),
            ("", 1124, Some(0)),
            ("words", 1124, Some(1024)),
            ("words", 1124, Some(1030)),
        ] {
            assert_eq!(starved(&failure(text, output, hidden), LENGTHS), None);
        }
    }

    #[test]
    fn a_starved_answer_is_asked_again_with_twice_as_many_hidden_tokens() {
        for (text, output, hidden, more) in [
            ("", 1124, Some(1124), 2248),
            ("wo", 1124, Some(1060), 2120),
            (" ", 1124, None, 2248),
            ("", 60, Some(60), 2048),
            ("", u64::MAX, None, 200_000),
        ] {
            let found = starved(&failure(text, output, hidden), LENGTHS).expect("it is starved");
            let again = found.again.expect("it is asked again");
            assert_eq!((again.visible, again.hidden), (Some(100), more));
            let spent = hidden.unwrap_or(output);
            assert!(
                found.why.contains(&format!("took {spent} tokens")),
                "{}",
                found.why
            );
        }
    }

    #[test]
    fn without_a_limit_there_is_nothing_to_raise() {
        let unlimited = Lengths {
            visible: None,
            hidden: 0,
        };
        let found = starved(&failure("", 9000, Some(9000)), unlimited).expect("it is starved");
        assert_eq!(found.again, None);
    }
}

//! Answers that reasoning cut off: hidden, or written as thoughts into the answer itself.
//!
//! In: a failed reply, and the lengths that it was asked with. Out: what to say about it, and how many tokens to allow for
//! reasoning when the question is asked once more. The same request would be cut off again, so it is never repeated as
//! it was.

use super::settings::Lengths;
use super::wire::Failure;
use fab_model::Reasoning;
use fab_program::reply::{Aside, standing};

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
    let thoughts = Thoughts::within(failure.cut_text.as_ref()?);
    let is_blank = thoughts.rest == 0;
    let usage = failure.usage;
    let spent = usage.and_then(|usage| {
        // Nobody counts thoughts in the answer's text, so they have their share of its tokens.
        let within = thoughts.share_of(usage.visible_tokens());
        // A server that does not count hidden tokens spent all of them on what cannot be seen.
        let whole = is_blank.then_some(usage.output_tokens);
        match within {
            Some(within) => Some(within.saturating_add(usage.reasoning_tokens.unwrap_or(0))),
            None => usage.reasoning_tokens.or(whole),
        }
    });
    let lacks_room = |limit: u32| {
        // Counts of single tokens differ by delimiters.
        let output = usage.map_or(0, |usage| usage.output_tokens);
        let visible = output.saturating_sub(spent.unwrap_or(0));
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
    let who = match thoughts.length {
        0 => "hidden reasoning",
        _ => "thoughts in its text",
    };
    let allowed = match (lengths.visible, lengths.hidden) {
        (None, _) => "no limit was sent".to_owned(),
        (Some(limit), 0) => format!("{limit} were allowed for the answer, and none for reasoning"),
        (Some(limit), hidden) => {
            format!("{limit} were allowed for the answer, and {hidden} for reasoning")
        }
    };
    let why = format!(
        "{who} took {spent_words} and left no room for the answer: {allowed}; `--reasoning none` or `low` makes the model think less, `high` or `--reasoning N` allows more"
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

/// Thoughts in a text, such as `<think>…</think>`, whether they end or not.
struct Thoughts {
    /// Their length, bytes.
    length: usize,
    /// The length of the rest without white space at its ends, bytes.
    rest: usize,
}

impl Thoughts {
    fn within(text: &str) -> Thoughts {
        let asides = standing(text).asides;
        let spans = asides
            .into_iter()
            .filter_map(|(span, kind)| (kind == Aside::Thought).then_some(span));
        let (mut rest, mut end) = (String::new(), 0);
        for span in spans {
            rest.push_str(text.get(end..span.start).unwrap_or_default());
            end = end.max(span.end);
        }
        rest.push_str(text.get(end..).unwrap_or_default());
        Thoughts {
            length: text.len() - rest.len(),
            rest: rest.trim().len(),
        }
    }

    /// Returns their share of the tokens of the whole text, rounded up; `None` if there are none.
    fn share_of(&self, tokens: u64) -> Option<u64> {
        let whole = (self.length + self.rest) as u128;
        let share = (u128::from(tokens) * self.length as u128).div_ceil(whole.max(1));
        (self.length > 0).then(|| u64::try_from(share).unwrap_or(u64::MAX))
    }
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
            reasoning: None,
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
    fn thoughts_in_the_answer_count_as_reasoning_by_their_share_of_its_tokens() {
        let thoughts = "x".repeat(188);
        for (text, output, reported, spent) in [
            (format!("<think>{thoughts}"), 100, None, 100),
            (format!("<think>{thoughts}"), 100, Some(0), 100),
            (format!("<think>{thoughts}</think>\n"), 100, None, 100),
            (format!("<think>{thoughts}</think>Pick"), 100, None, 99),
            (format!("{thoughts}12345</think>"), 100, None, 100),
            (
                format!("<think>{thoughts}</think>Pick"),
                400,
                Some(200),
                397,
            ),
        ] {
            let failure = failure(&text, output, reported);
            let found = starved(&failure, LENGTHS).expect(&text);
            let told = format!("thoughts in its text took {spent} tokens");
            assert!(found.why.starts_with(&told), "{}", found.why);
            let again = found.again.expect("it is asked again");
            assert_eq!((again.visible, again.hidden), (Some(100), 2048));
        }
        // Half of the text is the answer, and it filled its length.
        let text = format!("<think>{}</think>{}", "x".repeat(85), "y".repeat(100));
        assert_eq!(starved(&failure(&text, 200, None), LENGTHS), None);
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

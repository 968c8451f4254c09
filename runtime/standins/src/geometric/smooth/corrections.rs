//! Applies the corrections of a conversation.
//!
//! In: the turns after the question, and a possible pull. Out: whether it is still allowed. A correction is recognised
//! by its request: another corner, another direction, which it may name, or a smaller distance. A correction with none
//! of these rules out only the answer that it follows.

use super::super::{prompt, spoken};
use super::parsed_prompt::{self, Choice, ParsedPrompt};
use super::pulls::Pull;
use fab_model::{Message, Speaker};

/// Returns whether no correction in `turns` rules a pull out.
pub fn leaves(turns: &[Message], parsed: &ParsedPrompt, pull: &Pull) -> bool {
    let pairs = turns
        .windows(2)
        .filter(|pair| pair[0].speaker == Speaker::Assistant && pair[1].speaker == Speaker::User);
    pairs
        .into_iter()
        .all(|pair| !rules_out(&spoken(&pair[0]), &spoken(&pair[1]), parsed, pull))
}

fn rules_out(answer: &str, correction: &str, parsed: &ParsedPrompt, pull: &Pull) -> bool {
    if prompt::answered("pick", answer) != Some(pull.pick) {
        return false;
    }
    let answered = |field: &str, offered: &[Choice]| {
        let stated = parsed_prompt::choices(answer, field).into_iter().next()?;
        offered.iter().position(|choice| *choice == stated)
    };
    let is_direction = answered("direction", &parsed.directions) == Some(pull.direction);
    let correction = correction.to_lowercase();
    let correction = correction.split_whitespace().collect::<Vec<_>>().join(" ");
    // Corrections also say what was wrong and describe an attached picture; only requests count.
    let is_request = |sentence: &&str| sentence.contains("choose") || sentence.contains("pull ");
    let asked: Vec<&str> = correction.split(". ").filter(is_request).collect();
    if let Some(named) = asked
        .iter()
        .find_map(|sentence| named_direction(sentence, parsed))
    {
        return named != pull.direction;
    }
    let asked = asked.join(". ");
    if asked.contains("smaller distance") {
        let distance = answered("distance", &parsed.distances);
        let is_smaller = distance
            .is_some_and(|at| parsed.distances[pull.distance].value < parsed.distances[at].value);
        return is_direction && !is_smaller;
    }
    if asked.contains("corner") || asked.contains("another point") {
        return true;
    }
    is_direction && answered("distance", &parsed.distances) == Some(pull.distance)
}

/// Returns the offered direction named in a request such as `pull it in the direction 45 deg`.
fn named_direction(asked: &str, parsed: &ParsedPrompt) -> Option<usize> {
    let (_, named) = asked.rsplit_once("direction ")?;
    let named = named.trim_end_matches(['.', '\n', ' ']);
    let is_named = |choice: &Choice| choice.words.eq_ignore_ascii_case(named);
    parsed.directions.iter().position(is_named)
}

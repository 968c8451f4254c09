//! Finds what an answer says in its own words that it chooses, beside the asked form: `2. (10, 20), the tip of the flap`.
//!
//! In: the tokens of an answer. Out: claims that a field has one of the values that such a line or sentence names. They
//! state nothing; the value in the asked form is held against them.

use super::claim::{Claim, Claimed};
use super::cursor::Cursor;
use super::lexer::{Gap, Kind, Token};
use super::names;
use super::sentences::{Reader, THINGS, UNREAL};
use super::sizes;
use super::value::{self, Clarity};
use super::wordlist;
use super::words;
use crate::data::actions::{ActionField, Choices, Value};
use std::ops::Range;

/// Verbs with which the author tells what it has chosen.
const CHOOSING: &[&str] = wordlist::words!("pick picked choose chose select selected");

/// What may stand between such a verb and a point.
const BETWEEN: &[&str] = wordlist::words!("the a corner tip flap one point end at of its is");

/// What a point is called that is chosen.
const BEST: &[&str] = wordlist::words!("best");

/// Nouns for a point that may be chosen.
const CORNERS: &[&str] = wordlist::words!("corner one choice candidate point");

/// Verbs for how a gripper reaches the cloth.
const COMING: &[&str] = wordlist::words!("come comes coming approach approaches approaching");

/// What makes a line or sentence no choice, besides what makes it unreal.
const WEIGHING: &[&str] = wordlist::words!("too or either between both exceeds far already also");

/// The most tokens of a line or sentence that is looked at.
const MAX_PART: usize = 60;

/// Returns the values that numbered lines begin with, and the points that sentences choose.
pub(super) fn of(reader: &Reader<'_>, text: &str, tokens: &[Token<'_>]) -> Vec<Claim> {
    let kinds: [fn(&ActionField) -> bool; 3] = [
        ActionField::is_point,
        |field| matches!(field.choices, Choices::Directions { .. }),
        |field| matches!(field.choices, Choices::Lengths { .. }),
    ];
    let fields: Vec<usize> = kinds
        .into_iter()
        .filter_map(|is_kind| names::only(reader.fields, is_kind))
        .collect();
    let mut claims = Vec::new();
    let mut add = |field: usize, part: Range<usize>| {
        let words = &tokens[part.clone()];
        let is_weighed = words
            .iter()
            .any(|it| it.is_any(UNREAL) || it.is_any(WEIGHING));
        if is_weighed || words.len() > MAX_PART {
            return;
        }
        let context = reader.context(field, text, None, Clarity::Spoken);
        let values = (0..words.len())
            .filter_map(|at| value::bare(&mut Cursor::at(words, at), &context))
            .map(|(value, _)| value)
            .collect();
        let span = words[0].at..words[words.len() - 1].end();
        claims.push(Claim::new(field, span, Claimed::Chosen(values)));
    };
    for at in (0..tokens.len()).filter(|at| is_numbered(text, &tokens[*at])) {
        let end = (at + 1..tokens.len()).find(|next| tokens[*next].gap >= Gap::Line);
        let line = at..end.unwrap_or(tokens.len());
        for field in &fields {
            let context = reader.context(*field, text, None, Clarity::Spoken);
            let mut cursor = Cursor::at(&tokens[..line.end], at);
            // `3. The lower left corner` is no direction.
            let is_value = value::bare(&mut cursor, &context).is_some()
                && !cursor.peek().is_some_and(|it| it.is_any(THINGS))
                && !tokens[at..cursor.at].iter().any(|it| it.is("corner"));
            if is_value {
                add(*field, line.clone());
            }
        }
    }
    let angle = names::only(reader.fields, kinds[1]);
    let parts = value::sentences(tokens).flat_map(|it| sizes::parts(tokens, it));
    for (part, field) in parts.filter_map(|it| Some((it, angle?))) {
        let context = reader.context(field, text, None, Clarity::Spoken);
        let within = &tokens[..part.end];
        // `The fingers have to come in flat, at 0 deg`
        let verb = part.clone().find(|at| within[*at].is_any(COMING));
        let comes = verb.is_some_and(|verb| {
            (verb + 1..part.end).any(|at| {
                let is_number = within.get(at + 1).is_some_and(|it| it.kind == Kind::Number);
                let mut cursor = Cursor::at(within, at + 1);
                within[at].is("at") && is_number && value::bare(&mut cursor, &context).is_some()
            })
        });
        if comes {
            add(field, part);
        }
    }
    let point = names::only(reader.fields, ActionField::is_point);
    for (sentence, field) in value::sentences(tokens).filter_map(|it| Some((it, point?))) {
        let context = reader.context(field, text, None, Clarity::Spoken);
        let within = &tokens[..sentence.end];
        let is_point = |mut cursor: Cursor<'_, '_>| {
            cursor.skip(BETWEEN, &[':']);
            value::bare(&mut cursor, &context).is_some()
        };
        let chooses = sentence.clone().any(|at| {
            let word = &within[at];
            let before = within[..at].last();
            let is_mine = before.is_some_and(|it| it.is_any(&["i", "we"]));
            is_mine && word.is_any(CHOOSING) && is_point(Cursor::at(within, at + 1))
                || word.is_any(CORNERS)
                    && before.is_some_and(|it| it.is_any(BEST))
                    && is_point(Cursor::at(within, at + 1))
                || word.is("is") && {
                    let mut cursor = Cursor::at(within, at + 1);
                    cursor.skip(&["therefore", "thus", "clearly", "the", "my"], &[]);
                    cursor.eat_any(BEST)
                        && cursor.eat_any(CORNERS)
                        && (at.saturating_sub(6).max(sentence.start)..at).any(|begin| {
                            let mut cursor = Cursor::at(&within[..at], begin);
                            value::bare(&mut cursor, &context).is_some() && cursor.at == at
                        })
                }
        });
        if chooses {
            add(field, sentence);
        }
    }
    claims
}

/// Returns whether a token begins a numbered line.
fn is_numbered(text: &str, token: &Token<'_>) -> bool {
    let mark = |letter: char| matches!(letter, '*' | '_' | ' ' | '\t');
    let above = text[..token.at].trim_end_matches(mark);
    token.gap >= Gap::Item
        && above
            .strip_suffix(['.', ')', ':'])
            .is_some_and(|above| above.ends_with(|letter: char| letter.is_ascii_digit()))
}

/// How far an angle may be from the choice to which it is rounded, and words from the angle that they describe, degrees.
const ROUNDED_DEG: f64 = 67.5;

/// Returns whether an answer that says that it chooses one value may mean the other.
pub(super) fn is_near(said: &Value, value: &Value) -> bool {
    match (said, value) {
        (Value::Direction { deg: said }, Value::Direction { deg }) => {
            words::apart_deg(*said, *deg) < ROUNDED_DEG
        }
        _ => said == value,
    }
}

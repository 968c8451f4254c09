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
use super::wordlist::words;
use super::words::apart_deg;
use crate::data::actions::{ActionField, Choices, Value};
use std::ops::Range;

/// Verbs with which the author tells what it has chosen.
const CHOOSING: &[&str] = words!("pick picked choose chose select selected");

/// What may stand between such a verb and a point.
const BETWEEN: &[&str] = words!("the a corner tip flap one point end at of its is");

/// Nouns for a point that may be called the best.
const CORNERS: &[&str] = words!("corner one choice candidate point");

/// Verbs for how a gripper reaches the cloth.
const COMING: &[&str] = words!("come comes coming approach approaches approaching");

/// What makes a line or sentence no choice, besides what makes it unreal.
const WEIGHING: &[&str] = words!("too or either between both exceeds far already also");

/// The most tokens of a point.
const MAX_POINT: usize = 6;

/// The most tokens of a line or sentence that is looked at.
const MAX_PART: usize = 60;

/// Returns what an answer says that it chooses: the values with which numbered lines begin, the angles at which the
/// gripper comes, and, where there is one point, the point that a sentence chooses.
pub(super) fn of(reader: &Reader<'_>, text: &str, tokens: &[Token<'_>]) -> Vec<Claim> {
    let answer = Answer {
        reader,
        text,
        tokens,
    };
    let only = |is_kind: fn(&ActionField) -> bool| names::only(reader.fields, is_kind);
    let point = only(ActionField::is_point);
    let angle = only(|it| matches!(it.choices, Choices::Directions { .. }));
    let length = only(|it| matches!(it.choices, Choices::Lengths { .. }));
    let mut claims = Vec::new();
    for field in [point, angle, length].into_iter().flatten() {
        let lines = answer.numbered_lines(field);
        claims.extend(lines.filter_map(|part| answer.claim(field, part)));
    }
    if let Some(field) = angle {
        let parts = value::sentences(tokens).flat_map(|it| sizes::parts(tokens, it));
        let comes = parts.filter(|part| answer.comes_at(field, part.clone()));
        claims.extend(comes.filter_map(|part| answer.claim(field, part)));
    }
    if let Some(field) = point {
        let sentences = value::sentences(tokens);
        let chooses = sentences.filter(|it| answer.chooses_point(field, it.clone()));
        claims.extend(chooses.filter_map(|part| answer.claim(field, part)));
    }
    claims
}

struct Answer<'a> {
    reader: &'a Reader<'a>,
    text: &'a str,
    tokens: &'a [Token<'a>],
}

impl<'a> Answer<'a> {
    fn context(&self, field: usize) -> value::Context<'a> {
        self.reader.context(field, self.text, None, Clarity::Spoken)
    }

    /// Returns a claim of one of a field's values in a part, unless the part weighs or supposes.
    fn claim(&self, field: usize, part: Range<usize>) -> Option<Claim> {
        let words = &self.tokens[part];
        let is_weighed = |it: &Token<'_>| it.is_any(UNREAL) || it.is_any(WEIGHING);
        if words.len() > MAX_PART || words.iter().any(is_weighed) {
            return None;
        }
        let context = self.context(field);
        let values = (0..words.len())
            .filter_map(|at| value::bare(&mut Cursor::at(words, at), &context))
            .map(|(value, _)| value)
            .collect();
        let span = words.first()?.at..words.last()?.end();
        Some(Claim::new(field, span, Claimed::Chosen(values)))
    }

    /// Returns the numbered lines that begin with a value of a field.
    fn numbered_lines(&self, field: usize) -> impl Iterator<Item = Range<usize>> {
        let numbered =
            (0..self.tokens.len()).filter(|at| is_numbered(self.text, &self.tokens[*at]));
        numbered.filter_map(move |at| {
            let end = (at + 1..self.tokens.len()).find(|next| self.tokens[*next].gap >= Gap::Line);
            let end = end.unwrap_or(self.tokens.len());
            let mut cursor = Cursor::at(&self.tokens[..end], at);
            value::bare(&mut cursor, &self.context(field))?;
            // `3. The lower left corner` is no direction.
            let is_place = cursor.peek().is_some_and(|it| it.is_any(THINGS))
                || self.tokens[at..cursor.at].iter().any(|it| it.is("corner"));
            (!is_place).then_some(at..end)
        })
    }

    /// Returns whether a part tells at which angle the gripper comes: `The fingers have to come in flat, at 0 deg`.
    fn comes_at(&self, field: usize, part: Range<usize>) -> bool {
        let within = &self.tokens[..part.end];
        let verb = part.clone().find(|at| within[*at].is_any(COMING));
        verb.is_some_and(|verb| {
            (verb + 1..part.end).any(|at| {
                let is_number = within.get(at + 1).is_some_and(|it| it.kind == Kind::Number);
                let mut cursor = Cursor::at(within, at + 1);
                within[at].is("at")
                    && is_number
                    && value::bare(&mut cursor, &self.context(field)).is_some()
            })
        })
    }

    /// Returns whether a sentence chooses a point: `I chose (10, 20)`, `The best corner is (10, 20)`, `(10, 20) is the
    /// best corner`.
    fn chooses_point(&self, field: usize, sentence: Range<usize>) -> bool {
        let context = self.context(field);
        let within = &self.tokens[..sentence.end];
        let leads_to_point = |at: usize| {
            let mut cursor = Cursor::at(within, at);
            cursor.skip(BETWEEN, &[':']);
            value::bare(&mut cursor, &context).is_some()
        };
        let follows_point = |at: usize| {
            (at.saturating_sub(MAX_POINT).max(sentence.start)..at).any(|begin| {
                let mut cursor = Cursor::at(&within[..at], begin);
                value::bare(&mut cursor, &context).is_some() && cursor.at == at
            })
        };
        sentence.clone().any(|at| {
            let word = &within[at];
            let before = within[..at].last();
            let follows = |words: &[&str]| before.is_some_and(|it| it.is_any(words));
            if word.is("is") {
                let mut cursor = Cursor::at(within, at + 1);
                cursor.skip(&["therefore", "thus", "clearly", "the", "my"], &[]);
                return cursor.eat_word("best") && cursor.eat_any(CORNERS) && follows_point(at);
            }
            (word.is_any(CHOOSING) && follows(&["i", "we"])
                || word.is_any(CORNERS) && follows(&["best"]))
                && leads_to_point(at + 1)
        })
    }
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
            apart_deg(*said, *deg) < ROUNDED_DEG
        }
        _ => said == value,
    }
}

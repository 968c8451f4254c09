//! Finds what an answer says in its own words that it chooses, beside the asked form: `2. (10, 20), the tip of the flap`.
//!
//! In: the tokens of an answer. Out: claims that a field has one of the values that such a line or sentence names. They
//! state nothing; the value in the asked form is held against them.

use super::claim::{Claim, Claimed, Named};
use super::cursor::Cursor;
use super::lexer::{Gap, Kind, Token};
use super::names;
use super::sentences::Reader;
use super::sizes;
use super::value::{self, Clarity};
use super::wordlist::{PLACES, UNREAL, words};
use crate::data::actions::{ActionField, Choices, Value};
use std::ops::Range;

/// Verbs with which the author tells what it has chosen.
const POINT_CHOSEN: &[&str] = words!("pick picked choose chose select selected");

/// What may stand between such a verb and a point.
const BETWEEN: &[&str] = words!("the a corner tip flap one point end at of its is");

/// Nouns for a point that may be called the best.
const CORNERS: &[&str] = words!("corner one choice candidate point");

/// Verbs for how a gripper reaches the cloth.
const COMING: &[&str] = words!("come comes coming approach approaches approaching");

/// What makes a line or sentence no choice, besides what makes it unreal.
const WEIGHING: &[&str] = words!("too or either between both exceeds far also most limit maximum");

/// Words that call what was just said unfit.
const DROPPING: &[&str] =
    words!("too near rules ruled out ring last excluded forbidden invalid breaks violates");

/// What moves from one point to another.
const MOTIONS: &[&str] = words!(
    "motion movement path arrow gripper move moves moved carry carries carried drag drags dragged bring brings brought travel travels"
);

/// Verbs of a fold that is a motion: `the fold runs from (10, 20) to (30, 40)`.
const RUNNING: &[&str] = words!("runs goes leads");

/// What makes such a part speak of something else than the motion.
const NO_MOTION: &[&str] = words!(
    "edge side hem rim border crease line diagonal seam boundary distance length vector px pixels mm gap row wrinkle flap layer
    cloth's not neither nor than second opposite"
);

/// The most tokens of a line or sentence that is looked at.
const MAX_PART: usize = 60;

/// Returns what an answer says that it chooses: the values with which numbered lines begin, the angles at which the
/// gripper comes, where a motion from the pick point goes, and, where there is one point, the point that a sentence
/// chooses.
///
/// - `stated`: what it states.
pub(super) fn of(
    reader: &Reader<'_>,
    text: &str,
    tokens: &[Token<'_>],
    stated: &[Claim],
) -> Vec<Claim> {
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
        let line = answer.numbered_line(field);
        claims.extend(line.and_then(|part| answer.claim(field, part)));
    }
    // Of a pull, `the crease comes down at 135 deg` says nothing.
    let is_pull = |field: &usize| names::is_compass(&reader.fields[*field]);
    if let Some(field) = angle.filter(|field| !is_pull(field)) {
        let parts = value::sentences(tokens).flat_map(|it| sizes::parts(tokens, it));
        let comes = parts.filter(|part| answer.comes_at(field, part.clone()));
        claims.extend(comes.filter_map(|part| answer.claim(field, part)));
    }
    if let [Some(pick), Some(place)] = ["pick", "place"].map(|name| only_point(reader, name)) {
        let parts = value::sentences(tokens).flat_map(|it| sizes::parts(tokens, it));
        claims.extend(parts.filter_map(|part| answer.goes(pick, place, part, stated)));
    }
    if let Some(field) = point {
        let sentences: Vec<Range<usize>> = value::sentences(tokens).collect();
        let chooses = sentences.iter().enumerate().filter(|(at, it)| {
            let is_dropped = sentences
                .get(at + 1)
                .is_some_and(|next| answer.drops(next.clone()));
            !is_dropped && answer.chooses_point(field, (*it).clone())
        });
        claims.extend(chooses.filter_map(|(_, part)| answer.claim(field, part.clone())));
    }
    claims
}

/// Returns the point field of a name.
fn only_point(reader: &Reader<'_>, name: &str) -> Option<usize> {
    names::only(reader.fields, |it| it.name == name && it.is_point())
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
        let values = (0..words.len()).filter_map(|at| {
            let (value, _) = value::bare(&mut Cursor::at(words, at), &context)?;
            let is_worded = words[at].kind == Kind::Word;
            Some(Named { value, is_worded })
        });
        let values = values.collect();
        let span = words.first()?.at..words.last()?.end();
        Some(Claim::new(field, span, Claimed::Chosen(values)))
    }

    /// Returns the numbered line that begins with a value of a field, if only one does; several list what there is.
    fn numbered_line(&self, field: usize) -> Option<Range<usize>> {
        let numbered =
            (0..self.tokens.len()).filter(|at| is_numbered(self.text, &self.tokens[*at]));
        let mut lines = numbered.filter_map(|at| {
            let end = (at + 1..self.tokens.len()).find(|next| self.tokens[*next].gap >= Gap::Line);
            let end = end.unwrap_or(self.tokens.len());
            let mut cursor = Cursor::at(&self.tokens[..end], at);
            value::bare(&mut cursor, &self.context(field))?;
            // `3. The lower left corner` is no direction, and `1. 1 edge = 222.7 px` no choice.
            let is_worded = self.tokens[at].kind == Kind::Word;
            let is_other = cursor.peek().is_some_and(|it| {
                it.is_any(PLACES)
                    || it.is_sign('=')
                    || is_worded && (it.is_sign('(') || it.is("now"))
            });
            let is_place = self.tokens[at..cursor.at].iter().any(|it| it.is("corner"));
            (!is_other && !is_place).then_some(at..end)
        });
        lines.next().filter(|_| lines.next().is_none())
    }

    /// Returns whether a part tells at which angle the gripper comes: `The fingers have to come in flat, at 0 deg`.
    fn comes_at(&self, field: usize, part: Range<usize>) -> bool {
        let within = &self.tokens[..part.end];
        let verb = part.clone().find(|at| within[*at].is_any(COMING));
        verb.is_some_and(|verb| {
            // `I come in tilted since at 90 deg the tip hits the hem`
            let is_reason = |at: &usize| within[*at].is_any(&["since", "because", "as"]);
            (verb + 1..part.end)
                .take_while(|at| !is_reason(at))
                .any(|at| {
                    let is_number = within.get(at + 1).is_some_and(|it| it.kind == Kind::Number);
                    let mut cursor = Cursor::at(within, at + 1);
                    within[at].is("at")
                        && is_number
                        && value::bare(&mut cursor, &self.context(field)).is_some()
                })
        })
    }

    /// Returns where a part says that a motion from the picked point goes: `The fold runs from (10, 20) to (30, 40)`.
    fn goes(
        &self,
        pick: usize,
        place: usize,
        part: Range<usize>,
        stated: &[Claim],
    ) -> Option<Claim> {
        let words = &self.tokens[part];
        let is_other =
            |it: &Token<'_>| it.is_any(UNREAL) || it.is_any(WEIGHING) || it.is_any(NO_MOTION);
        if words.len() > MAX_PART || words.iter().any(is_other) {
            return None;
        }
        let from = words.iter().position(|it| it.is("from"))?;
        let has = |wanted: &[&str]| words[..from].iter().any(|it| it.is_any(wanted));
        let is_motion = has(MOTIONS) || has(&["fold"]) && has(RUNNING);
        if !is_motion {
            return None;
        }
        let mut cursor = Cursor::at(words, from + 1);
        let (picked, _) = value::bare(&mut cursor, &self.context(pick))?;
        let is_picked = stated.iter().any(|it| it.value_of(pick) == Some(&picked));
        cursor.eat_any(&["to", "onto"]).then_some(())?;
        let (value, _) = value::bare(&mut cursor, &self.context(place))?;
        let named = Named {
            value,
            is_worded: false,
        };
        let span = words[from].at..words[cursor.at - 1].end();
        is_picked.then(|| Claim::new(place, span, Claimed::Chosen(vec![named])))
    }

    /// Returns whether a sentence says of the one before it that it will not do: `It lies too near to a ring.`
    fn drops(&self, sentence: Range<usize>) -> bool {
        let words = &self.tokens[sentence];
        words
            .first()
            .is_some_and(|it| it.is_any(&["it", "that", "but", "however", "yet"]))
            && words
                .iter()
                .any(|it| it.is_any(UNREAL) || it.is_any(DROPPING))
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
            (at.saturating_sub(value::POINT_TOKENS).max(sentence.start)..at).any(|begin| {
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
            (word.is_any(POINT_CHOSEN) && follows(&["i", "we"])
                || word.is_any(CORNERS) && follows(&["best"]))
                && leads_to_point(at + 1)
        })
    }
}

/// Returns whether a token begins a numbered line.
fn is_numbered(text: &str, token: &Token<'_>) -> bool {
    if token.gap < Gap::Item {
        return false;
    }
    let mark = |letter: char| matches!(letter, '*' | '_' | ' ' | '\t');
    let above = text[..token.at].trim_end_matches(mark);
    let number = above.strip_suffix(['.', ')']);
    number.is_some_and(|number| number.ends_with(|it: char| it.is_ascii_digit()))
}

/// How much of a length may be lost when it is rounded.
const ROUNDED: f64 = 0.03;

/// Returns whether an answer that says that it chooses one value may mean the other.
pub(super) fn may_mean(said: &Named, value: &Value) -> bool {
    match (&said.value, value) {
        (Value::Length { length: said }, Value::Length { length }) => {
            (said - length).abs() <= ROUNDED * length.abs()
        }
        _ => said.may_mean(value),
    }
}

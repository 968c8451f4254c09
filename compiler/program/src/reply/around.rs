//! What stands directly above and below an answer, and makes it another one.
//!
//! In: the tokens of an answer, and where its claims are. Out: a heading that makes the lines below it no answer
//! (`What not to do:`), values of other fields' kinds that a short remark states without a name (`Better: 180 deg.`), and fields
//! that a line of values alone states.

use super::aside::Aside;
use super::claim::{Claim, Claimed};
use super::lexer::{Gap, Kind, Token};
use super::names;
use super::remarks::{Stated, spoken};
use super::sentences::Reader;
use super::value::{self, Clarity};
use super::wordlist::{says, words};
use crate::data::actions::{ActionField, Choices, Value};
use std::mem::discriminant;
use std::ops::Range;

/// The most tokens of a heading, and of a remark that only states a value.
const MAX_SHORT: usize = 24;

/// The most different values of an answer that are compared with those of its remarks.
const MAX_STATED: usize = 24;

/// How much of a length may be lost when it is converted.
const ROUNDED: f64 = 0.03;

/// What makes the lines below a heading no answer: it is denied, supposed, one of several, or another's.
const NO_ANSWER: &str = "there is no|would not|wouldn't|won't|must not|mustn't|do not|don't|not to do|not what|avoid|\
    everything except|anything but|opposite of|reverse of|contrary of|incorrect|wrong|mistake|counterexample|counter - example|naive|\
    candidate 1|candidate 2|candidate 3|candidate a|candidate b|option 1|option 2|option 3|second candidate|second option|\
    suppose|supposing|imagine|what if|say we|say i|let us say|pretend|hypothetically|option a|option b|alternative|\
    alternatively|possible answer|possible action|possible solution|one possibility|the format is|template|\
    previously|first attempt|earlier attempt|previous attempt|last attempt|first try|my earlier|gpt|gemini|claude|\
    according to the last|according to the previous|different cloth|another cloth|different picture|another picture|\
    different image|another image|rotated by|upside down|asked for this format|\
    second robot|other robot|other arm|another robot|ruled out|discarded|rejected|should be written|should look|would look|worst|\
    not to be taken|not yet checked|entwurf|beispiel|nicht freigegeben|modèle|exemple|ejemplo";

/// What keeps such words from that: `what I will not do again, so here is the answer:`.
const ANSWER: &str = "chosen|selected|best|winner|my choice|i choose|i chose|here is|here's|final|instead|corrected|therefore|so|thus|hence|avoid this|to avoid|to avoid that";

/// The words of a remark that only states a value.
const STATING: &[&str] = words!(
    "answer chosen choice final summary short in so thus hence therefore result better correct corrected best is are be the an a
    angle direction distance length point pull move use using take choose go goes to should must please change from robot gripper
    on second thought thoughts reflection fold carry with by and then it its place pick at of deg degrees degree ° edge edges mm px pixel
    pixels overall conclusion decision action output value values my i'd i'll that's"
);

/// Returns why the lines below the heading directly above an answer are none.
///
/// - `asides`: what is blank in the text because it states nothing.
/// - `at`: where the answer begins in the text, bytes.
pub(super) fn heading(
    text: &str,
    asides: &[(Range<usize>, Aside)],
    tokens: &[Token<'_>],
    at: usize,
) -> Option<&'static str> {
    let first = tokens.partition_point(|token| token.at < at);
    // Objects and tables have no tokens.
    let above = tokens[..first].last()?;
    if !text.get(above.end()..at)?.contains('\n') {
        return None;
    }
    // Below `Rejected:`, what it heads may have been set aside; the answer comes after that.
    let heads_aside = |(aside, kind): &(Range<usize>, Aside)| {
        let is_said = !matches!(kind, Aside::Comment | Aside::Mark | Aside::Thought);
        is_said && above.end() <= aside.start && aside.end <= at
    };
    if asides.iter().any(heads_aside) {
        return None;
    }
    let line = (0..first).rev().find(|at| tokens[*at].gap >= Gap::Line);
    let line = &tokens[line.unwrap_or(0)..first];
    let sentence = (1..line.len())
        .rev()
        .find(|at| value::ends_sentence(line, at - 1));
    let line = &line[sentence.unwrap_or(0)..];
    let is_whole = value::ends_sentence(line, line.len() - 1);
    let has_number = line
        .iter()
        .any(|token| token.kind == Kind::Number && token.text.len() > 2);
    if line.len() > MAX_SHORT || is_whole || has_number {
        return None;
    }
    let spoken = spoken(line);
    let is_format = line.len() <= 2 && line[0].is("format");
    (is_format || says(&spoken, NO_ANSWER) && !says(&spoken, ANSWER))
        .then_some("the line above it says that it is no answer")
}

/// Returns claims of values that short remarks below the last claim state, and that no field has.
pub(super) fn remarks(
    reader: &Reader<'_>,
    text: &str,
    tokens: &[Token<'_>],
    claims: &[Claim],
    stated: Stated,
) -> Vec<Claim> {
    let has_value = |field: usize| claims.iter().any(|claim| claim.value_of(field).is_some());
    let first = claims.iter().filter(|it| it.span.start <= stated.settled);
    let whole = first
        .map(|claim| claim.span.end)
        .max()
        .unwrap_or(stated.end);
    let end = tokens.partition_point(|token| token.at < whole);
    // `(chosen from 0.1 edge | 0.25 edge)` belongs to the claim.
    let start = (end..tokens.len())
        .find(|at| tokens[*at].gap >= Gap::Line || *at > 0 && value::ends_sentence(tokens, at - 1));
    let Some(start) = start.filter(|_| (0..reader.fields.len()).all(has_value)) else {
        return Vec::new();
    };
    let rest = &tokens[start..];
    let ends = |at: usize| value::ends_sentence(rest, at) || begins_line(rest, at + 1);
    // `0.25 edge?` asks.
    let remarks = pieces(rest, ends).into_iter();
    let remarks = remarks.filter(|sentence| only_states(sentence, "?"));
    let mut values: Vec<&Value> = Vec::new();
    for claim in claims {
        let value = claim.value_of(claim.field);
        values.extend(value.filter(|value| !values.contains(value)));
        // With so many, the answer is asked again anyway.
        if values.len() > MAX_STATED {
            return Vec::new();
        }
    }
    remarks
        .flat_map(|sentence| others(reader, text, sentence, &values))
        .collect()
}

/// Cuts tokens behind each one that ends a piece.
fn pieces<'a, 't>(tokens: &'a [Token<'t>], ends: impl Fn(usize) -> bool) -> Vec<&'a [Token<'t>]> {
    let cuts = (0..tokens.len()).filter(|at| ends(*at) || at + 1 == tokens.len());
    let cuts: Vec<usize> = cuts.map(|at| at + 1).collect();
    let begins = std::iter::once(0).chain(cuts.iter().copied());
    begins
        .zip(&cuts)
        .map(|(from, to)| &tokens[from..*to])
        .collect()
}

fn begins_line(tokens: &[Token<'_>], at: usize) -> bool {
    tokens.get(at).is_some_and(|token| token.gap >= Gap::Line)
}

/// Returns whether a piece is short and has nothing but values and words that state them.
///
/// - `unless`: signs that it must not have.
fn only_states(piece: &[Token<'_>], unless: &str) -> bool {
    piece.len() <= MAX_SHORT
        && piece.iter().all(|token| match token.kind {
            Kind::Word => token.is_any(STATING),
            Kind::Number => true,
            Kind::Sign(sign) => !unless.contains(sign),
        })
}

/// Returns claims of the fields that nothing names, from lines that only state values: `(10, 20), 45 deg, 0.5 edge`.
///
/// Each must be the only value of its kind on its line, and the only field of its kind.
pub(super) fn unnamed(
    reader: &Reader<'_>,
    text: &str,
    tokens: &[Token<'_>],
    claims: &[Claim],
) -> Vec<Claim> {
    let mut is_missing = vec![true; reader.fields.len()];
    for claim in claims.iter().filter(|it| !it.claimed.is_worded()) {
        is_missing[claim.field] = false;
    }
    if !is_missing.contains(&true) {
        return Vec::new();
    }
    let lines = pieces(tokens, |at| begins_line(tokens, at + 1)).into_iter();
    let lines = lines.filter(|line| only_states(line, "?=<>"));
    lines
        .flat_map(|line| {
            let mut values = others(reader, text, line, &[]);
            let count = |field: usize| values.iter().filter(|it| it.field == field).count();
            let is_whole = values.len() > 1
                && (0..is_missing.len()).all(|field| match is_missing[field] {
                    true => count(field) == 1,
                    false => count(field) < 2,
                });
            let is_only = |it: &Claim| {
                let alike = |field: &ActionField| is_alike(field, &reader.fields[it.field]);
                names::only(reader.fields, alike).is_some()
            };
            if values.len() == 2 && is_missing.iter().all(|it| *it) {
                return carried(reader, line, values);
            }
            values.retain(|it| is_whole && is_missing[it.field] && is_only(it));
            values
        })
        .collect()
}

/// Reads two points with an arrow between them, `(10, 20) -> (30, 40)`, where there is a pick and a place alone.
fn carried(reader: &Reader<'_>, line: &[Token<'_>], values: Vec<Claim>) -> Vec<Claim> {
    let field = |name: &str| names::only(reader.fields, |it| it.name == name && it.is_point());
    let between = line.iter().filter(|it| {
        (values[0].span.end..values[1].span.start).contains(&it.at) && it.kind != Kind::Sign(',')
    });
    let between: Vec<&Token<'_>> = between.collect();
    let is_arrow = matches!(between[..], [arrow] if arrow.is_sign('→'));
    let (Some(pick), Some(place), true) = (field("pick"), field("place"), is_arrow) else {
        return Vec::new();
    };
    let fields = [pick, place].into_iter();
    values
        .into_iter()
        .zip(fields.filter(|_| reader.fields.len() == 2))
        .map(|(value, field)| Claim { field, ..value })
        .collect()
}

/// Returns a claim for each value of a sentence that is of a field's kind, but of no field.
///
/// - `stated`: the values of the fields.
fn others(
    reader: &Reader<'_>,
    text: &str,
    sentence: &[Token<'_>],
    stated: &[&Value],
) -> Vec<Claim> {
    let is_stated = |value: &Value| stated.iter().any(|stated| is_about(stated, value));
    let fields = reader.fields.iter().enumerate();
    let mut kinds: Vec<(usize, &ActionField)> = Vec::new();
    for (index, field) in fields {
        let is_kind = field.is_point()
            || matches!(
                field.choices,
                Choices::Directions { .. } | Choices::Lengths { .. }
            );
        if is_kind && !kinds.iter().any(|(_, other)| is_alike(other, field)) {
            kinds.push((index, field));
        }
    }
    let has_place = reader.fields.iter().any(|field| field.name == "place");
    let mut found = Vec::new();
    for (index, field) in kinds {
        let context = reader.context(index, text, None, Clarity::Spoken);
        let mut at = 0;
        while at < sentence.len() {
            let mut cursor = super::cursor::Cursor::at(sentence, at);
            // Only numbers: words such as `right` mean too much.
            let is_number = matches!(sentence[at].kind, Kind::Number | Kind::Sign('(' | '['));
            let value = value::bare(&mut cursor, &context).filter(|_| is_number);
            let Some((value, _)) = value else {
                at += 1;
                continue;
            };
            let tokens = &sentence[at..cursor.at.max(at + 1)];
            let leads =
                field.is_point() && sentence[..at].iter().any(|it| it.is_any(&["to", "place"]));
            // `175 px from (10, 20)`
            let is_origin = field.is_point()
                && at > 1
                && sentence[at - 1].is("from")
                && sentence[at - 2].is_any(&["px", "pixel", "pixels", "mm"]);
            if !is_stated(&value) && (has_place || !leads) && !is_origin {
                let span = tokens[0].at..tokens[tokens.len() - 1].end();
                found.push(Claim::new(index, span, Claimed::Value(value, None)));
            }
            at = cursor.at.max(at + 1);
        }
    }
    found
}

/// Returns whether the values of two fields are written alike.
fn is_alike(a: &ActionField, b: &ActionField) -> bool {
    let kind = |field: &ActionField| discriminant(&field.choices);
    a.is_point() && b.is_point() || kind(a) == kind(b)
}

/// Returns whether two values are the same up to rounding: `0.75 edge, 253 mm`.
fn is_about(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Length { length: a }, Value::Length { length: b }) => {
            (a - b).abs() <= ROUNDED * a.abs()
        }
        (Value::Direction { deg: a }, Value::Direction { deg: b }) => {
            let apart = (a - b).rem_euclid(360.0);
            apart.min(360.0 - apart) < 1.0
        }
        _ => a == b,
    }
}

//! Reads bare numbers and units: the pieces of [`super::expression`].

use super::cursor::{Cursor, first_word};
use crate::units::{DEG, Dimension, EDGE, UNITS, Unit};

/// The largest number that an answer can mean.
pub(super) const MAX_NUMBER: f64 = 1_000_000.0;

/// The most digits of a number.
const MAX_DIGITS: usize = 24;

/// A number's decimal separator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimals {
    /// A point, or none.
    Point,
    /// A comma, which may also separate two numbers.
    Comma,
}

/// What follows a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AnswerUnit {
    /// A unit of the language.
    Of(&'static Unit),
    /// Percent of something unnamed.
    Percent,
    /// Percent of the cloth's longer side.
    PercentOfEdge,
}

/// Returns a decimal digit, of normal or full width.
fn digit(character: char) -> Option<char> {
    match character {
        '0'..='9' => Some(character),
        '０'..='９' => char::from_u32(u32::from(character) - u32::from('０') + u32::from('0')),
        _ => None,
    }
}

/// Reads a number without sign or exponent.
///
/// Fails with the reason, or with `None` if there is no number here.
pub(super) fn number(cursor: &mut Cursor<'_>) -> Result<(f64, Decimals), Option<String>> {
    for (character, value) in [('¼', 0.25), ('½', 0.5), ('¾', 0.75), ('⅛', 0.125)] {
        if cursor.eat(character) {
            return Ok((value, Decimals::Point));
        }
    }
    let start = *cursor;
    let is_digit = |character: char| digit(character).is_some();
    let whole = cursor.skip(is_digit);
    let mut decimals = Decimals::Point;
    let mut behind = "";
    let mark = *cursor;
    if let Some(separator) = cursor.peek().filter(|it| ".,．，".contains(*it)) {
        cursor.step();
        behind = cursor.skip(is_digit);
        let is_comma = matches!(separator, ',' | '，');
        if behind.is_empty() || (is_comma && whole.is_empty()) {
            (*cursor, behind) = (mark, "");
        } else if is_comma {
            decimals = Decimals::Comma;
        }
    }
    if whole.is_empty() && behind.is_empty() {
        *cursor = start;
        return Err(None);
    }
    let n_digits = whole.chars().count() + behind.chars().count();
    if n_digits > MAX_DIGITS {
        return Err(Some(format!("its number has {n_digits} digits")));
    }
    let is_zero = whole.chars().all(|character| digit(character) == Some('0'));
    if decimals == Decimals::Comma && behind.chars().count() == 3 && !is_zero {
        return Err(Some(
            "its comma can set apart decimals or thousands".to_owned(),
        ));
    }
    let plain: String = whole
        .chars()
        .filter_map(digit)
        .chain(['.'])
        .chain(behind.chars().filter_map(digit))
        .chain(['0'])
        .collect();
    let value: f64 = plain.parse().map_err(|_| None)?;
    if value > MAX_NUMBER {
        return Err(Some("its number is far too large".to_owned()));
    }
    Ok((value, decimals))
}

/// Reads a unit and the blanks before it; without a unit the cursor does not move.
pub(super) fn unit(cursor: &mut Cursor<'_>) -> Option<AnswerUnit> {
    let start = *cursor;
    cursor.skip(|character| matches!(character, ' ' | '\t' | '\u{a0}' | '\u{202f}' | '\\' | '$'));
    let found = if cursor.eat('^') {
        raised_circle(cursor).then_some(AnswerUnit::Of(&DEG))
    } else if eat_any(cursor, &['%', '％']) || cursor.eat_word("percent") {
        let is_of_edge = of_edge(cursor);
        Some(if is_of_edge {
            AnswerUnit::PercentOfEdge
        } else {
            AnswerUnit::Percent
        })
    } else if of_edge(cursor) {
        Some(AnswerUnit::Of(&EDGE))
    } else {
        named(cursor).map(AnswerUnit::Of)
    };
    if found.is_none() {
        *cursor = start;
    }
    found
}

/// Reads the rest of LaTeX's `^{\circ}` after the `^`.
fn raised_circle(cursor: &mut Cursor<'_>) -> bool {
    cursor.skip(|character| character == '{' || character == '\\');
    let is_there = cursor.eat_word("circ") || cursor.eat('∘');
    cursor.eat('}');
    is_there
}

/// Reads the name or a spelling of a unit that answers may use. Pixels are only for points.
fn named(cursor: &mut Cursor<'_>) -> Option<&'static Unit> {
    let rest = cursor.rest();
    let stands_here = |word: &&str| match word.is_ascii() {
        true => first_word(rest).eq_ignore_ascii_case(word),
        false => rest.starts_with(word),
    };
    let units = UNITS
        .iter()
        .filter(|unit| unit.dimension != Dimension::Pixels);
    let mut found = units.filter_map(|unit| Some((unit, unit.words().find(stands_here)?)));
    let (unit, word) = found.next()?;
    cursor.at += word.len();
    Some(unit)
}

/// Reads `edge`, `edges`, `of the edge`, `* edge length`; otherwise the cursor does not move.
fn of_edge(cursor: &mut Cursor<'_>) -> bool {
    let start = *cursor;
    blanks(cursor);
    let _ = eat_any(cursor, &['*', '×', '·']) || cursor.eat_word("of") || cursor.eat_word("times");
    blanks(cursor);
    for word in ["the", "an", "cloth"] {
        cursor.eat_word(word);
        blanks(cursor);
    }
    if !cursor.eat_word("edge") && !cursor.eat_word("edges") {
        *cursor = start;
        return false;
    }
    let behind = *cursor;
    cursor.skip(|character| character == ' ' || character == '_' || character == '-');
    if !cursor.eat_word("length") && !cursor.eat_word("lengths") {
        *cursor = behind;
    }
    true
}

/// Skips one of these characters.
pub(super) fn eat_any(cursor: &mut Cursor<'_>, wanted: &[char]) -> bool {
    wanted.iter().any(|character| cursor.eat(*character))
}

/// Skips blanks on the same line.
pub(super) fn blanks(cursor: &mut Cursor<'_>) {
    cursor.skip(|character| matches!(character, ' ' | '\t' | '\u{a0}' | '\u{202f}'));
}

//! Reads one point by its number, if points are numbered: `3`, `point 3`, `#3`, `3 at (41, 167)`.
//!
//! In: a cursor after the field's name. Out: the numbered point. Coordinates alone are rejected: a model that gives
//! them instead of a number has its own frame in mind.

use super::around::list_number;
use super::cursor::{Cursor, decorates};
use super::finding::{Clarity, Found};
use super::pixel::{self, Brackets};
use crate::data::actions::Value;
use crate::pointing::Notation;

/// The most digits of a number; no scene has so many points.
const MAX_DIGITS: usize = 6;

/// Words that may precede a number.
const LEADING: [&str; 12] = [
    "the",
    "listed",
    "point",
    "number",
    "no",
    "nr",
    "candidate",
    "mark",
    "label",
    "index",
    "id",
    "corner",
];

/// Words that join a number to another one.
const JOINING: [&str; 5] = ["or", "and", "to", "through", "then"];

/// Reads a number and moves past it.
pub(super) fn read(cursor: &mut Cursor<'_>, notation: &Notation, firmness: Clarity) -> Found {
    if firmness == Clarity::Loose {
        return Found::Nothing;
    }
    match number(cursor, notation) {
        // In running text, a number that is not a point means nothing.
        Found::Bad(_) if firmness == Clarity::Spoken => Found::Nothing,
        found => found,
    }
}

fn number(cursor: &mut Cursor<'_>, notation: &Notation) -> Found {
    let start = *cursor;
    skip_blank(cursor);
    let is_new_line = start.text[start.at..cursor.at].contains('\n');
    if is_new_line && list_number(*cursor).is_some() {
        return Found::Nothing;
    }
    if by_coordinates(*cursor, notation) {
        return Found::Bad("it is given by coordinates, and its number is asked for".to_owned());
    }
    lead(cursor);
    let digits = cursor.skip(|character| character.is_ascii_digit());
    if digits.is_empty() {
        *cursor = start;
        return Found::Nothing;
    }
    let n_points = notation.marks().len();
    let number = digits.parse().ok().filter(|_| digits.len() <= MAX_DIGITS);
    let Some(point) = number.and_then(|number| notation.marked(number)) else {
        return Found::Bad(match n_points {
            0 => format!("no point has the number {digits}: none is offered"),
            _ => format!("no point has the number {digits}; they are numbered 1 to {n_points}"),
        });
    };
    if goes_on(*cursor) {
        return Found::Bad("it is not one whole number".to_owned());
    }
    let mut behind = *cursor;
    skip_blank(&mut behind);
    behind.skip(|character| matches!(character, ')' | ']' | '}' | ':'));
    skip_blank(&mut behind);
    behind.eat_word("at");
    skip_blank(&mut behind);
    match pixel::read(&mut behind, notation, Brackets::Needed) {
        pixel::PixelFound::Pixel(place, _) if place != point => {
            return Found::Bad(format!(
                "its number says {} and its coordinates say another place",
                notation.written(point)
            ));
        }
        pixel::PixelFound::Pixel(..) => *cursor = behind,
        pixel::PixelFound::Bad(_) | pixel::PixelFound::Nothing => {}
    }
    if leaves_open(*cursor) {
        return Found::Bad("it leaves more than one point open".to_owned());
    }
    Found::Value(Value::Point(point), None)
}

fn skip_blank(cursor: &mut Cursor<'_>) {
    cursor.skip(|character| character.is_whitespace() || decorates(character));
}

/// Returns whether coordinates follow: two numbers in a row, with or without brackets.
fn by_coordinates(start: Cursor<'_>, notation: &Notation) -> bool {
    let mut cursor = start;
    match pixel::read(&mut cursor, notation, Brackets::Optional) {
        pixel::PixelFound::Pixel(..) => true,
        // A single number may be a point's.
        pixel::PixelFound::Bad(_) => start.text[start.at..cursor.at].contains(','),
        pixel::PixelFound::Nothing => false,
    }
}

/// Skips brackets, words, their colons and a `#`.
fn lead(cursor: &mut Cursor<'_>) {
    for _ in 0..5 {
        cursor.skip(|character| {
            character.is_whitespace()
                || decorates(character)
                || matches!(character, '(' | '[' | '{' | '<' | ':' | '=' | '#' | '№')
        });
        if !LEADING.iter().any(|word| cursor.eat_word(word)) {
            return;
        }
        cursor.eat('.');
    }
}

/// Returns whether digits are only the beginning of something else: `3.5`, `3rd`, `3%`.
fn goes_on(cursor: Cursor<'_>) -> bool {
    let mut rest = cursor.rest().chars();
    match rest.next() {
        Some('.' | ',') => rest.next().is_some_and(|next| next.is_ascii_digit()),
        Some(next) => next.is_alphanumeric() || matches!(next, '%' | '°'),
        None => false,
    }
}

/// Returns whether another number follows as an alternative: `3 or 4`, `3/4`, `3-4`.
fn leaves_open(mut cursor: Cursor<'_>) -> bool {
    let blank =
        |character: char| matches!(character, ' ' | '\t' | ',' | ')' | ']') || decorates(character);
    cursor.skip(blank);
    let is_joined = JOINING.iter().any(|word| cursor.eat_word(word))
        || ['/', '|', '-', '–', '&', '+']
            .iter()
            .any(|sign| cursor.eat(*sign));
    if !is_joined {
        return false;
    }
    lead(&mut cursor);
    cursor.peek().is_some_and(|next| next.is_ascii_digit())
}

//! Reads one pixel: `(x, y)` as asked for, and the forms that models use instead.

use super::cursor::{Cursor, decorates, head};
use crate::program::PixelPoint;

/// The largest coordinate that can be meant, pixels; far beyond any picture.
const MAX_COORDINATE: f64 = 1_000_000.0;

/// The most characters between brackets.
const MAX_INSIDE: usize = 200;

/// What stands where a pixel is expected.
pub(super) enum Found {
    /// A pixel, and whether its numbers were rounded.
    Pixel(PixelPoint, Option<String>),
    /// Numbers that make no pixel, and why not.
    Bad(String),
    /// Something else.
    Nothing,
}

/// Whether two numbers without brackets are a pixel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Brackets {
    Needed,
    Optional,
}

/// Reads a pixel and moves behind it; where there is none the cursor does not move.
pub(super) fn read(cursor: &mut Cursor<'_>, brackets: Brackets) -> Found {
    let start = *cursor;
    let mut closing = Vec::new();
    while let Some(close) = cursor
        .peek()
        .and_then(closing_of)
        .filter(|_| closing.len() < 2)
    {
        cursor.step();
        closing.push(close);
        cursor.skip(|character| character.is_whitespace());
    }
    if closing.is_empty() && (brackets == Brackets::Needed || !starts_number(cursor.rest())) {
        return Found::Nothing;
    }
    let inside = match closing.last() {
        Some(close) => match head(cursor.rest(), MAX_INSIDE + 1).find(*close) {
            Some(length) => {
                let inside = &cursor.rest()[..length];
                cursor.at += length;
                inside
            }
            // A cut answer may have lost digits, so that even two numbers are not to be trusted.
            None if starts_number(cursor.rest()) => {
                return Found::Bad("its bracket is never closed".to_owned());
            }
            None => {
                *cursor = start;
                return Found::Nothing;
            }
        },
        None => {
            let length = cursor
                .rest()
                .find(|character: char| !is_bare(character))
                .unwrap_or(cursor.rest().len());
            let inside = cursor.rest()[..length].trim_end_matches([' ', '\t', ',', '.']);
            cursor.at += inside.len();
            inside
        }
    };
    for close in closing.iter().rev() {
        cursor.skip(|character| character.is_whitespace());
        cursor.eat(*close);
    }
    match coordinates(inside) {
        Some(numbers) => pixel(&numbers),
        None => {
            *cursor = start;
            Found::Nothing
        }
    }
}

fn closing_of(opening: char) -> Option<char> {
    match opening {
        '(' => Some(')'),
        '[' => Some(']'),
        '{' => Some('}'),
        '<' => Some('>'),
        _ => None,
    }
}

fn starts_number(text: &str) -> bool {
    let text = text.trim_start_matches(['-', '+', '−', '.']);
    text.starts_with(|character: char| character.is_ascii_digit())
}

fn is_bare(character: char) -> bool {
    character.is_ascii_digit() || matches!(character, '-' | '+' | '−' | '.' | ',' | ' ' | '\t')
}

/// Returns the coordinates between two brackets, each with its name where it has one; None where there is anything else.
fn coordinates(inside: &str) -> Option<Vec<(Option<char>, f64)>> {
    let mut cursor = Cursor::new(inside, 0);
    let mut numbers = Vec::new();
    let separates = |character: char| {
        character.is_whitespace() || decorates(character) || matches!(character, ',' | ';')
    };
    loop {
        cursor.skip(separates);
        if cursor.peek().is_none() {
            return (!numbers.is_empty()).then_some(numbers);
        }
        let name = name(&mut cursor);
        numbers.push((name, number(&mut cursor)?));
        cursor.skip(|character| character.is_whitespace());
        if !cursor.eat_word("pixels") {
            cursor.eat_word("px");
        }
    }
}

/// Reads `x:` or `"y" =`; the cursor does not move where there is no such name.
fn name(cursor: &mut Cursor<'_>) -> Option<char> {
    let start = *cursor;
    for (words, axis) in [
        (["x", "u", "col", "column"], 'x'),
        (["y", "v", "row", "line"], 'y'),
    ] {
        for word in words {
            *cursor = start;
            if !cursor.eat_word(word) {
                continue;
            }
            cursor.skip(|character| character.is_whitespace() || decorates(character));
            if cursor.eat(':') || cursor.eat('=') {
                cursor.skip(|character| character.is_whitespace() || decorates(character));
                return Some(axis);
            }
        }
    }
    *cursor = start;
    None
}

fn number(cursor: &mut Cursor<'_>) -> Option<f64> {
    let is_negative = matches!(cursor.peek(), Some('-' | '−'));
    if is_negative || cursor.peek() == Some('+') {
        cursor.step();
    }
    let digits = cursor.skip(|character| character.is_ascii_digit() || character == '.');
    let value: f64 = digits.parse().ok()?;
    // `1e3` is a number too, but nobody writes a pixel so: better to ask again.
    if cursor.peek().is_some_and(|next| next.is_alphabetic())
        && !cursor.rest().to_ascii_lowercase().starts_with('p')
    {
        return None;
    }
    Some(if is_negative { -value } else { value })
}

fn pixel(numbers: &[(Option<char>, f64)]) -> Found {
    let (u, v) = match numbers {
        [(None | Some('x'), u), (None | Some('y'), v)] => (*u, *v),
        [(Some('y'), v), (Some('x'), u)] => (*u, *v),
        [_, _] => return Found::Bad("one coordinate is named twice".to_owned()),
        [_] => return Found::Bad("it has one number instead of two".to_owned()),
        _ => return Found::Bad(format!("it has {} numbers instead of two", numbers.len())),
    };
    if u.abs() > MAX_COORDINATE || v.abs() > MAX_COORDINATE {
        return Found::Bad("it lies far outside of any picture".to_owned());
    }
    // Both are at most a million, so nothing is cut off.
    let pixel = PixelPoint::new(u.round() as i32, v.round() as i32);
    let is_whole = u.fract() == 0.0 && v.fract() == 0.0;
    Found::Pixel(
        pixel,
        (!is_whole).then(|| format!("rounded ({u}, {v}) to {pixel}")),
    )
}

//! Reads one point by its coordinates: `(x, y)` or `[y, x]` as requested, and the forms that models use instead.
//!
//! In: a cursor, and the scene's notation, which turns numbers into the pixel that they mean. Numbers that show that
//! their order or unit is not the requested one are rejected.

use super::cursor::{Cursor, decorates, head};
use crate::data::camera::PixelPoint;
use crate::pointing::{CoordinateUnit, Notation, Order};

/// The largest coordinate that an answer can mean, pixels; far beyond any picture.
const MAX_COORDINATE: f64 = 1_000_000.0;

/// The most characters between brackets.
const MAX_INSIDE: usize = 200;

/// Keys that may precede a point, `{"point": [10, 20]}`.
const KEYS: [&str; 7] = [
    "point_2d",
    "point",
    "pixel",
    "position",
    "location",
    "coordinates",
    "coords",
];

/// What was found where a pixel is expected.
pub(super) enum PixelFound {
    /// A pixel, and how it was read if it would be written with other numbers.
    Pixel(PixelPoint, Option<String>),
    /// Numbers that are not a pixel, and why not.
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

/// Reads a pixel and moves past it; otherwise the cursor does not move.
pub(super) fn read(cursor: &mut Cursor<'_>, notation: &Notation, brackets: Brackets) -> PixelFound {
    let start = *cursor;
    let closing = opened(cursor);
    if closing.is_empty() && brackets == Brackets::Needed {
        return PixelFound::Nothing;
    }
    if closing.is_empty() && !starts_number(cursor.rest()) {
        return match named_pair(cursor, notation) {
            Some(numbers) => pixel(&numbers, None, notation),
            None => PixelFound::Nothing,
        };
    }
    let inside = match closing.last() {
        Some(close) => match head(cursor.rest(), MAX_INSIDE + 1).find(*close) {
            Some(length) => {
                let inside = &cursor.rest()[..length];
                cursor.at += length;
                inside
            }
            // A truncated answer may have lost digits, so even two numbers cannot be trusted.
            None if starts_number(cursor.rest()) => {
                return PixelFound::Bad("its bracket is never closed".to_owned());
            }
            None => {
                *cursor = start;
                return PixelFound::Nothing;
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
    match coordinates(inside, notation) {
        Some(numbers) => pixel(&numbers, closing.last().copied(), notation),
        None => {
            *cursor = start;
            PixelFound::Nothing
        }
    }
}

/// Skips opening brackets, `[[`, `{"point": [`, `<point`; returns the closing ones.
fn opened(cursor: &mut Cursor<'_>) -> Vec<char> {
    let mut closing = Vec::new();
    let mut most = 2;
    while let Some(close) = cursor.peek().and_then(closing_of)
        && closing.len() < most
    {
        cursor.step();
        closing.push(close);
        cursor.skip(|character| character.is_whitespace());
        match close {
            '>' => {
                cursor.eat_word("point");
                cursor.skip(|character| character.is_whitespace());
            }
            '}' if skip_key(cursor) => most = 3,
            _ => {}
        }
    }
    closing
}

/// Skips `"point":`; if there is no such key, or no bracket after it, the cursor does not move.
fn skip_key(cursor: &mut Cursor<'_>) -> bool {
    let start = *cursor;
    let blank = |character: char| character.is_whitespace() || decorates(character);
    cursor.skip(blank);
    let is_key = KEYS.iter().any(|key| cursor.eat_word(key));
    cursor.skip(blank);
    let has_colon = cursor.eat(':');
    cursor.skip(blank);
    if is_key && has_colon && cursor.peek().and_then(closing_of).is_some() {
        return true;
    }
    *cursor = start;
    false
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

/// A coordinate.
struct Coordinate {
    /// `x` or `y`, if it is named.
    name: Option<char>,
    value: f64,
    /// Whether it has the unit px.
    has_px: bool,
}

/// Reads `x = 0.412, y = 0.33` without brackets; if there is no such pair, the cursor does not move.
fn named_pair(cursor: &mut Cursor<'_>, notation: &Notation) -> Option<Vec<Coordinate>> {
    let start = *cursor;
    let mut numbers = Vec::with_capacity(2);
    for _ in 0..2 {
        cursor
            .skip(|character| matches!(character, ' ' | '\t' | ',' | ';') || decorates(character));
        cursor.eat_word("and");
        cursor.skip(|character| character == ' ');
        match coordinate(cursor, notation).filter(|it| it.name.is_some()) {
            Some(found) => numbers.push(found),
            None => {
                *cursor = start;
                return None;
            }
        }
    }
    Some(numbers)
}

/// Returns the coordinates between two brackets; `None` if there is anything else.
fn coordinates(inside: &str, notation: &Notation) -> Option<Vec<Coordinate>> {
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
        // A point's name says nothing about its position.
        if !numbers.is_empty() && cursor.rest().starts_with("alt=") {
            return Some(numbers);
        }
        numbers.push(coordinate(&mut cursor, notation)?);
    }
}

/// Reads a number with its name and unit, if it has them.
fn coordinate(cursor: &mut Cursor<'_>, notation: &Notation) -> Option<Coordinate> {
    let name = name(cursor);
    let value = number(cursor)?;
    let behind = *cursor;
    cursor.skip(|character| character.is_whitespace());
    let has_px = cursor.eat_word("pixels") || cursor.eat_word("px");
    let in_percent = notation.unit() == CoordinateUnit::Percent && cursor.eat('%');
    if !has_px && !in_percent {
        *cursor = behind;
    }
    Some(Coordinate {
        name,
        value,
        has_px,
    })
}

/// Reads `x:` or `"y" =`; otherwise the cursor does not move.
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
    // A second point ends the sentence.
    let ends_sentence = digits.ends_with('.') && digits.matches('.').count() == 2;
    let digits = if ends_sentence {
        cursor.at -= 1;
        &digits[..digits.len() - 1]
    } else {
        digits
    };
    let value: f64 = digits.parse().ok()?;
    // `1e3` is a number too, but nobody writes a pixel like that, so it is better to ask again.
    if cursor.peek().is_some_and(|next| next.is_alphabetic())
        && !cursor.rest().to_ascii_lowercase().starts_with('p')
    {
        return None;
    }
    Some(if is_negative { -value } else { value })
}

fn pixel(numbers: &[Coordinate], close: Option<char>, notation: &Notation) -> PixelFound {
    let [first, second] = numbers else {
        return PixelFound::Bad(match numbers.len() {
            1 => "it has one number instead of two".to_owned(),
            n_numbers => format!("it has {n_numbers} numbers instead of two"),
        });
    };
    let (x, y) = match (notation.order(), first.name, second.name) {
        (_, Some('y'), Some('x')) => (second, first),
        (_, Some('x'), Some('y')) | (Order::Xy, None | Some('x'), None | Some('y')) => {
            (first, second)
        }
        (Order::Yx, None, None) if close == Some(']') => (second, first),
        (Order::Yx, None, None) => {
            let why = "its two numbers stand in no square brackets, so that either can be x";
            return PixelFound::Bad(why.to_owned());
        }
        (Order::Yx, ..) if first.name != second.name => {
            return PixelFound::Bad("only one of its coordinates is named".to_owned());
        }
        _ => return PixelFound::Bad("one coordinate is named twice".to_owned()),
    };
    let counts_pixels = notation.unit() == CoordinateUnit::Pixels;
    if !counts_pixels && [x, y].iter().any(|it| it.has_px) {
        return PixelFound::Bad("it is given in pixels".to_owned());
    }
    let (x, y) = (x.value, y.value);
    if x.abs() > MAX_COORDINATE || y.abs() > MAX_COORDINATE {
        return PixelFound::Bad("it lies far outside of any picture".to_owned());
    }
    let pixel = notation.pixel(x, y);
    let is_whole = x.fract() == 0.0 && y.fract() == 0.0;
    let note = (notation.is_native() && !is_whole)
        .then(|| format!("rounded ({x}, {y}) to {}", notation.written(pixel)));
    PixelFound::Pixel(pixel, note)
}

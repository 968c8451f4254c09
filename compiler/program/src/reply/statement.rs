//! Reads one statement of a field, starting at the field's name.
//!
//! In: an answer and a position where a field is named. Out: the value that is stated there and how firmly, or
//! nothing. Markdown, JSON, other signs and words in between are understood.

use super::around;
use super::choice::{Expected, TextEnd};
use super::cursor::{Cursor, decorates, head};
use super::finding::{Clarity, Found};
use super::mark;
use super::names::{Mention, NEGATING, is_negated, turns};
use super::pixel::{self, Brackets};
use super::value;
use crate::data::actions::{ActionField, Value};
use crate::data::camera::PixelPoint;
use crate::pointing::Notation;

/// The most characters between a field's name and its point.
const MAX_BETWEEN: usize = 100;

/// Words that may follow the name of a field that is a point.
const POINT_NOUNS: [&str; 7] = [
    "point",
    "pixel",
    "position",
    "location",
    "coordinates",
    "coordinate",
    "coords",
];

/// Words that may follow the name of any other field.
const NOUNS: [&str; 5] = ["angle", "value", "choice", "length", "type"];

/// What is needed to read lengths and points of an answer.
#[derive(Clone, Copy)]
pub(super) struct Scale<'a> {
    /// The cloth's longer side, metres.
    pub edge_m: f64,
    /// How the scene's points are written.
    pub notation: &'a Notation,
}

/// A statement of a field.
pub(super) struct Statement<'t> {
    /// How clearly it is a statement.
    pub firmness: Clarity,
    /// Its value.
    pub value: Value,
    /// Its text.
    pub text: &'t str,
    /// How the value was read from it, if that is not obvious.
    pub note: Option<String>,
}

/// Reads the statement that begins with a field's name: `None` if there is none, an error for a wrong one.
pub(super) fn statement_at<'t>(
    scale: Scale<'_>,
    field: &ActionField,
    reply: &'t str,
    named: Mention,
) -> Option<Result<Statement<'t>, String>> {
    if is_negated(reply, named.at) {
        return None;
    }
    let is_point = field.is_point();
    let blank = |character: char| matches!(character, ' ' | '\t' | '-') || decorates(character);
    // The text after another field's name belongs to that field.
    let text = &reply[..named.until];
    let mut cursor = Cursor::new(text, named.end);
    cursor.skip(blank);
    let nouns = if is_point { &POINT_NOUNS[..] } else { &NOUNS };
    let has_noun = nouns.iter().any(|noun| cursor.eat_word(noun));
    if !has_noun && text[named.end..].starts_with(char::is_alphanumeric) {
        return None;
    }
    let hint = if is_point {
        skip_echo(&mut cursor);
        None
    } else {
        around::hint(&mut cursor)
    };
    cursor.skip(blank);
    let firmness = match sign(&mut cursor) {
        Sign::Assigns => Clarity::Assigned,
        Sign::Says => Clarity::Spoken,
        Sign::None if has_noun => Clarity::Spoken,
        Sign::None => Clarity::Loose,
    };
    let found = if is_point {
        match scale.notation.is_of_marks() {
            true => mark::read(&mut cursor, scale.notation, firmness),
            false => point(&mut cursor, scale.notation, firmness),
        }
    } else {
        if firmness < Clarity::Spoken {
            cursor.eat_word("of");
        }
        let end = if named.until < reply.len() {
            TextEnd::Name
        } else {
            TextEnd::Answer
        };
        let expected = Expected {
            field,
            edge_m: scale.edge_m,
            hint,
            end,
        };
        value::read(&mut cursor, &expected, firmness)
    };
    match found {
        Found::Value(value, note) => Some(Ok(Statement {
            firmness,
            value,
            text: &reply[named.at..cursor.at],
            note,
        })),
        Found::Bad(why) => Some(Err(why)),
        Found::Nothing => None,
    }
}

fn point(cursor: &mut Cursor<'_>, notation: &Notation, firmness: Clarity) -> Found {
    let brackets = match firmness {
        Clarity::Assigned => Brackets::Optional,
        Clarity::Spoken | Clarity::Loose => Brackets::Needed,
    };
    cursor.skip(|character| character.is_whitespace() || decorates(character));
    let mut found = pixel::read(cursor, notation, brackets);
    if matches!(found, pixel::PixelFound::Nothing)
        && firmness == Clarity::Assigned
        && skip_words(cursor)
    {
        found = pixel::read(cursor, notation, Brackets::Needed);
    }
    match found {
        pixel::PixelFound::Pixel(point, _) if leaves_open(*cursor, notation, point) => {
            if firmness == Clarity::Assigned {
                Found::Bad("it leaves more than one point open".to_owned())
            } else {
                Found::Nothing
            }
        }
        pixel::PixelFound::Pixel(point, rounding) => Found::Value(Value::Point(point), rounding),
        // In running text, brackets with other numbers mean nothing.
        pixel::PixelFound::Bad(why) if firmness == Clarity::Assigned => Found::Bad(why),
        pixel::PixelFound::Bad(_) | pixel::PixelFound::Nothing => Found::Nothing,
    }
}

/// Returns whether another point follows as an alternative: `(1, 2) or (3, 4)`.
fn leaves_open(mut cursor: Cursor<'_>, notation: &Notation, point: PixelPoint) -> bool {
    let blank = |character: char| matches!(character, ' ' | '\t' | ',') || decorates(character);
    cursor.skip(blank);
    if !cursor.eat_word("or") && !cursor.eat('/') && !cursor.eat('|') {
        return false;
    }
    cursor.skip(blank);
    match pixel::read(&mut cursor, notation, Brackets::Needed) {
        pixel::PixelFound::Pixel(other, _) => other != point,
        pixel::PixelFound::Bad(_) => true,
        pixel::PixelFound::Nothing => false,
    }
}

/// Skips `(x, y)` or `[y, x]` between the name and the sign: the model repeats the format there.
fn skip_echo(cursor: &mut Cursor<'_>) {
    let start = *cursor;
    cursor.skip(|character| character == ' ' || decorates(character));
    for echo in ["(x, y)", "(x,y)", "[x, y]", "[x,y]", "[y, x]", "[y,x]"] {
        if cursor
            .rest()
            .get(..echo.len())
            .is_some_and(|text| text.eq_ignore_ascii_case(echo))
        {
            cursor.at += echo.len();
            return;
        }
    }
    *cursor = start;
}

enum Sign {
    Assigns,
    Says,
    None,
}

fn sign(cursor: &mut Cursor<'_>) -> Sign {
    if cursor.eat(':') || cursor.eat('：') || cursor.eat('＝') || cursor.eat('≈') {
        cursor.eat('=');
        return Sign::Assigns;
    }
    if cursor.eat('=') {
        cursor.skip(|character| matches!(character, '=' | '>'));
        return Sign::Assigns;
    }
    let start = *cursor;
    for words in [
        ["is", "at"],
        ["equals", ""],
        ["should", "be"],
        ["will", "be"],
        ["is", ""],
        ["at", ""],
    ] {
        *cursor = start;
        let is_there = words.iter().all(|word| {
            let found = word.is_empty() || cursor.eat_word(word);
            cursor.skip(|character| character == ' ');
            found
        });
        if is_there {
            return Sign::Says;
        }
    }
    *cursor = start;
    Sign::None
}

/// Skips words up to a bracket on the same line; does not move if a negating word comes first.
fn skip_words(cursor: &mut Cursor<'_>) -> bool {
    // A character has at most four bytes.
    let rest = head(cursor.rest(), 4 * MAX_BETWEEN + 4);
    let Some(length) = rest.find(|character: char| {
        matches!(character, '(' | '[' | '\n' | '\r' | '.' | ';' | '{') || character.is_ascii_digit()
    }) else {
        return false;
    };
    let words = &rest[..length];
    let is_bracket = rest[length..].starts_with(['(', '[']);
    let turns = turns(words, usize::MAX, &NEGATING);
    if !is_bracket || turns || words.chars().count() > MAX_BETWEEN {
        return false;
    }
    cursor.at += length;
    true
}

//! Recognises what surrounds a value: words before it, links to the next value, list numbers, units.

use super::cursor::{Cursor, decorates, first_word, starts_with_word};
use super::expression::skip_decoration;
use super::number::{AnswerUnit, unit};

/// The most words to skip before a value.
const MAX_LEADING: usize = 6;

/// Words that may precede a value without changing it.
const LEADING: [&str; 20] = [
    "the",
    "a",
    "an",
    "about",
    "approximately",
    "approx",
    "around",
    "roughly",
    "exactly",
    "precisely",
    "towards",
    "toward",
    "of",
    "be",
    "is",
    "angle",
    "direction",
    "distance",
    "length",
    "value",
];

/// Words after a value that change its meaning.
pub(super) const CHANGING: [&str; 13] = [
    "clockwise",
    "cw",
    "below",
    "more",
    "less",
    "minus",
    "plus",
    "further",
    "longer",
    "shorter",
    "higher",
    "lower",
    "larger",
];

/// How a value is linked to the next one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Link {
    /// Both mean the same: `45 deg (pi/4)`.
    Same,
    /// One or the other.
    Or,
    /// From one to the other, or both.
    Range,
}

/// Skips words that do not change the value after them.
pub(super) fn skip_leading(cursor: &mut Cursor<'_>) {
    for _ in 0..MAX_LEADING {
        cursor.skip(|character| {
            matches!(character, ' ' | '\t' | '≈' | '~' | '=' | ':' | '→') || decorates(character)
        });
        if !LEADING.iter().any(|word| cursor.eat_word(word)) {
            return;
        }
    }
}

/// Skips the link between a value and the next one.
pub(super) fn link(cursor: &mut Cursor<'_>) -> Option<Link> {
    for words in ["to", "through", "until", "till", "and"] {
        if cursor.eat_word(words) {
            return Some(Link::Range);
        }
    }
    if cursor.eat_word("or") {
        return Some(Link::Or);
    }
    for words in ["equals", "aka", "that"] {
        if cursor.eat_word(words) {
            return Some(Link::Same);
        }
    }
    if cursor.rest().starts_with("i.e.") {
        cursor.at += "i.e.".len();
        return Some(Link::Same);
    }
    let link = match cursor.peek()? {
        '/' | '=' | '≈' | '(' | '[' | '（' => Link::Same,
        ',' => {
            cursor.step();
            cursor.skip(|character| character == ' ');
            return Some(if cursor.eat_word("or") {
                Link::Or
            } else {
                Link::Same
            });
        }
        '-' | '–' | '—' | '…' | '|' | '&' => Link::Range,
        '.' if cursor.rest().starts_with("..") => Link::Range,
        '±' | '+' | '−' => Link::Or,
        _ => return None,
    };
    let sign = cursor.peek();
    cursor.skip(|character| {
        Some(character) == sign || (sign == Some('+') && "/-".contains(character))
    });
    Some(link)
}

/// Returns the text after a list number, `2. `; `None` if the text does not begin with one.
pub(super) fn list_number<'t>(mut cursor: Cursor<'t>) -> Option<&'t str> {
    let digits = cursor.skip(|character| character.is_ascii_digit());
    let is_number = (1..=2).contains(&digits.len()) && (cursor.eat('.') || cursor.eat(')'));
    let rest = cursor.rest();
    (is_number && rest.starts_with([' ', '\t', '*'])).then_some(rest)
}

/// Returns whether a text is short enough to precede a field's name.
pub(super) fn is_short(text: &str) -> bool {
    text.len() <= 40
        && text
            .chars()
            .all(|character| character.is_alphabetic() || character == ' ' || decorates(character))
}

/// Returns whether a text begins like `2nd` or `3rd`.
pub(super) fn is_ordinal(text: &str) -> bool {
    let word = first_word(text).trim_start_matches(|character: char| character.is_ascii_digit());
    ["st", "nd", "rd", "th"].contains(&word)
}

/// Reads the unit next to a field's name, `(degrees)`, `[mm]`, `in deg`; otherwise the cursor does not move.
pub(super) fn hint(cursor: &mut Cursor<'_>) -> Option<AnswerUnit> {
    let start = *cursor;
    skip_decoration(cursor);
    let close = if cursor.eat('(') {
        Some(')')
    } else if cursor.eat('[') {
        Some(']')
    } else {
        None
    };
    cursor.eat_word("in");
    skip_decoration(cursor);
    let found = unit(cursor).filter(|_| close.is_none_or(|close| cursor.eat(close)));
    let mut behind = *cursor;
    skip_decoration(&mut behind);
    let is_beside = [':', '=', '：']
        .iter()
        .any(|sign| behind.rest().starts_with(*sign))
        || starts_with_word(behind.rest(), "is");
    if found.is_none() || !is_beside {
        *cursor = start;
        return None;
    }
    found
}

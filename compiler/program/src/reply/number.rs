//! Reads bare numbers and units: the pieces of [`super::expression`].

use super::cursor::{Cursor, first_word};

/// The largest number that can be meant.
pub(super) const MAX_NUMBER: f64 = 1_000_000.0;

/// The most digits of a number.
const MAX_DIGITS: usize = 24;

/// How a number's decimals are set apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimals {
    /// By a point, or it has none.
    Point,
    /// By a comma, which may also separate two numbers.
    Comma,
}

/// What follows a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Deg,
    Rad,
    Mm,
    Cm,
    M,
    Edge,
    Percent,
    PercentOfEdge,
}

/// Returns a decimal digit, of usual or of full width.
fn digit(character: char) -> Option<char> {
    match character {
        '0'..='9' => Some(character),
        '０'..='９' => char::from_u32(u32::from(character) - u32::from('０') + u32::from('0')),
        _ => None,
    }
}

/// Reads a number without sign or exponent.
///
/// Fails with what is wrong, or with nothing where no number stands here.
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

/// Reads a unit, with what may stand before it; where there is none the cursor does not move.
pub(super) fn unit(cursor: &mut Cursor<'_>) -> Option<Unit> {
    let start = *cursor;
    cursor.skip(|character| matches!(character, ' ' | '\t' | '\u{a0}' | '\u{202f}' | '\\' | '$'));
    if eat_any(cursor, &['°', 'º', '˚', '∘']) {
        return Some(Unit::Deg);
    }
    if cursor.eat('^') {
        cursor.skip(|character| character == '{' || character == '\\');
        if cursor.eat_word("circ") || cursor.eat('∘') {
            cursor.eat('}');
            return Some(Unit::Deg);
        }
        *cursor = start;
        return None;
    }
    if eat_any(cursor, &['%', '％']) || cursor.eat_word("percent") {
        let unit = if of_edge(cursor) {
            Unit::PercentOfEdge
        } else {
            Unit::Percent
        };
        return Some(unit);
    }
    if of_edge(cursor) {
        return Some(Unit::Edge);
    }
    let word = first_word(cursor.rest());
    let unit = WORDS
        .iter()
        .find(|(known, _)| word.eq_ignore_ascii_case(known))
        .map(|(_, unit)| *unit);
    match unit {
        Some(unit) => {
            cursor.at += word.len();
            Some(unit)
        }
        None => {
            *cursor = start;
            None
        }
    }
}

/// Units as words.
const WORDS: [(&str, Unit); 21] = [
    ("deg", Unit::Deg),
    ("degs", Unit::Deg),
    ("degree", Unit::Deg),
    ("degrees", Unit::Deg),
    ("rad", Unit::Rad),
    ("rads", Unit::Rad),
    ("radian", Unit::Rad),
    ("radians", Unit::Rad),
    ("mm", Unit::Mm),
    ("millimeter", Unit::Mm),
    ("millimeters", Unit::Mm),
    ("millimetre", Unit::Mm),
    ("millimetres", Unit::Mm),
    ("cm", Unit::Cm),
    ("centimeters", Unit::Cm),
    ("centimetres", Unit::Cm),
    ("m", Unit::M),
    ("meter", Unit::M),
    ("meters", Unit::M),
    ("metre", Unit::M),
    ("metres", Unit::M),
];

/// Reads `edge`, `edges`, `of the edge`, `* edge length`; where there is none the cursor does not move.
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

/// Moves over one of these characters.
pub(super) fn eat_any(cursor: &mut Cursor<'_>, wanted: &[char]) -> bool {
    wanted.iter().any(|character| cursor.eat(*character))
}

/// Moves over blanks on the same line.
pub(super) fn blanks(cursor: &mut Cursor<'_>) {
    cursor.skip(|character| matches!(character, ' ' | '\t' | '\u{a0}' | '\u{202f}'));
}

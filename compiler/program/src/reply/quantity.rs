//! Reads a number with its unit: `45 deg`, `3*pi/4`, `0.5 edge`, `50 % of the edge`, `half the edge`, `200 mm/s`.
//!
//! In: a cursor. Out: a number, whether it is a multiple of pi, and its unit.

use super::cursor::Cursor;
use super::lexer::{Kind, digit};
use super::point::digits;
use crate::units::{EDGE, PER_SECOND, UNITS, Unit};

/// A number as stated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    pub number: f64,
    /// Whether the number includes a factor pi.
    pub has_pi: bool,
    pub unit: Option<&'static Unit>,
}

/// Parts of the cloth's edge in words, and what they mean.
const PARTS: [(&str, f64); 4] = [
    ("half", 0.5),
    ("quarter quarters", 0.25),
    ("tenth", 0.1),
    ("full", 1.0),
];

/// Reads a quantity and moves past it; otherwise the cursor does not move.
pub(super) fn read(cursor: &mut Cursor<'_, '_>) -> Option<Quantity> {
    let mut ahead = *cursor;
    if let Some(number) = part(&mut ahead) {
        *cursor = ahead;
        return Some(Quantity {
            number,
            has_pi: false,
            unit: Some(&EDGE),
        });
    }
    ahead = *cursor;
    let is_negative = ahead.eat_sign('-');
    if !is_negative {
        ahead.eat_sign('+');
    }
    let (mut number, has_pi) = product(&mut ahead)?;
    let is_percent = ahead.eat_sign('%') || ahead.eat_any("percent");
    let unit = unit(&mut ahead);
    if is_percent {
        number /= 100.0;
    }
    *cursor = ahead;
    Some(Quantity {
        number: if is_negative { -number } else { number },
        has_pi,
        unit,
    })
}

/// Reads `half the edge`, `three quarters of an edge length`, `one full edge`.
fn part(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    cursor.eat_any("a the");
    let times = if cursor.eat_any("three") { 3.0 } else { 1.0 };
    let is_one = cursor.eat_any("one");
    cursor.eat_sign('-');
    let part = PARTS.iter().find(|(words, _)| cursor.eat_any(words));
    cursor.eat_sign('-');
    (of_edge(cursor) && (is_one || part.is_some()))
        .then_some(times * part.map_or(1.0, |(_, part)| *part))
}

/// Skips `of the cloth's edge length`; `edge` itself has to be there.
fn of_edge(cursor: &mut Cursor<'_, '_>) -> bool {
    let mut ahead = *cursor;
    ahead.eat_sign('*');
    ahead.skip("of a an the cloth cloth's cloth’s", &[]);
    let found = ahead.eat_any("edge edges side sides");
    if found {
        *cursor = ahead;
        let _ = cursor.is_joined() && cursor.eat_sign('-');
        cursor.eat_any("length lengths");
    }
    found
}

/// Reads a number, a fraction, and a factor pi.
fn product(cursor: &mut Cursor<'_, '_>) -> Option<(f64, bool)> {
    let (mut number, mut has_pi) = if cursor.eat_any("frac") {
        let mut braced = || {
            let is_open = cursor.eat_sign('{');
            let found = factor(cursor)?;
            (is_open && cursor.eat_sign('}')).then_some(found)
        };
        let ((over, over_pi), (under, _)) = (braced()?, braced()?);
        (over / under, over_pi)
    } else {
        factor(cursor)?
    };
    if cursor.eat_sign('/') {
        // `0/45 deg` and `0.25/0.5 edge` are alternatives.
        if number == 0.0 || number.fract() != 0.0 {
            return None;
        }
        number /= digits(cursor.eat_number()?)?;
    }
    if !has_pi && times_pi(cursor) {
        has_pi = true;
        if cursor.eat_sign('/') {
            number /= digits(cursor.eat_number()?)?;
        }
    }
    number.is_finite().then_some((number, has_pi))
}

/// Reads `0.25`, `0,25`, `½`, `pi`, `3pi`, `3*pi`.
fn factor(cursor: &mut Cursor<'_, '_>) -> Option<(f64, bool)> {
    if times_pi(cursor) {
        return Some((1.0, true));
    }
    let text = cursor.eat_number()?;
    let mut number = digits(text)?;
    // `0,25`: a comma is a decimal point where digits are joined to it.
    let mut ahead = *cursor;
    if text == "0"
        && ahead.is_joined()
        && ahead.eat_sign(',')
        && ahead.is_joined()
        && let Some(decimals) = ahead.eat_number()
        && decimals.chars().all(|letter| digit(letter).is_some())
    {
        number = digits(&format!("0.{decimals}"))?;
        *cursor = ahead;
    }
    let has_pi = times_pi(cursor);
    Some((number, has_pi))
}

/// Skips `pi`, `* pi`.
fn times_pi(cursor: &mut Cursor<'_, '_>) -> bool {
    let mut ahead = *cursor;
    ahead.eat_sign('*');
    let found = ahead.eat_any("pi π");
    if found {
        *cursor = ahead;
    }
    found
}

/// Reads a unit; otherwise the cursor does not move.
fn unit(cursor: &mut Cursor<'_, '_>) -> Option<&'static Unit> {
    if of_edge(cursor) {
        return Some(&EDGE);
    }
    let mut ahead = *cursor;
    let _ = ahead.is_joined() && ahead.eat_sign('-');
    let token = ahead
        .peek()
        .filter(|it| it.kind == Kind::Word || it.is_sign('°'))?;
    let text = if token.is_sign('°') {
        "°"
    } else {
        token.text
    };
    let is_unit = |unit: &&Unit| unit.words().any(|word| text.eq_ignore_ascii_case(word));
    let unit = UNITS.iter().find(is_unit)?;
    ahead.at += 1;
    *cursor = ahead;
    let is_per = ahead.eat_sign('/') || ahead.eat_any("per");
    match unit.per_second() {
        Some(speed) if is_per && ahead.eat_any(PER_SECOND) => {
            *cursor = ahead;
            Some(speed)
        }
        _ => Some(unit),
    }
}

//! Reads one point: `(x, y)` or `[y, x]` as asked for, the forms that models use instead, or a point's number.
//!
//! In: a cursor, and the scene's notation, which turns numbers into the pixel that they mean. Numbers that show that
//! their order or unit is another one are not read. Where points are numbered, coordinates alone are not read either:
//! a model that gives them has its own frame in mind.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token, digit};
use crate::data::camera::PixelPoint;
use crate::pointing::{CoordinateUnit, Notation, Order};

/// The largest coordinate that an answer can mean, pixels; far beyond any picture.
const MAX_COORDINATE: f64 = 999_999.0;

/// The most digits of a number.
pub(super) const MAX_DIGITS: usize = 20;

/// Words before a point, which say where it lies or only that it is one.
const LEADING: &str = "the upper lower top bottom left right back front middle corner center centre point points pixel keypoint at of cloth number mark no id";

/// Reads a point and moves past it; otherwise the cursor does not move.
pub(super) fn read(
    cursor: &mut Cursor<'_, '_>,
    notation: &Notation,
) -> Option<(PixelPoint, Option<String>)> {
    let mut ahead = *cursor;
    let tag = ahead.peek().filter(|it| it.kind == Kind::Tag);
    ahead.at += usize::from(tag.is_some());
    if let Some(found) = tag.and_then(|it| tagged(it, notation)) {
        // `>a corner</point>`
        while ahead.peek().is_some_and(|it| it.kind == Kind::Word) {
            ahead.at += 1;
        }
        *cursor = ahead;
        return Some(found);
    }
    // `the upper left corner at (10, 20)`
    for _ in 0..8 {
        if !ahead.eat_any(LEADING) {
            break;
        }
        let _ = ahead.is_joined() && ahead.eat_sign('-');
    }
    let has_words = ahead.at > cursor.at;
    ahead.eat_sign(',');
    let found = match notation.is_of_marks() {
        true => numbered(&mut ahead, notation).map(|point| (point, None)),
        false => placed(&mut ahead, notation, has_words),
    };
    if found.is_some() {
        *cursor = ahead;
    }
    found
}

/// Returns the bracket that closes what this one opens.
pub(super) fn closing(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        '{' => '}',
        _ => '>',
    }
}

/// Reads `<point x="61.5" y="40.6" alt="a corner">`.
fn tagged(tag: &Token<'_>, notation: &Notation) -> Option<(PixelPoint, Option<String>)> {
    let inside = lexer::tokens(tag.text);
    let mut cursor = Cursor::at(&inside, 1);
    let (x, y) = (
        coordinate(&mut cursor, notation)?,
        coordinate(&mut cursor, notation)?,
    );
    // Models that write tags count in percent, with decimals.
    let is_percent = notation.is_native() && (x.1.fract() != 0.0 || y.1.fract() != 0.0);
    match (x, y) {
        ((Some('x'), x), (Some('y'), y)) if !is_percent => at(x, y, notation),
        _ => None,
    }
}

/// Skips the key of a value in braces: `{"point_2d": `.
fn skip_key(cursor: &mut Cursor<'_, '_>) {
    let mut ahead = *cursor;
    if ahead.eat_any("point number") {
        let _ = ahead.eat_number().is_some() && ahead.eat_any("d");
        if ahead.eat_sign(':') {
            *cursor = ahead;
        }
    }
}

fn placed(
    cursor: &mut Cursor<'_, '_>,
    notation: &Notation,
    needs_brackets: bool,
) -> Option<(PixelPoint, Option<String>)> {
    let mut open = Vec::new();
    while let Some(bracket) = cursor.eat_signs(&['(', '[', '{', '<'])
        && open.len() < 3
    {
        open.push(bracket);
        skip_key(cursor);
    }
    if needs_brackets && open.is_empty() {
        return None;
    }
    let first = coordinate(cursor, notation)?;
    let is_apart = cursor.eat_signs(&[',', ';']).is_some() || cursor.eat_any("and");
    // `10-20`
    if !is_apart && cursor.is_joined() {
        return None;
    }
    let second = coordinate(cursor, notation)?;
    for bracket in open.iter().rev() {
        if !cursor.eat_sign(closing(*bracket)) {
            return None;
        }
    }
    // `(10, 20) + (5, 0)`, `10 20 30`
    let goes_on = cursor.peek().is_some_and(|next| match next.kind {
        Kind::Number => open.is_empty() && next.gap < Gap::Line,
        Kind::Sign(sign) => "%*+/°".contains(sign),
        _ => false,
    });
    if goes_on {
        return None;
    }
    if cursor.eat_any("px pixels pixel") && notation.unit() != CoordinateUnit::Pixels {
        return None;
    }
    let is_listed = open.last() == Some(&'[');
    let (x, y) = match (notation.order(), first.0, second.0) {
        (_, Some('y'), Some('x')) => (second.1, first.1),
        (_, Some('x'), Some('y')) => (first.1, second.1),
        (Order::Xy, None, None) => (first.1, second.1),
        // Without square brackets, either number can be x.
        (Order::Yx, None, None) if is_listed => (second.1, first.1),
        _ => return None,
    };
    at(x, y, notation)
}

/// Reads a coordinate with its name and unit, if it has them.
pub(super) fn coordinate(
    cursor: &mut Cursor<'_, '_>,
    notation: &Notation,
) -> Option<(Option<char>, f64)> {
    let axis = if cursor.eat_any("x u col column") {
        Some('x')
    } else if cursor.eat_any("y v row") {
        Some('y')
    } else {
        None
    };
    if axis.is_some() {
        cursor.eat_signs(&['=', ':']);
    }
    let value = number(cursor)?;
    let has_px = cursor.eat_any("px pixels pixel");
    if has_px && notation.unit() != CoordinateUnit::Pixels {
        return None;
    }
    let _ = notation.unit() == CoordinateUnit::Percent && cursor.eat_sign('%');
    Some((axis, value))
}

/// Reads a number with its sign; `1e3` and `10cm` are none.
pub(super) fn number(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let is_negative = cursor.eat_sign('-');
    let value = digits(cursor.eat_number()?)?;
    let goes_on = cursor.is_joined()
        && cursor
            .peek()
            .is_some_and(|token| token.kind == Kind::Word && !token.is_any("px pixels pixel"));
    (!goes_on).then_some(if is_negative { -value } else { value })
}

/// Returns the number that a token of digits means, of normal or full width.
pub(super) fn digits(text: &str) -> Option<f64> {
    let plain = text.chars().map(|letter| digit(letter).unwrap_or('.'));
    let plain: String = plain.collect();
    plain.parse().ok().filter(|_| plain.len() <= MAX_DIGITS)
}

/// Returns the pixel at these coordinates, and how it was read if it had to be rounded.
pub(super) fn at(x: f64, y: f64, notation: &Notation) -> Option<(PixelPoint, Option<String>)> {
    // NaN must fail this check.
    let is_near = [x, y].into_iter().all(|it| it.abs() <= MAX_COORDINATE);
    let is_part = |it: f64| it.fract() != 0.0 && it.abs() < 1.0;
    if !is_near || (notation.is_native() && is_part(x) && is_part(y)) {
        return None;
    }
    let pixel = notation.pixel(x, y);
    let is_whole = x.fract() == 0.0 && y.fract() == 0.0;
    let note = (notation.is_native() && !is_whole)
        .then(|| format!("rounded ({x}, {y}) to {}", notation.written(pixel)));
    Some((pixel, note))
}

/// Reads a point's number: `3`, `#3`, `(3)`, `3 at (41, 167)`.
fn numbered(cursor: &mut Cursor<'_, '_>, notation: &Notation) -> Option<PixelPoint> {
    cursor.eat_sign('#');
    let open = cursor.eat_signs(&['(', '[', '{']);
    skip_key(cursor);
    let text = cursor.eat_number()?;
    let number = digits(text).filter(|it| it.fract() == 0.0 && *it >= 1.0)?;
    // Far below 2^53, so the conversion loses nothing; a larger number is no point's.
    let point = notation.marked(number as usize)?;
    if open.is_some_and(|open| !cursor.eat_sign(closing(open))) {
        return None;
    }
    let mut behind = *cursor;
    behind.eat_signs(&[':', ',']);
    behind.eat_any("at");
    let begins_place = behind
        .peek()
        .is_some_and(|it| it.is_sign('(') || it.is_sign('['));
    if begins_place && let Some((place, _)) = placed(&mut behind, notation, true) {
        *cursor = behind;
        return (place == point).then_some(point);
    }
    // `41, 167` is a pair of coordinates, `3.5` and `3rd` no numbers of points.
    let goes_on = cursor.peek().is_some_and(|next| match next.kind {
        Kind::Number | Kind::Word => cursor.is_joined(),
        Kind::Sign(',') => cursor.ahead(1).is_some_and(|it| it.kind == Kind::Number),
        Kind::Sign(sign) => cursor.is_joined() && "%*/+°".contains(sign),
        Kind::Tag => false,
    });
    (!goes_on).then_some(point)
}

//! Reads one point: `(x, y)` or `[y, x]` as requested, the forms that models use instead, or a point's number.
//!
//! In: a cursor, and the scene's notation, which turns numbers into the pixel that they mean. Numbers that show that
//! their order or unit is not the requested one are rejected. Where points are numbered, coordinates alone are
//! rejected: a model that gives them has its own frame in mind.

use super::cursor::Cursor;
use super::lexer::{Kind, TAG_END, digit};
use super::wordlist::words;
use crate::data::camera::PixelPoint;
use crate::pointing::{CoordinateUnit, Notation, Order};

/// The largest coordinate that an answer can mean, pixels; far beyond any picture.
const MAX_COORDINATE: f64 = 999_999.0;

/// The most digits of a coordinate or a point's number.
const MAX_DIGITS: usize = 12;

/// The most brackets around a point, `{"point": [[10, 20]]}`.
const MAX_BRACKETS: usize = 4;

/// The most numbers that are read where a point is expected.
const MAX_NUMBERS: usize = 8;

/// Words between the brackets and the numbers of a point, which say only that it is one.
const NOUNS: &[&str] = words!(
    "point points 2 d pixel pixels position location coordinates coordinate coords coord xy center number mark id index"
);

/// Words before a point's number.
const NUMBER_NOUNS: &[&str] =
    words!("the listed point number no nr candidate mark label index id corner keypoint option");

/// What was found where a point is expected.
pub(super) enum PointFound {
    /// A pixel, and how it was read if it would be written with other numbers.
    Pixel(PixelPoint, Option<String>),
    /// Numbers that are not a point, and why not.
    Bad(String),
    /// Something else.
    Nothing,
}

/// Whether two numbers without brackets are a point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Brackets {
    Needed,
    Optional,
}

/// Reads a point as the scene asks for it and moves past it; otherwise the cursor does not move.
pub(super) fn read(
    cursor: &mut Cursor<'_, '_>,
    notation: &Notation,
    brackets: Brackets,
) -> PointFound {
    let start = *cursor;
    let found = if notation.is_of_marks() {
        numbered(cursor, notation, brackets)
    } else {
        placed(cursor, notation, brackets)
    };
    if !matches!(found, PointFound::Pixel(..)) {
        *cursor = start;
    }
    found
}

/// Skips `(x, y)` or `[y, x]`, which repeats the format; returns the order that it states.
pub(super) fn echo(cursor: &mut Cursor<'_, '_>) -> Option<Order> {
    const OTHER: [&str; 5] = ["px", "pixels", "in", "pixel", "coordinates"];
    let mut ahead = *cursor;
    ahead.eat_signs(&['(', '['])?;
    ahead.skip(&OTHER, &[]);
    let order = match ahead.peek()? {
        first if first.is_any(&["x", "u", "column", "col"]) => Order::Xy,
        first if first.is_any(&["y", "v", "row"]) => Order::Yx,
        _ => return None,
    };
    ahead.skip(&["x", "y", "u", "v", "row", "column", "col"], &[',']);
    ahead.skip(&OTHER, &[',']);
    ahead.eat_signs(&[')', ']'])?;
    *cursor = ahead;
    Some(order)
}

/// A coordinate.
struct Coordinate {
    /// `x` or `y`, if it is named.
    axis: Option<char>,
    value: f64,
    /// Whether it has the unit px.
    has_px: bool,
}

fn placed(cursor: &mut Cursor<'_, '_>, notation: &Notation, brackets: Brackets) -> PointFound {
    // `pixel (10, 20)`
    while cursor.eat_any(&["pixel", "point", "pixels"]) {}
    let mut open = Vec::new();
    while let Some(bracket) = cursor.eat_signs(&['(', '[', '{', '<'])
        && open.len() < MAX_BRACKETS
    {
        // `Pick Point < (10, 20)` compares; `<10, 20>` is a point.
        let is_pair = cursor.ahead(1).is_some_and(|comma| comma.is_sign(','))
            && cursor.ahead(3).is_some_and(|close| close.is_sign('>'));
        if bracket == '<' && !cursor.is_joined() && !is_pair {
            return PointFound::Bad("`<` before its numbers is not understood".to_owned());
        }
        open.push(bracket);
        // `{"point": `, `<point `
        let behind = *cursor;
        while cursor.eat_any(NOUNS) || (cursor.is_joined() && cursor.eat_number() == Some("2")) {}
        // `<point>(10, 20)</point>`
        if bracket == '<' && cursor.at > behind.at {
            cursor.eat_sign('>');
        }
        if bracket != '<' && cursor.at > behind.at && cursor.eat_signs(&[':', '=', '→']).is_none()
        {
            *cursor = behind;
        }
    }
    let mut numbers: Vec<Coordinate> = Vec::new();
    // `(46,0; 182,0)`: with a semicolon between, a comma is a decimal point.
    if !open.is_empty()
        && let Some([x, y]) = with_commas(cursor)
    {
        numbers = [x, y]
            .map(|value| Coordinate {
                axis: None,
                value,
                has_px: false,
            })
            .into();
    }
    while numbers.len() < MAX_NUMBERS {
        let before = *cursor;
        if !numbers.is_empty() {
            let _ = cursor.eat_signs(&[',', ';']).is_some() || cursor.eat_word("by");
            cursor.eat_word("and");
        }
        match coordinate(cursor, notation) {
            Some(found) => numbers.push(found),
            None => {
                *cursor = before;
                break;
            }
        }
        let all_named = numbers.len() == 2 && numbers.iter().all(|it| it.axis.is_some());
        if open.is_empty() && (numbers.len() == 2 || all_named) {
            break;
        }
    }
    if numbers.is_empty() {
        return PointFound::Nothing;
    }
    let has_axes = numbers.iter().any(|it| it.axis.is_some());
    if open.is_empty() && brackets == Brackets::Needed && !(has_axes && numbers.len() == 2) {
        return PointFound::Nothing;
    }
    let last = open.last().copied();
    for bracket in open.iter().rev() {
        cursor.eat_sign(',');
        // `alt="a corner">a corner</point>` says nothing about the place.
        if *bracket == '<' && !tag_ends(cursor) {
            return PointFound::Bad("its tag is never closed".to_owned());
        }
        if *bracket == '{' {
            skip_remarks(cursor);
        }
        if *bracket != '<' && !cursor.eat_sign(closing(*bracket)) {
            return PointFound::Bad(match cursor.peek() {
                None => "its bracket is never closed".to_owned(),
                Some(token) => format!("`{}` between its brackets is not understood", token.text),
            });
        }
    }
    pixel(&numbers, last, notation)
}

/// Reads `46,0; 182,0`; otherwise the cursor does not move.
fn with_commas(cursor: &mut Cursor<'_, '_>) -> Option<[f64; 2]> {
    let mut ahead = *cursor;
    let mut one = || {
        let (whole, is_comma, decimals) = (
            ahead.eat_number()?,
            ahead.eat_sign(','),
            ahead.eat_number()?,
        );
        let text = format!("{whole}.{decimals}");
        let value = text
            .parse()
            .ok()
            .filter(|_| is_comma && !whole.contains('.') && !decimals.contains('.'))?;
        Some((value, ahead.eat_sign(';')))
    };
    let ((x, is_apart), (y, _)) = (one()?, one()?);
    if !is_apart {
        return None;
    }
    *cursor = ahead;
    Some([x, y])
}

/// Skips `label: corner` and the like after the numbers in braces.
fn skip_remarks(cursor: &mut Cursor<'_, '_>) {
    let mut ahead = *cursor;
    if !ahead.eat_any(&[
        "label",
        "name",
        "description",
        "desc",
        "reason",
        "alt",
        "type",
    ]) {
        return;
    }
    while let Some(token) = ahead.peek() {
        if token.is_sign('}') {
            *cursor = ahead;
            return;
        }
        if token.kind == Kind::Number || token.is_any(&["not", "or"]) {
            return;
        }
        ahead.at += 1;
    }
}

/// Skips the rest of `<point x="1" y="2" alt="a corner">a corner</point>`.
fn tag_ends(cursor: &mut Cursor<'_, '_>) -> bool {
    if cursor.eat_sign(TAG_END) {
        return true;
    }
    while let Some(token) = cursor.peek() {
        cursor.at += 1;
        if token.is_sign('>') {
            break;
        }
        if token.kind == Kind::Number {
            return false;
        }
    }
    let mut ahead = *cursor;
    while let Some(token) = ahead.peek() {
        ahead.at += 1;
        if token.is_sign(TAG_END) {
            *cursor = ahead;
            break;
        }
        if token.kind != Kind::Word && !token.is_sign('-') {
            break;
        }
    }
    true
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

/// Reads a number with its name and unit, if it has them.
fn coordinate(cursor: &mut Cursor<'_, '_>, notation: &Notation) -> Option<Coordinate> {
    let start = *cursor;
    let axis = axis(cursor);
    let Some(value) = number(cursor) else {
        *cursor = start;
        return None;
    };
    let has_px = cursor.eat_any(&["px", "pixels", "pixel"]);
    let axis = axis.or_else(|| from_side(cursor));
    if !has_px && notation.unit() == CoordinateUnit::Percent {
        cursor.eat_sign('%');
    }
    Some(Coordinate {
        axis,
        value,
        has_px,
    })
}

/// Reads `from the left`, `from the top`; otherwise the cursor does not move.
fn from_side(cursor: &mut Cursor<'_, '_>) -> Option<char> {
    let start = *cursor;
    let leads = cursor.eat_any(&["from", "down", "right"]);
    cursor.eat_any(&["from"]);
    cursor.eat_word("the");
    let axis = if cursor.eat_word("left") {
        Some('x')
    } else if cursor.eat_word("top") {
        Some('y')
    } else {
        None
    };
    if !leads || axis.is_none() {
        *cursor = start;
        return None;
    }
    cursor.eat_any(&["edge", "side", "border"]);
    axis
}

/// Reads `x:`, `y =`, `column`; otherwise the cursor does not move.
pub(super) fn axis(cursor: &mut Cursor<'_, '_>) -> Option<char> {
    let start = *cursor;
    let axis = if cursor.eat_any(&["x", "u", "col", "column", "horizontal"]) {
        'x'
    } else if cursor.eat_any(&["y", "v", "row", "line", "vertical"]) {
        'y'
    } else {
        return None;
    };
    let is_word = cursor.tokens[start.at].text.len() > 1;
    cursor.eat_any(&["coordinate", "coord", "position", "value"]);
    let has_sign = cursor.eat_signs(&[':', '=', '→']).is_some() || cursor.eat_any(&["is", "of"]);
    if has_sign || is_word {
        return Some(axis);
    }
    *cursor = start;
    None
}

/// Returns the axis that a name has after it: `x` in `pick_x`.
pub(super) fn single_axis(cursor: &Cursor<'_, '_>) -> Option<char> {
    let token = cursor.peek()?;
    match () {
        () if token.is_any(&["x", "u", "col", "column"]) => Some('x'),
        () if token.is_any(&["y", "v", "row"]) => Some('y'),
        () => None,
    }
}

/// Reads a coordinate's number; `1e3` and `10cm` are none.
pub(super) fn number(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let start = *cursor;
    let is_negative = cursor.eat_sign('-');
    if !is_negative {
        cursor.eat_sign('+');
    }
    let text = cursor
        .eat_number()
        .filter(|text| text.len() <= MAX_DIGITS + 8);
    let goes_on = cursor.is_joined()
        && cursor.peek().is_some_and(|token| {
            token.kind == Kind::Word && !token.is_any(&["px", "pixels", "pixel", "and"])
        });
    let value = text
        .filter(|_| !goes_on)
        .map(|text| {
            text.chars()
                .map(|letter| digit(letter).unwrap_or('.'))
                .collect::<String>()
        })
        .and_then(|digits| digits.parse::<f64>().ok());
    if value.is_none() {
        *cursor = start;
    }
    value.map(|value| if is_negative { -value } else { value })
}

fn pixel(numbers: &[Coordinate], open: Option<char>, notation: &Notation) -> PointFound {
    let [first, second] = numbers else {
        return PointFound::Bad(match numbers.len() {
            1 => "it has one number instead of two".to_owned(),
            n_numbers => format!("it has {n_numbers} numbers instead of two"),
        });
    };
    let (x, y) = match (notation.order(), first.axis, second.axis) {
        (_, Some('y'), Some('x')) => (second, first),
        (_, Some('x'), Some('y')) | (Order::Xy, None | Some('x'), None | Some('y')) => {
            (first, second)
        }
        (Order::Yx, None, None) if open == Some('[') => (second, first),
        (Order::Yx, None, None) => {
            let why = "its two numbers stand in no square brackets, so that either can be x";
            return PointFound::Bad(why.to_owned());
        }
        (Order::Yx, ..) if first.axis != second.axis => {
            return PointFound::Bad("only one of its coordinates is named".to_owned());
        }
        _ => return PointFound::Bad("one coordinate is named twice".to_owned()),
    };
    let counts_pixels = notation.unit() == CoordinateUnit::Pixels;
    if !counts_pixels && [x, y].iter().any(|it| it.has_px) {
        return PointFound::Bad("it is given in pixels".to_owned());
    }
    at(x.value, y.value, notation)
}

/// Returns the pixel at these coordinates.
pub(super) fn at(x: f64, y: f64, notation: &Notation) -> PointFound {
    if x.abs() > MAX_COORDINATE || y.abs() > MAX_COORDINATE {
        return PointFound::Bad("it lies far outside of any picture".to_owned());
    }
    let is_part = |it: f64| it.fract() != 0.0 && it.abs() < 1.0;
    if notation.is_native() && is_part(x) && is_part(y) {
        return PointFound::Bad(format!(
            "({x}, {y}) is given in parts of the picture, and pixels are asked for"
        ));
    }
    let pixel = notation.pixel(x, y);
    let is_whole = x.fract() == 0.0 && y.fract() == 0.0;
    let note = (notation.is_native() && !is_whole)
        .then(|| format!("rounded ({x}, {y}) to {}", notation.written(pixel)));
    PointFound::Pixel(pixel, note)
}

/// Reads a point by its coordinates; returns it with the cursor after it.
fn by_place<'a, 't>(
    mut cursor: Cursor<'a, 't>,
    notation: &Notation,
) -> Option<(PixelPoint, Cursor<'a, 't>)> {
    match placed(&mut cursor, notation, Brackets::Optional) {
        PointFound::Pixel(point, _) => Some((point, cursor)),
        PointFound::Bad(_) | PointFound::Nothing => None,
    }
}

/// Reads a point's number: `3`, `point 3`, `#3`, `(3)`, `3 at (41, 167)`.
fn numbered(cursor: &mut Cursor<'_, '_>, notation: &Notation, brackets: Brackets) -> PointFound {
    if by_place(*cursor, notation).is_some() {
        return PointFound::Bad(
            "it is given by coordinates, and its number is asked for".to_owned(),
        );
    }
    let mut open = Vec::new();
    let mut has_noun = false;
    for _ in 0..8 {
        if cursor.eat_any(NUMBER_NOUNS) {
            has_noun = true;
            let _ = cursor.peek().is_some_and(|token| token.is_sign('.')) && cursor.eat_sign('.');
        } else if cursor.eat_signs(&[':', '=', '#', '№', '→']).is_some() {
            has_noun = true;
        } else if let Some(bracket) = cursor.eat_signs(&['(', '[', '{']) {
            open.push(bracket);
        } else {
            break;
        }
    }
    let Some(text) = cursor.eat_number() else {
        return PointFound::Nothing;
    };
    if brackets == Brackets::Needed && !has_noun && open.is_empty() {
        return PointFound::Nothing;
    }
    let n_points = notation.marks().len();
    let plain: String = text.chars().filter_map(digit).collect();
    let goes_on = cursor.is_joined()
        && cursor.peek().is_some_and(|token| {
            token.kind != Kind::Sign(TAG_END)
                && !matches!(
                    token.kind,
                    Kind::Sign(')' | ']' | '}' | ':' | ',' | '.' | ';' | '!')
                )
        });
    if text.contains('.') || goes_on {
        return PointFound::Bad("it is not one whole number".to_owned());
    }
    let number = plain.parse().ok().filter(|_| plain.len() <= MAX_DIGITS);
    let Some(point) = number.and_then(|number| notation.marked(number)) else {
        return PointFound::Bad(match n_points {
            0 => format!("no point has the number {text}: none is offered"),
            _ => format!("no point has the number {text}; they are numbered 1 to {n_points}"),
        });
    };
    for bracket in open.iter().rev() {
        if !cursor.eat_sign(closing(*bracket)) {
            return PointFound::Bad("its brackets hold more than one number".to_owned());
        }
    }
    let mut behind = *cursor;
    behind.eat_sign(':');
    behind.eat_sign(',');
    behind.eat_word("at");
    if let Some((place, behind)) = by_place(behind, notation) {
        if place != point {
            return PointFound::Bad(format!(
                "its number says {} and its coordinates say another place",
                notation.written(point)
            ));
        }
        *cursor = behind;
    }
    PointFound::Pixel(point, None)
}

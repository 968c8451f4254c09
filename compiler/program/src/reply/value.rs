//! Reads one value of a field: a point, a direction, a length or a word that is offered.
//!
//! In: a cursor behind a label. Out: the value and how it was read if that is not obvious, or nothing. A direction or a
//! length has to be one of the offered values; a point does not, because the verifier says better what is wrong with it.

use super::cursor::Cursor;
use super::lexer::{self, Gap, Kind, Token};
use super::point;
use super::quantity;
use crate::data::actions::{ActionField, Choices, LengthChoice, Value};
use crate::pointing::Notation;
use crate::units::{DEG, Dimension, Unit};

/// How far an angle stated in degrees, or in radians with their fewer decimals, may be from the offered one, degrees.
pub const SAME_DEG: f64 = 0.05;
const SAME_RAD_DEG: f64 = 0.5;

/// How far a stated length may be from the offered one: as much as a prompt rounds it, and a part of it in another unit.
const SAME_LENGTH: f64 = 6e-5;
const SAME_CONVERTED: f64 = 2e-3;

/// What a value is read with.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub field: &'a ActionField,
    pub notation: &'a Notation,
    /// The cloth's longer side, metres.
    pub edge_m: f64,
}

/// Reads a value and moves past it; otherwise the cursor does not move.
pub(super) fn read(
    cursor: &mut Cursor<'_, '_>,
    context: &Context<'_>,
) -> Option<(Value, Option<String>)> {
    let mut ahead = *cursor;
    let found = match &context.field.choices {
        Choices::Points { .. } | Choices::Region { .. } => {
            let (point, note) = point::read(&mut ahead, context.notation)?;
            (Value::Point(point), note)
        }
        Choices::Words { choices } => (word(&mut ahead, choices)?, None),
        Choices::Directions { .. } | Choices::Lengths { .. } => {
            ahead.eat_any("about approx approximately exactly roughly");
            ahead.eat_sign('.');
            ahead.eat_sign('≈');
            let open = ahead.eat_signs(&['(', '[']);
            let value = number(&mut ahead, context)?;
            if open.is_some_and(|open| !ahead.eat_sign(point::closing(open))) {
                return None;
            }
            (value, None)
        }
    };
    *cursor = ahead;
    Some(found)
}

/// Reads an angle or a length.
fn number(cursor: &mut Cursor<'_, '_>, context: &Context<'_>) -> Option<Value> {
    let Some(quantity) = quantity::read(cursor) else {
        let deg = side(cursor)?;
        return angle(deg, SAME_DEG, &context.field.choices)
            .filter(|_| is_compass(&context.field.choices));
    };
    // `0.25 edge * 2`, `45 - 90`, `45-90 deg`
    let goes_on = cursor.peek().is_some_and(|next| match next.kind {
        Kind::Number => next.gap < Gap::Line,
        Kind::Word | Kind::Tag => cursor.is_joined() && next.kind == Kind::Word,
        Kind::Sign(',') if cursor.is_joined() => cursor
            .ahead(1)
            .is_some_and(|it| it.kind == Kind::Number && it.gap == Gap::None),
        Kind::Sign('-' | '–') => { cursor.ahead(1) }.is_some_and(|it| it.kind == Kind::Number),
        Kind::Sign(sign) => "%*/+^±°".contains(sign),
    });
    if goes_on {
        return None;
    }
    let (number, unit) = (quantity.number, quantity.unit);
    match &context.field.choices {
        Choices::Directions { .. } => {
            let is_other = unit.is_some_and(|unit| unit.dimension != Dimension::Angle);
            let in_deg = match (quantity.has_pi, unit) {
                _ if is_other => return None,
                (true, None) => std::f64::consts::PI.to_degrees(),
                (true, Some(unit)) => std::f64::consts::PI * unit.in_deg(),
                (false, unit) => unit.map_or(1.0, Unit::in_deg),
            };
            let is_in_deg = in_deg == DEG.in_deg();
            let tolerance = if is_in_deg { SAME_DEG } else { SAME_RAD_DEG };
            angle(number * in_deg, tolerance, &context.field.choices)
        }
        Choices::Lengths {
            unit: asked,
            choices,
        } => {
            let size = |unit: &Unit| unit.size_with(context.edge_m);
            let value = match unit {
                _ if quantity.has_pi => return None,
                None => number,
                Some(stated) if stated.dimension == asked.dimension => {
                    number * size(stated) / size(asked)
                }
                Some(_) => return None,
            };
            let apart = |choice: &&LengthChoice| (choice.value - value).abs();
            let nearest = choices.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
            let tolerance = match unit.is_none_or(|unit| *unit == **asked) {
                true => SAME_LENGTH,
                false => (SAME_CONVERTED * value.abs()).max(SAME_LENGTH),
            };
            let choice = nearest.filter(|choice| apart(choice) <= tolerance)?;
            Some(Value::Length {
                length: choice.value,
            })
        }
        _ => None,
    }
}

/// Returns the offered direction at an angle, degrees.
fn angle(deg: f64, tolerance: f64, choices: &Choices) -> Option<Value> {
    let Choices::Directions { choices } = choices else {
        return None;
    };
    let apart = |offered: f64| {
        let turned = (offered - deg).rem_euclid(360.0);
        turned.min(360.0 - turned)
    };
    let nearest = choices
        .iter()
        .min_by(|a, b| apart(a.deg).total_cmp(&apart(b.deg)));
    let choice = nearest.filter(|choice| apart(choice.deg) <= tolerance)?;
    Some(Value::Direction { deg: choice.deg })
}

/// Returns whether right, up, left and down are offered, so that their names mean an angle.
pub(super) fn is_compass(choices: &Choices) -> bool {
    let offers = |deg: f64| angle(deg, 0.0, choices).is_some();
    [0.0, 90.0, 180.0, 270.0].into_iter().all(offers)
}

/// Names of directions, right and up.
const SIDES: [(&str, [i32; 2]); 8] = [
    ("right east e", [1, 0]),
    ("left west w", [-1, 0]),
    ("up upper top upward upwards north n", [0, 1]),
    ("down lower bottom downward downwards south s", [0, -1]),
    ("northeast ne", [1, 1]),
    ("northwest nw", [-1, 1]),
    ("southwest sw", [-1, -1]),
    ("southeast se", [1, -1]),
];

/// Words around the names of directions.
const AROUND: &str = "and to the toward towards straight directly diagonally diagonal pointing";

/// Reads a direction in words, `straight up`, `top-left`, `left and up`; degrees.
pub(super) fn side(cursor: &mut Cursor<'_, '_>) -> Option<f64> {
    let mut ahead = *cursor;
    let (mut right, mut up, mut n_sides) = (0, 0, 0);
    loop {
        ahead.skip(AROUND, &[]);
        let _ = n_sides > 0 && ahead.eat_signs(&['-', '/']).is_some();
        let goes_on = |it: &&Token<'_>| n_sides == 0 || it.gap < Gap::Line;
        let token = ahead
            .peek()
            .filter(|it| it.kind == Kind::Word)
            .filter(goes_on);
        let found = token.and_then(|token| SIDES.iter().find(|(names, _)| token.is_any(names)));
        let Some((_, [to_right, to_up])) = found else {
            break;
        };
        (right, up, n_sides) = (right + to_right, up + to_up, n_sides + 1);
        ahead.at += 1;
        *cursor = ahead;
        if n_sides == 2 {
            break;
        }
    }
    // `left and right`, `up up`
    let is_one = right.abs() <= 1 && up.abs() <= 1 && (right, up) != (0, 0);
    let deg = match (right, up) {
        (1, 0) => 0.0,
        (1, 1) => 45.0,
        (0, 1) => 90.0,
        (-1, 1) => 135.0,
        (-1, 0) => 180.0,
        (-1, -1) => 225.0,
        (0, -1) => 270.0,
        _ => 315.0,
    };
    is_one.then_some(deg)
}

/// Reads one of the offered words, the longest one that is there.
fn word(cursor: &mut Cursor<'_, '_>, choices: &[String]) -> Option<Value> {
    let open = cursor.eat_signs(&['(', '[']);
    let found = choices.iter().filter_map(|choice| {
        let mut ahead = *cursor;
        let tokens = lexer::tokens(choice);
        let mut words = tokens.iter().filter(|it| !it.is_sign('-')).enumerate();
        let is_there = words.all(|(at, word)| {
            let _ = at > 0 && ahead.eat_sign('-');
            let next = ahead.peek().filter(|it| at == 0 || it.gap < Gap::Line);
            ahead.at += 1;
            next.is_some_and(|it| it.text.to_lowercase() == word.text.to_lowercase())
        });
        let goes_on = ahead.peek().is_some_and(|it| {
            it.gap == Gap::None && matches!(it.kind, Kind::Word | Kind::Number | Kind::Sign('-'))
        });
        (is_there && !goes_on).then_some((ahead.at, choice))
    });
    let (end, choice) = found.max_by_key(|(end, _)| *end)?;
    cursor.at = end;
    if open.is_some_and(|open| !cursor.eat_sign(point::closing(open))) {
        return None;
    }
    Some(Value::Word(choice.clone()))
}

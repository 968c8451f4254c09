//! Decides which choice a stated number means.
//!
//! In: a field's directions or lengths, and a quantity. Out: the choice that it matches. A number that matches no
//! choice is returned as stated, and [`crate::verify`] rejects it. A number that can mean two choices is an error.

use super::quantity::{AnswerUnit, Quantity};
use super::words;
use crate::data::actions::{ActionField, Choices, Direction, LengthChoice, Value};
use crate::exact::{normalised_deg, written};
use crate::space::{self, DECIMALS};
use crate::units::{Dimension, LengthUnit, RAD};
use std::f64::consts::PI;

/// The relative tolerance for a number with pi, or in radians: `0.785 rad` is 45 degrees.
const ROUNDED: f64 = 1e-3;

/// The relative tolerance for a length that had to be converted.
const CONVERTED: f64 = 1e-6;

/// How far apart two numbers that are written alike can be.
const WRITTEN: f64 = 1e-4;

/// The largest angle in radians that a number without a unit can mean: one turn, rounded up.
const MAX_BARE_RAD: f64 = 6.29;

/// The expected field, and what its surroundings say about its value.
#[derive(Clone, Copy)]
pub(super) struct Expected<'a> {
    /// The field.
    pub field: &'a ActionField,
    /// The cloth's longer side, metres.
    pub edge_m: f64,
    /// The unit next to the field's name, if there is one.
    pub hint: Option<AnswerUnit>,
}

/// A choice, and how the number was read if that is not obvious.
pub(super) type Resolved = (Value, Option<String>);

/// Returns the meaning of a quantity. Fails with the reason in words, to follow `it cannot be used:`.
///
/// - `text`: the quantity as written in the answer.
pub(super) fn resolve(
    expected: &Expected<'_>,
    quantity: Quantity,
    text: &str,
) -> Result<Resolved, String> {
    let (value, note) = match &expected.field.choices {
        Choices::Directions { choices } => direction(choices, expected, quantity, text)?,
        Choices::Lengths { unit, choices } => length(choices, *unit, expected, quantity, text)?,
        Choices::Points { .. } | Choices::Region { .. } | Choices::Words { .. } => {
            return Err(format!("`{text}` is a number"));
        }
    };
    if !quantity.has_comma {
        return Ok((value, note));
    }
    if space::declared(expected.field).contains(&value) {
        return Ok((value, Some("its comma as a decimal point".to_owned())));
    }
    Err(format!("`{text}` has a comma where a point is needed"))
}

fn direction(
    choices: &[Direction],
    expected: &Expected<'_>,
    quantity: Quantity,
    text: &str,
) -> Result<Resolved, String> {
    let number = quantity.number;
    let stated = |deg: f64, nearest: Option<f64>| {
        let deg = normalised_deg(deg);
        let note = nearest
            .filter(|choice| *choice != deg && written(*choice, DECIMALS) != written(deg, DECIMALS))
            .map(|_| "it as rounded".to_owned());
        let deg = nearest.unwrap_or(deg);
        (Value::Direction { deg }, note)
    };
    let unit = quantity.unit.or(expected.hint);
    let (deg, rounding) = match (quantity.times_pi, unit) {
        (true, None) => (number * 180.0, Some(number.abs() * PI * ROUNDED)),
        (true, Some(AnswerUnit::Of(unit))) if *unit == RAD => {
            (number * 180.0, Some(number.abs() * PI * ROUNDED))
        }
        (false, Some(AnswerUnit::Of(unit))) if *unit == RAD && number.abs() > MAX_BARE_RAD => {
            return Err(format!("`{text}` is more than a turn"));
        }
        (false, Some(AnswerUnit::Of(unit))) if *unit == RAD => {
            (number.to_degrees(), Some(rounding_rad(quantity)))
        }
        (false, Some(AnswerUnit::Of(unit))) if unit.dimension == Dimension::Angle => {
            // `33.3 deg` is a rounded 33.3333; `33 deg` is another angle.
            let has_decimals = (1e-9..0.06).contains(&quantity.rounding);
            let rounding = has_decimals.then(|| (quantity.rounding * unit.in_deg()).to_radians());
            (number * unit.in_deg(), rounding)
        }
        (false, None) => return bare_direction(choices, quantity, text),
        _ => return Err(format!("`{text}` is no angle")),
    };
    Ok(stated(deg, nearest_deg(choices, deg, rounding, text)?))
}

/// Reads a number without a unit: degrees if that is a choice, otherwise radians.
fn bare_direction(
    choices: &[Direction],
    quantity: Quantity,
    text: &str,
) -> Result<Resolved, String> {
    let number = quantity.number;
    if let Some(deg) = nearest_deg(choices, number, None, text)? {
        let note = "the number as degrees".to_owned();
        return Ok((Value::Direction { deg }, Some(note)));
    }
    let in_radians = match number.abs() <= MAX_BARE_RAD {
        true => nearest_deg(
            choices,
            number.to_degrees(),
            Some(rounding_rad(quantity)),
            text,
        )?,
        false => None,
    };
    match in_radians {
        Some(deg) => {
            let note = "the number as radians".to_owned();
            Ok((Value::Direction { deg }, Some(note)))
        }
        None => Err(format!(
            "`{text}` has no unit and is none of its choices in degrees or radians"
        )),
    }
}

/// Returns how far a number of radians may be from the angle that it means.
fn rounding_rad(quantity: Quantity) -> f64 {
    let least = quantity.number.abs().min(MAX_BARE_RAD) * ROUNDED;
    // One decimal is too coarse: 0.8 is 46 degrees.
    if quantity.rounding <= 0.005 {
        quantity.rounding.max(least)
    } else {
        least
    }
}

/// Returns the choice that an angle means; fails if it can mean two.
///
/// - `rounding_rad`: how far from it the choice may be if it was rounded, radians.
fn nearest_deg(
    choices: &[Direction],
    deg: f64,
    rounding_rad: Option<f64>,
    text: &str,
) -> Result<Option<f64>, String> {
    let deg = normalised_deg(deg);
    let apart = |choice: &Direction| words::apart_deg(choice.deg, deg);
    // `359.99999` is written `360`, which means 0.
    let reads = |choice: &Direction| {
        let same = |value: f64| written(normalised_deg(value), DECIMALS);
        apart(choice) < WRITTEN && same(choice.deg) == same(deg)
    };
    if let Some(same) = choices.iter().find(|choice| choice.deg == deg) {
        return Ok(Some(same.deg));
    }
    let alike = only(choices.iter().filter(|choice| reads(choice)), text)?;
    let tolerance_deg = rounding_rad.map(f64::to_degrees);
    let found = match (alike, tolerance_deg) {
        (None, Some(most_deg)) => only(
            choices.iter().filter(|choice| apart(choice) <= most_deg),
            text,
        )?,
        _ => alike,
    };
    Ok(found.map(|choice| choice.deg))
}

/// Returns the only remaining one; fails if there are several.
fn only<T>(mut left: impl Iterator<Item = T>, text: &str) -> Result<Option<T>, String> {
    let first = left.next();
    match left.next() {
        None => Ok(first),
        Some(_) => Err(format!("`{text}` can be more than one of its choices")),
    }
}

fn length(
    choices: &[LengthChoice],
    unit: LengthUnit,
    expected: &Expected<'_>,
    quantity: Quantity,
    text: &str,
) -> Result<Resolved, String> {
    let number = quantity.number;
    if quantity.times_pi {
        return Err(format!("`{text}` is no length"));
    }
    let (stated, in_unit, note) = match quantity.unit.or(expected.hint) {
        None => {
            let note = format!("the number in `{}`", unit.name);
            (number, unit, Some(note))
        }
        // Percent of what is clear only if the choices are parts of the edge.
        Some(AnswerUnit::Percent) if unit != LengthUnit::EDGE => {
            return Err(format!("`{text}` does not say of what"));
        }
        Some(AnswerUnit::Percent | AnswerUnit::PercentOfEdge) => {
            (number / 100.0, LengthUnit::EDGE, None)
        }
        Some(AnswerUnit::Micrometres) => match LengthUnit::find("mm") {
            Some(millimetres) => (
                number / 1000.0,
                millimetres,
                Some("micrometres as `mm`".to_owned()),
            ),
            None => return Err(format!("`{text}` is no length")),
        },
        Some(AnswerUnit::Of(stated)) => match LengthUnit::of(stated) {
            Some(stated) => (number, stated, None),
            None => return Err(format!("`{text}` is no length")),
        },
    };
    if in_unit.dimension != unit.dimension {
        let noun = match unit.dimension {
            Dimension::Speed => "speed",
            _ => "length",
        };
        return Err(format!("`{text}` is no {noun}"));
    }
    let given = |length: f64| (Value::Length { length }, note.clone());
    if in_unit == unit {
        if let Some(same) = choices.iter().find(|choice| choice.value == stated) {
            return Ok(given(same.value));
        }
        let reads = |choice: &&LengthChoice| {
            (choice.value - stated).abs() < WRITTEN
                && written(choice.value, DECIMALS) == written(stated, DECIMALS)
        };
        let alike = only(choices.iter().filter(reads), text)?;
        return Ok(given(alike.map_or(stated, |choice| choice.value)));
    }
    let stated_m = stated * in_unit.size_with(expected.edge_m);
    let is_same =
        |choice: &&LengthChoice| (choice.m - stated_m).abs() <= CONVERTED * choice.m.abs();
    if let Some(choice) = only(choices.iter().filter(is_same), text)? {
        let note = format!(
            "`{}` as `{}`",
            text,
            space::text(
                expected.field,
                &Value::Length {
                    length: choice.value
                }
            )
        );
        let length = choice.value;
        return Ok((Value::Length { length }, Some(note)));
    }
    let length = stated_m / unit.size_with(expected.edge_m);
    if length.is_finite() {
        Ok(given(length))
    } else {
        Err(format!("`{text}` is no length of this cloth"))
    }
}

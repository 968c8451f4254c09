//! Every unit of the language: one row each.
//!
//! A row serves sources, prompts and answers alike: a number with this unit may stand in a `.fab` file, is written with
//! its name, and is understood in an answer by its name or one of its spellings.

use std::f64::consts::PI;

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// A length on the table, metres.
    Length,
    /// A length in a picture, pixels.
    Pixels,
    /// An angle, radians.
    Angle,
    /// A plain number.
    Number,
}

/// A unit.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// How it is written.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Its size in base units; of `edge`, which the cloth decides, not a number.
    pub size: f64,
    /// The most digits behind the point of a number that a prompt writes in it.
    pub decimals: u8,
    /// How else people and models write it; in a source the right name is suggested.
    pub spellings: &'static [&'static str],
    /// What it is, in the plural.
    pub doc: &'static str,
}

/// Every unit.
pub const UNITS: &[Unit] = &[
    unit(
        "mm",
        Dimension::Length,
        0.001,
        1,
        &["millimeter", "millimeters", "millimetre", "millimetres"],
        "millimetres",
    ),
    unit(
        "cm",
        Dimension::Length,
        0.01,
        2,
        &["centimeter", "centimeters", "centimetre", "centimetres"],
        "centimetres",
    ),
    unit(
        "m",
        Dimension::Length,
        1.0,
        3,
        &["meter", "meters", "metre", "metres"],
        "metres",
    ),
    unit(
        "edge",
        Dimension::Length,
        f64::NAN,
        3,
        &["edges"],
        "lengths of the cloth's longer side",
    ),
    unit(
        "px",
        Dimension::Pixels,
        1.0,
        1,
        &["pixel", "pixels"],
        "pixels",
    ),
    unit(
        "deg",
        Dimension::Angle,
        PI / 180.0,
        2,
        &["degs", "degree", "degrees", "°"],
        "degrees",
    ),
    unit(
        "rad",
        Dimension::Angle,
        1.0,
        3,
        &["rads", "radian", "radians"],
        "radians",
    ),
];

const fn unit(
    name: &'static str,
    dimension: Dimension,
    size: f64,
    decimals: u8,
    spellings: &'static [&'static str],
    doc: &'static str,
) -> Unit {
    Unit {
        name,
        dimension,
        size,
        decimals,
        spellings,
        doc,
    }
}

/// Returns the unit of that name.
pub fn find(name: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.name == name)
}

/// Returns a number with the name of its unit in base units; a plain one, or one of an unknown unit, as it is.
pub fn base((number, unit): (f64, &str)) -> f64 {
    number * find(unit).map_or(1.0, |unit| unit.size)
}

//! Every unit of the language: one row each.
//!
//! A row serves sources, prompts and answers alike. Its name may follow a number in a `.fab` file, prompts write the
//! name, and answers may use the name or one of its spellings.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::f64::consts::PI;

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Dimension {
    /// A length on the table, metres.
    Length,
    /// A length in a picture, pixels.
    Pixels,
    /// An angle, radians.
    Angle,
    /// A speed, metres per second.
    Speed,
    /// Mass per area, kilograms per square metre.
    ArealDensity,
    /// A plain number.
    Number,
}

impl Dimension {
    /// Returns its name in messages and in the reference.
    pub fn noun(self) -> &'static str {
        match self {
            Dimension::Length => "a length on the table",
            Dimension::Pixels => "a length in the picture",
            Dimension::Angle => "an angle",
            Dimension::Speed => "a speed",
            Dimension::ArealDensity => "a mass per area",
            Dimension::Number => "a plain number",
        }
    }
}

/// A unit.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Unit {
    /// Its name, as written after a number.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Its size in base units; NaN for `edge`, which depends on the cloth.
    pub size: f64,
    /// The most digits after the decimal point of a number that a prompt writes in it.
    pub decimals: u8,
    /// Other ways in which people and models write it, ASCII words or signs. In a source, the right name is suggested
    /// instead.
    pub spellings: &'static [&'static str],
    /// Its meaning, in the plural.
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
    EDGE,
    PX,
    DEG,
    RAD,
    unit(
        "turn",
        Dimension::Angle,
        2.0 * PI,
        4,
        &["turns"],
        "whole turns",
    ),
    speed("mm/s", 0.001, 1, "millimetres per second"),
    speed("cm/s", 0.01, 2, "centimetres per second"),
    speed("m/s", 1.0, 3, "metres per second"),
    unit(
        "g/m2",
        Dimension::ArealDensity,
        0.001,
        1,
        &["g/m^2", "g/m²", "gsm"],
        "grams per square metre",
    ),
];

/// What an answer may write for `/s` after a unit of length.
pub const PER_SECOND: &str = "s sec secs second seconds";

const fn speed(name: &'static str, size: f64, decimals: u8, doc: &'static str) -> Unit {
    unit(name, Dimension::Speed, size, decimals, &[], doc)
}

/// The cloth's longer side.
pub const EDGE: Unit = unit(
    "edge",
    Dimension::Length,
    f64::NAN,
    3,
    &["edges"],
    "lengths of the cloth's longer side",
);

/// Pixels, the unit of lengths in the picture.
pub const PX: Unit = unit(
    "px",
    Dimension::Pixels,
    1.0,
    1,
    &["pixel", "pixels"],
    "pixels",
);

/// Degrees, the unit of angles in programs.
pub const DEG: Unit = unit(
    "deg",
    Dimension::Angle,
    PI / 180.0,
    2,
    &["degs", "degree", "degrees", "°", "º", "˚", "∘"],
    "degrees",
);

/// Radians.
pub const RAD: Unit = unit(
    "rad",
    Dimension::Angle,
    1.0,
    3,
    &["rads", "radian", "radians"],
    "radians",
);

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

impl PartialEq for Unit {
    /// Compares names, because the size of `edge` is NaN and not equal to itself.
    fn eq(&self, other: &Unit) -> bool {
        self.name == other.name
    }
}

impl Eq for Unit {}

impl Unit {
    /// Returns the unit of the speed that is this length in a second; `None` if there is none.
    pub fn per_second(&self) -> Option<&'static Unit> {
        find(&format!("{}/s", self.name))
    }

    /// Returns its size in base units, for a cloth whose longer side is `edge_m`.
    pub fn size_with(&self, edge_m: f64) -> f64 {
        if *self == EDGE { edge_m } else { self.size }
    }

    /// Returns the size of a unit of angles in degrees; exactly 1 for `deg`.
    pub fn in_deg(&self) -> f64 {
        self.size / DEG.size
    }

    /// Returns its name and its spellings.
    pub fn words(&self) -> impl Iterator<Item = &'static str> {
        [self.name]
            .into_iter()
            .chain(self.spellings.iter().copied())
    }
}

/// A unit of length on the table, or of length per second, in which a field offers its choices. In JSON it is the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LengthUnit(&'static Unit);

impl LengthUnit {
    /// The cloth's longer side.
    pub const EDGE: LengthUnit = LengthUnit(&EDGE);

    /// Returns a unit if it is one of length on the table, or of speed.
    pub fn of(unit: &'static Unit) -> Option<LengthUnit> {
        matches!(unit.dimension, Dimension::Length | Dimension::Speed).then_some(LengthUnit(unit))
    }

    /// Returns its row.
    pub fn row(self) -> &'static Unit {
        self.0
    }

    /// Returns the unit of length or speed with that name.
    pub fn find(name: &str) -> Option<LengthUnit> {
        find(name).and_then(LengthUnit::of)
    }
}

impl std::ops::Deref for LengthUnit {
    type Target = Unit;

    fn deref(&self) -> &Unit {
        self.0
    }
}

impl Serialize for LengthUnit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

impl<'de> Deserialize<'de> for LengthUnit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<LengthUnit, D::Error> {
        let name = String::deserialize(deserializer)?;
        LengthUnit::find(&name)
            .ok_or_else(|| D::Error::custom(format!("no unit of length or speed `{name}`")))
    }
}

/// Returns the unit with that name.
pub fn find(name: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.name == name)
}

/// Returns a number in base units; a plain number, or one with an unknown unit, is unchanged.
pub fn base((number, unit): (f64, &str)) -> f64 {
    number * find(unit).map_or(1.0, |unit| unit.size)
}

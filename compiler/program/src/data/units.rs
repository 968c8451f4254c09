//! Units in which lengths on the table are offered and written.

use serde::{Deserialize, Serialize};

/// A unit of length on the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Multiples of the cloth's longer side.
    Edge,
}

impl LengthUnit {
    /// Returns how it is written.
    pub fn as_str(self) -> &'static str {
        match self {
            LengthUnit::Mm => "mm",
            LengthUnit::Cm => "cm",
            LengthUnit::M => "m",
            LengthUnit::Edge => "edge",
        }
    }

    /// Returns its size in metres, for a cloth whose longer side is `edge_m`.
    pub fn in_m(self, edge_m: f64) -> f64 {
        match self {
            LengthUnit::Mm => 0.001,
            LengthUnit::Cm => 0.01,
            LengthUnit::M => 1.0,
            LengthUnit::Edge => edge_m,
        }
    }
}

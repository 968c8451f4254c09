//! A cloth as textile laboratories measure it.
//!
//! Plain data with bounds. `textile` turns it into forces; without a material a cloth is the recorded scene's
//! (the other numbers of [`Params`](crate::Params)).

use serde::{Deserialize, Serialize};

/// What was measured of a woven or knitted cloth. Each value is what a laboratory reports, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Mass per area, kg/m^2 (ISO 3801).
    pub weight_kg_m2: f32,
    /// Distance between the middles of two layers that lie on each other, metres (ISO 5084).
    pub thickness_m: f32,
    /// Bending length, metres (Peirce 1930; ASTM D1388, option A). A strip's bending rigidity per width is
    /// `weight * 9.81 m/s^2 * length^3`.
    pub bending_length_m: Directions,
    /// Angle to which a fold that was pressed flat opens again, degrees: 180 is flat, 0 stays folded (ISO 2313). Internal
    /// friction of bending follows from it.
    pub crease_recovery_deg: f32,
    /// Most that the cloth gives along its threads, and along their diagonal, as a share of its length.
    pub stretch: Directions,
    /// Coulomb friction on the table.
    pub table_friction: f32,
    /// Coulomb friction between layers.
    pub self_friction: f32,
}

/// A value along each direction of a woven cloth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Directions {
    /// Along the warp: the cloth's first side, from left to right in the grid.
    pub warp: f32,
    /// Along the weft: from back to front in the grid.
    pub weft: f32,
    /// At 45 degrees to both.
    pub bias: f32,
}

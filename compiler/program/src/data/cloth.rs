//! The cloth of a task.

use crate::data::files::FileRef;
use crate::data::material::{Colour, Face, Material};
use serde::{Deserialize, Serialize};

/// Distance between the recorded cloth's particles, metres (protocol, section 1), and of every cloth that states none.
pub const RECORDED_SPACING_M: f64 = 0.00625;

/// The fewest and the most particles along a side of a cloth.
pub const PARTICLES_A_SIDE: [u32; 2] = [2, 200];

/// Returns how many particles a side of a cloth has that is this long, to the nearest one and within [`PARTICLES_A_SIDE`].
///
/// - `side_m`, `spacing_m`: metres, finite; the spacing is more than 0.
pub fn particles_along(side_m: f64, spacing_m: f64) -> u32 {
    let [fewest, most] = PARTICLES_A_SIDE.map(f64::from);
    ((side_m / spacing_m).round() + 1.0).clamp(fewest, most) as u32
}

/// The spacings that a cloth of a material may state, millimetres.
///
/// At 2 mm, bending lengths above about 15 mm are too stiff for a step, and most woven cloths have such; at 12 mm, no loop
/// or fold of one below 24 mm is met.
pub const STATED_SPACING_MM: [f64; 2] = [2.0, 12.0];

/// How high the recorded scene's cloth lies above the table, metres.
pub const RECORDED_HEIGHT_M: f64 = 0.005;

/// Coulomb friction of the recorded scene's cloth on the table. A test in `fab-world` compares it with the simulator's.
const RECORDED_TABLE_FRICTION: f64 = 0.75;

/// A rectangular cloth as a grid of particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloth {
    /// Particles from left to right, at least 2.
    pub dimx: u32,
    /// Particles from back (image top) to front (image bottom), at least 2.
    pub dimy: u32,
    /// Distance between neighbours, metres.
    pub spacing_m: f64,
    /// How it lies at the start, unless the command line says otherwise.
    pub start: ClothStart,
    /// What it is made of; `None` is the cloth of the recorded scene. A cloth on a real table is what it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
}

impl Cloth {
    /// Returns the length of the longer side, metres: one `edge`.
    pub fn edge_m(&self) -> f64 {
        f64::from(self.dimx.max(self.dimy) - 1) * self.spacing_m
    }

    /// Returns the colour of a face.
    pub fn colour(&self, face: Face) -> Colour {
        match (&self.material, face) {
            (None, _) => Colour::recorded(face),
            (Some(material), Face::Upper) => material.upper.clone(),
            (Some(material), Face::Under) => material.under.clone(),
        }
    }

    /// Returns how high the flat cloth's surface lies above the table in the simulator, metres.
    pub fn rest_height_m(&self) -> f64 {
        match &self.material {
            None => RECORDED_HEIGHT_M,
            Some(material) => material.gap_m() / 2.0,
        }
    }

    /// Returns its coefficient of friction on the table in the simulator.
    pub fn table_friction(&self) -> f64 {
        match &self.material {
            None => RECORDED_TABLE_FRICTION,
            Some(material) => material.table_friction,
        }
    }

    /// Returns the area of the flat cloth, square metres.
    pub fn area_m2(&self) -> f64 {
        let side_m = |n_particles: u32| f64::from(n_particles - 1) * self.spacing_m;
        side_m(self.dimx) * side_m(self.dimy)
    }
}

/// How a cloth lies at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "lies", rename_all = "snake_case")]
pub enum ClothStart {
    /// Flat and straight.
    Flat,
    /// Crumpled: lifted and dropped at random, from the rollout's seed.
    Crumpled,
    /// At the particle positions in a file.
    File {
        /// The file.
        file: FileRef,
    },
}

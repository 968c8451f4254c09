//! The cloth that a task is about.

use serde::{Deserialize, Serialize};

/// A rectangular cloth as a grid of particles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloth {
    /// Particles from left to right, at least 2.
    pub dimx: u32,
    /// Particles from back (image top) to front (image bottom), at least 2.
    pub dimy: u32,
    /// Distance between neighbours, metres.
    pub spacing_m: f64,
}

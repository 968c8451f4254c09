//! Folds between points of a cloth: demonstrations, and the sequences that count as right.

use serde::{Deserialize, Serialize};

/// Moves one cloth point to another: `place = pick + fraction * (target - pick)` (protocol, section 6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fold {
    /// The picked point.
    pub pick: ClothPoint,
    /// The point it is carried to.
    pub place: ClothPoint,
    /// How far towards it, `0 < fraction <= 1`.
    pub fraction: f64,
}

/// A point of the cloth, independent of its size and position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClothPoint {
    /// A particle, by its position in the flat cloth: `right` from 0 (left edge) to 1 (right edge), `front` from 0
    /// (back edge, image top) to 1 (front edge). The particle's grid index is
    /// `floor(right * (dimx - 1)), floor(front * (dimy - 1))`; its position is read when the fold starts.
    Particle {
        /// Fraction from the left edge to the right edge.
        right: f64,
        /// Fraction from the back edge to the front edge.
        front: f64,
    },
    /// The middle of the cloth's bounding box on the table at the start of the rollout; a fixed table point.
    Center,
}

/// A sequence of folds whose result counts as right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sequence {
    /// The folds in order.
    pub folds: Vec<Fold>,
}

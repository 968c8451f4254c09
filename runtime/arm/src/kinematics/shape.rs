//! The shapes of an arm's links and hand, and where they are at given joint angles.
//!
//! In: capsules in their links' frames, and joint angles. Out: the same capsules in the base frame. They contain the
//! link, the hand and the fingers in every opening. Links that no joint moves are left out.

use super::chain::{BadAngles, Chain};
use nalgebra::Point3;

/// A ball swept along a straight line, in the frame of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule {
    /// The link: an index into [`Chain::frames`]. The last is the hand, in the tool's frame.
    pub link: usize,
    /// One end of the line, metres, in the link's frame.
    pub from: Point3<f64>,
    /// The other.
    pub to: Point3<f64>,
    /// Radius of the ball, metres.
    pub radius_m: f64,
}

/// A capsule at an arm's angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCapsule {
    /// The link, as in [`Capsule`].
    pub link: usize,
    /// The ends of the line, metres, base frame.
    pub ends: [Point3<f64>; 2],
    /// Radius of the ball, metres.
    pub radius_m: f64,
}

impl PlacedCapsule {
    /// Returns the height of its lowest point, metres, base frame.
    pub fn lowest_m(&self) -> f64 {
        self.ends[0].z.min(self.ends[1].z) - self.radius_m
    }
}

impl Chain {
    /// Returns the shapes of links, hand and fingers.
    pub fn shapes(&self) -> &[Capsule] {
        &self.shapes
    }

    /// Returns these shapes at joint angles, in the base frame.
    ///
    /// - `joints_rad`: one for each joint, from the base; limits are not checked.
    pub fn placed_shapes(&self, joints_rad: &[f64]) -> Result<Vec<PlacedCapsule>, BadAngles> {
        let frames = self.frames(joints_rad)?;
        let placed = |shape: &Capsule| PlacedCapsule {
            link: shape.link,
            ends: [&shape.from, &shape.to].map(|end| frames[shape.link] * end),
            radius_m: shape.radius_m,
        };
        Ok(self.shapes.iter().map(placed).collect())
    }
}

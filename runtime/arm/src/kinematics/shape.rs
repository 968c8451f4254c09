//! The shapes of an arm's links and hand, where they are at given joint angles, and how far they are from each other.
//!
//! In: capsules in their links' frames, and joint angles. Out: the same capsules in the base frame, and exact distances.
//! They contain the link, the hand and the fingers in every opening. Links that no joint moves are left out.

use super::chain::Chain;
use nalgebra::{Isometry3, Matrix2, Point3, Vector2, Vector3};

/// A ball swept along a straight line, in the frame of a link or in the base frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule {
    /// The link: an index into [`Chain::frames`]. The last is the hand, in the tool's frame.
    pub link: usize,
    /// The ends of the line, metres.
    pub ends: [Point3<f64>; 2],
    /// Radius of the ball, metres.
    pub radius_m: f64,
    /// Whether it was laid around a mesh, which may be much narrower.
    pub is_around_mesh: bool,
}

impl Capsule {
    /// Returns it with its frame at a place.
    pub fn at(&self, frame: &Isometry3<f64>) -> Capsule {
        Capsule {
            ends: self.ends.map(|end| frame * end),
            ..*self
        }
    }

    /// Returns the distance to a box along the axes, metres; 0 or less if they overlap.
    ///
    /// - `min_m`, `max_m`: its corners, base frame.
    pub fn gap_to_box_m(&self, min_m: &[f64; 3], max_m: &[f64; 3]) -> f64 {
        let (from, along) = (self.ends[0], self.ends[1] - self.ends[0]);
        let outside = |part: f64| {
            let point = from + along * part;
            Vector3::from_fn(|axis, _| point[axis] - point[axis].clamp(min_m[axis], max_m[axis]))
        };
        // The squared distance is convex along the line, and between the planes of the faces a parabola: its slope is a
        // polygon that rises.
        let slope = |part: f64| outside(part).dot(&along);
        let faces = (0..3).flat_map(|axis| [min_m[axis], max_m[axis]].map(|face| (axis, face)));
        let crossed = faces.map(|(axis, face)| (face - from[axis]) / along[axis]);
        let mut parts: Vec<f64> = crossed.filter(|part| (0.0..1.0).contains(part)).collect();
        parts.extend([0.0, 1.0]);
        parts.sort_by(f64::total_cmp);
        let nearest = match parts.iter().position(|part| slope(*part) >= 0.0) {
            None => 1.0,
            Some(0) => 0.0,
            Some(next) => {
                let [before, after] = [parts[next - 1], parts[next]];
                let [down, up] = [slope(before), slope(after)];
                before + (after - before) * -down / (up - down)
            }
        };
        outside(nearest).norm() - self.radius_m
    }

    /// Returns the distance to another capsule, metres; 0 or less if they overlap.
    pub fn gap_m(&self, other: &Capsule) -> f64 {
        let [one, two] = [self, other].map(|it| it.ends[1] - it.ends[0]);
        let between = other.ends[0] - self.ends[0];
        // Either an end is nearest, or the shortest way is at right angles to both lines.
        let square = Matrix2::new(one.dot(&one), -one.dot(&two), one.dot(&two), -two.dot(&two));
        let parts = square
            .try_inverse()
            .map(|inverse| inverse * Vector2::new(between.dot(&one), between.dot(&two)));
        let across = parts
            .filter(|parts| parts.iter().all(|part| (0.0..=1.0).contains(part)))
            .map(|parts| (between + two * parts.y - one * parts.x).norm());
        let ends = [(self, other), (other, self)].map(|(line, other)| {
            let away = other.ends.map(|end| from_line_m(&line.ends, &end));
            away[0].min(away[1])
        });
        let axes_m = ends[0].min(ends[1]).min(across.unwrap_or(f64::INFINITY));
        axes_m - self.radius_m - other.radius_m
    }
}

/// Returns the distance of a point from a line between two ends, metres.
fn from_line_m([from, to]: &[Point3<f64>; 2], point: &Point3<f64>) -> f64 {
    let along = to - from;
    let part = (point - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    (point - from - along * part.clamp(0.0, 1.0)).norm()
}

impl Chain {
    /// Returns the shapes of links, hand and fingers.
    pub fn shapes(&self) -> &[Capsule] {
        &self.shapes
    }

    /// Returns these shapes at joint angles, in the base frame.
    ///
    /// - `joints_rad`: one for each joint, from the base; limits are not checked.
    pub fn placed_shapes(&self, joints_rad: &[f64]) -> Result<Vec<Capsule>, String> {
        let frames = self.frames(joints_rad)?;
        let shapes = self.shapes.iter();
        Ok(shapes.map(|shape| shape.at(&frames[shape.link])).collect())
    }
}

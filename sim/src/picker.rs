//! The folding picker's route, and what it may grasp.
//!
//! In: where to pick and place. Out: the sphere's way points and, step by
//! step, its next position. The simulator carries the particle along. Route,
//! heights and speed follow Foldsformer's folding environment.

use crate::params::Params;

// The picker counts as arrived within this distance of a way point, metres (Foldsformer).
const ARRIVED_M: f32 = 1e-4;

/// Whether the picker takes hold of a particle when it can.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gripper {
    Open,
    Closed,
}

/// A straight move of the sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub target: [f32; 3],
    pub gripper: Gripper,
}

/// Returns the particle nearest to the sphere's centre, if it is within `capture_m`; of equals, the first.
pub(crate) fn nearest(
    particles: impl Iterator<Item = (usize, [f32; 3])>,
    centre: [f32; 3],
    capture_m: f32,
) -> Option<usize> {
    let mut best = None;
    let mut best_2 = f32::INFINITY;
    for (particle, point) in particles {
        let distance_2 = distance_2(point, centre);
        if distance_2 <= capture_m * capture_m && distance_2 < best_2 {
            best = Some(particle);
            best_2 = distance_2;
        }
    }
    best
}

/// Returns the uppermost of the particles at a point of the table; where none is as near as the particles of a
/// flat cloth are to any point of it, the nearest as seen from above.
pub(crate) fn uppermost(
    particles: impl Iterator<Item = (usize, [f32; 3])>,
    spacing_m: f32,
    [x_m, y_m]: [f32; 2],
) -> Option<usize> {
    let reach_2 = 0.5 * spacing_m * spacing_m;
    let order = |&(_, [x, y, z]): &(usize, [f32; 3])| {
        let aside_2 = (x - x_m) * (x - x_m) + (y - y_m) * (y - y_m);
        // Those at the point come before all others, the highest first.
        (
            aside_2 > reach_2,
            if aside_2 > reach_2 { aside_2 } else { -z },
        )
    };
    let before = |a: &(bool, f32), b: &(bool, f32)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
    let first = particles.min_by(|a, b| before(&order(a), &order(b)));
    first.map(|(particle, _)| particle)
}

fn distance_2(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (dx, dy, dz) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    dx * dx + dy * dy + dz * dz
}

/// Lists the legs of one pick-and-place: over, down, up, across, down, up, home.
pub(crate) fn legs(pick: [f32; 2], place: [f32; 2], params: &Params) -> [Leg; 7] {
    use Gripper::{Closed, Open};
    let (low, high) = (params.picker_grasp_height_m, params.picker_lift_height_m);
    let leg = |[x, y]: [f32; 2], z, gripper| Leg {
        target: [x, y, z],
        gripper,
    };
    [
        leg(pick, high, Open),
        leg(pick, low, Open),
        leg(pick, high, Closed),
        leg(place, high, Closed),
        leg(place, low, Closed),
        leg(place, high, Open),
        Leg {
            target: params.picker_home_m,
            gripper: Open,
        },
    ]
}

/// Returns the sphere's next centre on the way to a target, or `None` once it has arrived.
pub(crate) fn advance(from: [f32; 3], target: [f32; 3], travel_m: f32) -> Option<[f32; 3]> {
    let way = [
        target[0] - from[0],
        target[1] - from[1],
        target[2] - from[2],
    ];
    let distance = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
    if distance < ARRIVED_M {
        return None;
    }
    if distance < travel_m {
        return Some(target);
    }
    let share = travel_m / distance;
    Some([0, 1, 2].map(|axis| from[axis] + share * way[axis]))
}

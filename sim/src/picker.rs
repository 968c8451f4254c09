//! The picker's route, and what it may grasp.
//!
//! In: where to pick and place. Out: the sphere's way points and, step by
//! step, its next position. The simulator carries the particle along. Routes,
//! heights and speeds follow Foldsformer's folding and SoftGym's smoothing environment.

use crate::mask::Mask;
use crate::mesh;
use crate::params::{DROP_LEG_STEPS, Params, Route};

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

/// Returns the particle that a camera above shows at a point of the table: the corner nearest to the point of the
/// uppermost triangle there; beside the cloth, the particle nearest to the point as seen from above.
///
/// - `points`: `[n_particles]`, grid order, world frame, metres.
pub(crate) fn uppermost(mask: &Mask, points: &[[f32; 3]], at: [f32; 2]) -> Option<usize> {
    let aside_2 = |particle: usize| {
        let [x, y, _] = points[particle];
        distance_2([x, y, 0.0], [at[0], at[1], 0.0])
    };
    let nearest = |particles: &mut dyn Iterator<Item = usize>| {
        particles.min_by(|&a, &b| aside_2(a).total_cmp(&aside_2(b)))
    };
    let there = mesh::cells(mask).flatten().filter_map(|corners| {
        let height = height_at(corners.map(|corner| points[corner]), at)?;
        Some((height, corners))
    });
    match there.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, corners)) => nearest(&mut corners.into_iter()),
        None => nearest(&mut (0..points.len()).filter(|&particle| mask.has(particle))),
    }
}

/// Returns the height of a triangle over a point of the table, or `None` beside it and for one seen edge on.
fn height_at([a, b, c]: [[f32; 3]; 3], at: [f32; 2]) -> Option<f32> {
    let twice = |p: [f32; 2], q: [f32; 2], r: [f32; 2]| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let [pa, pb, pc] = [a, b, c].map(|point| [point[0], point[1]]);
    let whole = twice(pa, pb, pc);
    let shares = [twice(at, pb, pc), twice(pa, at, pc), twice(pa, pb, at)].map(|part| part / whole);
    // A triangle without area has shares that are no numbers.
    let inside = shares.iter().all(|&share| share >= 0.0);
    inside.then(|| shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2])
}

fn distance_2(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (dx, dy, dz) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    dx * dx + dy * dy + dz * dz
}

/// Lists the legs of one pick-and-place.
///
/// - `surface_m`: height of the cloth at the pick point, metres.
pub(crate) fn legs(pick: [f32; 2], place: [f32; 2], surface_m: f32, params: &Params) -> Vec<Leg> {
    use Gripper::{Closed, Open};
    let high = params.picker_lift_height_m;
    let leg = |[x, y]: [f32; 2], z, gripper| Leg {
        target: [x, y, z],
        gripper,
    };
    let home = Leg {
        target: params.picker_home_m,
        gripper: Open,
    };
    match params.picker_route {
        Route::PutDown => {
            let low = params.picker_grasp_height_m;
            vec![
                leg(pick, high, Open),
                leg(pick, low, Open),
                leg(pick, high, Closed),
                leg(place, high, Closed),
                leg(place, low, Closed),
                leg(place, high, Open),
                home,
            ]
        }
        Route::Drop => {
            let radius_m = params.picker_radius_m;
            let low = surface_m.max(radius_m);
            vec![
                leg(pick, low + 2.0 * radius_m, Open),
                leg(pick, low, Open),
                leg(pick, high, Closed),
                leg(place, high, Closed),
                // It stays there, open, while the cloth falls.
                leg(place, high, Open),
                home,
            ]
        }
    }
}

/// The sphere's way along one leg, step by step.
pub(crate) struct Way {
    from: [f32; 3],
    target: [f32; 3],
    taken: u32,
    route: Route,
    travel_m: f32,
}

impl Way {
    pub(crate) fn new(from: [f32; 3], leg: &Leg, params: &Params) -> Way {
        Way {
            from,
            target: leg.target,
            taken: 0,
            route: params.picker_route,
            travel_m: params.picker_travel_m,
        }
    }

    /// Returns the sphere's next centre, or `None` once the leg is done.
    pub(crate) fn next(&mut self, now: [f32; 3]) -> Option<[f32; 3]> {
        if self.route == Route::PutDown {
            return advance(now, self.target, self.travel_m);
        }
        if self.taken == DROP_LEG_STEPS {
            return None;
        }
        self.taken += 1;
        let share = self.taken as f32 / DROP_LEG_STEPS as f32;
        let axis = |axis: usize| self.from[axis] + share * (self.target[axis] - self.from[axis]);
        Some([0, 1, 2].map(axis))
    }
}

/// Returns the sphere's next centre on the way to a target, or `None` once it has arrived.
fn advance(from: [f32; 3], target: [f32; 3], travel_m: f32) -> Option<[f32; 3]> {
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

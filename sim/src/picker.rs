//! The picker's route, and what it may grasp.
//!
//! In: where to pick and place. Out: the sphere's way points and, step by
//! step, its next position. The simulator carries the particle along. Routes,
//! heights and speeds follow Foldsformer's folding and SoftGym's smoothing environment.

use crate::mask::Mask;
use crate::mesh;
use crate::params::{DROP_LEG_STEPS, Params, ParamsError, Route};

// The picker counts as arrived within this distance of a way point, metres (Foldsformer).
const ARRIVED_M: f32 = 1e-4;

/// Whether the picker takes hold of a particle when it can.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gripper {
    Open,
    Closed,
}

/// How the picker goes about one action. What is not stated is as the parameters say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manner {
    /// How far the sphere rises after the grasp, and with it the held particle, metres, 0 to 1; 0 drags.
    pub lift_m: Option<f32>,
    /// Speed of the sphere while it is closed, m/s, above 0 and at most 10.
    pub speed_m_s: Option<f32>,
    /// Height of the sphere above that of its grasp when it opens, metres, 0 to 1.
    pub release_height_m: Option<f32>,
    /// The length of the crease that the sphere presses afterwards, metres, 0 to 2; 0 presses nothing. The crease lies
    /// across the way from pick to place, through its middle.
    pub press_m: Option<f32>,
}

impl Manner {
    /// Fails on the first number that is out of bounds.
    pub(crate) fn check(&self) -> Result<(), ParamsError> {
        #[rustfmt::skip] // a table, one field a line
        let rows = [
            ("lift_m", self.lift_m, [0.0, 1.0], " m"),
            ("speed_m_s", self.speed_m_s, [1e-3, 10.0], " m/s"),
            ("release_height_m", self.release_height_m, [0.0, 1.0], " m"),
            ("press_m", self.press_m, [0.0, 2.0], " m"),
        ];
        for (field, value, [low, high], unit) in rows {
            if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
                let value = value.to_string();
                return Err(ParamsError {
                    field,
                    value,
                    low,
                    high,
                    unit,
                });
            }
        }
        Ok(())
    }
}

/// Largest distance between two places where the crease is pressed, metres: half the sphere's radius.
const PRESS_EVERY_M: f32 = 0.025;

/// Least way from pick to place that makes a crease, metres.
const CREASE_WAY_M: f32 = 0.001;

/// Steps for which the sphere stays down on the crease. Trial: pressing longer flattens no further.
const PRESS_STEPS: u32 = 20;

/// A straight move of the sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub target: [f32; 3],
    pub gripper: Gripper,
    /// Travel per step, metres, if it is not what the route says.
    pub travel_m: Option<f32>,
    /// Steps for which the sphere stays at the target.
    pub stays: u32,
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

/// Lists the legs of one pick-and-place, up to where the sphere is open again over the place.
///
/// - `surface_m`: height of the cloth at the pick point, metres.
pub(crate) fn legs(
    pick: [f32; 2],
    place: [f32; 2],
    surface_m: f32,
    manner: &Manner,
    params: &Params,
) -> Vec<Leg> {
    use Gripper::{Closed, Open};
    let high = params.picker_lift_height_m;
    let carry_m = manner
        .speed_m_s
        .map(|speed_m_s| speed_m_s * params.step_secs);
    let leg = |[x, y]: [f32; 2], z, gripper| Leg {
        target: [x, y, z],
        gripper,
        travel_m: carry_m.filter(|_| gripper == Closed),
        stays: 0,
    };
    let lifted = |low: f32| manner.lift_m.map_or(high, |lift_m| low + lift_m);
    match params.picker_route {
        Route::PutDown => {
            let low = params.picker_grasp_height_m;
            let carried = lifted(low);
            vec![
                leg(pick, high, Open),
                leg(pick, low, Open),
                leg(pick, carried, Closed),
                leg(place, carried, Closed),
                leg(place, low + manner.release_height_m.unwrap_or(0.0), Closed),
                // Up from the cloth, however low it was carried.
                leg(place, carried.max(high), Open),
            ]
        }
        Route::Drop => {
            let radius_m = params.picker_radius_m;
            let low = surface_m.max(radius_m);
            let carried = lifted(low);
            let mut legs = vec![
                leg(pick, low + 2.0 * radius_m, Open),
                leg(pick, low, Open),
                leg(pick, carried, Closed),
                leg(place, carried, Closed),
            ];
            let release = match manner.release_height_m {
                Some(height_m) => low + height_m,
                None => carried,
            };
            if release != carried {
                legs.push(leg(place, release, Closed));
            }
            // It stays there, open, while the cloth falls.
            legs.push(leg(place, release, Open));
            legs
        }
    }
}

/// Returns the leg to where the sphere waits.
pub(crate) fn home(params: &Params) -> Leg {
    Leg {
        target: params.picker_home_m,
        gripper: Gripper::Open,
        travel_m: None,
        stays: 0,
    }
}

/// Lists the legs that press a crease: down as low as for a grasp on the table, a while, and up, place by place.
pub(crate) fn presses(pick: [f32; 2], place: [f32; 2], press_m: f32, params: &Params) -> Vec<Leg> {
    let way = [place[0] - pick[0], place[1] - pick[1]];
    let way_m = (way[0] * way[0] + way[1] * way[1]).sqrt();
    // A NaN presses nothing either.
    if !(press_m > 0.0 && way_m >= CREASE_WAY_M) {
        return Vec::new();
    }
    let along = [-way[1] / way_m, way[0] / way_m];
    let low = match params.picker_route {
        Route::PutDown => params.picker_grasp_height_m,
        Route::Drop => params.picker_radius_m,
    };
    let high = low.max(params.picker_lift_height_m);
    let gaps = (press_m / PRESS_EVERY_M).ceil();
    let place_at = |gap: u32| {
        let off_m = (gap as f32 / gaps - 0.5) * press_m;
        [0, 1].map(|axis| pick[axis] + 0.5 * way[axis] + off_m * along[axis])
    };
    let press = |[x, y]: [f32; 2]| {
        [(high, 0), (low, PRESS_STEPS), (high, 0)].map(|(z, stays)| Leg {
            target: [x, y, z],
            gripper: Gripper::Open,
            travel_m: Some(params.picker_travel_m),
            stays,
        })
    };
    (0..=gaps as u32)
        .flat_map(|gap| press(place_at(gap)))
        .collect()
}

/// The sphere's way along one leg, step by step.
pub(crate) struct Way {
    from: [f32; 3],
    target: [f32; 3],
    taken: u32,
    /// Travel per step, metres; without it, the leg takes [`DROP_LEG_STEPS`].
    travel_m: Option<f32>,
    stays: u32,
}

impl Way {
    pub(crate) fn new(from: [f32; 3], leg: &Leg, params: &Params) -> Way {
        Way {
            from,
            target: leg.target,
            taken: 0,
            travel_m: leg.travel_m.or(match params.picker_route {
                Route::PutDown => Some(params.picker_travel_m),
                Route::Drop => None,
            }),
            stays: leg.stays,
        }
    }

    /// Returns the sphere's next centre, or `None` once the leg is done.
    pub(crate) fn next(&mut self, now: [f32; 3]) -> Option<[f32; 3]> {
        if let Some(travel_m) = self.travel_m {
            let next = advance(now, self.target, travel_m);
            if next.is_none() && self.stays > 0 {
                self.stays -= 1;
                return Some(now);
            }
            return next;
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

//! How far an action moved the cloth, and how much of that stayed.
//!
//! In: every particle before and after an action, and what was done. Out: distances along the table, as seen from
//! above: a corner that was lifted and put back has moved 0 mm.

use crate::{Executed, Grasp};
use serde::{Deserialize, Serialize};

/// How far an action moved the cloth along the table, millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClothMoved {
    /// The particle that was held; null if none was, or if the world does not tell which.
    pub held: Option<HeldMoved>,
    /// How far the particle that moved most lies from its place before the action.
    pub farthest_mm: f64,
    /// How far the whole cloth slid: half of its particles moved at least as far along x, and half along y.
    pub slid_mm: f64,
    /// How far the particle that moved most lies from where it would lie if the whole cloth had only slid.
    pub folded_mm: f64,
}

/// How far an action moved the particle that was held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldMoved {
    /// From its place before the action to its place at the release.
    pub carried_mm: f64,
    /// From its place before the action to its place after it, when the cloth rests.
    pub stayed_mm: f64,
}

impl HeldMoved {
    /// Returns whether the particle went back more than half of its way.
    pub fn sprang_back(&self) -> bool {
        self.stayed_mm < self.carried_mm / 2.0
    }
}

impl ClothMoved {
    /// Returns whether a carried cloth lies as before, wherever it slid to: no particle was folded even half as far as the held one was
    /// carried, or even a millimetre.
    ///
    /// `None` if nothing was held.
    pub fn went_back(&self) -> Option<bool> {
        let held = self.held?;
        Some(self.folded_mm < (held.carried_mm / 2.0).max(1.0))
    }
}

/// Measures an action.
///
/// - `before`, `after`: `[n_particles]` positions, grid order, world frame, metres.
///
/// `None` if the counts differ, or there is no particle.
pub fn cloth_moved(
    before: &[[f32; 3]],
    after: &[[f32; 3]],
    executed: &Executed,
) -> Option<ClothMoved> {
    if before.len() != after.len() {
        return None;
    }
    let ways = || {
        let pairs = before.iter().zip(after);
        pairs.map(|(before, after)| {
            [0, 1].map(|axis| f64::from(after[axis]) - f64::from(before[axis]))
        })
    };
    let mut slid = [0.0; 2];
    for axis in [0, 1] {
        let mut along: Vec<f64> = ways().map(|way| way[axis]).collect();
        along.sort_by(f64::total_cmp);
        slid[axis] = *along.get(along.len() / 2)?;
    }
    let farthest_mm = |from: [f64; 2]| {
        let ways = ways().map(|way| mm([way[0] - from[0], way[1] - from[1]]));
        ways.fold(0.0, f64::max)
    };
    let held = || {
        let Grasp::Particle(particle) = executed.grasp else {
            return None;
        };
        let from = before.get(particle as usize)?.map(f64::from);
        let rests = after.get(particle as usize)?.map(f64::from);
        let away_mm = |to: [f64; 3]| mm([to[0] - from[0], to[1] - from[1]]);
        Some(HeldMoved {
            carried_mm: away_mm(executed.released_at?.into()),
            stayed_mm: away_mm(rests),
        })
    };
    Some(ClothMoved {
        held: held(),
        farthest_mm: farthest_mm([0.0; 2]),
        slid_mm: mm(slid),
        folded_mm: farthest_mm(slid),
    })
}

fn mm(way_m: [f64; 2]) -> f64 {
    way_m[0].hypot(way_m[1]) * 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, WorldPoint};

    fn executed(grasp: Grasp, released_at: Option<WorldPoint>) -> Executed {
        let pick = WorldPoint::origin();
        Executed {
            motion: Motion {
                pick,
                place: pick,
                manner: Default::default(),
            },
            grasp,
            released_at,
            duration_s: 1.0,
        }
    }

    #[test]
    fn distances_are_along_the_table_and_count_from_the_place_before() {
        let before = [[0.0, 0.0, 0.005], [1.0, 0.0, 0.005]];
        let after = [[0.003, 0.004, 0.005], [1.012, 0.0, 0.305]];
        let released = WorldPoint::new(0.03, 0.04, 0.2);
        let moved = cloth_moved(
            &before,
            &after,
            &executed(Grasp::Particle(0), Some(released)),
        );
        let moved = moved.expect("equal counts");
        let held = moved.held.expect("a particle was held");
        for (found, expected) in [
            (held.carried_mm, 50.0),
            (held.stayed_mm, 5.0),
            (moved.farthest_mm, 12.0),
        ] {
            assert!((found - expected).abs() < 1e-3, "{found} is not {expected}");
        }
        assert!(held.sprang_back());
        assert_eq!(moved.went_back(), Some(true));
    }

    #[test]
    fn a_cloth_that_was_dragged_was_not_folded() {
        let before = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.02, 0.0, 0.0]];
        let mut after = before.map(|[x, y, z]| [x + 0.03, y - 0.04, z]);
        let released = WorldPoint::new(0.06, 0.0, 0.2);
        let measured = |after: &[[f32; 3]]| {
            let done = executed(Grasp::Particle(0), Some(released));
            cloth_moved(&before, after, &done).expect("equal counts")
        };
        let dragged = measured(&after);
        assert_eq!(dragged.went_back(), Some(true));
        assert!((dragged.slid_mm - 50.0).abs() < 1e-3 && dragged.folded_mm < 1e-3);
        after[0][0] += 0.035;
        let folded = measured(&after);
        assert_eq!(folded.went_back(), Some(false));
        assert!((folded.slid_mm - 50.0).abs() < 1e-3);
        assert!((folded.folded_mm - 35.0).abs() < 1e-3);
    }

    #[test]
    fn a_world_that_does_not_tell_the_particle_tells_how_far_the_cloth_moved() {
        let (before, after) = ([[0.0; 3]], [[0.01, 0.0, 0.0]]);
        let moved = cloth_moved(&before, &after, &executed(Grasp::Held, None));
        let moved = moved.expect("equal counts");
        assert_eq!((moved.held, moved.went_back()), (None, None));
        assert!((moved.farthest_mm - 10.0).abs() < 1e-3);
    }
}

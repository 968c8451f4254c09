//! How far an action moved the cloth, and how much of that stayed.
//!
//! In: every particle before and after an action, and what was done. Out: distances along the table, as seen from
//! above: a corner that was lifted and put back has moved 0 mm.

use crate::{Executed, Grasp};
use serde::{Deserialize, Serialize};

/// How far an action moved the cloth along the table, millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClothMoved {
    /// The particle that was held; null if none was, if several were, or if the world does not tell which.
    pub held: Option<HeldMoved>,
    /// How far the particle that moved most lies from its place before the action.
    pub farthest_mm: f64,
    /// How far the whole cloth slid: the length of the way whose x and y are the medians over all particles. It is
    /// no slide where more than half of the cloth was folded over, or where the cloth turned.
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
    /// Whether it went back more than half of its way, once the slide of the whole cloth is taken off.
    pub sprang_back: bool,
    /// Whether the cloth lies as before, wherever it slid to: once the slide is taken off, no particle lies farther from its old
    /// place than half of what the held one was carried (or a tenth of it with the slide, or 1 mm, if that is more).
    pub went_back: bool,
}

/// Measures an action.
///
/// - `before`, `after`: `[n_particles]` positions, grid order, world frame, metres.
///
/// `None` if the counts differ, there is no particle, or a coordinate is not finite.
pub fn cloth_moved(
    before: &[[f32; 3]],
    after: &[[f32; 3]],
    executed: &Executed,
) -> Option<ClothMoved> {
    let are_finite = before
        .iter()
        .chain(after)
        .flatten()
        .all(|it| it.is_finite());
    if before.len() != after.len() || !are_finite {
        return None;
    }
    let ways = || {
        let pairs = before.iter().zip(after);
        pairs.map(|(before, after)| way(before.map(f64::from), after.map(f64::from)))
    };
    let slid = [
        median(ways().map(|way| way[0]))?,
        median(ways().map(|way| way[1]))?,
    ];
    let farthest_mm = |from: [f64; 2]| ways().map(|way| mm(less(way, from))).fold(0.0, f64::max);
    let folded_mm = farthest_mm(slid);
    let held = || {
        let [done] = executed.grips[..] else {
            return None;
        };
        let Grasp::Particle(particle) = done.grasp else {
            return None;
        };
        let from = before.get(particle as usize)?.map(f64::from);
        let carried = way(from, done.released_at?.into());
        let stayed = way(from, after.get(particle as usize)?.map(f64::from));
        let half_mm = mm(less(carried, slid)) / 2.0;
        Some(HeldMoved {
            carried_mm: mm(carried),
            stayed_mm: mm(stayed),
            sprang_back: mm(less(stayed, slid)) < half_mm,
            // A rim that was dragged is bent a little.
            went_back: folded_mm < half_mm.max(mm(carried) / 10.0).max(1.0),
        })
    };
    Some(ClothMoved {
        held: held(),
        farthest_mm: farthest_mm([0.0; 2]),
        slid_mm: mm(slid),
        folded_mm,
    })
}

/// Returns the mean of the two middle values, or the middle one; `None` of nothing.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let lower = middle.saturating_sub(usize::from(values.len().is_multiple_of(2)));
    Some((values.get(lower)? + values.get(middle)?) / 2.0)
}

/// Returns the way along the table.
fn way(from: [f64; 3], to: [f64; 3]) -> [f64; 2] {
    less([to[0], to[1]], [from[0], from[1]])
}

fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn mm(way_m: [f64; 2]) -> f64 {
    way_m[0].hypot(way_m[1]) * 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ExecutedGrip, Grip, WorldPoint};

    fn executed(grasp: Grasp, released_at: Option<WorldPoint>) -> Executed {
        let pick = WorldPoint::origin();
        let done = ExecutedGrip {
            grip: Grip::new(pick, pick),
            grasp,
            released_at,
        };
        Executed {
            grips: vec![done],
            duration_s: 1.0,
        }
    }

    #[test]
    fn distances_are_along_the_table_and_count_from_the_place_before() {
        let before = [[0.0, 0.0, 0.005], [1.0, 0.0, 0.005], [2.0, 0.0, 0.005]];
        let after = [
            [0.003, 0.004, 0.005],
            [1.012, 0.0, 0.305],
            [2.0, 0.0, 0.005],
        ];
        let released = WorldPoint::new(0.03, 0.04, 0.2);
        let done = executed(Grasp::Particle(0), Some(released));
        let moved = cloth_moved(&before, &after, &done).expect("equal counts");
        let held = moved.held.expect("a particle was held");
        for (found, expected) in [
            (held.carried_mm, 50.0),
            (held.stayed_mm, 5.0),
            (moved.farthest_mm, 12.0),
            (moved.slid_mm, 3.0),
        ] {
            assert!((found - expected).abs() < 1e-3, "{found} is not {expected}");
        }
        assert!(held.sprang_back && held.went_back);
    }

    /// The particle in the middle is carried by 100 mm, and the cloth slides by 60 mm.
    #[test]
    fn what_slid_was_not_folded() {
        let before = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.02, 0.0, 0.0]];
        let released = WorldPoint::new(0.11, 0.0, 0.2);
        for sign in [1.0, -1.0] {
            for (folded_mm, went_back) in [(0.0, true), (15.0, true), (25.0, false)] {
                let mut after = before.map(|[x, y, z]| [x + 0.06, y, z]);
                after[1][0] += 0.001 * folded_mm;
                let mirrored = |it: [f32; 3]| [sign * it[0], it[1], it[2]];
                let mut done = executed(Grasp::Particle(1), Some(released));
                done.grips[0].released_at = Some(WorldPoint::new(f64::from(sign) * 0.11, 0.0, 0.2));
                let moved = cloth_moved(&before.map(mirrored), &after.map(mirrored), &done);
                let moved = moved.expect("equal counts");
                let held = moved.held.expect("a particle was held");
                assert!((moved.slid_mm - 60.0).abs() < 1e-3, "{moved:?}");
                assert!(
                    (moved.folded_mm - f64::from(folded_mm)).abs() < 1e-3,
                    "{moved:?}"
                );
                assert_eq!(
                    [held.went_back, held.sprang_back],
                    [went_back; 2],
                    "{moved:?}"
                );
            }
        }
    }

    #[test]
    fn what_cannot_be_measured_is_none() {
        let done = executed(Grasp::Held, None);
        let point = [[0.0; 3]];
        assert_eq!(cloth_moved(&[], &[], &done), None);
        assert_eq!(cloth_moved(&point, &[], &done), None);
        assert_eq!(cloth_moved(&point, &[[0.0, f32::NAN, 0.0]], &done), None);
    }

    /// The cloth slides nearly as far as it is carried, so that half of the rest is little.
    #[test]
    fn a_rim_that_was_dragged_is_no_fold() {
        let before = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.02, 0.0, 0.0]];
        let went_back = |carried_mm: f32, slid_mm: f32, other_mm: f32| {
            let mut after = before.map(|[x, y, z]| [x + 0.001 * slid_mm, y, z]);
            after[2][0] -= 0.001 * other_mm;
            let released = WorldPoint::new(0.001 * f64::from(carried_mm), 0.0, 0.2);
            let done = executed(Grasp::Particle(0), Some(released));
            let moved = cloth_moved(&before, &after, &done).expect("equal counts");
            let held = moved.held.expect("a particle was held");
            (held.went_back, held.sprang_back)
        };
        assert_eq!(went_back(60.0, 55.0, 4.0), (true, true));
        // Another particle was folded than the one that was held.
        assert_eq!(went_back(60.0, 55.0, 7.0), (false, true));
        assert_eq!(went_back(5.0, 5.5, 0.9), (true, true));
        assert_eq!(went_back(5.0, 5.5, 1.1), (false, true));
    }

    #[test]
    fn mirrored_folds_of_half_a_cloth_slide_equally_far() {
        let before: Vec<[f32; 3]> = (0..4).map(|i| [0.1 * i as f32, 0.0, 0.0]).collect();
        let done = executed(Grasp::Held, None);
        for folded in [[0, 1], [2, 3]] {
            let mut after = before.clone();
            for i in folded {
                after[i][0] = 0.3 - before[i][0];
            }
            let moved = cloth_moved(&before, &after, &done).expect("equal counts");
            assert!((moved.slid_mm - 50.0).abs() < 1e-3, "{moved:?}");
        }
    }

    #[test]
    fn a_world_that_does_not_tell_the_particle_tells_how_far_the_cloth_moved() {
        let (before, after) = ([[0.0; 3]], [[0.01, 0.0, 0.0]]);
        let moved = cloth_moved(&before, &after, &executed(Grasp::Held, None));
        let moved = moved.expect("equal counts");
        assert_eq!(moved.held, None);
        assert!((moved.farthest_mm - 10.0).abs() < 1e-3);
    }
}

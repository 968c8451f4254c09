//! Unit tests of `metrics::cloth_moved`.

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

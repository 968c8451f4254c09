//! Symmetry: folds of a square that are mirrored or turned end as mirrored or turned cloths.

use super::*;
use crate::square::Symmetry;

const DIM: usize = 40;

/// Folds the corner that is the image of particle 0; returns the cloth, mapped back.
fn folded(symmetry: Symmetry, to: [f32; 2]) -> Vec<[f32; 3]> {
    let mut cloth = flat(DIM, DIM);
    let corner = symmetry.particle(0, DIM);
    assert_eq!(
        fold_corner(&mut cloth, corner, symmetry.apply(to)),
        Some(corner)
    );
    symmetry.undo(&cloth.positions(), DIM)
}

#[test]
fn folds_that_mirror_or_turn_each_other_agree() {
    // Each of the other seven once, with a fold that ends before the middle or beside it.
    for (to, codes) in [
        ([-0.012, 0.012], [1, 2, 4, 7].as_slice()),
        ([0.01, 0.02], &[3, 5, 6]),
    ] {
        let first = folded(Symmetry::ALL[0], to);
        for &code in codes {
            let symmetry = Symmetry::ALL[code];
            let other = folded(symmetry, to);
            let apart = first.iter().zip(&other).map(|(a, b)| distance(*a, *b));
            let mean = apart.sum::<f32>() / (DIM * DIM) as f32;
            // The sweeps run from one corner to the other, and along one side first, so the folds differ, here by up
            // to 0.6 mm. Cloths whose layers interlock differently can be a spacing apart.
            assert!(
                mean < 2e-3,
                "{to:?}, {symmetry:?}: mean difference {mean} m"
            );
        }
    }
}

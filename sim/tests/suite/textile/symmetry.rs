//! Folds of a square that are mirrored or turned by quarters end as mirrored or turned cloths.

use super::*;
use crate::square::Symmetry;
use fab_sim::Mask;

const DIM: usize = 27;

/// Carries the image of `from`, a place in spacings from the middle, to that of `to`; returns the cloth, mapped back to the
/// fold that is not mirrored or turned, after it has come to rest or 1 s.
fn folded(material: &Material, symmetry: Symmetry, [from, to]: [[f32; 2]; 2]) -> Vec<[f32; 3]> {
    let mut cloth = square(DIM, material);
    let [from, to] = [from, to].map(|place| symmetry.apply(place.map(|value| value * SPACING_M)));
    let done = cloth.pick_and_place(from, to, &|| false).unwrap();
    assert!(done.grasped.is_some());
    cloth.settle(100).unwrap();
    symmetry.undo(&cloth.positions(), DIM)
}

/// A cloth whose warp is as its weft does not know front from back or left from right.
///
/// Equal folds are not equal bits, since contacts are solved one after the other. Measured: at most 0.6 mm apart in the mean.
/// Folds near the carry from which friction holds them are no test: there a corner stays or opens by chance.
#[test]
fn folds_that_mirror_or_turn_each_other_agree() {
    let soft = of_length(12.0);
    let middle = (DIM - 1) as f32 / 2.0;
    // A corner that stays, and one that opens.
    let folds = [
        ([[-middle, middle], [6.0, -6.0]], [1, 2, 3]),
        ([[-middle, middle], [-6.0, 6.0]], [2, 4, 6]),
    ];
    for (fold, codes) in folds {
        let first = folded(&soft, Symmetry::ALL[0], fold);
        for code in codes {
            let symmetry = Symmetry::ALL[code];
            let other = folded(&soft, symmetry, fold);
            let apart = first.iter().zip(&other).map(|(a, b)| distance(*a, *b));
            let mean = apart.sum::<f32>() / (DIM * DIM) as f32;
            assert!(
                mean < 0.001,
                "{fold:?}, {symmetry:?}: mean difference {mean} m"
            );
        }
    }
}

/// A cloth with a hole does not know where it lies: around the world's origin, or far from it.
#[test]
fn a_cloth_with_a_hole_moves_alike_wherever_it_lies() {
    let [(_, silk), ..] = materials();
    let grid = Grid::new(16, 12, SPACING_M).unwrap();
    let mask = Mask::from_fn(grid, |ix, iy| {
        !(ix + iy < 3 || (6..9).contains(&ix) && (5..8).contains(&iy))
    })
    .unwrap();
    let ends = [0.0, 0.3].map(|aside| {
        let mut start = grid.flat_positions(&params(&silk));
        for point in &mut start {
            *point = [point[0] + aside, point[1], 0.2];
        }
        let mut cloth = Simulator::from_positions(&mask, &start, &params(&silk)).unwrap();
        cloth.hold(&[15, 31]).unwrap();
        run(&mut cloth, 15);
        let points = cloth.positions().into_iter();
        points
            .map(|[x, y, z]| [x - aside, y, z])
            .collect::<Vec<_>>()
    });
    let there: Vec<usize> = (0..grid.particle_count())
        .filter(|&i| mask.has(i))
        .collect();
    let [here, far] = ends.map(|end| there.iter().map(|&i| end[i]).collect::<Vec<_>>());
    let apart = farthest(&here, &far);
    assert!(apart < 0.0005, "{apart} m");
}

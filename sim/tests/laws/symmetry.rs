//! Symmetry: folds of a square that are mirrored or turned end as mirrored or turned cloths.

use super::*;

const DIM: usize = 40;

/// One of the eight symmetries of the square: mirrored along X or not, then turned by quarters.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    mirror: f32,
    quarters: usize,
}

impl Symmetry {
    fn apply(self, [x, y]: [f32; 2]) -> [f32; 2] {
        (0..self.quarters).fold([self.mirror * x, y], |[x, y], _| [-y, x])
    }

    /// Returns the particle at the position to which `i` is mapped in the flat cloth.
    fn particle(self, i: usize) -> usize {
        let middle = (DIM - 1) as f32 / 2.0;
        let place = [(i % DIM) as f32 - middle, middle - (i / DIM) as f32];
        let [x, y] = self.apply(place);
        (middle - y).round() as usize * DIM + (x + middle).round() as usize
    }
}

/// Folds the corner that is the image of particle 0; returns the cloth, mapped back by particle.
fn folded(symmetry: Symmetry, to: [f32; 2]) -> (Vec<[f32; 2]>, Vec<f32>) {
    let mut cloth = flat(DIM, DIM);
    let corner = symmetry.particle(0);
    assert_eq!(
        fold_corner(&mut cloth, corner, symmetry.apply(to)),
        Some(corner)
    );
    let points = cloth.positions();
    let own = |i: usize| points[symmetry.particle(i)];
    (0..DIM * DIM).map(|i| (xy(own(i)), own(i)[2])).unzip()
}

#[test]
fn folds_that_mirror_or_turn_each_other_agree() {
    // Each of the other seven once, with a fold that ends before the middle or beside it.
    for (to, codes) in [
        ([-0.012, 0.012], [1, 2, 4, 7].as_slice()),
        ([0.01, 0.02], &[3, 5, 6]),
    ] {
        let (first_xy, first_z) = folded(
            Symmetry {
                mirror: 1.0,
                quarters: 0,
            },
            to,
        );
        for &code in codes {
            let symmetry = Symmetry {
                mirror: if code < 4 { 1.0 } else { -1.0 },
                quarters: code % 4,
            };
            let (xy, z) = folded(symmetry, to);
            let apart = |i: usize| {
                let [x, y] = symmetry.apply(first_xy[i]);
                distance([x, y, first_z[i]], [xy[i][0], xy[i][1], z[i]])
            };
            let mean = (0..DIM * DIM).map(apart).sum::<f32>() / (DIM * DIM) as f32;
            // The sweeps run from one corner to the other, and along one side first, so the folds differ, here by up
            // to 0.6 mm. Cloths whose layers interlock differently can be a spacing apart.
            assert!(
                mean < 2e-3,
                "{to:?}, {symmetry:?}: mean difference {mean} m"
            );
        }
    }
}

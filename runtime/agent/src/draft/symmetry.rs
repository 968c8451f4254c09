//! The same folds as seen from the cloth's other sides.

use fab_program::{Cloth, ClothPoint, Fold, Sequence};

/// A symmetry as a map of points: fractions from left to right and from back to front.
type Symmetry = fn([f64; 2]) -> [f64; 2];

/// The symmetries of a rectangle.
const OF_A_RECTANGLE: [Symmetry; 4] = [
    |[right, front]| [right, front],
    |[right, front]| [1.0 - right, front],
    |[right, front]| [right, 1.0 - front],
    |[right, front]| [1.0 - right, 1.0 - front],
];

/// The additional symmetries of a square.
const OF_A_SQUARE: [Symmetry; 4] = [
    |[right, front]| [front, right],
    |[right, front]| [1.0 - front, right],
    |[right, front]| [front, 1.0 - right],
    |[right, front]| [1.0 - front, 1.0 - right],
];

/// Returns a sequence under every symmetry of the cloth, mirrored ones included; the original first.
///
/// Equal sequences are listed once.
pub fn symmetric(folds: &[Fold], cloth: &Cloth) -> Vec<Sequence> {
    let square: &[Symmetry] = match cloth.dimx == cloth.dimy {
        true => &OF_A_SQUARE,
        false => &[],
    };
    let mut sequences: Vec<Sequence> = Vec::new();
    for seen in OF_A_RECTANGLE.iter().chain(square) {
        let point = |point: ClothPoint| match point {
            ClothPoint::Center => point,
            ClothPoint::Particle { right, front } => {
                let [right, front] = seen([right, front]);
                ClothPoint::Particle { right, front }
            }
        };
        let folds = folds.iter().map(|fold| Fold {
            pick: point(fold.pick),
            place: point(fold.place),
            fraction: fold.fraction,
        });
        let sequence = Sequence {
            folds: folds.collect(),
        };
        if !sequences.contains(&sequence) {
            sequences.push(sequence);
        }
    }
    sequences
}

//! The same folds from the cloth's other sides.

use fab_program::{Cloth, ClothPoint, Fold, Sequence};

/// Where a point lies for somebody at another side: fractions from left to right and from back to front.
type Seen = fn([f64; 2]) -> [f64; 2];

/// The ways in which a rectangle looks the same.
const OF_A_RECTANGLE: [Seen; 4] = [
    |[right, front]| [right, front],
    |[right, front]| [1.0 - right, front],
    |[right, front]| [right, 1.0 - front],
    |[right, front]| [1.0 - right, 1.0 - front],
];

/// Those that a square has besides.
const OF_A_SQUARE: [Seen; 4] = [
    |[right, front]| [front, right],
    |[right, front]| [1.0 - front, right],
    |[right, front]| [front, 1.0 - right],
    |[right, front]| [1.0 - front, 1.0 - right],
];

/// Returns a sequence as it is from every side from which the cloth looks the same, mirrored too; itself first.
///
/// Equal sequences are listed once.
pub fn symmetric(folds: &[Fold], cloth: &Cloth) -> Vec<Sequence> {
    let square: &[Seen] = match cloth.dimx == cloth.dimy {
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

//! Estimates the score of an untouched cloth, to warn if it already meets the goal.
//!
//! Each fold is treated as a fold of ideal paper: everything on the picked side of the line midway between pick and
//! place is mirrored at that line. Real cloth drags and overshoots, so the score is only an estimate.

use fab_program::{Cloth, ClothPoint, ClothStart, Fold, Goal, Metric, Sequence};

/// Points along each side of the sheet that stands for the cloth.
const SIDE: usize = 15;

/// The most sequences that are folded; more do not change the estimate much.
const MAX_SEQUENCES: usize = 64;

/// Returns the score of the untouched cloth, metres or a fraction; `None` if it is not known.
pub(super) fn score(goal: &Goal, cloth: &Cloth, experts: &[Sequence]) -> Option<f64> {
    match goal.metric {
        Metric::NormalizedImprovement => Some(0.0),
        Metric::Coverage => (cloth.start == ClothStart::Flat).then_some(1.0),
        Metric::ParticleDistance => experts
            .iter()
            .take(MAX_SEQUENCES)
            .map(|sequence| distance_m(cloth, &sequence.folds))
            .min_by(f64::total_cmp),
    }
}

/// Returns the mean distance between the flat sheet and the folded one, metres.
fn distance_m(cloth: &Cloth, folds: &[Fold]) -> f64 {
    let sides_m = [cloth.dimx, cloth.dimy].map(|count| f64::from(count - 1) * cloth.spacing_m);
    let fraction = |index: usize| index as f64 / (SIDE - 1) as f64;
    let flat: Vec<[f64; 2]> = (0..SIDE * SIDE)
        .map(|index| {
            [
                fraction(index % SIDE) * sides_m[0],
                fraction(index / SIDE) * sides_m[1],
            ]
        })
        .collect();
    let mut folded = flat.clone();
    for fold in folds {
        // Points of the cloth move with the folded sheet; the center belongs to the table.
        let at = |point: &ClothPoint, sheet: &[[f64; 2]]| match point {
            ClothPoint::Center => [sides_m[0] / 2.0, sides_m[1] / 2.0],
            ClothPoint::Particle { right, front } => {
                let index = |part: f64| (part * (SIDE - 1) as f64).round() as usize;
                sheet[index(*front).min(SIDE - 1) * SIDE + index(*right).min(SIDE - 1)]
            }
        };
        let (pick, target) = (at(&fold.pick, &folded), at(&fold.place, &folded));
        let way = [0, 1].map(|axis| fold.fraction * (target[axis] - pick[axis]));
        let length2 = way[0] * way[0] + way[1] * way[1];
        if length2 == 0.0 {
            continue;
        }
        let middle = [0, 1].map(|axis| pick[axis] + way[axis] / 2.0);
        for point in &mut folded {
            let beyond = (point[0] - middle[0]) * way[0] + (point[1] - middle[1]) * way[1];
            if beyond < 0.0 {
                let turn = -2.0 * beyond / length2;
                *point = [0, 1].map(|axis| point[axis] + turn * way[axis]);
            }
        }
    }
    let moved = flat.iter().zip(&folded).map(|(before, after)| {
        let (du, dv) = (before[0] - after[0], before[1] - after[1]);
        (du * du + dv * dv).sqrt()
    });
    moved.sum::<f64>() / flat.len() as f64
}

#[cfg(test)]
mod tests;

//! Measures of a result: distance to another state, and how much of the table the cloth covers.
//!
//! In: particle positions in grid order, world frame, metres. Out: numbers. Coverage is measured twice: [`coverage`] as
//! SoftGym does, for comparison with published numbers, and [`true_coverage`], which does not depend on the cloth's
//! rotation. If the particles are not known, [`seen_coverage`] compares two pictures. [`cloth_moved`] says how far an
//! action moved the cloth. The program defines what counts as success.

mod cloth_moved;
mod grid_coverage;
mod seen_coverage;
mod true_coverage;
mod whole_cloth;

pub use cloth_moved::{ClothMoved, HeldMoved, cloth_moved};
pub use grid_coverage::{coverage, covered_area_m2, flat_area_m2, outlined_coverage};
pub use seen_coverage::seen_coverage;
pub use true_coverage::{true_coverage, true_covered_area_m2};
pub use whole_cloth::{whole_area_m2, whole_triangles};

/// Returns the mean distance between equal particles of two states, metres.
///
/// Index to index, without alignment (protocol, section 6). `None` if the counts differ or there is no particle.
pub fn mean_particle_distance_m(a: &[[f32; 3]], b: &[[f32; 3]]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    let sum: f64 = a.iter().zip(b).map(|(a, b)| distance_m(a, b)).sum();
    Some(sum / a.len() as f64)
}

/// Returns the same once the first state is shifted and turned over the table to where it lies nearest to the second.
///
/// Nearest in the least squares over `x` and `y` (Kabsch 1976), so a cloth that slid as a whole is at its place, and what
/// is left is how differently it is folded. Metres.
pub fn shape_distance_m(a: &[[f32; 3]], b: &[[f32; 3]]) -> Option<f64> {
    if a.len() != b.len() || a.is_empty() {
        return None;
    }
    let middle = |state: &[[f32; 3]]| {
        [0, 1].map(|axis| {
            let along = state.iter().map(|point| f64::from(point[axis]));
            along.sum::<f64>() / state.len() as f64
        })
    };
    let (of_a, of_b) = (middle(a), middle(b));
    let from = |point: &[f32; 3], middle: [f64; 2]| {
        [0, 1].map(|axis| f64::from(point[axis]) - middle[axis])
    };
    let (mut along, mut across) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let ([ax, ay], [bx, by]) = (from(a, of_a), from(b, of_b));
        along += ax * bx + ay * by;
        across += ax * by - ay * bx;
    }
    let length = (along * along + across * across).sqrt();
    // Points that all coincide have no direction, so any turn does.
    let [cos, sin] = match length > 0.0 {
        true => [along / length, across / length],
        false => [1.0, 0.0],
    };
    let laid = a.iter().map(|point| {
        let [x, y] = from(point, of_a);
        let [x, y] = [cos * x - sin * y + of_b[0], sin * x + cos * y + of_b[1]];
        [x as f32, y as f32, point[2]]
    });
    let sum: f64 = laid.zip(b).map(|(a, b)| distance_m(&a, b)).sum();
    Some(sum / a.len() as f64)
}

fn distance_m(a: &[f32; 3], b: &[f32; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Returns which share of the initially missing coverage has been gained: 0 as at the start, 1 when flat.
///
/// - `now`, `at_start`: as [`coverage`] gives them.
///
/// Negative if coverage was lost, above 1 if [`coverage`] is. `None` if nothing was missing but for rounding.
pub fn normalized_improvement(now: f64, at_start: f64) -> Option<f64> {
    let missing = 1.0 - at_start;
    (missing > COVERAGE_ROUNDING).then(|| (now - at_start) / missing)
}

/// The largest error of a flat cloth's coverage; particles have 32 bits.
const COVERAGE_ROUNDING: f64 = 1e-6;

#[cfg(test)]
#[path = "tests/metrics.rs"]
mod tests;

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
/// Negative if coverage was lost, above 1 if [`coverage`] is. `None` if nothing was missing.
pub fn normalized_improvement(now: f64, at_start: f64) -> Option<f64> {
    let missing = 1.0 - at_start;
    (missing > 0.0).then(|| (now - at_start) / missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_state_is_as_far_away_as_it_was_shifted() {
        let a = vec![[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]];
        let b: Vec<_> = a.iter().map(|[x, y, z]| [x + 0.3, y - 0.4, *z]).collect();
        let distance = mean_particle_distance_m(&a, &b).expect("equal counts");
        assert!((distance - 0.5).abs() < 1e-6, "{distance}");
    }

    #[test]
    fn states_of_different_size_have_no_distance() {
        assert_eq!(mean_particle_distance_m(&[[0.0; 3]], &[]), None);
        assert_eq!(mean_particle_distance_m(&[], &[]), None);
    }

    #[test]
    fn improvement_counts_from_the_start_to_the_flat_cloth() {
        assert_eq!(normalized_improvement(0.5, 0.5), Some(0.0));
        assert_eq!(normalized_improvement(0.75, 0.5), Some(0.5));
        assert_eq!(normalized_improvement(0.25, 0.5), Some(-0.5));
        assert_eq!(normalized_improvement(1.0, 0.5), Some(1.0));
        assert_eq!(normalized_improvement(1.0, 1.0), None);
        assert_eq!(normalized_improvement(1.0, 1.05), None);
        assert_eq!(normalized_improvement(1.0, f64::NAN), None);
    }
}

//! Unit tests of `metrics`.

use super::*;

#[test]
fn a_shifted_state_is_as_far_away_as_it_was_shifted() {
    let a = vec![[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]];
    let b: Vec<_> = a.iter().map(|[x, y, z]| [x + 0.3, y - 0.4, *z]).collect();
    let distance = mean_particle_distance_m(&a, &b).expect("equal counts");
    assert!((distance - 0.5).abs() < 1e-6, "{distance}");
}

#[test]
fn a_cloth_that_slid_as_a_whole_has_its_shape_still() {
    let a = [[0.1, 0.0, 0.0], [0.3, 0.1, 0.01], [0.2, 0.4, 0.0]];
    // Turned by the angle whose cosine is 0.6, and shifted.
    let slid = a.map(|[x, y, z]| [0.6 * x - 0.8 * y + 0.5, 0.8 * x + 0.6 * y - 0.2, z]);
    let distance = shape_distance_m(&a, &slid).expect("equal counts");
    assert!(distance < 1e-6, "{distance}");
    // A mirrored cloth, or one that is higher, has another.
    let mirrored = a.map(|[x, y, z]| [x, -y, z]);
    let distance = shape_distance_m(&a, &mirrored).expect("equal counts");
    assert!(distance > 0.05, "{distance}");
    let higher = a.map(|[x, y, z]| [x, y, z + 0.25]);
    let distance = shape_distance_m(&a, &higher).expect("equal counts");
    assert!((distance - 0.25).abs() < 1e-6, "{distance}");
    assert_eq!(
        shape_distance_m(&[[1.0; 3]; 2], &[[0.0, 0.0, 1.0]; 2]),
        Some(0.0)
    );
}

#[test]
fn states_of_different_size_have_no_distance() {
    assert_eq!(shape_distance_m(&[[0.0; 3]], &[]), None);
    assert_eq!(shape_distance_m(&[], &[]), None);
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
    assert_eq!(normalized_improvement(0.5, 1.0 - 4e-8), None);
    assert_eq!(normalized_improvement(1.0, 1.05), None);
    assert_eq!(normalized_improvement(1.0, f64::NAN), None);
}

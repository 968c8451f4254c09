//! Measures of a result.

/// Returns the mean distance between equal particles of two states, metres.
///
/// Index to index, without alignment (protocol, section 6). `None` where the counts differ or there
/// is no particle.
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
}

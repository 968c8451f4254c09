//! Tests of `table.rs`.

use super::*;
use std::collections::BTreeSet;

#[test]
fn the_nearest_of_the_uppermost_layer_is_grasped() {
    let below = [0.0, 0.0, 0.0];
    let above = [
        [0.009, 0.0, 0.0040],
        [0.004, 0.0, 0.0038],
        [0.02, 0.0, 0.01],
    ];
    let cloth = [below, above[0], above[1], above[2]];
    assert_eq!(grasped(&cloth, [0.0, 0.0, 0.002]), Some(2));
    assert_eq!(grasped(&cloth[..1], [0.0, 0.0, 0.002]), Some(0));
    assert_eq!(grasped(&cloth, [0.1, 0.0, 0.0]), None);
}

#[test]
fn a_frame_is_printed_around_the_cloth() {
    let half_diagonal_m = 0.306_25 / 2.0 * 2.0_f64.sqrt();
    for step in 0..1000 {
        let angle = f64::from(step) * 0.006_3;
        let rim = [half_diagonal_m * angle.cos(), half_diagonal_m * angle.sin()];
        assert_eq!(printed_at(rim[0], rim[1]), None);
    }
    let greys: BTreeSet<u8> = (-30..30)
        .filter_map(|square| printed_at(0.36, f64::from(square) * SQUARE_M))
        .collect();
    assert!(greys.len() > 45, "{greys:?}");
}

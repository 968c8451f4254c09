//! Tests of `table.rs`.

use super::*;

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

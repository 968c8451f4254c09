//! Unit tests of `expert`.

use super::*;

#[test]
fn corners_and_edge_middles_are_the_recorded_particles() {
    let grid = Grid {
        dimx: 55,
        dimy: 44,
        spacing_m: 0.00625,
    };
    let index = |right, front| particle_index(grid, right, front);
    assert_eq!(index(0.0, 0.0), 0);
    assert_eq!(index(0.0, 1.0), 55 * 43);
    assert_eq!(index(1.0, 0.0), 54);
    assert_eq!(index(1.0, 1.0), 55 * 44 - 1);
    assert_eq!(index(0.0, 0.5), 21 * 55);
    assert_eq!(index(0.5, 1.0), 55 * 43 + 27);
    assert_eq!(index(1.0, 0.5), 21 * 55 + 54);
}

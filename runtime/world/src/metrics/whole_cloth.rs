//! The triangles of a cloth without holes, for its true coverage.
//!
//! In: a grid. Out: particle indices and an area. The simulator's camera draws the same triangles; they are computed
//! separately here because a measure must not depend on a world's own code.

use crate::start::Grid;

/// Cuts a whole cloth into triangles, two a cell, with diagonals that alternate like a chessboard.
///
/// Returns particle indices, `iy * dimx + ix`.
pub fn whole_triangles(grid: &Grid) -> Vec<[usize; 3]> {
    let (dimx, dimy) = (grid.dimx as usize, grid.dimy as usize);
    let mut triangles = Vec::new();
    for iy in 0..dimy.saturating_sub(1) {
        for ix in 0..dimx.saturating_sub(1) {
            let back_left = iy * dimx + ix;
            let [back_right, front_left] = [back_left + 1, back_left + dimx];
            let front_right = front_left + 1;
            triangles.extend(if (ix + iy) % 2 == 0 {
                [
                    [back_left, front_left, front_right],
                    [back_left, front_right, back_right],
                ]
            } else {
                [
                    [back_left, front_left, back_right],
                    [back_right, front_left, front_right],
                ]
            });
        }
    }
    triangles
}

/// Returns the area of the whole cloth lying flat and unstretched, square metres.
pub fn whole_area_m2(grid: &Grid) -> f64 {
    let side_m = |count: u32| f64::from(count.saturating_sub(1)) * grid.spacing_m;
    side_m(grid.dimx) * side_m(grid.dimy)
}

//! The rectangular grid of particles that a cloth is made of.
//!
//! Index order, used by every array in this crate: `index = iy * dimx + ix`,
//! where `ix` runs along +X and `iy` along -Y, towards the bottom of the
//! folding camera's image, when the cloth lies flat and unrotated.

use crate::params::Params;
use serde::Serialize;

/// Fewest particles along a side.
pub const MIN_DIM: usize = 2;
/// Most particles along a side; 200 x 200 steps about 17 times slower than the 50 x 50 of the recorded data.
pub const MAX_DIM: usize = 200;
/// Smallest distance between neighbours, metres.
pub const MIN_SPACING_M: f32 = 0.001;
/// Largest distance between neighbours, metres.
pub const MAX_SPACING_M: f32 = 0.1;

/// Numbers of particles along the sides, and the distance between neighbours at rest.
///
/// Only [`Grid::new`] builds one, so its numbers are always within bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Grid {
    /// Particles along X.
    pub dimx: usize,
    /// Particles along Y.
    pub dimy: usize,
    /// Rest distance between neighbours along a side, metres.
    pub spacing_m: f32,
}

/// Says why no cloth can have the asked-for grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A side has too few or too many particles.
    #[error("a side of `{0}` particles is outside `{MIN_DIM}` to `{MAX_DIM}`")]
    Dim(usize),
    /// The spacing is not a usable length.
    #[error("a spacing of `{0}` m is outside `{MIN_SPACING_M}` to `{MAX_SPACING_M}` m")]
    Spacing(f32),
}

impl Grid {
    /// Checks the numbers and builds the grid.
    pub fn new(dimx: usize, dimy: usize, spacing_m: f32) -> Result<Grid, GridError> {
        for dim in [dimx, dimy] {
            if !(MIN_DIM..=MAX_DIM).contains(&dim) {
                return Err(GridError::Dim(dim));
            }
        }
        if !(MIN_SPACING_M..=MAX_SPACING_M).contains(&spacing_m) {
            return Err(GridError::Spacing(spacing_m));
        }
        Ok(Grid {
            dimx,
            dimy,
            spacing_m,
        })
    }

    /// Returns the number of particles.
    pub fn particle_count(&self) -> usize {
        self.dimx * self.dimy
    }

    /// Returns the position of every particle of the cloth lying flat, centred on the table, world frame, metres.
    pub fn flat_positions(&self, params: &Params) -> Vec<[f32; 3]> {
        let half_x = (self.dimx - 1) as f32 * 0.5;
        let half_y = (self.dimy - 1) as f32 * 0.5;
        let mut positions = Vec::with_capacity(self.particle_count());
        for iy in 0..self.dimy {
            for ix in 0..self.dimx {
                positions.push([
                    (ix as f32 - half_x) * self.spacing_m,
                    (half_y - iy as f32) * self.spacing_m,
                    params.rest_height_m(),
                ]);
            }
        }
        positions
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn sizes_outside_the_bounds_are_refused_with_their_value() {
        assert_eq!(Grid::new(1, 50, 0.00625), Err(GridError::Dim(1)));
        assert_eq!(Grid::new(50, 201, 0.00625), Err(GridError::Dim(201)));
        assert_eq!(Grid::new(50, 50, 0.5), Err(GridError::Spacing(0.5)));
        assert!(Grid::new(50, 50, f32::NAN).is_err());
        assert!(Grid::new(2, 200, 0.00625).is_ok());
    }

    #[test]
    fn the_second_row_of_a_flat_cloth_lies_towards_the_front() {
        let grid = Grid::new(3, 2, 0.01).unwrap();
        let positions = grid.flat_positions(&Params::default());
        assert_eq!(positions.len(), 6);
        assert_eq!(positions[0], [-0.01, 0.005, 0.005]);
        assert_eq!(positions[5], [0.01, -0.005, 0.005]);
    }
}

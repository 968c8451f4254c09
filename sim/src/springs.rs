//! Springs that keep the cloth's lengths: stretch, shear and bend.
//!
//! In: positions and inverse masses. Out: positions moved towards the rest
//! lengths, in place. The springs follow from the grid, so no list of them
//! exists: each family is a loop over pairs of rows, within which no spring
//! shares a particle with another and the compiler can use SIMD. Springs along
//! rows run on a transposed copy, where they are springs along columns.

use crate::grid::Grid;
use crate::params::Params;
use crate::planes::Planes;
use multiversion::multiversion;

// Added to a squared length so that coincident particles give a zero force, not 0/0; it is far below
// the rounding error of any real spring's squared length.
const TINY_M2: f32 = 1e-20;
// Side of the squares that a matrix is transposed by: four values fill a register of every x86-64.
const TILE: usize = 4;

/// Order in which a sweep visits families and rows; alternating it keeps errors from drifting one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Direction {
    Forward,
    Backward,
}

/// Springs between rows `r` and `r + rows_apart`, from column `lower_column + k` to `upper_column + k`.
#[derive(Clone, Copy, Debug)]
struct Family {
    rows_apart: usize,
    lower_column: usize,
    upper_column: usize,
    rest_m: f32,
    stiffness: f32,
}

/// All springs of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Springs {
    rows: usize,
    columns: usize,
    along_columns: [Family; 2],
    along_diagonals: [Family; 2],
    transposed: Planes,
    transposed_inverse_mass: Vec<f32>,
}

impl Springs {
    /// Lists the families of a grid.
    pub fn new(grid: Grid, params: &Params) -> Springs {
        let straight = |rows_apart: usize, stiffness| Family {
            rows_apart,
            lower_column: 0,
            upper_column: 0,
            rest_m: rows_apart as f32 * grid.spacing_m,
            stiffness,
        };
        let diagonal = |lower_column, upper_column| Family {
            rows_apart: 1,
            lower_column,
            upper_column,
            rest_m: std::f32::consts::SQRT_2 * grid.spacing_m,
            stiffness: params.shear.min(1.0),
        };
        Springs {
            rows: grid.dimy,
            columns: grid.dimx,
            along_columns: [
                straight(1, params.stretch.min(1.0)),
                straight(2, params.bend.min(1.0)),
            ],
            along_diagonals: [diagonal(0, 1), diagonal(1, 0)],
            transposed: Planes::zeros(grid.particle_count()),
            transposed_inverse_mass: vec![1.0; grid.particle_count()],
        }
    }

    /// Notes which particles can move, before any sweep that follows.
    ///
    /// - `inverse_mass`: `[n_particles]`, 1 for a free and 0 for a held particle; at most one is held.
    pub fn set_inverse_mass(&mut self, inverse_mass: &[f32]) {
        transpose(
            inverse_mass,
            &mut self.transposed_inverse_mass,
            self.columns,
        );
    }

    /// Pulls every spring towards its rest length once, row after row (Gauss-Seidel).
    ///
    /// A position-based distance constraint without compliance (Müller et al. 2007): each end moves by
    /// its share of `stiffness * (length - rest)`.
    pub fn sweep(&mut self, positions: &mut Planes, inverse_mass: &[f32], direction: Direction) {
        match direction {
            Direction::Forward => {
                for family in self.along_columns.iter().chain(&self.along_diagonals) {
                    pull(
                        positions,
                        inverse_mass,
                        self.rows,
                        self.columns,
                        family,
                        direction,
                    );
                }
                self.sweep_rows(positions, direction);
            }
            Direction::Backward => {
                self.sweep_rows(positions, direction);
                for family in self.along_columns.iter().chain(&self.along_diagonals).rev() {
                    pull(
                        positions,
                        inverse_mass,
                        self.rows,
                        self.columns,
                        family,
                        direction,
                    );
                }
            }
        }
    }

    fn sweep_rows(&mut self, positions: &mut Planes, direction: Direction) {
        let (rows, columns) = (self.rows, self.columns);
        transpose(&positions.x, &mut self.transposed.x, columns);
        transpose(&positions.y, &mut self.transposed.y, columns);
        transpose(&positions.z, &mut self.transposed.z, columns);
        let weights = &self.transposed_inverse_mass;
        let [stretch, bend] = &self.along_columns;
        let order = match direction {
            Direction::Forward => [stretch, bend],
            Direction::Backward => [bend, stretch],
        };
        for family in order {
            pull(
                &mut self.transposed,
                weights,
                columns,
                rows,
                family,
                direction,
            );
        }
        transpose(&self.transposed.x, &mut positions.x, rows);
        transpose(&self.transposed.y, &mut positions.y, rows);
        transpose(&self.transposed.z, &mut positions.z, rows);
    }
}

/// Writes the matrix `from`, of rows of `columns` values, into `to` with rows and columns exchanged.
#[multiversion(targets("x86_64+avx2"))]
fn transpose(from: &[f32], to: &mut [f32], columns: usize) {
    let rows = from.len() / columns;
    let whole_columns = columns - columns % TILE;
    let bands = from.chunks_exact(TILE * columns);
    let rest = bands.remainder();
    for (band, lines) in bands.enumerate() {
        let row = band * TILE;
        let (l0, lines) = lines.split_at(columns);
        let (l1, lines) = lines.split_at(columns);
        let (l2, l3) = lines.split_at(columns);
        let tiles = l0.chunks_exact(TILE).zip(l1.chunks_exact(TILE)).zip(l2.chunks_exact(TILE)).zip(l3.chunks_exact(TILE));
        for ((((a, b), c), d), target) in tiles.zip(to.chunks_exact_mut(TILE * rows)) {
            for (k, line) in target.chunks_exact_mut(rows).enumerate() {
                line[row..row + TILE].copy_from_slice(&[a[k], b[k], c[k], d[k]]);
            }
        }
        for column in whole_columns..columns {
            to[column * rows + row..][..TILE].copy_from_slice(&[l0[column], l1[column], l2[column], l3[column]]);
        }
    }
    let first = rows - rest.len() / columns;
    for (k, line) in rest.chunks_exact(columns).enumerate() {
        for (target, value) in to.chunks_exact_mut(rows).zip(line) {
            target[first + k] = *value;
        }
    }
}

/// Pulls one family, row pair after row pair.
fn pull(
    positions: &mut Planes,
    inverse_mass: &[f32],
    rows: usize,
    columns: usize,
    family: &Family,
    direction: Direction,
) {
    let pairs = rows.saturating_sub(family.rows_apart);
    for pair in 0..pairs {
        let row = match direction {
            Direction::Forward => pair,
            Direction::Backward => pairs - 1 - pair,
        };
        let lower = row * columns + family.lower_column;
        let upper = (row + family.rows_apart) * columns + family.upper_column;
        let n = columns - family.lower_column.max(family.upper_column);
        let (lower_x, upper_x) = two_rows(&mut positions.x, lower, upper, n);
        let (lower_y, upper_y) = two_rows(&mut positions.y, lower, upper, n);
        let (lower_z, upper_z) = two_rows(&mut positions.z, lower, upper, n);
        pull_row_pair(
            lower_x,
            lower_y,
            lower_z,
            upper_x,
            upper_y,
            upper_z,
            &inverse_mass[lower..lower + n],
            &inverse_mass[upper..upper + n],
            family.rest_m,
            family.stiffness,
        );
    }
}

/// Returns `n` values from `lower` on and `n` from `upper` on; `lower + n <= upper`.
fn two_rows(plane: &mut [f32], lower: usize, upper: usize, n: usize) -> (&mut [f32], &mut [f32]) {
    let (before, after) = plane.split_at_mut(upper);
    (&mut before[lower..lower + n], &mut after[..n])
}

/// Pulls the spring between particles `a[k]` and `b[k]`, for every `k`.
// Separate slices in a function that stays out of line: only so does the compiler know that they do not
// overlap, which is worth a factor of two.
#[allow(clippy::too_many_arguments)]
#[multiversion(targets("x86_64+avx2"))]
fn pull_row_pair(
    ax: &mut [f32],
    ay: &mut [f32],
    az: &mut [f32],
    bx: &mut [f32],
    by: &mut [f32],
    bz: &mut [f32],
    wa: &[f32],
    wb: &[f32],
    rest_m: f32,
    stiffness: f32,
) {
    let n = ax.len();
    let (ay, az) = (&mut ay[..n], &mut az[..n]);
    let (bx, by, bz) = (&mut bx[..n], &mut by[..n], &mut bz[..n]);
    let (wa, wb) = (&wa[..n], &wb[..n]);
    for k in 0..n {
        let dx = bx[k] - ax[k];
        let dy = by[k] - ay[k];
        let dz = bz[k] - az[k];
        let length = (dx * dx + dy * dy + dz * dz + TINY_M2).sqrt();
        let pull = stiffness * (length - rest_m) / (length * (wa[k] + wb[k]));
        let pull_a = wa[k] * pull;
        let pull_b = wb[k] * pull;
        ax[k] += pull_a * dx;
        ay[k] += pull_a * dy;
        az[k] += pull_a * dz;
        bx[k] -= pull_b * dx;
        by[k] -= pull_b * dy;
        bz[k] -= pull_b * dz;
    }
}

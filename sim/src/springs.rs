//! Springs that keep the cloth's lengths: stretch, shear and bend.
//!
//! In: positions and inverse masses. Out: positions moved towards the rest lengths, in place. The springs
//! follow from the grid, so no list of them exists: each family is a loop over pairs of rows, eight springs at
//! a time, none of which share a particle. Springs along rows run on a transposed copy, where they are springs
//! along columns. Springs of padding, and of missing particles, are there like all others, without stiffness.

use crate::layout::{LANES, Layout};
use crate::params::Params;
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// Added to a squared length so that coincident particles give a zero force, not 0/0; it is far below
// the rounding error of any real spring's squared length.
const TINY_M2: f32 = 1e-20;

/// Order in which a sweep visits families and rows; alternating it keeps errors from drifting one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Direction {
    Forward,
    Backward,
}

/// Springs between rows `r` and `r + rows_apart`, from column `lower_column + k` to `upper_column + k`.
#[derive(Clone, Debug)]
struct Family {
    row_pairs: usize,
    rows_apart: usize,
    lower_column: usize,
    upper_column: usize,
    stride: usize,
    rest_m: f32,
    /// Stiffness of each spring of a row pair, whole lanes; one row for all pairs, or one for each.
    stiffness: Vec<f32>,
    /// Distance between the rows of `stiffness`: 0 if one row holds for all.
    stiffness_step: usize,
}

/// All springs of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Springs {
    along_columns: [Family; 2],
    along_diagonals: [Family; 2],
    along_rows: [Family; 2],
    layout: Layout,
    across: Layout,
    transposed: Planes,
    weights: Weights,
    transposed_weights: Weights,
}

/// Inverse masses in one layout, and which rows hold a fixed particle.
#[derive(Clone, Debug)]
struct Weights {
    inverse_mass: Vec<f32>,
    fixed_rows: Vec<bool>,
}

impl Springs {
    /// Lists the families of a cloth.
    pub fn new(layout: &Layout, params: &Params) -> Springs {
        let across = layout.transposed();
        let [stretch, shear, bend] =
            [params.stretch, params.shear, params.bend].map(|s| s.min(1.0));
        let spacing_m = layout.grid().spacing_m;
        let straight = |layout: &Layout, apart: usize, stiffness| {
            let rest_m = apart as f32 * spacing_m;
            Family::new(layout, apart, [0, 0], rest_m, stiffness)
        };
        let diagonal = |columns| {
            Family::new(
                layout,
                1,
                columns,
                std::f32::consts::SQRT_2 * spacing_m,
                shear,
            )
        };
        Springs {
            along_columns: [straight(layout, 1, stretch), straight(layout, 2, bend)],
            along_diagonals: [diagonal([0, 1]), diagonal([1, 0])],
            along_rows: [straight(&across, 1, stretch), straight(&across, 2, bend)],
            transposed: Planes::zeros(across.len()),
            weights: Weights::of(layout, &layout.free()),
            transposed_weights: Weights::of(&across, &across.free()),
            layout: layout.clone(),
            across,
        }
    }

    /// Returns the number of springs that a sweep pulls.
    pub fn count(&self) -> usize {
        let families = [&self.along_columns, &self.along_diagonals, &self.along_rows];
        families.into_iter().flatten().map(Family::count).sum()
    }

    /// Notes which particles can move, before any sweep that follows.
    ///
    /// - `inverse_mass`: by slot of the layout, 1 for a free and 0 for a held particle.
    pub fn set_inverse_mass(&mut self, inverse_mass: &[f32]) {
        let mut transposed = vec![0.0; self.across.len()];
        self.layout.transpose(inverse_mass, &mut transposed);
        self.weights = Weights::of(&self.layout, inverse_mass);
        self.transposed_weights = Weights::of(&self.across, &transposed);
    }

    /// Pulls every spring towards its rest length once, row after row (Gauss-Seidel).
    ///
    /// A position-based distance constraint without compliance (Müller et al. 2007): each end moves by
    /// its share of `stiffness * (length - rest)`.
    pub fn sweep(&mut self, positions: &mut Planes, direction: Direction) {
        match direction {
            Direction::Forward => {
                for family in self.along_columns.iter().chain(&self.along_diagonals) {
                    family.pull(positions, &self.weights, direction);
                }
                self.sweep_rows(positions, direction);
            }
            Direction::Backward => {
                self.sweep_rows(positions, direction);
                for family in self.along_columns.iter().chain(&self.along_diagonals).rev() {
                    family.pull(positions, &self.weights, direction);
                }
            }
        }
    }

    fn sweep_rows(&mut self, positions: &mut Planes, direction: Direction) {
        let (layout, across) = (&self.layout, &self.across);
        layout.transpose(&positions.x, &mut self.transposed.x);
        layout.transpose(&positions.y, &mut self.transposed.y);
        layout.transpose(&positions.z, &mut self.transposed.z);
        let [stretch, bend] = &self.along_rows;
        let order = match direction {
            Direction::Forward => [stretch, bend],
            Direction::Backward => [bend, stretch],
        };
        for family in order {
            family.pull(&mut self.transposed, &self.transposed_weights, direction);
        }
        across.transpose(&self.transposed.x, &mut positions.x);
        across.transpose(&self.transposed.y, &mut positions.y);
        across.transpose(&self.transposed.z, &mut positions.z);
    }
}

impl Weights {
    fn of(layout: &Layout, inverse_mass: &[f32]) -> Weights {
        let is_fixed = |row: usize| {
            let slots = layout.row(row);
            let mut present = slots.clone().zip(&inverse_mass[slots]);
            present.any(|(slot, &mass)| mass == 0.0 && layout.is_present(slot))
        };
        Weights {
            inverse_mass: inverse_mass.to_vec(),
            fixed_rows: (0..layout.rows()).map(is_fixed).collect(),
        }
    }
}

impl Family {
    fn new(
        layout: &Layout,
        rows_apart: usize,
        [lower_column, upper_column]: [usize; 2],
        rest_m: f32,
        stiffness: f32,
    ) -> Family {
        let springs = layout.columns() - lower_column.max(upper_column);
        let lanes = springs.next_multiple_of(LANES);
        let row_pairs = layout.rows().saturating_sub(rows_apart);
        let rows = if layout.is_full() {
            row_pairs.min(1)
        } else {
            row_pairs
        };
        let mut all = vec![0.0; rows * lanes];
        for row in 0..rows {
            for k in 0..springs {
                let lower = layout.row(row).start + lower_column + k;
                let upper = layout.row(row + rows_apart).start + upper_column + k;
                if layout.is_present(lower) && layout.is_present(upper) {
                    all[row * lanes + k] = stiffness;
                }
            }
        }
        Family {
            row_pairs,
            rows_apart,
            lower_column,
            upper_column,
            stride: layout.stride(),
            rest_m,
            stiffness: all,
            stiffness_step: if layout.is_full() { 0 } else { lanes },
        }
    }

    fn count(&self) -> usize {
        let listed = self
            .stiffness
            .iter()
            .filter(|&&stiffness| stiffness > 0.0)
            .count();
        match self.stiffness_step {
            0 => listed * self.row_pairs,
            _ => listed,
        }
    }

    fn pull(&self, positions: &mut Planes, weights: &Weights, direction: Direction) {
        let Planes { x, y, z } = positions;
        pull_rows(x, y, z, weights, self, direction);
    }
}

/// Pulls one family, row pair after row pair.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn pull_rows(
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    weights: &Weights,
    family: &Family,
    direction: Direction,
) {
    let lanes = match family.stiffness_step {
        0 => family.stiffness.len(),
        step => step,
    };
    for pair in 0..family.row_pairs {
        let row = match direction {
            Direction::Forward => pair,
            Direction::Backward => family.row_pairs - 1 - pair,
        };
        let lower = row * family.stride + family.lower_column;
        let upper = (row + family.rows_apart) * family.stride + family.upper_column;
        let (ax, bx) = two_rows(x, lower, upper, lanes);
        let (ay, by) = two_rows(y, lower, upper, lanes);
        let (az, bz) = two_rows(z, lower, upper, lanes);
        let from = row * family.stiffness_step;
        let stiffness = family.stiffness[from..from + lanes].chunks_exact(LANES);
        let a_blocks = blocks(ax).zip(blocks(ay)).zip(blocks(az));
        let b_blocks = blocks(bx).zip(blocks(by)).zip(blocks(bz));
        let ends = a_blocks.zip(b_blocks).zip(stiffness);
        if weights.fixed_rows[row] | weights.fixed_rows[row + family.rows_apart] {
            let wa = weights.inverse_mass[lower..lower + lanes].chunks_exact(LANES);
            let wb = weights.inverse_mass[upper..upper + lanes].chunks_exact(LANES);
            for (((((ax, ay), az), ((bx, by), bz)), stiffness), (wa, wb)) in ends.zip(wa.zip(wb)) {
                let share = |k: usize| {
                    let weight = wa[k] + wb[k];
                    let share = 1.0 / if weight > 0.5 { weight } else { 1.0 };
                    (wa[k] * share, wb[k] * share)
                };
                pull_lanes([ax, ay, az], [bx, by, bz], stiffness, share, family.rest_m);
            }
        } else {
            for ((((ax, ay), az), ((bx, by), bz)), stiffness) in ends {
                pull_lanes(
                    [ax, ay, az],
                    [bx, by, bz],
                    stiffness,
                    |_| (0.5, 0.5),
                    family.rest_m,
                );
            }
        }
    }
}

/// Returns `n` values from `lower` on and `n` from `upper` on; `lower + n <= upper`.
#[inline(always)]
fn two_rows(plane: &mut [f32], lower: usize, upper: usize, n: usize) -> (&mut [f32], &mut [f32]) {
    let (before, after) = plane.split_at_mut(upper);
    (&mut before[lower..lower + n], &mut after[..n])
}

#[inline(always)]
fn blocks(row: &mut [f32]) -> std::slice::ChunksExactMut<'_, f32> {
    row.chunks_exact_mut(LANES)
}

/// Pulls the springs between equal lanes of `a` and `b`.
///
/// - `share`: what of a correction each of the two ends makes, by lane.
#[inline(always)]
fn pull_lanes(
    [ax, ay, az]: [&mut [f32]; 3],
    [bx, by, bz]: [&mut [f32]; 3],
    stiffness: &[f32],
    share: impl Fn(usize) -> (f32, f32),
    rest_m: f32,
) {
    let (mut x, mut y, mut z) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [[0.0; LANES]; 2]);
    for k in 0..LANES {
        let (dx, dy, dz) = (bx[k] - ax[k], by[k] - ay[k], bz[k] - az[k]);
        let length = (dx * dx + dy * dy + dz * dz + TINY_M2).sqrt();
        let pull = stiffness[k] * (1.0 - rest_m / length);
        let (share_a, share_b) = share(k);
        let (pull_a, pull_b) = (share_a * pull, share_b * pull);
        x[0][k] = ax[k] + pull_a * dx;
        y[0][k] = ay[k] + pull_a * dy;
        z[0][k] = az[k] + pull_a * dz;
        x[1][k] = bx[k] - pull_b * dx;
        y[1][k] = by[k] - pull_b * dy;
        z[1][k] = bz[k] - pull_b * dz;
    }
    ax.copy_from_slice(&x[0]);
    ay.copy_from_slice(&y[0]);
    az.copy_from_slice(&z[0]);
    bx.copy_from_slice(&x[1]);
    by.copy_from_slice(&y[1]);
    bz.copy_from_slice(&z[1]);
}

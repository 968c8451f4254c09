//! Springs that keep the cloth's lengths: stretch, shear and bend.
//!
//! In: positions and inverse masses. Out: positions moved towards the rest lengths, in place. The springs
//! follow from the grid, so no list of them exists: each family is a loop over slots and those a row, or so, away,
//! eight springs at a time, none of which share a particle. Springs along rows run by columns (see `sides`), where
//! they are like springs along columns. Springs of missing particles, and from the end of a row to the beginning of the next,
//! are there like all others, without stiffness.

use crate::layout::{LANES, Layout};
use crate::params::Params;
use crate::planes::Planes;
use crate::sides::{Side, Sides};
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// Added to a squared length so that coincident particles give a zero force, not 0/0; it is far below
// the rounding error of any real spring's squared length.
const TINY_M2: f32 = 1e-20;

/// Order in which a sweep visits families and rows; alternating it keeps errors from drifting one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Direction {
    /// From positions that are current by rows to such that are current by columns.
    Forward,
    /// From positions that are current by columns to such that are current by rows.
    Backward,
}

/// Springs from slots `lower + k` to slots `upper + k`, in the order of `k`.
///
/// They are pulled in runs that are short enough for the two ends of a run to have no slot in common.
#[derive(Clone, Debug)]
struct Family {
    lower: usize,
    upper: usize,
    /// Springs of a run, whole lanes.
    run: usize,
    /// Whole runs; what is left over follows them.
    runs: usize,
    rest_m: f32,
    /// Half the stiffness of spring `k` is `halves[k % period]`, for whole runs from any `k` below the period on.
    halves: Vec<f32>,
    period: usize,
    /// Half the stiffness of the springs after the last whole run, filled up to whole lanes.
    tail: Vec<f32>,
    /// By run, and for the tail: whether an end is a fixed particle.
    fixed: Vec<bool>,
    count: usize,
}

/// All springs of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Springs {
    along_columns: [Family; 2],
    along_diagonals: [Family; 2],
    along_rows: [Family; 2],
}

impl Springs {
    /// Lists the families of a cloth that is laid out by rows.
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
        }
    }

    /// Returns the number of springs that a sweep pulls.
    pub fn count(&self) -> usize {
        let families = [&self.along_columns, &self.along_diagonals, &self.along_rows];
        families
            .into_iter()
            .flatten()
            .map(|family| family.count)
            .sum()
    }

    /// Notes which particles are fixed, before any sweep that follows.
    pub fn note_fixed(&mut self, sides: &Sides) {
        let families = self.along_columns.iter_mut();
        for family in families.chain(&mut self.along_diagonals) {
            family.note_fixed(&sides.rows);
        }
        for family in &mut self.along_rows {
            family.note_fixed(&sides.columns);
        }
    }

    /// Pulls every spring towards its rest length once, row after row (Gauss-Seidel).
    ///
    /// A position-based distance constraint without compliance (Müller et al. 2007): each end moves by
    /// its share of `stiffness * (length - rest)`. The [`Direction`] tells on which side positions have to be
    /// current before, and are after.
    pub fn sweep(&self, sides: &mut Sides, direction: Direction) {
        match direction {
            Direction::Forward => {
                for family in self.along_columns.iter().chain(&self.along_diagonals) {
                    family.pull(&mut sides.rows, direction);
                }
                sides.turn_to_columns();
                for family in &self.along_rows {
                    family.pull(&mut sides.columns, direction);
                }
            }
            Direction::Backward => {
                for family in self.along_rows.iter().rev() {
                    family.pull(&mut sides.columns, direction);
                }
                sides.turn_to_rows();
                for family in self.along_columns.iter().chain(&self.along_diagonals).rev() {
                    family.pull(&mut sides.rows, direction);
                }
            }
        }
    }
}

impl Family {
    fn new(
        layout: &Layout,
        rows_apart: usize,
        [lower, upper_column]: [usize; 2],
        rest_m: f32,
        stiffness: f32,
    ) -> Family {
        let stride = layout.stride();
        let upper = rows_apart * stride + upper_column;
        let springs = layout.rows().saturating_sub(rows_apart) * stride;
        // Springs from the end of one row to the beginning of another have no stiffness.
        let is_there = |k: usize| {
            let columns = [(lower + k) % stride, (upper + k) % stride];
            columns[0] + upper_column == columns[1] + lower
                && layout.is_present(lower + k)
                && layout.is_present(upper + k)
        };
        let all: Vec<f32> = (0..springs)
            .map(|k| if is_there(k) { 0.5 * stiffness } else { 0.0 })
            .collect();
        let run = (upper - lower) / LANES * LANES;
        let runs = springs / run;
        let mut tail = all[runs * run..].to_vec();
        tail.resize(tail.len().next_multiple_of(LANES), 0.0);
        let count = all.iter().filter(|&&half| half > 0.0).count();
        // All rows of a cloth without holes are alike.
        let period = if layout.is_full() { stride } else { springs };
        let halves = all.iter().copied().cycle();
        Family {
            lower,
            upper,
            run,
            runs,
            rest_m,
            halves: match springs {
                0 => Vec::new(),
                _ => halves.take(period + run).collect(),
            },
            period,
            tail,
            fixed: vec![false; runs + 1],
            count,
        }
    }

    /// Returns half the stiffness of the springs of a run; of the tail, if it is the run after all.
    #[inline(always)]
    fn halves(&self, run: usize) -> &[f32] {
        if run == self.runs {
            return &self.tail;
        }
        let start = run * self.run % self.period;
        &self.halves[start..start + self.run]
    }

    fn note_fixed(&mut self, side: &Side) {
        let is_fixed = |run: usize| {
            let springs = run * self.run..;
            let mut springs = springs.zip(self.halves(run));
            springs.any(|(k, &half)| {
                let ends = [self.lower + k, self.upper + k];
                half > 0.0 && ends.map(|slot| side.inverse_mass[slot]).contains(&0.0)
            })
        };
        self.fixed = (0..=self.runs).map(is_fixed).collect();
    }

    fn pull(&self, side: &mut Side, direction: Direction) {
        let Planes { x, y, z } = &mut side.positions;
        pull_runs(x, y, z, &side.inverse_mass, self, direction);
    }
}

/// Pulls one family, run after run.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn pull_runs(
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    inverse_mass: &[f32],
    family: &Family,
    direction: Direction,
) {
    for index in 0..=family.runs {
        let index = match direction {
            Direction::Forward => index,
            Direction::Backward => family.runs - index,
        };
        let from = index * family.run;
        let halves = family.halves(index);
        let n = halves.len();
        let (lower, upper) = (family.lower + from, family.upper + from);
        let (ax, bx) = two_runs(x, lower, upper, n);
        let (ay, by) = two_runs(y, lower, upper, n);
        let (az, bz) = two_runs(z, lower, upper, n);
        let a_blocks = blocks(ax).zip(blocks(ay)).zip(blocks(az));
        let b_blocks = blocks(bx).zip(blocks(by)).zip(blocks(bz));
        let ends = a_blocks.zip(b_blocks).zip(halves.as_chunks().0);
        if family.fixed[index] {
            let wa = inverse_mass[lower..lower + n].as_chunks::<LANES>().0;
            let wb = inverse_mass[upper..upper + n].as_chunks::<LANES>().0;
            for (((((ax, ay), az), ((bx, by), bz)), halves), (wa, wb)) in
                ends.zip(wa.iter().zip(wb))
            {
                let shares = |k: usize| {
                    let weight = wa[k] + wb[k];
                    let share = 2.0 / if weight > 0.5 { weight } else { 1.0 };
                    (wa[k] * share, wb[k] * share)
                };
                pull_lanes([ax, ay, az], [bx, by, bz], halves, shares, family.rest_m);
            }
        } else {
            for ((((ax, ay), az), ((bx, by), bz)), halves) in ends {
                let shares = |_| (1.0, 1.0);
                pull_lanes([ax, ay, az], [bx, by, bz], halves, shares, family.rest_m);
            }
        }
    }
}

/// Returns `n` values from `lower` on and `n` from `upper` on; `lower + n <= upper`.
#[inline(always)]
fn two_runs(plane: &mut [f32], lower: usize, upper: usize, n: usize) -> (&mut [f32], &mut [f32]) {
    let (before, after) = plane.split_at_mut(upper);
    (&mut before[lower..lower + n], &mut after[..n])
}

#[inline(always)]
fn blocks(run: &mut [f32]) -> std::slice::IterMut<'_, [f32; LANES]> {
    run.as_chunks_mut().0.iter_mut()
}

/// Pulls the springs between equal lanes of `a` and `b`.
///
/// - `halves`: half the stiffness.
/// - `shares`: what the two ends make of a correction, by lane; 1 is half of it.
#[inline(always)]
fn pull_lanes(
    [ax, ay, az]: [&mut [f32; LANES]; 3],
    [bx, by, bz]: [&mut [f32; LANES]; 3],
    halves: &[f32; LANES],
    shares: impl Fn(usize) -> (f32, f32),
    rest_m: f32,
) {
    let (mut x, mut y, mut z) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2], [[0.0; LANES]; 2]);
    for k in 0..LANES {
        let (dx, dy, dz) = (bx[k] - ax[k], by[k] - ay[k], bz[k] - az[k]);
        let length = (dx * dx + dy * dy + dz * dz + TINY_M2).sqrt();
        let pull = halves[k] * (1.0 - rest_m / length);
        let (share_a, share_b) = shares(k);
        let (pull_a, pull_b) = (share_a * pull, share_b * pull);
        x[0][k] = ax[k] + pull_a * dx;
        y[0][k] = ay[k] + pull_a * dy;
        z[0][k] = az[k] + pull_a * dz;
        x[1][k] = bx[k] - pull_b * dx;
        y[1][k] = by[k] - pull_b * dy;
        z[1][k] = bz[k] - pull_b * dz;
    }
    ([*ax, *bx], [*ay, *by], [*az, *bz]) = (x, y, z);
}

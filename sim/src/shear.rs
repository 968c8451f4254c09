//! Resistance of cells to shear: springs along both diagonals, solved by whole lines.
//!
//! In: positions and inverse masses by rows. Out: positions moved. The diagonals of one direction that follow each other
//! are a chain, which is solved as a whole, as threads are (`lines`), so a stiff one needs no shorter substep, up to
//! `MOST_SHEAR`. Both directions are solved at the same positions, and a particle that both pull at gives half of its mass
//! to each (Tonge and others 2012), so none comes before the other. (Sweeps in the order of the grid carry what is left over
//! along it: folds from the back slide open where those from the front hold.)
//!
//! A cell that is sheared has one longer diagonal, and one that bends along a diagonal has none: what is longer than at rest
//! tells both apart, so only that is resisted by the declared rigidity. Where the mean of both is short by [`SLACK`], the
//! cell folds up, which a weaker spring resists. Cells with a missing corner have neither.

use crate::layout::{LANES, Layout};
use crate::lines::{blocks, blocks_mut, two_rows};
use crate::material::MOST_SHEAR;
use crate::planes::Planes;
use crate::sides::Side;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// Share of the spacing by which the diagonals of a cell may be too short in the mean.
const SLACK: f32 = 0.02;
// The longer diagonal pulls along itself, and the threads that hold against it turn with the shear, so it must pull more than the
// angle says, up to this many times what it is too long by. One of a cell that is sheared by 0.45 has it; one of a cell that bends
// is hardly longer.
const SHEARED: f32 = 1.5;
// Stiffness of a cell that folds up, times the square of the longest substep.
const FOLDED: f32 = 3.3;
const TINY_M2: f32 = 1e-20;

// Takes rows of values as so many blocks of lanes each, so that the compiler knows that all loops end with them.
macro_rules! known_lanes {
    (blocks, $n:expr; $($row:ident)*) => {
        $(let $row = &blocks($row)[..$n];)*
    };
    (blocks_mut, $n:expr; $($row:ident)*) => {
        $(let $row = &mut blocks_mut($row)[..$n];)*
    };
}

/// The diagonals of one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Shear {
    stride: usize,
    rows: usize,
    rest_m: f32,
    slack_m: f32,
    /// Acceleration per length error of a diagonal that is too long, and of one of a cell that folds up, 1/s^2.
    stiffness: [f32; 2],
    /// From a cell's first corner to the one that is right of it in the next row, and from the one right of it to the next row's.
    chains: [Chains; 2],
    /// By slot: inverse mass times the number of directions that pull at the particle.
    split: Vec<f32>,
}

/// The diagonals of one direction, by cell.
///
/// Rows of cells have room for [`LANES`] on both sides, and begin with one of none.
#[derive(Clone, Debug)]
struct Chains {
    /// 1 where the diagonal is there.
    there: Vec<f32>,
    /// Directions; when all are solved, what each diagonal moves its first end by.
    way: Planes,
    /// What each diagonal is too long by, as far as that is resisted.
    excess: Vec<f32>,
    /// Coupling of a diagonal to the one before, divided by the pivot of that one.
    ratio: Vec<f32>,
    /// Inverse pivots.
    pivot: Vec<f32>,
    pull: Vec<f32>,
}

impl Chains {
    fn new(there: Vec<f32>) -> Chains {
        let n = there.len();
        Chains {
            there,
            way: Planes::zeros(n),
            excess: vec![0.0; n],
            ratio: vec![0.0; n],
            pivot: vec![1.0; n],
            pull: vec![0.0; n],
        }
    }

    /// Returns where the diagonals of a row of cells are there, and the rows of directions and of excess.
    fn measured(&mut self, own: usize, s: usize) -> (&[f32], [&mut [f32]; 4]) {
        let Planes { x, y, z } = &mut self.way;
        let to = [x, y, z, &mut self.excess];
        (
            &self.there[own..own + s],
            to.map(|plane| &mut plane[own..own + s]),
        )
    }

    /// Eliminates the diagonals before from one row of cells.
    ///
    /// - `ends`: inverse masses of both ends.
    /// - `places`: those of the diagonals before, and of these.
    #[inline(always)]
    fn eliminate(&mut self, ends: [&[f32]; 2], [old, own]: [usize; 2], compliances: [f32; 2]) {
        let s = ends[0].len();
        let Planes { x, y, z } = &self.way;
        let ways = [x, y, z].map(|way| [&way[old..old + s], &way[own..own + s]]);
        let excess = [&self.excess[old..old + s], &self.excess[own..own + s]];
        let (old_pivot, pivot) = two_rows(&mut self.pivot, [old, own], s);
        let (old_pull, pull) = two_rows(&mut self.pull, [old, own], s);
        let ratio = &mut self.ratio[own..own + s];
        eliminate(
            ends,
            ways,
            excess,
            [old_pivot, old_pull],
            [pivot, pull, ratio],
            compliances,
        );
    }

    /// Corrects the pulls of one row of cells by those of the next, and makes of directions what they move the first ends by.
    #[inline(always)]
    fn substitute(&mut self, own: usize, next: usize, s: usize) {
        let (pull, after) = two_rows(&mut self.pull, [own, next], s);
        let ratio = &self.ratio[next..next + s];
        let Planes { x, y, z } = &mut self.way;
        let ways = [x, y, z].map(|way| &mut way[own..own + s]);
        substitute(pull, after, ratio, ways);
    }
}

impl Shear {
    /// Lists the diagonals of a cloth whose rows are whole lanes.
    ///
    /// - `stiffness`: acceleration per length error of both diagonals, 1/s^2.
    /// - `slow_secs`: the longest substep.
    pub fn new(layout: &Layout, stiffness: f32, slow_secs: f32) -> Shear {
        let (n, stride, rows) = (layout.len(), layout.stride(), layout.rows());
        let present = |slot: usize| slot < n && layout.is_present(slot);
        let mut there = vec![0.0; wide(stride) * (rows + 1)];
        for slot in layout.slots().iter().map(|&slot| slot as usize) {
            let is_cell = slot % stride + 1 < layout.grid().dimx;
            if is_cell
                && [1, stride, stride + 1]
                    .iter()
                    .all(|ahead| present(slot + ahead))
            {
                there[cell(stride, slot / stride) + slot % stride] = 1.0;
            }
        }
        let chains = [there.clone(), there].map(Chains::new);
        let per_2 = 1.0 / (slow_secs * slow_secs);
        // The longer diagonal resists for both.
        let taut = 2.0 * stiffness.min(MOST_SHEAR * per_2);
        Shear {
            stride,
            rows,
            rest_m: std::f32::consts::SQRT_2 * layout.grid().spacing_m,
            slack_m: SLACK * layout.grid().spacing_m,
            stiffness: [taut, taut.min(FOLDED * per_2)],
            chains,
            split: vec![0.0; n],
        }
    }

    /// Returns the number of diagonals.
    pub fn count(&self) -> usize {
        let there = self.chains.iter().flat_map(|chains| &chains.there);
        there.filter(|&&there| there > 0.0).count()
    }

    /// Moves particles towards the lengths of their diagonals.
    ///
    /// - `dt`: the substep, seconds.
    pub fn solve(&mut self, side: &mut Side, dt: f32) {
        let compliances = self.stiffness.map(|stiffness| 1.0 / (stiffness * dt * dt));
        let Planes { x, y, z } = &mut side.positions;
        solve_chains(self, [x, y, z], &side.inverse_mass, compliances);
    }
}

/// Returns the places from one row of cells to the next.
fn wide(stride: usize) -> usize {
    stride + 2 * LANES
}

/// Returns the place of the first cell of a row.
fn cell(stride: usize, row: usize) -> usize {
    (row + 1) * wide(stride) + LANES
}

#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn solve_chains(
    shear: &mut Shear,
    [x, y, z]: [&mut [f32]; 3],
    weights: &[f32],
    compliances: [f32; 2],
) {
    let (s, rows) = (shear.stride, shear.rows);
    let wide = wide(s);
    let [down, up] = &mut shear.chains;
    // Row by row, so that what one pass writes is at hand for the next.
    for row in 0..rows {
        let own = cell(s, row);
        if row + 1 < rows {
            let corners = [0, s + 1, 1, s].map(|ahead| {
                let from = row * s + ahead;
                [&x[from..from + s], &y[from..from + s], &z[from..from + s]]
            });
            let rest = [shear.rest_m, shear.slack_m];
            measure(corners, down.measured(own, s), up.measured(own, s), rest);
        }
        let pulls = [
            &down.excess[own..][..s],
            &down.excess[own - wide - 1..][..s],
            &up.excess[own - 1..][..s],
            &up.excess[own - wide..][..s],
        ];
        let slots = row * s..row * s + s;
        split(pulls, &weights[slots.clone()], &mut shear.split[slots]);
        if row > 0 {
            let (above, split) = (own - wide, &shear.split[row * s - s..]);
            let [a, right, below, across] = [0, 1, s, s + 1].map(|ahead| &split[ahead..][..s]);
            down.eliminate([a, across], [above - wide - 1, above], compliances);
            up.eliminate([right, below], [above - wide + 1, above], compliances);
        }
    }
    for row in (0..rows - 1).rev() {
        let (own, next) = (cell(s, row), cell(s, row) + wide);
        down.substitute(own, next + 1, s);
        up.substitute(own, next - 1, s);
        // Of the particles below the cells, whose other diagonals are known.
        gather_row(down, up, row + 1, s, weights, [&mut *x, &mut *y, &mut *z]);
    }
    gather_row(down, up, 0, s, weights, [x, y, z]);
}

/// Writes the directions of a row of cells' diagonals, and what is resisted of their lengths.
///
/// - `corners`: both ends of one diagonal, and both of the other.
#[inline(always)]
fn measure(
    corners: [[&[f32]; 3]; 4],
    (down, [dx, dy, dz, d]): (&[f32], [&mut [f32]; 4]),
    (up, [ux, uy, uz, u]): (&[f32], [&mut [f32]; 4]),
    [rest_m, slack_m]: [f32; 2],
) {
    let n = d.len() / LANES;
    let [[ax, ay, az], [bx, by, bz], [cx, cy, cz], [ex, ey, ez]] = corners;
    known_lanes!(blocks, n; ax ay az bx by bz cx cy cz ex ey ez down up);
    known_lanes!(blocks_mut, n; dx dy dz d ux uy uz u);
    for i in 0..n {
        let mut new = [[0.0; LANES]; 8];
        for k in 0..LANES {
            let (x, y, z) = (
                bx[i][k] - ax[i][k],
                by[i][k] - ay[i][k],
                bz[i][k] - az[i][k],
            );
            let (other_x, other_y, other_z) = (
                ex[i][k] - cx[i][k],
                ey[i][k] - cy[i][k],
                ez[i][k] - cz[i][k],
            );
            let length = (x * x + y * y + z * z + TINY_M2).sqrt();
            let other_length =
                (other_x * other_x + other_y * other_y + other_z * other_z + TINY_M2).sqrt();
            let (per, other_per) = (1.0 / length, 1.0 / other_length);
            let (longer, other_longer) = (length - rest_m, other_length - rest_m);
            let both = 0.5 * (longer + other_longer);
            let beyond = both + slack_m;
            let short = if beyond < 0.0 { beyond } else { 0.0 };
            // From where only the other is short, to where both are, to where only this one is.
            let share = longer / if both < -TINY_M2 { both } else { -TINY_M2 };
            let share = if share < 2.0 { share } else { 2.0 };
            let share = if share > 0.0 { share } else { 0.0 };
            let differ = 0.5 * (longer - other_longer);
            let taut = differ * rest_m * other_per;
            let most = SHEARED * longer;
            let taut = if taut < most { taut } else { most };
            let taut = if taut > 0.0 { taut } else { 0.0 };
            let other_taut = -differ * rest_m * per;
            let most = SHEARED * other_longer;
            let other_taut = if other_taut < most { other_taut } else { most };
            let other_taut = if other_taut > 0.0 { other_taut } else { 0.0 };
            new[0][k] = per * x;
            new[1][k] = per * y;
            new[2][k] = per * z;
            new[3][k] = down[i][k] * (taut + short * share);
            new[4][k] = other_per * other_x;
            new[5][k] = other_per * other_y;
            new[6][k] = other_per * other_z;
            new[7][k] = up[i][k] * (other_taut + short * (2.0 - share));
        }
        [dx[i], dy[i], dz[i], d[i], ux[i], uy[i], uz[i], u[i]] = new;
    }
}

/// Writes the inverse masses of a row of particles for each of the directions that pull at them.
///
/// - `pulls`: what is resisted of the diagonals that begin and end at each particle, of both directions.
#[inline(always)]
fn split(pulls: [&[f32]; 4], weights: &[f32], to: &mut [f32]) {
    let n = to.len() / LANES;
    let [d, ended, u, up_ended] = pulls;
    known_lanes!(blocks, n; d ended u up_ended weights);
    known_lanes!(blocks_mut, n; to);
    for i in 0..n {
        let mut new = [0.0; LANES];
        for k in 0..LANES {
            // Both are above 0 only where both directions pull.
            let (one, other) = (
                d[i][k].abs() + ended[i][k].abs(),
                u[i][k].abs() + up_ended[i][k].abs(),
            );
            let least = if one < other { one } else { other };
            let directions = if least > 0.0 { 2.0 } else { 1.0 };
            new[k] = directions * weights[i][k];
        }
        to[i] = new;
    }
}

/// Eliminates the diagonals before from one row of cells.
///
/// - `ends`: inverse masses of both ends; `ways`, `excess`: of the diagonal before, and of this one.
#[inline(always)]
fn eliminate(
    ends: [&[f32]; 2],
    ways: [[&[f32]; 2]; 3],
    excess: [&[f32]; 2],
    old: [&[f32]; 2],
    new: [&mut [f32]; 3],
    [taut, folded]: [f32; 2],
) {
    let n = ends[0].len() / LANES;
    let ([wa, wb], [[x0, x], [y0, y], [z0, z]]) = (ends, ways);
    let ([before, excess], [old_pivot, old_pull]) = (excess, old);
    let [pivot, pull, ratio] = new;
    known_lanes!(blocks, n; wa wb x0 x y0 y z0 z before excess old_pivot old_pull);
    known_lanes!(blocks_mut, n; pivot pull ratio);
    for i in 0..n {
        let mut new = [[0.0; LANES]; 3];
        for k in 0..LANES {
            let turn = x[i][k] * x0[i][k] + y[i][k] * y0[i][k] + z[i][k] * z0[i][k];
            let weight = if before[i][k] == 0.0 { 0.0 } else { wa[i][k] };
            let weight = if excess[i][k] == 0.0 { 0.0 } else { weight };
            let coupling = -weight * turn;
            let share = coupling * old_pivot[i][k];
            let compliance = if excess[i][k] < 0.0 { folded } else { taut };
            let inverse = 1.0 / (wa[i][k] + wb[i][k] + compliance - coupling * share);
            new[0][k] = inverse;
            new[1][k] = (excess[i][k] - coupling * old_pull[i][k]) * inverse;
            new[2][k] = share;
        }
        [pivot[i], pull[i], ratio[i]] = new;
    }
}

/// Corrects the pulls of one row of cells by those of the next, and makes of directions what they move the first ends by.
#[inline(always)]
fn substitute(pull: &mut [f32], next: &[f32], ratio: &[f32], [x, y, z]: [&mut [f32]; 3]) {
    let n = pull.len() / LANES;
    known_lanes!(blocks, n; next ratio);
    known_lanes!(blocks_mut, n; pull x y z);
    for i in 0..n {
        let mut new = [pull[i], x[i], y[i], z[i]];
        for k in 0..LANES {
            new[0][k] -= ratio[i][k] * next[i][k];
            new[1][k] *= new[0][k];
            new[2][k] *= new[0][k];
            new[3][k] *= new[0][k];
        }
        [pull[i], x[i], y[i], z[i]] = new;
    }
}

/// Moves a row of particles.
#[inline(always)]
fn gather_row(
    down: &Chains,
    up: &Chains,
    row: usize,
    s: usize,
    weights: &[f32],
    [x, y, z]: [&mut [f32]; 3],
) {
    let (own, before) = (cell(s, row), cell(s, row) - wide(s));
    let slots = row * s..row * s + s;
    for (to, down, up) in [
        (x, &down.way.x, &up.way.x),
        (y, &down.way.y, &up.way.y),
        (z, &down.way.z, &up.way.z),
    ] {
        let pulls = [
            &down[own..][..s],
            &down[before - 1..][..s],
            &up[own - 1..][..s],
            &up[before..][..s],
        ];
        gather(pulls, &weights[slots.clone()], &mut to[slots.clone()]);
    }
}

/// Moves a row of particles along one coordinate.
///
/// - `pulls`: of the diagonals that begin and end at each particle, of both directions.
#[inline(always)]
fn gather(pulls: [&[f32]; 4], weights: &[f32], to: &mut [f32]) {
    let n = to.len() / LANES;
    let [d, ended, u, up_ended] = pulls;
    known_lanes!(blocks, n; d ended u up_ended weights);
    known_lanes!(blocks_mut, n; to);
    for i in 0..n {
        let mut new = to[i];
        for k in 0..LANES {
            let pulled = (d[i][k] - ended[i][k]) + (u[i][k] - up_ended[i][k]);
            new[k] += weights[i][k] * pulled;
        }
        to[i] = new;
    }
}

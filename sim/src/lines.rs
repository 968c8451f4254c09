//! Keeps the threads' lengths: every line of the grid is solved as a whole.
//!
//! In: positions and inverse masses of one side. Out: positions moved so that all edges of each column have their
//! rest length, to first order. The edges of a line are a chain, whose equations have three diagonals, so that two
//! passes along it solve them exactly (Han and Harada 2013, for strands of hair), where sweeps over springs leave a
//! hanging cloth slack by the square of its length. All columns are solved side by side.

use crate::layout::{LANES, Layout};
use crate::planes::Planes;
use crate::sides::Side;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

const TINY_M2: f32 = 1e-20;
// An edge is corrected by at most this share of its length in a substep, so that a start that was stretched far is
// no explosion.
const MOST: f32 = 0.05;

/// The edges between one row and the next, of all columns.
///
/// The planes begin with a row of no edges, which is what comes before the first.
#[derive(Clone, Debug)]
pub(crate) struct Lines {
    stride: usize,
    rows: usize,
    spacing_m: f32,
    /// 1 if the edge from a slot to the next row's is there.
    there: Vec<f32>,
    /// Directions of the edges.
    way: Planes,
    /// Coupling of an edge to the one before, divided by the pivot of that one.
    ratio: Vec<f32>,
    /// Inverse pivots.
    pivot: Vec<f32>,
    pull: Vec<f32>,
}

impl Lines {
    /// Lists the edges along the columns of a layout whose rows are whole lanes.
    pub fn new(layout: &Layout) -> Lines {
        let stride = layout.stride();
        let n = layout.rows() * stride;
        let there = |slot: usize| {
            let is =
                slot + stride < n && layout.is_present(slot) && layout.is_present(slot + stride);
            if is { 1.0 } else { 0.0 }
        };
        let mut marks = vec![0.0; stride];
        marks.extend((0..n).map(there));
        let n = n + stride;
        Lines {
            stride,
            rows: layout.rows(),
            spacing_m: layout.grid().spacing_m,
            there: marks,
            way: Planes::zeros(n),
            ratio: vec![0.0; n],
            pivot: vec![1.0; n],
            pull: vec![0.0; n],
        }
    }

    /// Returns the number of edges.
    pub fn count(&self) -> usize {
        self.there.iter().filter(|&&there| there > 0.0).count()
    }

    /// Gives every edge its length.
    ///
    /// - `compliance`: inverse stiffness divided by the square of the substep.
    pub fn solve(&mut self, side: &mut Side, compliance: f32) {
        let Planes { x, y, z } = &mut side.positions;
        solve_rows(self, x, y, z, &side.inverse_mass, compliance);
    }
}

/// Solves all lines, row after row of edges.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn solve_rows(
    lines: &mut Lines,
    x: &mut [f32],
    y: &mut [f32],
    z: &mut [f32],
    weights: &[f32],
    compliance: f32,
) {
    let s = lines.stride;
    for row in 0..lines.rows - 1 {
        let (from, to) = (row * s, row * s + s);
        let (old_x, new_x) = two_rows(&mut lines.way.x, [from, to], s);
        let (old_y, new_y) = two_rows(&mut lines.way.y, [from, to], s);
        let (old_z, new_z) = two_rows(&mut lines.way.z, [from, to], s);
        let (old_pivot, new_pivot) = two_rows(&mut lines.pivot, [from, to], s);
        let (old_pull, new_pull) = two_rows(&mut lines.pull, [from, to], s);
        let ends = [&x[from..to + s], &y[from..to + s], &z[from..to + s]];
        let ratio = &mut lines.ratio[to..to + s];
        eliminate(
            ends,
            &weights[from..to + s],
            &lines.there[from..to + s],
            [old_x, old_y, old_z, old_pivot, old_pull],
            [new_x, new_y, new_z, new_pivot, new_pull, ratio],
            [lines.spacing_m, compliance],
        );
    }
    for row in (1..lines.rows - 1).rev() {
        let next = row * s + s;
        let (low, high) = two_rows(&mut lines.pull, [row * s, next], s);
        substitute(low, high, &lines.ratio[next..next + s]);
    }
    for row in 0..lines.rows - 1 {
        let (from, to) = (row * s, row * s + s);
        let pull = &lines.pull[to..to + s];
        let weights = &weights[from..to + s];
        apply(
            &mut x[from..to + s],
            weights,
            &lines.way.x[to..to + s],
            pull,
        );
        apply(
            &mut y[from..to + s],
            weights,
            &lines.way.y[to..to + s],
            pull,
        );
        apply(
            &mut z[from..to + s],
            weights,
            &lines.way.z[to..to + s],
            pull,
        );
    }
}

/// Returns two rows of a plane, of which the first ends before the second begins.
pub(crate) fn two_rows(
    plane: &mut [f32],
    [from, next]: [usize; 2],
    stride: usize,
) -> (&mut [f32], &mut [f32]) {
    let (before, after) = plane.split_at_mut(next);
    (&mut before[from..from + stride], &mut after[..stride])
}

/// Eliminates the edges before from one row of edges.
///
/// - `ends`, `weights`: two rows of particles; `there`: the row of edges before, and this one.
#[inline(always)]
fn eliminate(
    [x, y, z]: [&[f32]; 3],
    weights: &[f32],
    there: &[f32],
    [old_x, old_y, old_z, old_pivot, old_pull]: [&mut [f32]; 5],
    [new_x, new_y, new_z, new_pivot, new_pull, ratio]: [&mut [f32]; 6],
    [rest_m, compliance]: [f32; 2],
) {
    let s = new_x.len();
    let n = s / LANES;
    let pair = |rows| two_blocks(rows, s);
    let ([ax, bx], [ay, by], [az, bz]) = (pair(x), pair(y), pair(z));
    let ([wa, wb], [before, there]) = (pair(weights), pair(there));
    let (old_x, old_y, old_z) = (blocks(old_x), blocks(old_y), blocks(old_z));
    let (old_pivot, old_pull) = (blocks(old_pivot), blocks(old_pull));
    let (old_x, old_y, old_z) = (&old_x[..n], &old_y[..n], &old_z[..n]);
    let (old_pivot, old_pull) = (&old_pivot[..n], &old_pull[..n]);
    let (new_x, new_y, new_z) = (blocks_mut(new_x), blocks_mut(new_y), blocks_mut(new_z));
    let (new_pivot, new_pull) = (blocks_mut(new_pivot), blocks_mut(new_pull));
    let (new_x, new_y, new_z) = (&mut new_x[..n], &mut new_y[..n], &mut new_z[..n]);
    let (new_pivot, new_pull) = (&mut new_pivot[..n], &mut new_pull[..n]);
    let ratio = &mut blocks_mut(ratio)[..n];
    let most = MOST * rest_m;
    for i in 0..n {
        // Written at once when all lanes are known, so that the compiler sees that they do not depend on each other.
        let mut new = [[0.0; LANES]; 6];
        for k in 0..LANES {
            let (dx, dy, dz) = (
                bx[i][k] - ax[i][k],
                by[i][k] - ay[i][k],
                bz[i][k] - az[i][k],
            );
            let length = (dx * dx + dy * dy + dz * dz + TINY_M2).sqrt();
            let per = 1.0 / length;
            let (dx, dy, dz) = (dx * per, dy * per, dz * per);
            let excess = length - rest_m;
            let excess = if excess > most { most } else { excess };
            let excess = if excess < -most { -most } else { excess };
            let weight = wa[i][k] + wb[i][k];
            let own = if weight > 0.5 {
                weight + compliance
            } else {
                1.0
            };
            let turn = dx * old_x[i][k] + dy * old_y[i][k] + dz * old_z[i][k];
            let coupling = -wa[i][k] * turn * before[i][k] * there[i][k];
            let share = coupling * old_pivot[i][k];
            let pivot = 1.0 / (own - coupling * share);
            new[0][k] = dx;
            new[1][k] = dy;
            new[2][k] = dz;
            new[3][k] = pivot;
            new[4][k] = (-excess * there[i][k] - coupling * old_pull[i][k]) * pivot;
            new[5][k] = share;
        }
        [
            new_x[i],
            new_y[i],
            new_z[i],
            new_pivot[i],
            new_pull[i],
            ratio[i],
        ] = new;
    }
}

#[inline(always)]
pub(crate) fn blocks_mut(row: &mut [f32]) -> &mut [[f32; LANES]] {
    row.as_chunks_mut().0
}

#[inline(always)]
pub(crate) fn blocks(row: &[f32]) -> &[[f32; LANES]] {
    row.as_chunks().0
}

/// Returns the lanes of a row of `stride` values and of the next.
#[inline(always)]
fn two_blocks(rows: &[f32], stride: usize) -> [&[[f32; LANES]]; 2] {
    let n = stride / LANES;
    [&blocks(&rows[..stride])[..n], &blocks(&rows[stride..])[..n]]
}

/// Corrects the pulls of one row of edges by those of the next.
#[inline(always)]
fn substitute(pull: &mut [f32], next: &[f32], ratio: &[f32]) {
    for ((pull, next), ratio) in blocks_mut(pull)
        .iter_mut()
        .zip(blocks(next))
        .zip(blocks(ratio))
    {
        let mut new = *pull;
        for k in 0..LANES {
            new[k] -= ratio[k] * next[k];
        }
        *pull = new;
    }
}

/// Moves both rows of particles of a row of edges, along one coordinate.
#[inline(always)]
fn apply(ends: &mut [f32], weights: &[f32], way: &[f32], pull: &[f32]) {
    let s = way.len();
    let (a, b) = ends.split_at_mut(s);
    let ends = blocks_mut(a).iter_mut().zip(blocks_mut(b));
    let [wa, wb] = two_blocks(weights, s);
    let ways = blocks(way).iter().zip(blocks(pull));
    for (((a, b), (wa, wb)), (way, pull)) in ends.zip(wa.iter().zip(wb)).zip(ways) {
        let mut new = [*a, *b];
        for k in 0..LANES {
            let shift = way[k] * pull[k];
            new[0][k] -= wa[k] * shift;
            new[1][k] += wb[k] * shift;
        }
        [*a, *b] = new;
    }
}

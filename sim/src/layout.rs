//! Where the solver keeps each particle: row after row.
//!
//! In: a grid, and which of its particles are there. Out: slots. One slot for each particle of the grid, unless
//! rows are shorter than [`MIN_STRIDE`] or filled up to whole lanes; room for some lanes more at the end, so that no loop has a remainder.
//! Slots of that room and of missing particles never move and touch nothing.

use crate::grid::Grid;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use std::sync::Arc;
use wide::f32x4;

/// Values that are computed side by side: one AVX2 register, or two of the baseline's.
pub(crate) const LANES: usize = 8;
// Side of the squares that a matrix is transposed by: four values fill a register of every x86-64.
const TILE: usize = 4;
// Least slots of a row. Springs of a diagonal join slots that are one less than a row apart, and the ends of those
// that are pulled side by side must be different particles.
const MIN_STRIDE: usize = LANES + 1;

/// The slots of one cloth; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    grid: Grid,
    columns: usize,
    rows: usize,
    /// `stride` is a multiple of this.
    whole: usize,
    stride: usize,
    /// Slot of every present particle, ascending by particle.
    slots: Arc<[u32]>,
    /// By slot: whether a particle is there.
    present: Arc<[bool]>,
}

impl Layout {
    /// Lays out a grid; `has` tells of each particle whether it is there.
    pub fn new(grid: Grid, has: impl Fn(usize) -> bool) -> Layout {
        Layout::in_rows_of(1, grid, has)
    }

    /// Lays out a grid in rows and columns of whole lanes.
    pub fn in_lanes(grid: Grid, has: impl Fn(usize) -> bool) -> Layout {
        Layout::in_rows_of(LANES, grid, has)
    }

    fn in_rows_of(whole: usize, grid: Grid, has: impl Fn(usize) -> bool) -> Layout {
        let stride = stride(grid.dimx, whole);
        let mut present = vec![false; len(stride, grid.dimy)];
        let mut slots = Vec::with_capacity(grid.particle_count());
        for particle in (0..grid.particle_count()).filter(|&particle| has(particle)) {
            let slot = particle / grid.dimx * stride + particle % grid.dimx;
            present[slot] = true;
            slots.push(slot as u32);
        }
        Layout {
            grid,
            columns: grid.dimx,
            rows: grid.dimy,
            whole,
            stride,
            slots: slots.into(),
            present: present.into(),
        }
    }

    /// Returns the layout of the transposed copy, where rows and columns have changed places.
    pub fn transposed(&self) -> Layout {
        let stride = stride(self.rows, self.whole);
        let mut present = vec![false; len(stride, self.columns)];
        let own = self.stride();
        let across = |&slot: &u32| {
            let slot = slot as usize;
            (slot % own * stride + slot / own) as u32
        };
        let slots: Arc<[u32]> = self.slots.iter().map(across).collect();
        for &slot in slots.iter() {
            present[slot as usize] = true;
        }
        Layout {
            grid: self.grid,
            columns: self.rows,
            rows: self.columns,
            whole: self.whole,
            stride,
            slots,
            present: present.into(),
        }
    }

    /// Returns the grid.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Returns the number of rows with particles.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the slots from the beginning of one row to that of the next.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Returns the length of a plane: all slots, and room for the lanes of a spring beyond; whole lanes.
    pub fn len(&self) -> usize {
        self.present.len()
    }

    /// Returns the slot of every present particle, ascending.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// Returns the slot of a particle of the grid.
    pub fn slot(&self, particle: usize) -> usize {
        particle / self.grid.dimx * self.stride() + particle % self.grid.dimx
    }

    /// Returns the particle of a slot.
    pub fn particle(&self, slot: usize) -> usize {
        slot / self.stride() * self.grid.dimx + slot % self.stride()
    }

    /// Returns whether a slot holds a particle.
    pub fn is_present(&self, slot: usize) -> bool {
        self.present[slot]
    }

    /// Returns whether no particle of the grid is missing.
    pub fn is_full(&self) -> bool {
        self.slots.len() == self.columns * self.rows
    }

    /// Returns inverse masses by slot: 1 for particles, 0 for padding and missing ones.
    pub fn free(&self) -> Vec<f32> {
        self.present
            .iter()
            .map(|&there| if there { 1.0 } else { 0.0 })
            .collect()
    }

    /// Writes a plane of this layout into one of the transposed layout.
    pub fn transpose(&self, from: &[f32], to: &mut [f32]) {
        let strides = [self.stride(), stride(self.rows, self.whole)];
        if self.rows.min(self.columns) >= TILE {
            transpose_tiles(from, to, strides, [self.rows, self.columns]);
        } else {
            for row in 0..self.rows {
                for column in 0..self.columns {
                    to[column * strides[1] + row] = from[row * strides[0] + column];
                }
            }
        }
    }
}

fn stride(columns: usize, whole: usize) -> usize {
    columns.max(MIN_STRIDE).next_multiple_of(whole)
}

fn len(stride: usize, rows: usize) -> usize {
    (rows * stride + LANES).next_multiple_of(LANES)
}

/// Writes a matrix of at least one tile into another with rows and columns exchanged, tile by tile; the last ones
/// overlap those before.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn transpose_tiles(
    from: &[f32],
    to: &mut [f32],
    [stride, to_stride]: [usize; 2],
    [rows, columns]: [usize; 2],
) {
    for row in (0..rows).step_by(TILE) {
        let row = row.min(rows - TILE);
        let (l0, rest) = from[row * stride..].split_at(stride);
        let (l1, rest) = rest.split_at(stride);
        let (l2, l3) = rest.split_at(stride);
        let (l0, l1) = (&l0[..columns], &l1[..columns]);
        let (l2, l3) = (&l2[..columns], &l3[..columns]);
        let upper = tiles(l0).zip(tiles(l1));
        let lower = tiles(l2).zip(tiles(l3));
        let bands = to.chunks_exact_mut(TILE * to_stride);
        for (((a, b), (c, d)), band) in upper.zip(lower).zip(bands) {
            write_tile([a, b, c, d], band, row, to_stride);
        }
        if !columns.is_multiple_of(TILE) {
            let last = (l0.last_chunk(), l1.last_chunk());
            let last = (last, (l2.last_chunk(), l3.last_chunk()));
            if let ((Some(a), Some(b)), (Some(c), Some(d))) = last {
                let band = &mut to[(columns - TILE) * to_stride..columns * to_stride];
                write_tile([a, b, c, d], band, row, to_stride);
            }
        }
    }
}

#[inline(always)]
fn tiles(row: &[f32]) -> std::slice::Iter<'_, [f32; TILE]> {
    row.as_chunks().0.iter()
}

/// Writes four pieces of rows as pieces of the four rows of a band, from one column on.
#[inline(always)]
fn write_tile([a, b, c, d]: [&[f32; TILE]; TILE], band: &mut [f32], column: usize, stride: usize) {
    let (first, rest) = band.split_at_mut(stride);
    let (second, rest) = rest.split_at_mut(stride);
    let (third, fourth) = rest.split_at_mut(stride);
    let to = column..column + TILE;
    let (first, second) = (&mut first[to.clone()], &mut second[to.clone()]);
    let (third, fourth) = (&mut third[to.clone()], &mut fourth[to]);
    let lines = [
        f32x4::new(*a),
        f32x4::new(*b),
        f32x4::new(*c),
        f32x4::new(*d),
    ];
    let [a, b, c, d] = f32x4::transpose(lines);
    first.copy_from_slice(a.as_array());
    second.copy_from_slice(b.as_array());
    third.copy_from_slice(c.as_array());
    fourth.copy_from_slice(d.as_array());
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_transposed_plane_has_every_particle_and_nothing_else() {
        for (dimx, dimy) in [(2, 2), (2, 40), (3, 5), (4, 4), (7, 9), (25, 25), (50, 38)] {
            let grid = Grid::new(dimx, dimy, 0.00625).unwrap();
            let layout = Layout::new(grid, |_| true);
            let across = layout.transposed();
            let plane = |layout: &Layout| {
                let mut plane = vec![0.0; layout.len()];
                for (number, &slot) in layout.slots().iter().enumerate() {
                    plane[slot as usize] = 1.0 + number as f32;
                }
                plane
            };
            let (by_rows, mut there, mut back) = (
                plane(&layout),
                vec![0.0; across.len()],
                vec![0.0; layout.len()],
            );
            layout.transpose(&by_rows, &mut there);
            assert_eq!(there, plane(&across), "{dimx} x {dimy}");
            across.transpose(&there, &mut back);
            assert_eq!(back, by_rows, "{dimx} x {dimy}");
        }
    }
}

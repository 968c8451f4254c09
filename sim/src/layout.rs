//! Where the solver keeps each particle: rows padded to whole lanes.
//!
//! In: a grid, and which of its particles are there. Out: slots. A row begins at a multiple of the lanes, and
//! the number of rows is one too, so that no loop has a remainder and the transposed copy has none either.
//! Slots of padding and of missing particles never move and touch nothing.

use crate::grid::Grid;
use std::ops::Range;
use std::sync::Arc;
use wide::f32x4;

/// Values that are computed side by side: one AVX2 register, or two of the baseline's.
pub(crate) const LANES: usize = 8;
// Side of the squares that a matrix is transposed by: four values fill a register of every x86-64.
const TILE: usize = 4;

/// The slots of one cloth; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    grid: Grid,
    columns: usize,
    rows: usize,
    /// Slot of every present particle, ascending by particle.
    slots: Arc<[u32]>,
    /// By slot: whether a particle is there.
    present: Arc<[bool]>,
}

impl Layout {
    /// Lays out a grid; `has` tells of each particle whether it is there.
    pub fn new(grid: Grid, has: impl Fn(usize) -> bool) -> Layout {
        let stride = stride(grid.dimx);
        let len = grid.dimy.next_multiple_of(LANES) * stride;
        let mut present = vec![false; len + LANES];
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
            slots: slots.into(),
            present: present.into(),
        }
    }

    /// Returns the layout of the transposed copy, where rows and columns have changed places.
    pub fn transposed(&self) -> Layout {
        let stride = stride(self.rows);
        let len = self.columns.next_multiple_of(LANES) * stride;
        let mut present = vec![false; len + LANES];
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
            slots,
            present: present.into(),
        }
    }

    /// Returns the grid.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Returns the number of particles in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the number of rows with particles.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the slots from the beginning of one row to that of the next.
    pub fn stride(&self) -> usize {
        stride(self.columns)
    }

    /// Returns the length of a plane: all slots, and room for the lanes of one look beyond.
    pub fn len(&self) -> usize {
        self.present.len()
    }

    /// Returns the slots of a row, without padding.
    pub fn row(&self, row: usize) -> Range<usize> {
        let start = row * self.stride();
        start..start + self.columns
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
        let tiles = [self.rows.div_ceil(TILE), self.columns.div_ceil(TILE)];
        transpose(from, to, self.stride(), stride(self.rows), tiles);
    }
}

/// Returns the slots of a row: whole lanes for the springs of a diagonal, and as many more, so that what they
/// write beyond a row's end is padding of the same row.
fn stride(columns: usize) -> usize {
    (columns - 1).next_multiple_of(LANES) + LANES
}

/// Writes a matrix into another with rows and columns exchanged, tile by tile.
fn transpose(
    from: &[f32],
    to: &mut [f32],
    stride: usize,
    to_stride: usize,
    [down, across]: [usize; 2],
) {
    for (row, band) in from.chunks_exact(TILE * stride).take(down).enumerate() {
        let (l0, rest) = band.split_at(stride);
        let (l1, rest) = rest.split_at(stride);
        let (l2, l3) = rest.split_at(stride);
        let upper = l0.chunks_exact(TILE).zip(l1.chunks_exact(TILE));
        let lower = l2.chunks_exact(TILE).zip(l3.chunks_exact(TILE));
        let mut at = TILE * row;
        for ((a, b), (c, d)) in upper.zip(lower).take(across) {
            let lines = f32x4::transpose([line(a), line(b), line(c), line(d)]);
            let target = &mut to[at..at + 3 * to_stride + TILE];
            target[..TILE].copy_from_slice(lines[0].as_array());
            target[to_stride..to_stride + TILE].copy_from_slice(lines[1].as_array());
            target[2 * to_stride..2 * to_stride + TILE].copy_from_slice(lines[2].as_array());
            target[3 * to_stride..].copy_from_slice(lines[3].as_array());
            at += TILE * to_stride;
        }
    }
}

#[inline(always)]
fn line(values: &[f32]) -> f32x4 {
    f32x4::new([values[0], values[1], values[2], values[3]])
}

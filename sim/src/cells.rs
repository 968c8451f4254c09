//! Sorts particles by the square of the table that they hover over.
//!
//! In: positions by slot. Out: the slots of each cell, and the cells that a particle has moved in, into or out of
//! since the last look. Cells lie at multiples of their side from the world's origin; which part of the table they
//! cover is kept as long as it holds all particles, and has no say in their order.

use crate::layout::{LANES, Layout};
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;

// There are at most this many cells a side; particles farther out share the outermost cells.
const MAX_CELLS: f32 = 256.0;
// Cells beyond the particles on each side, so that a moving cloth seldom needs others. Of 1, 3 and 6 none costs
// a hundredth of a step more than another.
const SLACK: f32 = 3.0;
// A sum with it keeps no fraction, as long as the other number is less than a third of it.
const ROUNDS: f32 = 12_582_912.0;

/// Cells of the table, row after row, and what is in them.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    layout: Layout,
    per_cell: f32,
    area: Area,
    /// Where each slot was at the last look, and its cell.
    known: Planes,
    cell: Vec<u32>,
    /// Particles of cell `c` are in the places `first[c]..first[c + 1]`.
    first: Vec<u32>,
    /// Slot of the particle in each place; within a cell they ascend.
    slots: Vec<u32>,
    /// By cell: whether a particle has moved in it, into it or out of it.
    stale: Vec<bool>,
}

/// The part of the table that has cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Area {
    /// Number of the first column and row, counted from the world's origin.
    low: [f32; 2],
    /// Columns and rows.
    size: [f32; 2],
    /// Whether every particle has to be looked at anew, since not all had a place in it.
    is_crowded: bool,
}

/// What has changed since the last look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Change {
    Nothing,
    /// Only in stale cells.
    Some,
    /// All; the cells are others than before.
    All,
}

impl Cells {
    /// Makes cells of a side of `cell_m` for a cloth that has not been looked at.
    pub fn new(layout: &Layout, cell_m: f32) -> Cells {
        Cells {
            layout: layout.clone(),
            per_cell: 1.0 / cell_m,
            area: Area {
                low: [0.0; 2],
                size: [0.0; 2],
                is_crowded: true,
            },
            known: Planes::zeros(layout.len()),
            cell: vec![0; layout.len()],
            first: vec![0],
            slots: vec![0; layout.slots().len()],
            stale: Vec::new(),
        }
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.area.size[0] as usize
    }

    /// Returns the first place of each cell, and the end of the last.
    pub fn first(&self) -> &[u32] {
        &self.first
    }

    /// Returns the slot of the particle in each place.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// Returns by cell whether a particle has moved in it, into it or out of it.
    pub fn stale(&self) -> &[bool] {
        &self.stale
    }

    /// Sorts the particles anew.
    ///
    /// - `positions`: by slot, metres, finite.
    pub fn sort(&mut self, positions: &Planes) -> Change {
        self.stale.fill(false);
        let mut change = Change::All;
        if !self.area.is_crowded {
            let outcome = note_moves(
                [&positions.x, &positions.y, &positions.z],
                &mut self.known,
                self.area,
                self.per_cell,
                &mut self.cell,
                &mut self.stale,
            );
            change = match outcome {
                Moves::None => return Change::Nothing,
                Moves::WithinCells => return Change::Some,
                Moves::BetweenCells => Change::Some,
                Moves::Beyond => Change::All,
            };
        }
        if change == Change::All {
            self.area = self.area_of(positions);
            self.known.clone_from(positions);
            number(&self.known, self.area, self.per_cell, &mut self.cell);
            let cells = (self.area.size[0] * self.area.size[1]) as usize;
            self.stale.clear();
            self.stale.resize(cells, true);
            self.first.resize(cells + 1, 0);
        }
        self.count();
        change
    }

    /// Returns the part of the table that the particles are over, and a little more.
    fn area_of(&self, positions: &Planes) -> Area {
        let extent = |values: &[f32]| {
            let mut extent = [f32::INFINITY, f32::NEG_INFINITY];
            for &slot in self.layout.slots() {
                let value = values[slot as usize];
                extent = [extent[0].min(value), extent[1].max(value)];
            }
            extent.map(|end| (end * self.per_cell).floor())
        };
        let ends = [extent(&positions.x), extent(&positions.y)];
        let needed = ends.map(|[low, high]| high - low + 1.0);
        let slack = needed.map(|needed| ((MAX_CELLS - needed) / 2.0).floor().clamp(0.0, SLACK));
        Area {
            low: [0, 1].map(|axis| ends[axis][0] - slack[axis]),
            size: [0, 1].map(|axis| (needed[axis] + 2.0 * slack[axis]).min(MAX_CELLS)),
            is_crowded: needed.iter().any(|&needed| needed > MAX_CELLS),
        }
    }

    /// Notes which particles are in which cell (counting sort).
    fn count(&mut self) {
        self.first.fill(0);
        for &slot in self.layout.slots() {
            self.first[self.cell[slot as usize] as usize + 1] += 1;
        }
        let mut sum = 0;
        for first in &mut self.first {
            sum += *first;
            *first = sum;
        }
        // `first` serves as the cursor of each cell and is shifted back afterwards.
        for &slot in self.layout.slots() {
            let place = &mut self.first[self.cell[slot as usize] as usize];
            self.slots[*place as usize] = slot;
            *place += 1;
        }
        let cells = self.first.len() - 1;
        self.first.copy_within(0..cells, 1);
        self.first[0] = 0;
    }
}

/// How far particles have moved since the last look.
enum Moves {
    None,
    WithinCells,
    BetweenCells,
    /// At least one to where there is no cell.
    Beyond,
}

/// Notes where moved particles are now, and marks the cells that they moved in, out of and into.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn note_moves(
    [x, y, z]: [&[f32]; 3],
    known: &mut Planes,
    area: Area,
    per_cell: f32,
    cell: &mut [u32],
    stale: &mut [bool],
) -> Moves {
    let new = blocks(x).zip(blocks(y)).zip(blocks(z));
    let old = [&mut known.x, &mut known.y, &mut known.z];
    let [old_x, old_y, old_z] = old.map(|plane| plane.as_chunks_mut::<LANES>().0.iter_mut());
    let old = old_x.zip(old_y).zip(old_z);
    let cells = cell.as_chunks_mut::<LANES>().0;
    let mut moves = Moves::None;
    for ((((x, y), z), ((old_x, old_y), old_z)), cell) in new.zip(old).zip(cells) {
        let mut differs = [0; LANES];
        let mut any = 0;
        for k in 0..LANES {
            differs[k] = (x[k].to_bits() ^ old_x[k].to_bits())
                | (y[k].to_bits() ^ old_y[k].to_bits())
                | (z[k].to_bits() ^ old_z[k].to_bits());
            any |= differs[k];
        }
        if any == 0 {
            continue;
        }
        let (column, row) = (
            along(x, area.low[0], per_cell),
            along(y, area.low[1], per_cell),
        );
        let mut now = [0; LANES];
        let mut beyond = 0;
        for k in 0..LANES {
            now[k] = whole(row[k] * area.size[0] + column[k]);
            let inside = (column[k] >= 0.0)
                & (column[k] < area.size[0])
                & (row[k] >= 0.0)
                & (row[k] < area.size[1]);
            // Missing particles are nowhere, and do not move.
            beyond |= if inside { 0 } else { differs[k] };
        }
        if beyond != 0 {
            return Moves::Beyond;
        }
        (*old_x, *old_y, *old_z) = (*x, *y, *z);
        if matches!(moves, Moves::None) {
            moves = Moves::WithinCells;
        }
        for k in 0..LANES {
            if differs[k] != 0 {
                stale[now[k] as usize] = true;
                if cell[k] != now[k] {
                    stale[cell[k] as usize] = true;
                    cell[k] = now[k];
                    moves = Moves::BetweenCells;
                }
            }
        }
    }
    moves
}

/// Writes the number of the cell that each particle is in, or nearest to.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn number(positions: &Planes, area: Area, per_cell: f32, cell: &mut [u32]) {
    let [columns, rows] = area.size;
    let blocks = blocks(&positions.x).zip(blocks(&positions.y));
    for ((x, y), cell) in blocks.zip(cell.as_chunks_mut::<LANES>().0) {
        let (column, row) = (
            along(x, area.low[0], per_cell),
            along(y, area.low[1], per_cell),
        );
        for k in 0..LANES {
            let column = column[k].min(columns - 1.0).max(0.0);
            let row = row[k].min(rows - 1.0).max(0.0);
            cell[k] = whole(row * columns + column);
        }
    }
}

fn blocks(values: &[f32]) -> std::slice::Iter<'_, [f32; LANES]> {
    values.as_chunks().0.iter()
}

/// Returns the columns, or rows, of values, counted from that of number `low`.
#[inline(always)]
fn along(values: &[f32; LANES], low: f32, per_cell: f32) -> [f32; LANES] {
    let mut numbers = [0.0; LANES];
    for k in 0..LANES {
        let value = values[k] * per_cell;
        let nearest = (value + ROUNDS) - ROUNDS;
        let floor = if nearest > value {
            nearest - 1.0
        } else {
            nearest
        };
        numbers[k] = floor - low;
    }
    numbers
}

/// Returns a whole number from 0 to the number of cells as an integer.
#[inline(always)]
fn whole(value: f32) -> u32 {
    (value + ROUNDS).to_bits() & 0x3f_ffff
}

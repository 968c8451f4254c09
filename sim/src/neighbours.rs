//! Finds the pairs of particles that touch.
//!
//! In: positions. Out: pairs that are nearer than the contact distance and were not so in the flat cloth, in an
//! order that follows from the positions alone. What is kept from the last search only saves time: squares of
//! the table in and around which nothing has moved have the same pairs as before.

use crate::layout::Layout;
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use wide::f32x4;

// The search grid has at most this many cells a side; particles farther out share the outermost cells.
const MAX_CELLS: i32 = 256;
// More pairs than this per particle are dropped, which only a crushed cloth can reach; it bounds memory.
const MAX_PAIRS_PER_PARTICLE: usize = 32;
// Particles that one look compares with; a look costs the same whether all of them count or one.
const LOOK: usize = 4;

/// A search structure for one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    limits: Limits,
    cell_m: f32,
    max_pairs: usize,
    layout: Layout,
    /// Column and row of every slot in the cloth's grid.
    column: Vec<f32>,
    row: Vec<f32>,
    now: Search,
    last: Search,
    stale: Vec<bool>,
}

/// What makes a pair count.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Square of the contact distance, m^2.
    contact_2: f32,
    /// Pairs whose squared distance in the grid, in spacings, is less than this never collide.
    rest: f32,
}

/// One search: where every particle was, the cells, and what was found in each.
#[derive(Clone, Debug, Default)]
struct Search {
    /// Positions by particle, with [`LOOK`] values more that are never counted.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    cells: Cells,
    pairs: Vec<[u32; 2]>,
    /// Pairs of cell `c` are `pairs[first_pair[c]..first_pair[c + 1]]`.
    first_pair: Vec<u32>,
}

/// Particles sorted by the square of the table that they hover over, with all that the search reads.
#[derive(Clone, Debug, Default)]
struct Cells {
    /// Number of the first column and row, counted from the world's origin.
    origin: [i32; 2],
    columns: usize,
    rows: usize,
    cell_of_particle: Vec<u32>,
    /// Particles of cell `c` are in the places `first[c]..first[c + 1]`.
    first: Vec<u32>,
    /// Slot of the particle in each place; from here on one value per place, and [`LOOK`] more.
    slot: Vec<u32>,
    values: [Vec<f32>; 5],
}

impl Neighbours {
    /// Makes an empty structure; `contact_m` is the distance at which particles touch.
    pub fn new(layout: &Layout, contact_m: f32) -> Neighbours {
        let grid = layout.grid();
        let slots = 0..layout.len();
        Neighbours {
            limits: Limits {
                contact_2: contact_m * contact_m,
                rest: (contact_m / grid.spacing_m).powi(2),
            },
            cell_m: contact_m,
            max_pairs: MAX_PAIRS_PER_PARTICLE * grid.particle_count(),
            layout: layout.clone(),
            column: slots
                .clone()
                .map(|slot| (slot % layout.stride()) as f32)
                .collect(),
            row: slots.map(|slot| (slot / layout.stride()) as f32).collect(),
            now: Search::default(),
            last: Search::default(),
            stale: Vec::new(),
        }
    }

    /// Returns the pairs in touch, as slots.
    ///
    /// - `positions`: by slot, metres.
    pub fn find(&mut self, positions: &Planes) -> &[[u32; 2]] {
        std::mem::swap(&mut self.now, &mut self.last);
        let (now, slots) = (&mut self.now, self.layout.slots());
        gather(&positions.x, slots, &mut now.x);
        gather(&positions.y, slots, &mut now.y);
        gather(&positions.z, slots, &mut now.z);
        now.cells
            .number(&now.x[..slots.len()], &now.y[..slots.len()], self.cell_m);
        now.cells.sort(slots);
        let sources = [
            &positions.x,
            &positions.y,
            &positions.z,
            &self.column,
            &self.row,
        ];
        for (source, values) in sources.into_iter().zip(&mut now.cells.values) {
            gather(source, &now.cells.slot, values);
        }
        self.mark_stale();
        self.list_pairs();
        &self.now.pairs
    }

    /// Marks the cells that a particle has moved in, into or out of.
    fn mark_stale(&mut self) {
        let (now, last) = (&self.now, &self.last);
        let cells = now.cells.columns * now.cells.rows;
        self.stale.clear();
        // Where pairs were dropped, those kept would depend on what went before.
        let dropped = last.pairs.len() >= self.max_pairs;
        if dropped
            || last.x.len() != now.x.len()
            || now.cells.origin != last.cells.origin
            || now.cells.columns != last.cells.columns
            || now.cells.rows != last.cells.rows
        {
            self.stale.resize(cells, true);
            return;
        }
        self.stale.resize(cells, false);
        for particle in 0..now.cells.cell_of_particle.len() {
            let moved = now.x[particle].to_bits() != last.x[particle].to_bits()
                || now.y[particle].to_bits() != last.y[particle].to_bits()
                || now.z[particle].to_bits() != last.z[particle].to_bits();
            if moved {
                self.stale[now.cells.cell_of_particle[particle] as usize] = true;
                self.stale[last.cells.cell_of_particle[particle] as usize] = true;
            }
        }
    }

    /// Lists the pairs cell by cell: those within a cell, with the next one, and with three of the row below.
    fn list_pairs(&mut self) {
        let (now, last) = (&mut self.now, &self.last);
        let cells = &now.cells;
        now.pairs.clear();
        now.first_pair.clear();
        now.first_pair.push(0);
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                let cell = row * cells.columns + column;
                let right = cell + usize::from(column + 1 < cells.columns);
                let mut stale = self.stale[cell] | self.stale[right];
                let mut below = 0..0;
                if row + 1 < cells.rows {
                    let left = cell - usize::from(column > 0);
                    let [left, right] = [left + cells.columns, right + cells.columns];
                    stale |= self.stale[left..=right].contains(&true);
                    below = cells.first[left] as usize..cells.first[right + 1] as usize;
                }
                if stale {
                    let own = cells.first[cell] as usize..cells.first[cell + 1] as usize;
                    let ahead = cells.first[right + 1] as usize;
                    for place in own {
                        // A start may crush a cloth so that almost all pairs touch.
                        if now.pairs.len() >= self.max_pairs {
                            break;
                        }
                        cells.look_for(place, place + 1..ahead, self.limits, &mut now.pairs);
                        cells.look_for(place, below.clone(), self.limits, &mut now.pairs);
                    }
                } else {
                    let kept = last.first_pair[cell] as usize..last.first_pair[cell + 1] as usize;
                    now.pairs.extend_from_slice(&last.pairs[kept]);
                }
                now.pairs.truncate(self.max_pairs);
                now.first_pair.push(now.pairs.len() as u32);
            }
        }
    }
}

impl Cells {
    /// Notes the cell of every particle.
    fn number(&mut self, x: &[f32], y: &[f32], cell_m: f32) {
        let per_cell = 1.0 / cell_m;
        let ([min_x, max_x], [min_y, max_y]) = (extent(x), extent(y));
        let low = [min_x, min_y].map(|low| (low * per_cell).floor());
        let last = [max_x, max_y].map(|high| (high * per_cell).floor());
        let last = [0, 1].map(|axis| ((last[axis] - low[axis]) as i32).clamp(0, MAX_CELLS - 1));
        self.origin = low.map(|low| low as i32);
        [self.columns, self.rows] = last.map(|last| last as usize + 1);
        self.cell_of_particle.resize(x.len(), 0);
        number_cells(x, y, low, per_cell, last, &mut self.cell_of_particle);
    }

    /// Sorts the particles by cell (counting sort, so the order within a cell is by index).
    fn sort(&mut self, slots: &[u32]) {
        self.first.clear();
        self.first.resize(self.columns * self.rows + 1, 0);
        for &cell in &self.cell_of_particle {
            self.first[cell as usize + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        self.slot.resize(slots.len(), 0);
        // `first` serves as the cursor of each cell and is shifted back afterwards.
        for (&slot, &cell) in slots.iter().zip(&self.cell_of_particle) {
            let place = &mut self.first[cell as usize];
            self.slot[*place as usize] = slot;
            *place += 1;
        }
        let cells = self.first.len();
        self.first.copy_within(0..cells - 1, 1);
        self.first[0] = 0;
    }

    /// Adds the pairs in touch that the particle in one place forms with those in others.
    #[inline(always)]
    fn look_for(
        &self,
        place: usize,
        others: std::ops::Range<usize>,
        limits: Limits,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        let [x, y, z, column, row] = &self.values;
        let point = [x, y, z, column, row].map(|values| f32x4::splat(values[place]));
        let mut from = others.start;
        while from < others.end {
            let mut touched = look([x, y, z, column, row], point, from, limits);
            while touched != 0 {
                let other = from + touched.trailing_zeros() as usize;
                if other < others.end {
                    pairs.push([self.slot[place], self.slot[other]]);
                }
                touched &= touched - 1;
            }
            from += LOOK;
        }
    }
}

/// Returns one bit for each of the places from `from` on: whether it touches the point.
///
/// - `values`: x, y, z, column and row by place.
#[inline(always)]
fn look(values: [&Vec<f32>; 5], point: [f32x4; 5], from: usize, limits: Limits) -> u32 {
    let apart = |axis: usize| {
        let mut lanes = [0.0; LOOK];
        lanes.copy_from_slice(&values[axis][from..from + LOOK]);
        point[axis] - f32x4::new(lanes)
    };
    let [dx, dy, dz, across, along] = [apart(0), apart(1), apart(2), apart(3), apart(4)];
    let close = (dx * dx + dy * dy + dz * dz).simd_lt(f32x4::splat(limits.contact_2));
    let may_collide = (across * across + along * along).simd_ge(f32x4::splat(limits.rest));
    (close & may_collide).to_bitmask()
}

/// Writes the values of the listed slots, and `LOOK` zeros.
fn gather(values: &[f32], slots: &[u32], target: &mut Vec<f32>) {
    target.clear();
    target.extend(slots.iter().map(|&slot| values[slot as usize]));
    target.resize(slots.len() + LOOK, 0.0);
}

/// Writes the number of the cell that each particle is in.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn number_cells(
    x: &[f32],
    y: &[f32],
    low: [f32; 2],
    per_cell: f32,
    last: [i32; 2],
    number: &mut [u32],
) {
    let n = number.len();
    let (x, y) = (&x[..n], &y[..n]);
    let columns = last[0] + 1;
    for i in 0..n {
        let column = ((x[i] * per_cell).floor() - low[0]) as i32;
        let row = ((y[i] * per_cell).floor() - low[1]) as i32;
        number[i] = (row.min(last[1]) * columns + column.min(last[0])) as u32;
    }
}

/// Returns the least and the greatest value.
fn extent(values: &[f32]) -> [f32; 2] {
    let blocks = values.chunks_exact(LOOK);
    let rest = blocks.remainder();
    let (mut low, mut high) = (f32x4::splat(f32::INFINITY), f32x4::splat(f32::NEG_INFINITY));
    for block in blocks {
        let block = f32x4::new([block[0], block[1], block[2], block[3]]);
        low = low.fast_min(block);
        high = high.fast_max(block);
    }
    let low = low.to_array().into_iter().chain(rest.iter().copied());
    let high = high.to_array().into_iter().chain(rest.iter().copied());
    [
        low.fold(f32::INFINITY, f32::min),
        high.fold(f32::NEG_INFINITY, f32::max),
    ]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::grid::Grid;

    /// A start may put all particles in one place, where almost every two touch.
    #[test]
    fn a_crushed_cloth_needs_bounded_memory() {
        let grid = Grid::new(60, 60, 0.00625).unwrap();
        let layout = Layout::new(grid, |_| true);
        let mut neighbours = Neighbours::new(&layout, 0.01125);
        let crushed = Planes::zeros(layout.len());
        for _ in 0..3 {
            assert_eq!(neighbours.find(&crushed).len(), neighbours.max_pairs);
            // One particle more may have been compared with all others, and room grows by doubling.
            let room = neighbours.now.pairs.capacity();
            assert!(
                room <= 2 * (neighbours.max_pairs + grid.particle_count()),
                "{room}"
            );
        }
    }
}

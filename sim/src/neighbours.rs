//! Finds the pairs of particles that touch.
//!
//! In: positions. Out: pairs that are nearer than the contact distance and were not so in the flat cloth. The
//! answer and its order follow from the positions alone: nothing is kept from one search to the next but room.

use crate::layout::Layout;
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use wide::f32x4;

// The search grid has at most this many cells a side; particles farther out share the outermost cells.
const MAX_CELLS: usize = 256;
// More pairs than this per particle are dropped, which only a crushed cloth can reach; it bounds memory.
const MAX_PAIRS_PER_PARTICLE: usize = 32;
// Particles that one look compares with; a look costs the same whether all of them count or one.
const LOOK: usize = 4;

/// A search structure for one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    contact_m: f32,
    layout: Layout,
    /// Column and row of every slot in the cloth's grid.
    column: Vec<f32>,
    row: Vec<f32>,
    /// Pairs whose squared distance in the grid, in spacings, is less than this never collide.
    rest_limit: f32,
    max_pairs: usize,
    touching: Vec<[u32; 2]>,
    cells: Cells,
}

/// Particles sorted by the square of the table that they hover over, with all that the search reads.
#[derive(Clone, Debug, Default)]
struct Cells {
    columns: usize,
    rows: usize,
    /// Particles of cell `c` are in the slots `first[c]..first[c + 1]`.
    first: Vec<u32>,
    cell_of_particle: Vec<u32>,
    particle: Vec<u32>,
    // From here on one value per slot, and `LOOK` more that are never counted.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    column: Vec<f32>,
    row: Vec<f32>,
}

impl Neighbours {
    /// Makes an empty structure; `contact_m` is the distance at which particles touch.
    pub fn new(layout: &Layout, contact_m: f32) -> Neighbours {
        let grid = layout.grid();
        let slots = 0..layout.len();
        Neighbours {
            contact_m,
            column: slots
                .clone()
                .map(|slot| (slot % layout.stride()) as f32)
                .collect(),
            row: slots.map(|slot| (slot / layout.stride()) as f32).collect(),
            rest_limit: (contact_m / grid.spacing_m).powi(2),
            max_pairs: MAX_PAIRS_PER_PARTICLE * grid.particle_count(),
            layout: layout.clone(),
            touching: Vec::new(),
            cells: Cells::default(),
        }
    }

    /// Returns the pairs in touch.
    ///
    /// - `positions`: `[n_particles]`, metres.
    pub fn find(&mut self, positions: &Planes) -> &[[u32; 2]] {
        self.touching.clear();
        let cells = &mut self.cells;
        cells.sort(
            positions,
            &self.layout,
            &self.column,
            &self.row,
            self.contact_m,
        );
        let limits = Limits {
            contact_2: self.contact_m * self.contact_m,
            rest: self.rest_limit,
        };
        list_pairs(
            cells.columns,
            &cells.first,
            [&cells.x, &cells.y, &cells.z, &cells.column, &cells.row],
            &cells.particle,
            limits,
            self.max_pairs,
            &mut self.touching,
        );
        self.touching.truncate(self.max_pairs);
        &self.touching
    }
}

/// What makes a pair count.
#[derive(Clone, Copy)]
struct Limits {
    contact_2: f32,
    rest: f32,
}

/// Lists the pairs in touch, cell by cell: those within a cell, with the next one, and with three of the row below.
///
/// It ends early, with hardly more than `max_pairs`, where so many touch.
fn list_pairs(
    columns: usize,
    first: &[u32],
    values: [&[f32]; 5],
    particle: &[u32],
    limits: Limits,
    max_pairs: usize,
    touching: &mut Vec<[u32; 2]>,
) {
    let n = values[0].len();
    let values = values.map(|values| &values[..n]);
    let cells = first.len() - 1;
    let at = |cell: usize| first[cell] as usize;
    for row in 0..cells / columns {
        for column in 0..columns {
            let cell = row * columns + column;
            let own = at(cell)..at(cell + 1);
            if own.is_empty() {
                continue;
            }
            let (left, right) = (usize::from(column > 0), usize::from(column + 1 < columns));
            let ahead = at(cell + right + 1);
            let below = if cell + columns < cells {
                at(cell + columns - left)..at(cell + columns + right + 1)
            } else {
                0..0
            };
            for slot in own {
                if touching.len() > max_pairs {
                    return;
                }
                let point = values.map(|values| f32x4::splat(values[slot]));
                for others in [slot + 1..ahead, below.clone()] {
                    let mut from = others.start;
                    while from < others.end {
                        let mut touched = look(values, point, from, limits);
                        while touched != 0 {
                            let other = from + touched.trailing_zeros() as usize;
                            if other < others.end {
                                touching.push([particle[slot], particle[other]]);
                            }
                            touched &= touched - 1;
                        }
                        from += LOOK;
                    }
                }
            }
        }
    }
}

/// Returns one bit for each of the slots from `from` on: whether it touches the point.
#[inline(always)]
fn look(values: [&[f32]; 5], point: [f32x4; 5], from: usize, limits: Limits) -> u32 {
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

impl Cells {
    /// Sorts the particles by cell (counting sort, so the order within a cell is by index).
    fn sort(
        &mut self,
        positions: &Planes,
        layout: &Layout,
        column: &[f32],
        row: &[f32],
        cell_m: f32,
    ) {
        let slots = layout.slots();
        gather(&positions.x, slots, &mut self.x);
        gather(&positions.y, slots, &mut self.y);
        let (min_x, max_x) = extent(&self.x[..slots.len()]);
        let (min_y, max_y) = extent(&self.y[..slots.len()]);
        self.columns = cell_index(max_x - min_x, cell_m) + 1;
        self.rows = cell_index(max_y - min_y, cell_m) + 1;
        self.cell_of_particle.resize(slots.len(), 0);
        number_cells(
            &self.x,
            &self.y,
            [min_x, min_y],
            1.0 / cell_m,
            [self.columns as f32, self.rows as f32],
            &mut self.cell_of_particle,
        );
        self.first.clear();
        self.first.resize(self.columns * self.rows + 1, 0);
        for &cell in &self.cell_of_particle {
            self.first[cell as usize + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        self.particle.resize(slots.len(), 0);
        // `first` serves as the cursor of each cell and is shifted back afterwards.
        for (&slot, &cell) in slots.iter().zip(&self.cell_of_particle) {
            let place = &mut self.first[cell as usize];
            self.particle[*place as usize] = slot;
            *place += 1;
        }
        let cells = self.first.len();
        self.first.copy_within(0..cells - 1, 1);
        self.first[0] = 0;
        gather(&positions.x, &self.particle, &mut self.x);
        gather(&positions.y, &self.particle, &mut self.y);
        gather(&positions.z, &self.particle, &mut self.z);
        gather(column, &self.particle, &mut self.column);
        gather(row, &self.particle, &mut self.row);
    }
}

/// Writes the values of the listed particles, and `LOOK` zeros.
fn gather(values: &[f32], particles: &[u32], target: &mut Vec<f32>) {
    target.clear();
    target.extend(particles.iter().map(|&particle| values[particle as usize]));
    target.resize(particles.len() + LOOK, 0.0);
}

/// Writes the number of the cell that each particle is in.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn number_cells(
    x: &[f32],
    y: &[f32],
    min: [f32; 2],
    per_cell: f32,
    cells: [f32; 2],
    number: &mut [u32],
) {
    let n = number.len();
    let (x, y) = (&x[..n], &y[..n]);
    for i in 0..n {
        let column = ((x[i] - min[0]) * per_cell).min(cells[0] - 1.0);
        let row = ((y[i] - min[1]) * per_cell).min(cells[1] - 1.0);
        number[i] = row as i32 as u32 * cells[0] as u32 + column as i32 as u32;
    }
}

fn cell_index(offset_m: f32, cell_m: f32) -> usize {
    ((offset_m * (1.0 / cell_m)) as usize).min(MAX_CELLS - 1)
}

/// Returns the least and the greatest value.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn extent(values: &[f32]) -> (f32, f32) {
    let (mut low, mut high) = ([f32::INFINITY; LOOK], [f32::NEG_INFINITY; LOOK]);
    let looks = values.chunks_exact(LOOK);
    let rest = looks.remainder();
    for look in looks {
        for k in 0..LOOK {
            low[k] = if look[k] < low[k] { look[k] } else { low[k] };
            high[k] = if look[k] > high[k] { look[k] } else { high[k] };
        }
    }
    let all = |side: &[f32]| side.iter().chain(rest).copied().collect::<Vec<_>>();
    let low = all(&low).into_iter().fold(f32::INFINITY, f32::min);
    let high = all(&high).into_iter().fold(f32::NEG_INFINITY, f32::max);
    (low, high)
}

//! Finds the pairs of particles that touch.
//!
//! In: positions. Out: pairs that are nearer than the contact distance and were not so in the flat cloth. The
//! answer and its order follow from the positions alone: nothing is kept from one search to the next but room.

use crate::grid::Grid;
use crate::planes::Planes;
use multiversion::multiversion;
use std::ops::Range;

// The search grid has at most this many cells a side; particles farther out share the outermost cells.
const MAX_CELLS: usize = 256;
// More pairs than this per particle are dropped, which only a crushed cloth can reach; it bounds memory.
const MAX_PAIRS_PER_PARTICLE: usize = 32;
// Particles that one look compares with; a look costs the same whether all of them count or one.
const LOOK: usize = 8;

/// A search structure for one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    contact_m: f32,
    /// Column and row of every particle in the cloth's grid.
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
    cell_of_slot: Vec<u32>,
    particle: Vec<u32>,
    // From here on one value per slot, and `LOOK` more that are never counted.
    position: Planes,
    column: Vec<f32>,
    row: Vec<f32>,
}

impl Neighbours {
    /// Makes an empty structure; `contact_m` is the distance at which particles touch.
    pub fn new(grid: Grid, contact_m: f32) -> Neighbours {
        let particles = 0..grid.particle_count();
        Neighbours {
            contact_m,
            column: particles.clone().map(|i| (i % grid.dimx) as f32).collect(),
            row: particles.map(|i| (i / grid.dimx) as f32).collect(),
            rest_limit: (contact_m / grid.spacing_m).powi(2),
            max_pairs: MAX_PAIRS_PER_PARTICLE * grid.particle_count(),
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
        cells.sort(positions, &self.column, &self.row, self.contact_m);
        let limits = Limits {
            contact_2: self.contact_m * self.contact_m,
            rest: self.rest_limit,
        };
        for row in 0..cells.rows {
            for column in 0..cells.columns {
                let cell = row * cells.columns + column;
                let own = cells.slots(cell, cell);
                if own.is_empty() {
                    continue;
                }
                let right = cell + usize::from(column + 1 < cells.columns);
                let ahead = cells.slots(cell, right).end;
                let below = if row + 1 < cells.rows {
                    let left = cell - usize::from(column > 0);
                    cells.slots(left + cells.columns, right + cells.columns)
                } else {
                    0..0
                };
                if own.len() + below.len() + (ahead - own.end) > 1 {
                    pairs_of_cell(
                        own,
                        ahead,
                        below,
                        &cells.position.x,
                        &cells.position.y,
                        &cells.position.z,
                        &cells.column,
                        &cells.row,
                        &cells.particle,
                        limits,
                        &mut self.touching,
                    );
                }
            }
        }
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

/// Adds the pairs in touch that the slots `own` form with later ones: up to `ahead`, and in `below`.
// Separate slices, so that the compiler knows that they do not overlap.
#[allow(clippy::too_many_arguments)]
#[multiversion(targets("x86_64+avx2"))]
fn pairs_of_cell(
    own: Range<usize>,
    ahead: usize,
    below: Range<usize>,
    x: &[f32],
    y: &[f32],
    z: &[f32],
    column: &[f32],
    row: &[f32],
    particle: &[u32],
    limits: Limits,
    touching: &mut Vec<[u32; 2]>,
) {
    let n = x.len();
    let (y, z, column, row) = (&y[..n], &z[..n], &column[..n], &row[..n]);
    for slot in own {
        let (px, py, pz) = (x[slot], y[slot], z[slot]);
        let (own_column, own_row) = (column[slot], row[slot]);
        let later = [slot + 1..ahead, below.clone()];
        let mut near = [0u32; LOOK];
        for others in &later {
            let mut from = others.start;
            while from < others.end {
                let to = from + LOOK;
                let (xs, ys, zs) = (&x[from..to], &y[from..to], &z[from..to]);
                let (columns, rows) = (&column[from..to], &row[from..to]);
                for k in 0..LOOK {
                    let (dx, dy, dz) = (px - xs[k], py - ys[k], pz - zs[k]);
                    let (across, along) = (own_column - columns[k], own_row - rows[k]);
                    near[k] |= u32::from(dx * dx + dy * dy + dz * dz < limits.contact_2)
                        & u32::from(across * across + along * along >= limits.rest);
                }
                from = to;
            }
        }
        // Most particles touch nothing, and one answer for all that follow is cheaper than one for each.
        if near == [0; LOOK] {
            continue;
        }
        for other in later.into_iter().flatten() {
            let (dx, dy, dz) = (px - x[other], py - y[other], pz - z[other]);
            let (across, along) = (own_column - column[other], own_row - row[other]);
            if dx * dx + dy * dy + dz * dz < limits.contact_2
                && across * across + along * along >= limits.rest
            {
                touching.push([particle[slot], particle[other]]);
            }
        }
    }
}

impl Cells {
    /// Sorts the particles by cell (counting sort, so the order within a cell is by index).
    fn sort(&mut self, positions: &Planes, column: &[f32], row: &[f32], cell_m: f32) {
        let n = positions.len();
        let low = [extent(&positions.x), extent(&positions.y)];
        let [(min_x, max_x), (min_y, max_y)] = low;
        self.columns = cell_index(max_x - min_x, cell_m) + 1;
        self.rows = cell_index(max_y - min_y, cell_m) + 1;
        self.cell_of_particle.resize(n, 0);
        number_cells(
            &positions.x,
            &positions.y,
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
        self.particle.resize(n, 0);
        // `first` serves as the cursor of each cell and is shifted back afterwards.
        for (particle, &cell) in self.cell_of_particle.iter().enumerate() {
            let slot = &mut self.first[cell as usize];
            self.particle[*slot as usize] = particle as u32;
            *slot += 1;
        }
        let cells = self.first.len();
        self.first.copy_within(0..cells - 1, 1);
        self.first[0] = 0;
        gather(&positions.x, &self.particle, &mut self.position.x);
        gather(&positions.y, &self.particle, &mut self.position.y);
        gather(&positions.z, &self.particle, &mut self.position.z);
        gather(column, &self.particle, &mut self.column);
        gather(row, &self.particle, &mut self.row);
    }

    /// Returns the slots of the cells from `first` to `last`, which lie in one row of cells.
    fn slots(&self, first: usize, last: usize) -> Range<usize> {
        self.first[first] as usize..self.first[last + 1] as usize
    }
}

/// Writes the values of the listed particles, and `LOOK` zeros.
fn gather(values: &[f32], particles: &[u32], target: &mut Vec<f32>) {
    target.clear();
    target.extend(particles.iter().map(|&particle| values[particle as usize]));
    target.resize(particles.len() + LOOK, 0.0);
}

/// Writes the number of the cell that each particle is in.
#[multiversion(targets("x86_64+avx2"))]
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
#[multiversion(targets("x86_64+avx2"))]
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

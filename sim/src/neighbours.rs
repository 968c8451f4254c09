//! Finds the pairs of particles that are close enough to touch.
//!
//! In: positions. Out: pairs in ascending order that are nearer than the
//! contact distance and were not so in the flat cloth. The answer depends on
//! the positions alone: the wide list of candidates, kept while nobody has
//! moved far, only saves time.

use crate::grid::Grid;
use crate::planes::Planes;
use std::ops::Range;

// Extra reach of the wide list, metres. A larger one lasts longer and costs more per substep; replays of
// Double Straight took about the same time with 2, 3, 4 and 6 mm.
const MARGIN_M: f32 = 0.003;
// The search grid has at most this many cells a side; particles farther out share the outermost cells.
const MAX_CELLS: usize = 256;
// More candidates than this per particle are dropped, which only a crushed cloth can reach; it bounds memory.
const MAX_CANDIDATES: usize = 256;

/// Two particles in touch, the lower index in the upper half, so that sorting puts them in index order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Pair(u32);

impl Pair {
    fn new(i: u32, j: u32) -> Pair {
        Pair(i.min(j) << 16 | i.max(j))
    }

    /// Returns both indices, the lower one first.
    pub fn indices(self) -> (usize, usize) {
        ((self.0 >> 16) as usize, (self.0 & 0xffff) as usize)
    }
}

/// A search structure for one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    contact_m: f32,
    /// Column and row of every particle in the cloth's grid.
    column: Vec<f32>,
    row: Vec<f32>,
    /// Pairs whose squared distance in the grid, in spacings, is less than this never collide.
    rest_limit: f32,
    /// Where the particles were when the wide list was made; empty before the first.
    built_at: Planes,
    /// Candidates of the particle in slot `s` of `cells` are `candidates[starts[s]..starts[s + 1]]`.
    candidates: Vec<u32>,
    starts: Vec<u32>,
    in_touch: Vec<Pair>,
    cells: Cells,
    near: Vec<u32>,
}

/// Particles sorted by the square of the table that they hover over, with all that the search reads.
#[derive(Clone, Debug, Default)]
struct Cells {
    columns: usize,
    rows: usize,
    /// Particles of cell `c` are those of `slots(c, c)`.
    first: Vec<u32>,
    cell_of_particle: Vec<u32>,
    particle: Vec<u32>,
    position: Planes,
    grid_column: Vec<f32>,
    grid_row: Vec<f32>,
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
            built_at: Planes::default(),
            candidates: Vec::new(),
            starts: Vec::new(),
            in_touch: Vec::new(),
            cells: Cells::default(),
            near: Vec::new(),
        }
    }

    /// Returns the pairs in touch, in index order.
    ///
    /// - `positions`: `[n_particles]`, metres.
    pub fn find(&mut self, positions: &Planes) -> &[Pair] {
        let first_time = self.built_at.len() != positions.len();
        if first_time || positions.differs_beyond(&self.built_at, 0.5 * MARGIN_M) {
            self.rebuild(positions);
        }
        let limit = self.contact_m * self.contact_m;
        let (x, y, z) = (&positions.x[..], &positions.y[..], &positions.z[..]);
        // Every candidate is written, and stays if the cursor moves past it: unlike a branch, this costs
        // the same however often the answer changes.
        self.in_touch
            .resize(self.candidates.len() + 1, Pair::default());
        let mut found = 0;
        for (range, &i) in self.starts.windows(2).zip(&self.cells.particle) {
            let [xi, yi, zi] = positions.get(i as usize);
            for &j in &self.candidates[range[0] as usize..range[1] as usize] {
                let (dx, dy, dz) = (xi - x[j as usize], yi - y[j as usize], zi - z[j as usize]);
                self.in_touch[found] = Pair::new(i, j);
                found += usize::from(dx * dx + dy * dy + dz * dz < limit);
            }
        }
        self.in_touch.truncate(found);
        // Candidates come in the order of the cells, which depends on when the list was made.
        self.in_touch.sort_unstable();
        &self.in_touch
    }

    /// Lists every pair within contact distance plus margin.
    fn rebuild(&mut self, positions: &Planes) {
        let reach = self.contact_m + MARGIN_M;
        self.cells.sort(positions, &self.column, &self.row, reach);
        self.candidates.clear();
        self.starts.clear();
        self.starts.push(0);
        let cells = &self.cells;
        let mut found = 0;
        for slot in 0..cells.particle.len() {
            let last = found + MAX_CANDIDATES;
            for others in cells.later_neighbours(slot) {
                let n = others.len();
                if self.candidates.len() <= found + n {
                    self.candidates.resize(2 * (found + n) + 1, 0);
                }
                self.near.resize(self.near.len().max(n), 0);
                cells.mark_near(
                    slot,
                    others.clone(),
                    reach,
                    self.rest_limit,
                    &mut self.near[..n],
                );
                let target = &mut self.candidates[found..found + n + 1];
                let mut kept = 0;
                for (&other, &near) in cells.particle[others].iter().zip(&self.near) {
                    target[kept] = other;
                    kept += near as usize;
                }
                found = (found + kept).min(last);
            }
            self.starts.push(found as u32);
        }
        self.candidates.truncate(found);
        self.built_at.clone_from(positions);
    }
}

impl Cells {
    /// Sorts the particles by cell (counting sort, so the order within a cell is by index).
    fn sort(&mut self, positions: &Planes, column: &[f32], row: &[f32], cell_m: f32) {
        let n = positions.len();
        let (min_x, max_x) = extent(&positions.x);
        let (min_y, max_y) = extent(&positions.y);
        self.columns = cell_index(max_x - min_x, cell_m) + 1;
        self.rows = cell_index(max_y - min_y, cell_m) + 1;
        self.cell_of_particle.clear();
        self.first.clear();
        self.first.resize(self.columns * self.rows + 1, 0);
        for i in 0..n {
            let cell_column = cell_index(positions.x[i] - min_x, cell_m);
            let cell_row = cell_index(positions.y[i] - min_y, cell_m);
            let cell = cell_row * self.columns + cell_column;
            self.cell_of_particle.push(cell as u32);
            self.first[cell + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        self.particle.resize(n, 0);
        self.grid_column.resize(n, 0.0);
        self.grid_row.resize(n, 0.0);
        self.position.resize(n);
        // `first` serves as the cursor of each cell and is shifted back afterwards.
        for i in 0..n {
            let cell = self.cell_of_particle[i] as usize;
            let slot = self.first[cell] as usize;
            self.first[cell] += 1;
            self.particle[slot] = i as u32;
            self.grid_column[slot] = column[i];
            self.grid_row[slot] = row[i];
            self.position.set(slot, positions.get(i));
        }
        for cell in (1..self.first.len()).rev() {
            self.first[cell] = self.first[cell - 1];
        }
        self.first[0] = 0;
    }

    /// Returns the slots of the cells from `first` to `last`, which lie in one row of cells.
    fn slots(&self, first: usize, last: usize) -> Range<usize> {
        self.first[first] as usize..self.first[last + 1] as usize
    }

    /// Returns the slots in the same and the adjoining cells that come later in the order: after `slot` in
    /// its own row of cells, and in three cells of the next row. Each pair is met once.
    fn later_neighbours(&self, slot: usize) -> [Range<usize>; 2] {
        let cell = self.cell_of_particle[self.particle[slot] as usize] as usize;
        let column = cell % self.columns;
        let left = cell - usize::from(column > 0);
        let right = cell + usize::from(column + 1 < self.columns);
        let same_row = slot + 1..self.slots(cell, right).end;
        if cell / self.columns + 1 < self.rows {
            [
                same_row,
                self.slots(left + self.columns, right + self.columns),
            ]
        } else {
            [same_row, 0..0]
        }
    }

    /// Writes 1 for each slot of `others` that is within `reach` and may collide with `slot`, else 0.
    // Kept out of line: only as an argument of a function is `near` known not to overlap the others.
    #[inline(never)]
    fn mark_near(
        &self,
        slot: usize,
        others: Range<usize>,
        reach: f32,
        rest_limit: f32,
        near: &mut [u32],
    ) {
        let n = near.len();
        let xs = &self.position.x[others.clone()][..n];
        let ys = &self.position.y[others.clone()][..n];
        let zs = &self.position.z[others.clone()][..n];
        let columns = &self.grid_column[others.clone()][..n];
        let rows = &self.grid_row[others][..n];
        let [x, y, z] = self.position.get(slot);
        let (column, row) = (self.grid_column[slot], self.grid_row[slot]);
        for k in 0..n {
            let (dx, dy, dz) = (x - xs[k], y - ys[k], z - zs[k]);
            let (across, along) = (column - columns[k], row - rows[k]);
            let close = dx * dx + dy * dy + dz * dz < reach * reach;
            let may_collide = across * across + along * along >= rest_limit;
            near[k] = u32::from(close & may_collide);
        }
    }
}

fn cell_index(offset_m: f32, cell_m: f32) -> usize {
    ((offset_m / cell_m) as usize).min(MAX_CELLS - 1)
}

fn extent(values: &[f32]) -> (f32, f32) {
    values
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        })
}

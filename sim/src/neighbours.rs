//! Finds the pairs of particles that touch.
//!
//! In: positions. Out: pairs that are nearer than the contact distance and were not so in the flat cloth, in an
//! order that follows from the positions alone. What is kept from the last search only saves time: squares of
//! the table in and around which nothing has moved have the same pairs as before.

use crate::cells::{Cells, Change};
use crate::layout::{LANES, Layout};
use crate::planes::Planes;
#[cfg(not(feature = "narrow"))]
use multiversion::multiversion;
use std::ops::Range;
use wide::f32x4;

// More pairs than this per particle are dropped, which only a crushed cloth can reach; it bounds memory.
const MAX_PAIRS_PER_PARTICLE: usize = 32;
// Half of the particles that one look compares with, whether all of them count or one.
const HALF: usize = LANES / 2;

/// A search structure for one cloth.
#[derive(Clone, Debug)]
pub(crate) struct Neighbours {
    limits: Limits,
    max_pairs: usize,
    /// Column and row of every slot in the cloth's grid.
    column: Vec<f32>,
    row: Vec<f32>,
    cells: Cells,
    /// By cell: whether its pairs are to be searched, since it or a cell that it looks into is stale.
    searched: Vec<bool>,
    /// By cell: whether a search looks into it.
    seen: Vec<bool>,
    /// x, y, z, column and row by place, of cells that are seen; [`LANES`] values more that are never counted.
    values: [Vec<f32>; 5],
    now: Found,
    last: Found,
}

/// What makes a pair count.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Square of the contact distance, m^2.
    contact_2: f32,
    /// Pairs whose squared distance in the grid, in spacings, is less than this never collide.
    rest: f32,
}

/// What one search found.
#[derive(Clone, Debug, Default)]
struct Found {
    pairs: Vec<[u32; 2]>,
    /// Pairs of cell `c` are `pairs[first[c]..first[c + 1]]`.
    first: Vec<u32>,
}

impl Neighbours {
    /// Makes an empty structure; `contact_m` is the distance at which particles touch.
    pub fn new(layout: &Layout, contact_m: f32) -> Neighbours {
        let rest = (contact_m / layout.grid().spacing_m).powi(2);
        Neighbours::within(layout, contact_m, rest, MAX_PAIRS_PER_PARTICLE)
    }

    /// Makes an empty structure for pairs nearer than `contact_m` whose squared distance in the grid is at least
    /// `rest`, in spacings.
    ///
    /// - `most`: pairs per particle; more are dropped, which bounds memory.
    pub fn within(layout: &Layout, contact_m: f32, rest: f32, most: usize) -> Neighbours {
        let grid = layout.grid();
        let slots = 0..layout.len();
        Neighbours {
            limits: Limits {
                contact_2: contact_m * contact_m,
                rest,
            },
            max_pairs: most * grid.particle_count(),
            column: slots
                .clone()
                .map(|slot| (slot % layout.stride()) as f32)
                .collect(),
            row: slots.map(|slot| (slot / layout.stride()) as f32).collect(),
            cells: Cells::new(layout, contact_m),
            searched: Vec::new(),
            seen: Vec::new(),
            values: std::array::from_fn(|_| vec![0.0; layout.slots().len() + LANES]),
            now: Found::default(),
            last: Found::default(),
        }
    }

    /// Returns the pairs in touch, as slots.
    ///
    /// - `positions`: by slot, metres.
    pub fn find(&mut self, positions: &Planes) -> &[[u32; 2]] {
        let change = self.cells.sort(positions);
        if change == Change::Nothing {
            return &self.now.pairs;
        }
        // Where pairs were dropped, those kept would depend on what went before.
        let dropped = self.now.pairs.len() >= self.max_pairs;
        self.choose_cells(change == Change::All || dropped);
        self.gather(positions);
        std::mem::swap(&mut self.now, &mut self.last);
        self.now.pairs.clear();
        self.now.first.clear();
        self.now.first.push(0);
        let mut from = 0;
        while from < self.searched.len() {
            let run = next_run(&self.searched, from);
            self.keep(from..run.start);
            search(
                &self.cells,
                self.values.each_ref().map(Vec::as_slice),
                run.clone(),
                self.limits,
                self.max_pairs,
                &mut self.now,
            );
            from = run.end;
        }
        self.now.pairs.truncate(self.max_pairs);
        &self.now.pairs
    }

    /// Chooses the cells whose pairs are to be searched, and the cells that this looks into.
    ///
    /// A cell looks at itself, the next one, and three of the row below. Cells at the ends of rows count as if
    /// they were beside those of the next row, which costs little and does no harm.
    fn choose_cells(&mut self, all: bool) {
        let stale = self.cells.stale();
        let below = self.cells.columns();
        let ahead = [1, below.saturating_sub(1), below, below + 1];
        self.searched.clear();
        if all {
            self.searched.resize(stale.len(), true);
        } else {
            self.searched.extend_from_slice(stale);
            for offset in ahead.map(|offset| offset.min(stale.len())) {
                for (searched, stale) in self.searched.iter_mut().zip(&stale[offset..]) {
                    *searched |= stale;
                }
            }
        }
        self.seen.clone_from(&self.searched);
        for offset in ahead.map(|offset| offset.min(stale.len())) {
            for (seen, searched) in self.seen[offset..].iter_mut().zip(&self.searched) {
                *seen |= searched;
            }
        }
    }

    /// Writes the values of the particles that are looked at side by side.
    fn gather(&mut self, positions: &Planes) {
        let n = positions.len();
        let (x, y, z) = (&positions.x[..n], &positions.y[..n], &positions.z[..n]);
        let (column, row) = (&self.column[..n], &self.row[..n]);
        let [to_x, to_y, to_z, to_column, to_row] = &mut self.values;
        let mut from = 0;
        while from < self.seen.len() {
            let run = next_run(&self.seen, from);
            from = run.end;
            let first = self.cells.first();
            let places = first[run.start] as usize..first[run.end] as usize;
            let slots = &self.cells.slots()[places.clone()];
            let points = to_x[places.clone()]
                .iter_mut()
                .zip(&mut to_y[places.clone()])
                .zip(&mut to_z[places.clone()]);
            let nodes = to_column[places.clone()]
                .iter_mut()
                .zip(&mut to_row[places]);
            for ((&slot, ((to_x, to_y), to_z)), (to_column, to_row)) in
                slots.iter().zip(points).zip(nodes)
            {
                let slot = slot as usize;
                (*to_x, *to_y, *to_z) = (x[slot], y[slot], z[slot]);
                (*to_column, *to_row) = (column[slot], row[slot]);
            }
        }
    }

    /// Takes over the pairs that the last search found in a range of cells.
    fn keep(&mut self, cells: Range<usize>) {
        if cells.is_empty() {
            return;
        }
        let (now, last) = (&mut self.now, &self.last);
        let from = last.first[cells.start];
        let to = last.first[cells.end];
        let moved = (now.pairs.len() as u32).wrapping_sub(from);
        now.pairs
            .extend_from_slice(&last.pairs[from as usize..to as usize]);
        let ends = &last.first[cells.start + 1..=cells.end];
        now.first
            .extend(ends.iter().map(|end| end.wrapping_add(moved)));
    }
}

/// Returns the next range of cells that are marked, from `from` on; an empty one at the end if there is none.
fn next_run(marks: &[bool], from: usize) -> Range<usize> {
    let rest = &marks[from..];
    let start = rest.iter().position(|&mark| mark).unwrap_or(rest.len());
    let rest = &rest[start..];
    let len = rest.iter().position(|&mark| !mark).unwrap_or(rest.len());
    from + start..from + start + len
}

/// Lists the pairs of a range of cells, cell by cell: those within a cell, with the next one, and with three of
/// the row below.
#[cfg_attr(not(feature = "narrow"), multiversion(targets("x86_64+avx2")))]
fn search(
    cells: &Cells,
    values: [&[f32]; 5],
    range: Range<usize>,
    limits: Limits,
    max_pairs: usize,
    found: &mut Found,
) {
    let (first, columns) = (cells.first(), cells.columns());
    let n = values[0].len();
    let [x, y, z, column, row] = values;
    let values = [&x[..n], &y[..n], &z[..n], &column[..n], &row[..n]];
    let all = first.len() - 1;
    for cell in range {
        let own = first[cell] as usize..first[cell + 1] as usize;
        if !own.is_empty() {
            let column = cell % columns;
            let right = cell + usize::from(column + 1 < columns);
            let ahead = first[right + 1] as usize;
            let mut below = 0..0;
            if cell + columns < all {
                let left = cell - usize::from(column > 0);
                below = first[left + columns] as usize..first[right + columns + 1] as usize;
            }
            for place in own {
                // A start may crush a cloth so that almost all pairs touch.
                if found.pairs.len() >= max_pairs {
                    break;
                }
                for others in [place + 1..ahead, below.clone()] {
                    let mut from = others.start;
                    while from < others.end {
                        if touches_any(values, place, from, limits) {
                            list_touching(
                                values,
                                place,
                                from..others.end,
                                limits,
                                cells.slots(),
                                found,
                            );
                        }
                        from += LANES;
                    }
                }
            }
        }
        found.first.push(found.pairs.len() as u32);
    }
}

/// Tells whether the particle in one place touches one of those of a look, from the place `from` on.
#[inline(always)]
fn touches_any(values: [&[f32]; 5], place: usize, from: usize, limits: Limits) -> bool {
    let [x, y, z, column, row] = values;
    let (x0, y0, z0) = (x[place], y[place], z[place]);
    let (column0, row0) = (column[place], row[place]);
    let range = from..from + LANES;
    let (x, y, z) = (&x[range.clone()], &y[range.clone()], &z[range.clone()]);
    let (column, row) = (&column[range.clone()], &row[range]);
    let mut touches = false;
    for k in 0..LANES {
        let (dx, dy, dz) = (x0 - x[k], y0 - y[k], z0 - z[k]);
        let (across, along) = (column0 - column[k], row0 - row[k]);
        let close = dx * dx + dy * dy + dz * dz < limits.contact_2;
        let may_collide = across * across + along * along >= limits.rest;
        touches |= close & may_collide;
    }
    touches
}

/// Adds the pairs in touch that the particle in one place forms with those of a look, as long as these are in range.
#[inline(never)]
fn list_touching(
    values: [&[f32]; 5],
    place: usize,
    others: Range<usize>,
    limits: Limits,
    slots: &[u32],
    found: &mut Found,
) {
    for from in [others.start, others.start + HALF] {
        let apart = |axis: usize| {
            let from = &values[axis][from..from + HALF];
            let other = f32x4::new([from[0], from[1], from[2], from[3]]);
            f32x4::splat(values[axis][place]) - other
        };
        let (dx, dy, dz, across, along) = (apart(0), apart(1), apart(2), apart(3), apart(4));
        let close = (dx * dx + dy * dy + dz * dz).simd_lt(f32x4::splat(limits.contact_2));
        let may_collide = (across * across + along * along).simd_ge(f32x4::splat(limits.rest));
        let mut touched = (close & may_collide).to_bitmask();
        while touched != 0 {
            let other = from + touched.trailing_zeros() as usize;
            if other < others.end {
                found.pairs.push([slots[place], slots[other]]);
            }
            touched &= touched - 1;
        }
    }
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
        let mut crushed = Planes::zeros(layout.len());
        for step in 0..3 {
            crushed.x[0] = 1e-4 * step as f32;
            assert_eq!(neighbours.find(&crushed).len(), neighbours.max_pairs);
            // One particle more may have been compared with all others, and room grows by doubling.
            let room = neighbours.now.pairs.capacity();
            assert!(
                room <= 2 * (neighbours.max_pairs + grid.particle_count()),
                "{room}"
            );
        }
    }

    /// What a search finds, and in which order, has to follow from the positions alone.
    #[test]
    fn what_was_found_before_has_no_say() {
        let grid = Grid::new(21, 13, 0.00625).unwrap();
        let layout = Layout::new(grid, |particle| particle % 31 != 7);
        let fresh = Neighbours::new(&layout, 0.01125);
        let mut state = 1u32;
        let mut chance = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut positions = Planes::zeros(layout.len());
        for &slot in layout.slots() {
            // A cloth folded to a third, so that many touch.
            let along = layout.particle(slot as usize) % 21;
            let fold = [along % 14, 13 - along % 14][along / 7 % 2] as f32;
            let row = layout.particle(slot as usize) / 21;
            let at = [fold * 0.00625, row as f32 * 0.00625, along as f32 * 0.001];
            positions.set(slot as usize, at);
        }
        let mut neighbours = fresh.clone();
        let mut most = 0;
        for step in 0..120 {
            // Far away and back again, among them farther than there are cells.
            let reach_m = [0.0, 0.002, 0.02, 0.3, 4.0][step % 5];
            for &slot in layout.slots() {
                let slot = slot as usize;
                if chance() < 0.1 {
                    positions.x[slot] += reach_m * (chance() - 0.5);
                    positions.y[slot] -= reach_m * (chance() - 0.5);
                } else if step % 5 == 0 {
                    positions.x[slot] %= 0.15;
                    positions.y[slot] %= 0.15;
                }
            }
            let found = neighbours.find(&positions);
            assert!(found == fresh.clone().find(&positions), "step {step}");
            let mut found = found.to_vec();
            for pair in &mut found {
                pair.sort();
            }
            found.sort();
            assert!(found == in_touch(&layout, &positions), "step {step}");
            most = most.max(found.len());
        }
        assert!(most > 100, "{most} pairs are too few to test anything");
    }

    /// Returns the pairs in touch, by comparing every two particles.
    fn in_touch(layout: &Layout, positions: &Planes) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for (i, &a) in layout.slots().iter().enumerate() {
            for &b in &layout.slots()[i + 1..] {
                let [p, q] = [a, b].map(|slot| positions.get(slot as usize));
                let apart = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                let near = apart.iter().map(|d| d * d).sum::<f32>() < 0.01125 * 0.01125;
                let [p, q] = [a, b].map(|slot| layout.particle(slot as usize));
                let along = (p % 21).abs_diff(q % 21);
                if near && along.pow(2) + (p / 21).abs_diff(q / 21).pow(2) >= 4 {
                    pairs.push([a, b]);
                }
            }
        }
        pairs
    }
}

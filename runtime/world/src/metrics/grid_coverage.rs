//! Coverage as SoftGym measures it, number for number.
//!
//! In: particle positions, world frame, metres. Out: an area, or its part of the flat cloth's. Known flaws are
//! kept, since published results have them (protocol, section 5).

use crate::start::{Grid, Outline};

/// Cells along a side of the grid that coverage is counted on (SoftGym).
const CELLS: usize = 100;

/// Returns the area of the table that the cloth covers as SoftGym measures it, square metres.
///
/// The cloth's bounding box is cut into 100 x 100 cells, and each particle marks those within one spacing of it
/// (protocol, section 5). The result depends on how the cloth is turned: a flat one scores 0.95 of its area along
/// the axes and 1.06 across. `None` where there is no particle or a coordinate is not finite.
pub fn covered_area_m2(positions: &[[f32; 3]], spacing_m: f64) -> Option<f64> {
    if positions.is_empty() || !positions.iter().flatten().all(|value| value.is_finite()) {
        return None;
    }
    // SoftGym's second axis runs towards the front, and it counts in 32 bits: only this reproduces its numbers exactly.
    let along = |axis: usize| -> Vec<f32> {
        let sign = if axis == 0 { 1.0 } else { -1.0 };
        positions.iter().map(|point| sign * point[axis]).collect()
    };
    let (columns, column_m) = marked_cells(&along(0), spacing_m as f32);
    let (rows, row_m) = marked_cells(&along(1), spacing_m as f32);
    let mut marked = vec![false; CELLS * CELLS];
    for (columns, rows) in columns.into_iter().zip(rows) {
        for column in columns {
            for row in rows.clone() {
                // A particle on the far edge may begin at cell 100; SoftGym then runs over into the next column.
                marked[(column * CELLS + row).min(CELLS * CELLS - 1)] = true;
            }
        }
    }
    let n_marked = marked.iter().filter(|cell| **cell).count();
    Some(n_marked as f64 * f64::from(column_m) * f64::from(row_m))
}

/// Returns, for each particle, the cells that it marks along one axis, and the side of a cell, metres.
fn marked_cells(coordinates: &[f32], radius_m: f32) -> (Vec<std::ops::RangeInclusive<usize>>, f32) {
    let low = coordinates.iter().copied().fold(f32::INFINITY, f32::min);
    let high = coordinates
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max);
    let cell_m = (high - low) / CELLS as f32;
    let cells = coordinates
        .iter()
        .map(|coordinate| {
            let offset_m = coordinate - low;
            // Casts saturate, so a box without width is no special case: its area is zero whatever is marked.
            let cell = |edge_m: f32| (edge_m / cell_m).round_ties_even().max(0.0) as usize;
            let first = cell(offset_m - radius_m).min(CELLS);
            let end = cell(offset_m + radius_m).min(CELLS);
            // The end is not marked, unless it is also the beginning.
            first..=end.saturating_sub(1).max(first)
        })
        .collect();
    (cells, cell_m)
}

/// Returns the area that SoftGym takes for the flat cloth, square metres: one spacing longer than it is on each side.
pub fn flat_area_m2(grid: &Grid) -> f64 {
    // As the sum of its cells, in SoftGym's order of operations: the product of the sides differs in the last bit.
    let cell_m = |dim: u32| f64::from(dim) * grid.spacing_m / CELLS as f64;
    (CELLS * CELLS) as f64 * cell_m(grid.dimx) * cell_m(grid.dimy)
}

/// Returns the covered area over that of the flat cloth, as SoftGym measures both; it may exceed 1.
///
/// `None` where [`covered_area_m2`] is.
pub fn coverage(positions: &[[f32; 3]], grid: &Grid) -> Option<f64> {
    let flat_m2 = flat_area_m2(grid);
    let covered_m2 = covered_area_m2(positions, grid.spacing_m)?;
    (flat_m2 > 0.0).then(|| covered_m2 / flat_m2)
}

/// Returns the coverage of a cloth of which particles may be missing, by SoftGym's measure.
///
/// The flat area is what the measure gives for the cloth laid out flat, as SoftGym has it for whole ones; as there,
/// it is laid out one spacing longer on each side than it is. Without an outline this is [`coverage`].
///
/// - `positions`: `[dimy * dimx]`, grid order; those of missing particles are not read.
///
/// `None` where [`covered_area_m2`] is, where positions do not fill the grid, and where the outline misses all.
pub fn outlined_coverage(
    positions: &[[f32; 3]],
    grid: &Grid,
    outline: Option<&Outline>,
) -> Option<f64> {
    let Some(outline) = outline else {
        return coverage(positions, grid);
    };
    if positions.len() as u64 != u64::from(grid.dimx) * u64::from(grid.dimy) {
        return None;
    }
    let there = |index: &usize| outline.has(grid, *index);
    let indices: Vec<usize> = (0..positions.len()).filter(there).collect();
    let found: Vec<[f32; 3]> = indices.iter().map(|&index| positions[index]).collect();
    let covered_m2 = covered_area_m2(&found, grid.spacing_m)?;
    let flat_m2 = covered_area_m2(&laid_out(&indices, grid), grid.spacing_m)?;
    (flat_m2 > 0.0).then(|| covered_m2 / flat_m2)
}

/// Lays particles out flat as SoftGym does to measure the flat area: their box stretched by one spacing a side.
///
/// The box is that of the particles there are, so that missing rows and columns around them change nothing.
fn laid_out(indices: &[usize], grid: &Grid) -> Vec<[f32; 3]> {
    let dimx = grid.dimx as usize;
    let along = |place: &dyn Fn(usize) -> usize| -> Vec<f64> {
        let places = || indices.iter().map(|&index| place(index));
        let first = places().min().unwrap_or_default();
        let steps = (places().max().unwrap_or_default() - first).max(1) as f64;
        let pitch_m = (steps + 1.0) / steps * grid.spacing_m;
        let at = |place: usize| ((place - first) as f64 - 0.5 * steps) * pitch_m;
        places().map(at).collect()
    };
    let [xs, ys] = [along(&|index| index % dimx), along(&|index| index / dimx)];
    let points = xs.into_iter().zip(ys);
    points.map(|(x, y)| [x as f32, -y as f32, 0.0]).collect()
}

#[cfg(test)]
#[path = "tests/grid_coverage.rs"]
mod tests;

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
mod tests {
    use super::*;

    /// A flat cloth stretched by one spacing along each side, as SoftGym lays it to measure the flat area.
    fn laid_out_whole(grid: &Grid) -> Vec<[f32; 3]> {
        let at = |index: u32, dim: u32| {
            let side_m = f64::from(dim) * grid.spacing_m;
            (f64::from(index) / f64::from(dim - 1) - 0.5) * side_m
        };
        (0..grid.dimx * grid.dimy)
            .map(|index| {
                let (ix, iy) = (index % grid.dimx, index / grid.dimx);
                [at(ix, grid.dimx) as f32, -at(iy, grid.dimy) as f32, 0.005]
            })
            .collect()
    }

    fn grid(dimx: u32, dimy: u32) -> Grid {
        Grid {
            dimx,
            dimy,
            spacing_m: 0.00625,
        }
    }

    #[test]
    fn a_cloth_laid_out_over_its_flat_area_covers_all_of_it() {
        for (dimx, dimy) in [(2, 2), (3, 7), (40, 44), (42, 42), (59, 47), (101, 100)] {
            let grid = grid(dimx, dimy);
            let covered = coverage(&laid_out_whole(&grid), &grid).expect("a cloth");
            assert!((covered - 1.0).abs() < 1e-5, "{dimx} x {dimy}: {covered}");
        }
    }

    #[test]
    fn a_flat_cloth_scores_what_the_protocol_says_along_the_axes_and_across() {
        let grid = grid(42, 42);
        let flat = laid_out_whole(&grid)
            .iter()
            .map(|[x, y, z]| [x * 41.0 / 42.0, y * 41.0 / 42.0, *z])
            .collect::<Vec<_>>();
        let turned = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (sin, cos) = (sin as f32, cos as f32);
            let points: Vec<_> = flat
                .iter()
                .map(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, *z])
                .collect();
            coverage(&points, &grid).expect("a cloth")
        };
        for (degrees, expected) in [(0.0, 0.953), (2.0, 1.014), (5.0, 1.038), (45.0, 1.057)] {
            let covered = turned(degrees);
            assert!((covered - expected).abs() < 3e-3, "{degrees}: {covered}");
        }
    }

    #[test]
    fn what_is_no_cloth_covers_nothing_or_has_no_coverage() {
        let grid = grid(4, 4);
        assert_eq!(coverage(&[], &grid), None);
        assert_eq!(coverage(&[[0.0, f32::NAN, 0.0]; 16], &grid), None);
        assert_eq!(coverage(&[[0.1, 0.2, 0.0]; 16], &grid), Some(0.0));
        let line: Vec<_> = (0..16).map(|i| [i as f32 * 0.01, 0.0, 0.0]).collect();
        assert_eq!(coverage(&line, &grid), Some(0.0));
    }

    /// A flat cloth along the axes, unstretched, its missing particles far away.
    fn flat_with(grid: &Grid, outline: &Outline) -> Vec<[f32; 3]> {
        let dimx = grid.dimx as usize;
        (0..dimx * grid.dimy as usize)
            .map(|index| match outline.has(grid, index) {
                true => [(index % dimx) as f32, -((index / dimx) as f32), 0.8],
                false => [900.0, 900.0, 900.0],
            })
            .map(|point| point.map(|at| at * 0.00625))
            .collect()
    }

    #[test]
    fn a_full_outline_measures_as_none_does() {
        for (dimx, dimy) in [(2, 2), (3, 7), (40, 44), (59, 47)] {
            let grid = grid(dimx, dimy);
            let row = "#".repeat(dimx as usize) + "\n";
            let outline = Outline::new(&row.repeat(dimy as usize));
            for share in [1.0, 0.5] {
                let heap: Vec<_> = flat_with(&grid, &outline)
                    .into_iter()
                    .map(|[x, y, z]| [x * share, y, z])
                    .collect();
                let [whole, outlined] = [None, Some(&outline)]
                    .map(|it| outlined_coverage(&heap, &grid, it).expect("a cloth"));
                assert_eq!(Some(whole), coverage(&heap, &grid));
                assert!((whole - outlined).abs() < 1e-5, "{whole}, {outlined}");
            }
        }
    }

    #[test]
    fn missing_particles_and_margins_count_for_nothing() {
        // A block of 20 by 20 in a corner of 50 by 40; what is around it is missing.
        let block = "#".repeat(20) + &".".repeat(30) + "\n";
        let outline = Outline::new(&(block.repeat(20) + &(".".repeat(50) + "\n").repeat(20)));
        let wide = grid(50, 40);
        let covered = outlined_coverage(&flat_with(&wide, &outline), &wide, Some(&outline));
        let alone = coverage(
            &flat_with(
                &grid(20, 20),
                &Outline::new(&("#".repeat(20) + "\n").repeat(20)),
            ),
            &grid(20, 20),
        );
        let [covered, alone] = [covered, alone].map(Option::unwrap_or_default);
        assert!((covered - alone).abs() < 1e-5, "{covered}, alone {alone}");
    }

    #[test]
    fn what_has_no_particle_has_no_coverage() {
        let (grid, points) = (grid(2, 2), [[0.0; 3]; 4]);
        let none = Outline::new("..\n..\n");
        assert_eq!(outlined_coverage(&points, &grid, Some(&none)), None);
        let full = Outline::new("##\n##\n");
        assert_eq!(outlined_coverage(&points[1..], &grid, Some(&full)), None);
        assert_eq!(outlined_coverage(&points, &grid, Some(&full)), Some(0.0));
    }

    #[test]
    fn recorded_heaps_cover_what_was_recorded() {
        let Some(root) = crate::recorded::recorded_data("recorded_heaps_cover_what_was_recorded")
        else {
            return;
        };
        let text = std::fs::read_to_string(root.join("smoothing40/manifest.json")).expect("there");
        let manifest: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let states = manifest["states"].as_array().expect("a list");
        assert!(states.len() >= 20, "{} states", states.len());
        for state in states {
            let number = |name: &str| state[name].as_f64().expect("a number");
            let grid = grid(number("dimx") as u32, number("dimy") as u32);
            let path = root.join(state["pos"].as_str().expect("a path"));
            let frame = crate::start::StartFrame {
                grid,
                up: crate::start::Up::Y,
            };
            let start = crate::start::Start::load(&path, Some(frame)).expect("positions");
            // No tolerance: the same operations in the same order.
            assert_eq!(flat_area_m2(&grid), number("flatten_area_m2"), "{path:?}");
            let covered_m2 = covered_area_m2(&start.positions, grid.spacing_m);
            assert_eq!(covered_m2, Some(number("covered_area_m2")), "{path:?}");
            let covered = coverage(&start.positions, &grid);
            assert_eq!(covered, Some(number("initial_coverage")), "{path:?}");
        }
    }
}

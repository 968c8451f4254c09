//! Unit tests of `metrics::grid_coverage`.

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

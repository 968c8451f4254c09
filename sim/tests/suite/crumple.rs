//! Crumpled cloths: equal seeds, properties of a heap, interruption.

use fab_sim::{Grid, Look, Mask, Params, SimError, Simulator, TopDownCamera};
use std::cell::Cell;

fn flat(dim: usize) -> Simulator {
    Simulator::flat(Grid::new(dim, dim, 0.00625).unwrap(), &Params::default())
}

fn crumpled(dim: usize, seed: u64) -> Simulator {
    let mut cloth = flat(dim);
    cloth.crumple(seed, &|| false).unwrap();
    cloth
}

/// Returns the share of its own flat area that a cloth covers, seen from 10 m above.
fn coverage(cloth: &Simulator) -> f32 {
    let camera = TopDownCamera::new(10.0, 0.06, 512).unwrap();
    let frame = camera.render(cloth.grid(), &cloth.positions(), &Look::default());
    let pixels = frame.depth_m.iter().filter(|depth| **depth < 9.998).count();
    let side_m = (cloth.grid().dimx - 1) as f32 * cloth.grid().spacing_m;
    pixels as f32 * (10.0 / camera.focal_px()).powi(2) / (side_m * side_m)
}

/// Returns the length of every edge divided by its rest length.
fn stretches(cloth: &Simulator) -> Vec<f32> {
    let (grid, points) = (cloth.grid(), cloth.positions());
    let length = |a: usize, b: usize| {
        let square = |axis: usize| (points[a][axis] - points[b][axis]).powi(2);
        (square(0) + square(1) + square(2)).sqrt() / grid.spacing_m
    };
    (0..points.len())
        .flat_map(|index| {
            let right = (index % grid.dimx + 1 < grid.dimx).then_some(index + 1);
            let front = (index + grid.dimx < points.len()).then_some(index + grid.dimx);
            right
                .into_iter()
                .chain(front)
                .map(move |other| (index, other))
        })
        .map(|(index, other)| length(index, other))
        .collect()
}

/// Checks the properties of a heap, and returns its coverage.
fn check_heap(cloth: &Simulator, name: &str) -> f32 {
    let points = cloth.positions();
    for point in &points {
        assert!(point.iter().all(|value| value.is_finite()), "{name}");
        assert!(point[2] >= 0.0, "{name}: {point:?} is under the table");
    }
    for axis in [0, 1] {
        let mean = points.iter().map(|p| p[axis]).sum::<f32>() / points.len() as f32;
        assert!(mean.abs() < 0.001, "{name}: {mean} m off the centre");
    }
    let stretches = stretches(cloth);
    let mean = stretches.iter().sum::<f32>() / stretches.len() as f32;
    assert!((0.99..1.03).contains(&mean), "{name}: mean stretch {mean}");
    // Recorded heaps also have single edges of up to 1.9.
    let long = stretches.iter().filter(|&&stretch| stretch > 1.2).count();
    assert!(100 * long < stretches.len(), "{name}: {long} long edges");
    assert!(Simulator::from_positions(cloth.grid(), &points, &Params::default()).is_ok());
    coverage(cloth)
}

#[test]
fn a_flat_cloth_covers_its_area_as_these_tests_measure_it() {
    let covered = coverage(&flat(41));
    assert!((covered - 1.0).abs() < 0.02, "{covered}");
}

#[test]
fn equal_seeds_give_equal_heaps_and_others_give_others() {
    let [one, same, other] = [3, 3, 4].map(|seed| crumpled(24, seed));
    assert_eq!(one.digest(), same.digest());
    assert_ne!(one.digest(), other.digest());
    for (cloth, name) in [(&one, "3"), (&other, "4")] {
        let covered = check_heap(cloth, name);
        // A cloth this small may fall open again.
        assert!((0.25..1.05).contains(&covered), "{name} covers {covered}");
    }
}

#[test]
fn a_heap_goes_on_as_one_that_was_started_from_its_positions() {
    let mut heap = crumpled(16, 5);
    assert_eq!(heap.steps(), 0);
    let grid = heap.grid();
    let mut copy = Simulator::from_positions(grid, &heap.positions(), &Params::default()).unwrap();
    for cloth in [&mut heap, &mut copy] {
        cloth
            .pick_and_place([0.02, 0.0], [0.0, 0.05], &|| false)
            .unwrap();
    }
    assert_eq!(heap.digest(), copy.digest());
}

#[test]
fn a_refused_heap_is_lifted_again_from_where_it_lies() {
    let asked = Cell::new(0);
    let third = |_: &[[f32; 3]]| asked.replace(asked.get() + 1) == 2;
    let mut cloth = flat(12);
    let done = cloth.crumple_until(9, 20, &third, &|| false).unwrap();
    assert_eq!([done.lifts.len(), asked.get()], [3, 3]);
    assert_ne!(done.lifts[0], done.lifts[1]);
    let mut once = flat(12);
    let first = once.crumple(9, &|| false).unwrap();
    assert_eq!(first.lifts, done.lifts[..1]);
    assert!(first.steps < done.steps);
    assert_ne!(once.digest(), cloth.digest());
    check_heap(&cloth, "the third");
}

#[test]
fn a_cloth_of_which_no_heap_is_taken_keeps_the_last() {
    for (most, lifts) in [(0, 1), (1, 1), (2, 2)] {
        let mut cloth = flat(12);
        let done = cloth.crumple_until(9, most, &|_| false, &|| false).unwrap();
        assert_eq!(done.lifts.len(), lifts);
        check_heap(&cloth, "the last");
    }
}

#[test]
fn the_lifted_particle_rises_by_the_height_that_is_told() {
    let mut cloth = flat(12);
    let highest = Cell::new(0);
    let lifted = cloth.clone().crumple(9, &|| false).unwrap().lifts[0];
    // Stopped while it hangs.
    let stop = || highest.replace(highest.get() + 1) >= 12;
    let rises = (lifted.height_m / 0.1).ceil() as u32;
    assert!(rises <= 12 && lifted.height_m >= 0.5, "{lifted:?}");
    cloth.crumple(9, &stop).unwrap_err();
    let z_m = cloth.positions()[lifted.particle][2];
    let expected_m = Params::default().table_contact_m + lifted.height_m;
    assert!((z_m - expected_m).abs() < 1e-4, "{z_m} of {expected_m}");
}

#[test]
fn a_cloth_with_a_hole_is_crumpled_onto_the_centre() {
    let grid = Grid::new(16, 16, 0.00625).unwrap();
    let hole = |ix: usize, iy: usize| !((2..8).contains(&ix) && (2..8).contains(&iy));
    let mask = Mask::from_fn(grid, hole).unwrap();
    for seed in 0..4 {
        let mut cloth = Simulator::flat(&mask, &Params::default());
        let done = cloth.crumple(seed, &|| false).unwrap();
        assert!(mask.has(done.lifts[0].particle), "{done:?}");
        for axis in [0, 1] {
            let sum: f32 = cloth.positions().iter().map(|point| point[axis]).sum();
            assert!((sum / mask.count() as f32).abs() < 1e-4, "{sum}");
        }
    }
}

#[test]
fn an_interrupted_crumpling_ends_at_once_and_lets_go() {
    // During the lift, while hanging, and while coming to rest.
    for stop in [0, 5, 60, 320] {
        let mut cloth = flat(12);
        let asked = Cell::new(0);
        let interrupted = || asked.replace(asked.get() + 1) >= stop;
        match cloth.crumple(1, &interrupted) {
            Err(error) => assert_eq!(error, SimError::Interrupted { steps: stop }),
            Ok(done) => assert!(done.steps <= stop, "went on after {stop}: {done:?}"),
        }
        cloth.settle(300).unwrap();
        let highest = cloth
            .positions()
            .iter()
            .fold(0.0, |high: f32, p| high.max(p[2]));
        assert!(highest < 0.06, "still held after {stop}: {highest}");
    }
}

#[test]
#[ignore = "long"]
fn ten_heaps_cover_as_much_as_recorded_ones() {
    let mut sum = 0.0;
    for seed in 0..10 {
        let covered = check_heap(&crumpled(41, seed), &seed.to_string());
        println!("seed {seed} covers {covered:.3}");
        assert!((0.3..0.85).contains(&covered), "{seed} covers {covered}");
        sum += covered;
    }
    // Recorded: 0.33 to 0.63, mean 0.45, by a measure that adds a few hundredths.
    assert!((0.35..0.55).contains(&(sum / 10.0)), "mean {}", sum / 10.0);
}

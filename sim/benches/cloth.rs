//! Times the cloth; compare figures only within one run.
//!
//! `fold_resting_skipped` against `fold_every_step` shows what skipping the steps of a resting cloth saves.
//! `step_flat` is one computed step of a cloth that lies flat. `diagonal_fold_by_size` is the fold of
//! `fabc sim time`. Its items are particles times steps, so equal items per second at all sizes mean that the cost is
//! proportional to the particles. `diagonal_fold_side_by_side` folds one cloth on each thread: its items per second
//! with two threads, divided by those with one, show how well two rollouts run at the same time.

use divan::{Bencher, black_box, counter::ItemsCount};
use fab_sim::{
    Aim, Directions, Grid, Look, Manner, Material, Params, RestShortcut, Simulator, TopDownCamera,
    diagonal_fold,
};

fn main() {
    divan::main();
}

/// A flat cloth of the size in the paper's folds.
fn cloth(shortcut: RestShortcut) -> Simulator {
    let grid = Grid::new(55, 55, 0.00625).expect("55 by 55 particles are within bounds");
    let mut cloth = Simulator::flat(grid, &Params::default());
    cloth.set_rest_shortcut(shortcut);
    cloth
}

/// Folds one corner onto the opposite one.
fn fold(mut cloth: Simulator) -> Simulator {
    let positions = cloth.positions();
    let (from, to) = (positions[0], positions[positions.len() - 1]);
    cloth
        .pick_and_place([from[0], from[1]], [to[0], to[1]], &|| false)
        .expect("a fold within reach");
    cloth
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn fold_resting_skipped(bencher: Bencher) {
    bencher
        .with_inputs(|| cloth(RestShortcut::Skip))
        .bench_values(fold);
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn fold_every_step(bencher: Bencher) {
    bencher
        .with_inputs(|| cloth(RestShortcut::Compute))
        .bench_values(fold);
}

/// Folds a square cloth by hand, every step computed.
fn fold_square(dim: usize) -> Simulator {
    let grid = Grid::new(dim, dim, 0.00625).expect("at most 200 particles along a side");
    diagonal_fold(grid, &Params::default(), &|| false).expect("a fold within reach")
}

/// A shirting, as in `tasks/lib/materials.fab`.
fn cotton() -> Params {
    let material = Material {
        weight_kg_m2: 0.167,
        thickness_m: 0.000_35,
        bending_length_m: Directions {
            warp: 0.018,
            weft: 0.016,
            bias: 0.016,
        },
        crease_recovery_deg: 75.0,
        stretch: Directions {
            warp: 0.015,
            weft: 0.025,
            bias: 0.06,
        },
        table_friction: 0.27,
        self_friction: 0.6,
    };
    Params {
        material: Some(material),
        ..Params::default()
    }
}

/// The same fold of a measured material; compare with `diagonal_fold_by_size`.
#[divan::bench(args = [25, 50, 100, 200], sample_count = 1, sample_size = 1)]
fn cotton_fold_by_size(bencher: Bencher, dim: usize) {
    bencher.counter(particle_steps(dim)).bench(|| {
        let grid =
            Grid::new(black_box(dim), dim, 0.00625).expect("at most 200 particles along a side");
        diagonal_fold(grid, &cotton(), &|| false).expect("a fold within reach")
    });
}

#[divan::bench(threads = [1, 2], sample_count = 2, sample_size = 1)]
fn cotton_fold_side_by_side(bencher: Bencher) {
    let grid = Grid::new(50, 50, 0.00625).expect("50 particles are within bounds");
    bencher
        .counter(particle_steps(50))
        .bench(|| diagonal_fold(grid, &cotton(), &|| false).expect("a fold within reach"));
}

/// A whole crumple, in which everything moves: about 900 steps of the recorded scene's cloth, and of cotton.
#[divan::bench(args = ["pyflex", "cotton"], sample_count = 1, sample_size = 1)]
fn crumple_50(bencher: Bencher, cloth: &str) {
    let grid = Grid::new(50, 50, 0.00625).expect("50 particles are within bounds");
    let params = if cloth == "cotton" {
        cotton()
    } else {
        Params::default()
    };
    bencher.bench(|| {
        let mut cloth = Simulator::flat(grid, &params);
        cloth
            .crumple(3, &|| false)
            .expect("a cloth stays finite")
            .steps
    });
}

/// Pulls of a crumpled cloth of 40 by 40 particles as a smoothing search tries them: 4 picks, 8 directions each, with
/// every motion computed whole, or with those that share a pick computed from one lift. Its items are pulls.
#[divan::bench(args = ["whole", "shared lift"], sample_count = 1, sample_size = 1)]
fn pulls_40(bencher: Bencher, how: &str) {
    let grid = Grid::new(40, 40, 0.00625).expect("40 particles are within bounds");
    let mut heap = Simulator::flat(grid, &Params::default());
    heap.crumple(3, &|| false).expect("a cloth stays finite");
    let params = Params::with_dropping_picker();
    let mut cloth = Simulator::from_positions(grid, &heap.positions(), &params)
        .expect("a crumpled cloth is a start");
    cloth.set_aim(Aim::Uppermost);
    let points = cloth.positions();
    let picks = [0, 39, 40 * 39, 40 * 40 - 1].map(|particle: usize| points[particle]);
    let sides = [[1.0, 0.0], [0.7, 0.7], [0.0, 1.0], [-0.7, 0.7]];
    let directions: Vec<[f32; 2]> = sides
        .into_iter()
        .flat_map(|[x, y]| [[x, y], [-x, -y]])
        .collect();
    let place = |pick: [f32; 3], [x, y]: [f32; 2]| [pick[0] + 0.12 * x, pick[1] + 0.12 * y];
    let manner = Manner::default();
    bencher
        .counter(ItemsCount::new(picks.len() * directions.len()))
        .bench(|| {
            for pick in picks {
                let at = [pick[0], pick[1]];
                let lifted = cloth.lift(&manner, at, &|| false);
                let lifted = lifted.expect("a pick within reach");
                for direction in &directions {
                    let place = place(pick, *direction);
                    if how == "whole" {
                        let mut whole = cloth.clone();
                        let done = whole.pick_and_place(at, place, &|| false);
                        black_box(done.expect("a pull within reach"));
                    } else {
                        black_box(lifted.place(place, &|| false).expect("a pull within reach"));
                    }
                }
            }
        });
}

/// Counts the particles of all steps of a fold.
///
/// The number of steps is known only from running `diagonal_fold`.
fn particle_steps(dim: usize) -> ItemsCount {
    let side_m = (dim - 1) as f64 * 0.00625;
    let steps = 70.0 + (side_m * std::f64::consts::SQRT_2 / 0.005).ceil();
    ItemsCount::new(dim * dim * steps as usize)
}

#[divan::bench(args = [25, 50, 100, 200], sample_count = 1, sample_size = 1)]
fn diagonal_fold_by_size(bencher: Bencher, dim: usize) {
    bencher
        .counter(particle_steps(dim))
        .bench(|| fold_square(black_box(dim)));
}

#[divan::bench(threads = [1, 2], sample_count = 4, sample_size = 1)]
fn diagonal_fold_side_by_side(bencher: Bencher) {
    bencher
        .counter(particle_steps(50))
        .bench(|| fold_square(black_box(50)));
}

#[divan::bench(sample_count = 50, sample_size = 1)]
fn step_flat(bencher: Bencher) {
    let mut cloth = cloth(RestShortcut::Compute);
    bencher.bench_local(|| {
        black_box(&mut cloth)
            .step()
            .expect("a flat cloth stays finite")
    });
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn picture_224_px(bencher: Bencher) {
    let folded = fold(cloth(RestShortcut::Skip));
    let camera = TopDownCamera::new(0.65, std::f32::consts::FRAC_PI_4, 224)
        .expect("the paper's camera is within bounds");
    let (grid, positions, look) = (folded.grid(), folded.positions(), Look::default());
    bencher.bench(|| camera.render(grid, black_box(&positions), &look));
}

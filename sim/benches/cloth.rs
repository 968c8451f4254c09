//! Speed of the cloth, as figures that are compared within one run.
//!
//! `fold_resting_skipped` against `fold_every_step` is the gain of skipping steps of a cloth at rest;
//! `step_flat` is one step of a cloth that lies flat and is computed all the same.

use divan::{Bencher, black_box};
use sim::{Grid, Look, Params, RestShortcut, Simulator, TopDownCamera};

fn main() {
    divan::main();
}

/// A flat cloth of the size that the paper's folds have.
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

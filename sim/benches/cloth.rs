//! Times the cloth; compare figures only within one run.
//!
//! First, it prints the CPU time of a step of each cloth of `cloths`, and how many times that of the recorded scene's
//! cloth it is: in a fold, in which half of the cloth rests, and in a crumple, in which everything moves. Then that of a
//! fold by size; equal times of a particle at all sizes mean that the cost is proportional to the particles.
//! `fold_resting_skipped` against `fold_every_step` shows what skipping the steps of a resting cloth saves.
//! `step_flat` is one computed step of a cloth that lies flat. `fold_side_by_side` folds one cloth on each thread: its items
//! (particles times steps) per second with two threads, divided by those with one, show how well two rollouts run at the
//! same time.

mod cloths;

use cloths::CLOTHS;
use divan::{Bencher, black_box, counter::ItemsCount};
use fab_sim::{Aim, Grid, Look, Params, RestShortcut, Simulator, TopDownCamera, diagonal_fold};
use std::time::{Duration, Instant};

fn main() {
    // Not if they are only listed or filtered.
    if std::env::args()
        .skip(1)
        .all(|argument| argument == "--bench")
    {
        compare_cloths();
        compare_sizes();
    }
    divan::main();
}

/// Rounds in which the cloths take turns, so that all meet the same load; the least time counts.
const ROUNDS: usize = 3;

/// Prints a step of a fold and of a crumple of 50 by 50 particles, of every cloth.
fn compare_cloths() {
    let mut least = [[f64::INFINITY; 2]; CLOTHS.len()];
    for _ in 0..ROUNDS {
        for (cloth, least) in CLOTHS.into_iter().zip(&mut least) {
            let params = params(cloth);
            let folds = || fold_square(50, &params).steps();
            let crumples = || {
                let crumpled = Simulator::flat(square(50), &params).crumple(3, &|| false);
                u64::from(crumpled.expect("a cloth stays finite").steps)
            };
            *least = [
                least[0].min(step_ms(folds)),
                least[1].min(step_ms(crumples)),
            ];
        }
    }
    println!("a step of 50 by 50 particles, CPU time (least of {ROUNDS} rounds)");
    for (cloth, ms) in CLOTHS.into_iter().zip(least) {
        let [fold, crumple] = [0, 1].map(|scene| ms[scene] / least[0][scene]);
        println!(
            "{cloth:8} fold {:.2} ms, {fold:.1} times pyflex   crumple {:.2} ms, {crumple:.1} times",
            ms[0], ms[1]
        );
    }
    println!();
}

/// Prints a step of a fold of the recorded scene's cloth and of cotton, by size.
fn compare_sizes() {
    println!("a step of a fold by size, CPU time of a particle");
    for dim in [25, 50, 100, 200] {
        let [pyflex, cotton] = ["pyflex", "cotton"].map(|cloth| {
            let params = params(cloth);
            1e6 * step_ms(|| fold_square(dim, &params).steps()) / (dim * dim) as f64
        });
        println!(
            "{dim:3} a side   pyflex {pyflex:4.0} ns   cotton {cotton:4.0} ns, {:.1} times",
            cotton / pyflex
        );
    }
    println!();
}

/// Returns the CPU time, ms, of each of the steps that a run says it took.
fn step_ms(run: impl Fn() -> u64) -> f64 {
    let before = cpu_time();
    let steps = run();
    1e3 * (cpu_time() - before).as_secs_f64() / steps as f64
}

/// Returns this process's CPU time; where the system has no `/proc`, the time on the wall.
fn cpu_time() -> Duration {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let start = START.get_or_init(Instant::now);
    std::fs::read_to_string("/proc/self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .map_or_else(|| start.elapsed(), Duration::from_nanos)
}

fn params(cloth: &str) -> Params {
    cloths::params(cloth).expect("a name from the list of cloths")
}

fn square(dim: usize) -> Grid {
    Grid::new(dim, dim, 0.00625).expect("at most 200 particles along a side")
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

/// Folds a square cloth by hand, every step computed, as `fabc sim time` does.
fn fold_square(dim: usize, params: &Params) -> Simulator {
    diagonal_fold(square(dim), params, &|| false).expect("a fold within reach")
}

/// Pulls of a crumpled cloth of 40 by 40 particles as a smoothing search tries them: 4 picks, 8 directions each, on one
/// thread or two side by side. Its items are pulls of one thread. Contacts bound it (record 0089).
#[divan::bench(threads = [1, 2], sample_count = 1, sample_size = 1)]
fn pulls_40(bencher: Bencher) {
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
    bencher
        .counter(ItemsCount::new(picks.len() * directions.len()))
        .bench(|| {
            for pick in picks {
                let at = [pick[0], pick[1]];
                for direction in &directions {
                    let mut cloth = cloth.clone();
                    let done = cloth.pick_and_place(at, place(pick, *direction), &|| false);
                    black_box(done.expect("a pull within reach"));
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

#[divan::bench(args = ["pyflex", "cotton"], threads = [1, 2], sample_count = 4, sample_size = 1)]
fn fold_side_by_side(bencher: Bencher, cloth: &str) {
    let params = params(cloth);
    bencher
        .counter(particle_steps(50))
        .bench(|| fold_square(black_box(50), &params));
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

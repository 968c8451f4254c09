//! Recorded Double Straight starts, folded by the stand-in and compared with the recorded ends.

use super::support::{self, recorded_data};
use runtime::agent::Models;
use runtime::cache::Cache;
use runtime::interrupt::Interrupt;
use runtime::journal::RunFolder;
use runtime::metrics::mean_particle_distance_m;
use runtime::model::Geometric;
use runtime::outcome::Outcome;
use runtime::rollout::{self, Job};
use runtime::start::Start;
use runtime::subgoals::SubgoalSet;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

/// Distance to the recorded end below which a fold counts as the recorded one, millimetres; an
/// untouched cloth is 117 to 147 away.
const LIMIT_MM: f64 = 60.0;
/// Rotations 0 and 45 degrees, sizes from the smallest to the largest.
const IDS: [u32; 10] = [0, 2, 8, 10, 16, 18, 24, 26, 36, 38];
/// The other recorded ids of this split.
const MORE_IDS: [u32; 10] = [4, 6, 12, 14, 20, 22, 28, 30, 32, 34];

/// Folds one recorded start and returns the distance to the recorded end, millimetres.
fn fold(entry: &Path) -> f64 {
    let mut program = support::task("double_straight");
    program.experts.clear();
    let start = Start::load(&entry.join("init_pos.npy"), None).unwrap();
    let recorded = Start::load(&entry.join("final_pos.npy"), None).unwrap();
    let make_world = || support::world(&program);
    let interrupt = Interrupt::default();
    let mut world = make_world().unwrap();
    let subgoals = SubgoalSet::obtain(&program, &support::root().join("tasks"), world.as_mut(), &interrupt).unwrap();
    let job = Job {
        program: &program,
        start: &start,
        subgoals: &subgoals,
        models: Models { vision: &Geometric, text: &Geometric },
        make_world: &make_world,
        cache: &Cache::none(),
        interrupt: &interrupt,
    };
    let folder = tempfile::tempdir().unwrap();
    let report = rollout::run(&job, RunFolder::create(&folder.path().join("run")).unwrap(), &mut |_| {}).unwrap();
    assert_eq!(report.outcome, Outcome::HorizonReached, "{}", entry.display());
    let end = Start::load(&folder.path().join("run/step_3/positions.npy"), Some(runtime::start::StartFrame { grid: start.grid, up: runtime::start::Up::Z }));
    mean_particle_distance_m(&end.unwrap().positions, &recorded.positions).unwrap() * 1000.0
}

fn fold_all(data: &Path, ids: &[u32]) {
    let next = AtomicUsize::new(0);
    let distances = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(id) = ids.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let distance = fold(&data.join(format!("folding120/dev/DoubleStraight/{id:02}")));
                    eprintln!("start {id:02}: {distance:.1} mm from the recorded end");
                    distances.lock().unwrap().push((*id, distance));
                }
            });
        }
    });
    let distances = distances.into_inner().unwrap();
    assert_eq!(distances.len(), ids.len());
    let missed: Vec<_> = distances.iter().filter(|(_, distance)| *distance > LIMIT_MM).collect();
    assert!(missed.is_empty(), "further than {LIMIT_MM} mm from the recorded end: {missed:.1?} of {distances:.1?}");
}

#[test]
fn ten_recorded_starts_end_where_the_recorded_expert_ended() {
    let Some(data) = recorded_data("ten_recorded_starts_end_where_the_recorded_expert_ended") else { return };
    fold_all(&data, &IDS);
}

#[test]
#[ignore = "long: another ten rollouts"]
fn long_the_other_recorded_starts_end_there_too() {
    let Some(data) = recorded_data("long_the_other_recorded_starts_end_there_too") else { return };
    fold_all(&data, &MORE_IDS);
}

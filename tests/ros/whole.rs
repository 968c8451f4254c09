//! The whole loop over ROS: pictures from topics, a calibration with an unknown error, goals to actionlib's servers,
//! and a folded cloth at the end.

use super::lab::{Lab, cache_folder, project};
use super::nodes::Driver;
use super::touching::{Touching, calibrate};
use fab_arm::journal::run_state;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_compiler::{LoadError, Loader};
use fab_program::Program;
use fab_world::expert::Sequences;
use fab_world::start::Start;
use fab_world::{SimulatedWorld, World, WorldError};
use fab_world::{expert, metrics};

/// Largest distance of the cloth from the nearest expert's, metres: twice the 6 to 12 mm found over eight cameras; it
/// varies between runs with the timing of messages.
const DISTANCE_M: f64 = 0.025;

struct Files;

impl Loader for Files {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(project(name)).map_err(|error| LoadError {
            message: error.to_string(),
        })
    }
}

/// Returns the distance of a cloth from the nearest expert's, metres, as a simulated run's report computes it.
fn distance_m(program: &Program, particles: &[[f32; 3]]) -> f64 {
    let make_world =
        || -> Result<Box<dyn World>, WorldError> { Ok(Box::new(SimulatedWorld::of(program)?)) };
    let ends = expert::ends(
        Sequences {
            folds: &program.experts,
            manner: program.manner,
        },
        &Start::flat(&program.cloth),
        &make_world,
        &Cache::at(cache_folder().join("experts")),
        &Interrupt::default(),
        &mut |_| {},
    );
    let ends = ends.unwrap().ends.into_iter();
    let distances =
        ends.map(|end| metrics::mean_particle_distance_m(particles, &end.positions).unwrap());
    distances.fold(f64::INFINITY, f64::min)
}

/// Calibrates the camera, runs a Double Triangle fold, and compares the cloth with the nearest expert's.
pub fn folds_a_double_triangle(driver: Driver, seed: u64) {
    let mut lab = Lab::new(driver, seed);
    calibrate(&mut lab, Touching::Driven);
    lab.lay();
    let run = lab.run();
    let folder = run.folder.clone();
    let ended = run.end();
    assert_eq!(ended.code, Some(0), "{ended:#?}");
    // A real arm knows no particles, so the goal is not judged.
    assert_eq!(ended.report["outcome"], "horizon_reached");
    assert!(ended.report["goal_reached"].is_null());
    assert_eq!(ended.report["steps"], 2);
    assert!(run_state(&folder).unwrap().is_clear());

    let compiled = fab_compiler::compile("tasks/real/double_triangle.fab", &Files).unwrap();
    let truth = lab.truth();
    let distance_m = distance_m(&compiled.programs[0], &truth.particles_m);
    println!(
        "{driver:?}, seed {seed}: mean particle distance {:.1} mm; wall {:.1} s",
        distance_m * 1000.0,
        ended.report["wall_s"].as_f64().unwrap()
    );
    assert!(distance_m < DISTANCE_M, "{distance_m}");
    assert!(!truth.is_stopped);
}

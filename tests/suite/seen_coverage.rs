//! Coverage of a cloth whose particles are unknown: measured in pictures, relative to one of the flat cloth.

use super::support;
use fab_agent::examples::Examples;
use fab_agent::journal::RunFolder;
use fab_agent::outcome::Outcome;
use fab_agent::policy::Prompted;
use fab_agent::record::CoverageSource;
use fab_agent::record::RECORD_FILE;
use fab_agent::rollout;
use fab_agent::rollout::{Ended, Job, RunError};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::Budget;
use fab_picture::observation::Observation;
use fab_program::{Comparison, Goal, Metric, Program};
use fab_standins::Geometric;
use fab_world::start::Start;
use fab_world::{Executed, Motion, SimulatedWorld, World, WorldError, Wrapper};

/// The simulator's world with a camera only: it does not reveal particles.
pub(super) struct Blind {
    pub world: SimulatedWorld,
    pub flat: Option<Observation>,
}

impl Wrapper for Blind {
    fn inner(&self) -> &dyn World {
        &self.world
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.world
    }

    fn name(&self) -> &str {
        "blind"
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        None
    }

    fn flat_cloth(&self) -> Option<Observation> {
        self.flat.clone()
    }
}

/// The picture of a flat cloth with this many particles per side.
pub(super) fn flat(program: &Program, side: u32) -> Observation {
    let mut program = program.clone();
    (program.cloth.dimx, program.cloth.dimy) = (side, side);
    let mut world = support::world(&program).unwrap();
    world.reset(&Start::flat(&program.cloth)).unwrap();
    world.observe().unwrap()
}

fn with_goal(metric: Metric, limit: f64) -> Program {
    Program {
        goal: Some(Goal {
            metric,
            is: Comparison::Greater,
            limit,
        }),
        ..support::small_task()
    }
}

/// Runs the task's first step with the stand-in, and returns its report and its journal.
fn play(program: &Program, flat: Option<Observation>) -> Result<(Ended, String), RunError> {
    play_in(program, &|| {
        Ok(Box::new(Blind {
            world: SimulatedWorld::new(&program.camera, program.picker)?,
            flat: flat.clone(),
        }))
    })
}

fn play_in(
    program: &Program,
    make_world: &(dyn Fn() -> Result<Box<dyn World>, WorldError> + Sync),
) -> Result<(Ended, String), RunError> {
    let steps = program.subgoals.as_ref().map_or(0, |it| it.steps());
    let folder = tempfile::tempdir().unwrap();
    let subgoals = SubgoalSet::obtain(
        program,
        &support::root().join("tasks"),
        support::world(program).unwrap().as_mut(),
        &Interrupt::default(),
    );
    let job = Job {
        program,
        start: &Start::flat(&program.cloth),
        subgoals: &subgoals.unwrap_or(SubgoalSet {
            pictures: vec![image::RgbImage::new(32, 32); steps + 1],
            arrows: vec![None; steps],
            origin: Origin::Author,
            ..SubgoalSet::default()
        }),
        examples: &Examples::default(),
        make_policy: &Prompted::new(Models {
            vision: &Geometric,
            text: &Geometric,
        }),
        budget: &Budget::default(),
        make_world,
        make_expert_world: make_world,
        cache: &Cache::none(),
        interrupt: &Interrupt::default(),
        horizon: Some(1),
        early_stop: true,
        operator: None,
        repetition: 0,
        start_number: None,
    };
    let run = folder.path().join("run");
    let report = rollout::run(&job, RunFolder::create(&run).unwrap(), &mut |_| {})?;
    Ok((
        report,
        std::fs::read_to_string(run.join(RECORD_FILE)).unwrap(),
    ))
}

/// A world that shows its particles until it has acted.
struct Fading(SimulatedWorld, bool);

impl Wrapper for Fading {
    fn inner(&self) -> &dyn World {
        &self.0
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.0
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        self.1 = true;
        self.0.act(motion, interrupt)
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        self.0.particles().filter(|_| !self.1)
    }
}

#[test]
fn coverage_is_unknown_once_a_world_stops_giving_particles() {
    let program = with_goal(Metric::Coverage, 0.4);
    let make_world = || {
        let world = SimulatedWorld::new(&program.camera, program.picker)?;
        Ok(Box::new(Fading(world, false)) as Box<dyn World>)
    };
    let (ended, _) = play_in(&program, &make_world).unwrap();
    assert_eq!(ended.steps, 1, "{:?}", ended.stopped);
    assert!(ended.coverage_at_start.is_some());
    assert_eq!(ended.measures.coverage, None);
}

#[test]
fn a_picture_measures_nearly_what_the_particles_do() {
    let program = with_goal(Metric::Coverage, 0.4);
    let (report, journal) = play(&program, Some(flat(&program, 28))).unwrap();
    assert_eq!(report.coverage_source, Some(CoverageSource::Picture));
    assert_eq!(report.coverage_at_start, Some(1.0));
    assert_eq!(report.outcome, Outcome::GoalReached);
    assert_eq!(report.goal_reached, Some(true));
    let seen = report.measures.coverage.unwrap();
    // Half of a square that is folded corner to corner; the fold is 10 mm nearer to the camera.
    assert!((0.45..0.60).contains(&seen), "{seen}");
    assert_eq!(
        (
            report.measures.coverage_true,
            report.measures.normalized_improvement
        ),
        (None, None),
        "nothing was missing at first"
    );
    assert!(journal.contains(r#""coverage_source":"picture""#));

    let folder = tempfile::tempdir().unwrap();
    let trial = support::Trial::new(&program, &support::root().join("tasks"), Default::default());
    let known = trial.run_stand_in(&folder.path().join("run"));
    assert_eq!(known.coverage_source, Some(CoverageSource::Particles));
    let of_particles = known.measures.coverage_true.unwrap();
    assert!(
        (seen - of_particles).abs() < 0.05,
        "{seen} and {of_particles}"
    );
}

#[test]
fn improvement_counts_from_the_first_picture_to_the_flat_cloth() {
    let program = with_goal(Metric::NormalizedImprovement, 0.9);
    let (report, _) = play(&program, Some(flat(&program, 40))).unwrap();
    let (first, last) = (
        report.coverage_at_start.unwrap(),
        report.measures.coverage.unwrap(),
    );
    assert!((first - (27.0_f64 / 39.0).powi(2)).abs() < 0.02, "{first}");
    let gained = (last - first) / (1.0 - first);
    assert!((report.measures.normalized_improvement.unwrap() - gained).abs() < 1e-12);
    assert_eq!(report.goal_reached, Some(false));
}

#[test]
fn a_goal_that_nothing_can_be_measured_for_is_refused_before_anything_moves() {
    let program = with_goal(Metric::Coverage, 0.4);
    let message = play(&program, None).unwrap_err().to_string();
    assert!(message.contains("`blind` knows neither"), "{message}");
}

#[test]
fn a_distance_between_particles_that_nobody_knows_is_not_judged() {
    let program = with_goal(Metric::ParticleDistance, 0.04);
    let (report, _) = play(&program, None).unwrap();
    assert_eq!(report.outcome, Outcome::HorizonReached);
    assert_eq!((report.goal_reached, report.coverage_source), (None, None));
}

#[test]
fn a_picture_of_something_else_is_refused() {
    let program = with_goal(Metric::Coverage, 0.4);
    let mut small = flat(&program, 28);
    small.rgb = image::RgbImage::new(100, 224);
    let message = play(&program, Some(small)).unwrap_err().to_string();
    assert!(
        message.contains("it has 100 x 224 px, and the camera takes 224 x 224 px"),
        "{message}"
    );
    let mut empty = flat(&program, 28);
    empty.depth_m.fill(0.0);
    let message = play(&program, Some(empty)).unwrap_err().to_string();
    assert!(message.contains("must find the cloth"), "{message}");
}

/// A world that can be seen no more once the cloth was moved.
struct Blinded {
    world: SimulatedWorld,
    program: Program,
}

impl Wrapper for Blinded {
    fn inner(&self) -> &dyn World {
        &self.world
    }

    fn inner_mut(&mut self) -> &mut dyn World {
        &mut self.world
    }

    fn act(&mut self, motion: &Motion, interrupt: &Interrupt) -> Result<Executed, WorldError> {
        let done = self.world.act(motion, interrupt)?;
        self.world = SimulatedWorld::new(&self.program.camera, self.program.picker)?;
        Ok(done)
    }

    fn particles(&self) -> Option<Vec<[f32; 3]>> {
        None
    }
}

#[test]
fn an_action_is_kept_although_nothing_can_be_seen_of_it() {
    let program = support::small_task();
    let (report, journal) = play_in(&program, &|| {
        Ok(Box::new(Blinded {
            world: SimulatedWorld::new(&program.camera, program.picker)?,
            program: program.clone(),
        }))
    })
    .unwrap();
    assert_eq!((report.outcome, report.steps), (Outcome::WorldFailed, 1));
    let step: serde_json::Value = serde_json::from_str(journal.lines().nth(1).unwrap()).unwrap();
    assert!(step["executed"]["grips"][0]["pick"].is_array(), "{step}");
    assert!(step["stopped"].is_string());
}

//! Runs a compiled task: looks at the cloth, asks a model, checks its answer, moves, and scores the result.
//!
//! ```text
//! World.observe → Observation → Scene → Request → Reply → Proposal → Verdict     per attempt
//!                                          ▲                           │ reject: say why, ask again
//!                                          └───────────────────────────┘
//! accept → Action → World.act → Executed → step line → Report
//! ```
//!
//! [`rollout::run`] is that pipeline. Three traits make it extensible: [`fab_world::World`] is a simulated cloth or a
//! robot arm; [`policy::Policy`] decides the actions; and [`fab_model::Model`], a provider's model or a stand-in,
//! answers the prompting policy.
//!
//! This program compiles a task and runs it on a small simulated cloth. `fab_standins::Geometric` answers:
//! a stand-in that needs no API key and no network.
//!
//! ```
//! use fab_agent::examples::Examples;
//! use fab_agent::journal::RunFolder;
//! use fab_agent::policy::Prompted;
//! use fab_agent::rollout::{self, Job};
//! use fab_agent::subgoals::SubgoalSet;
//! use fab_base::{cache::Cache, interrupt::Interrupt};
//! use fab_compiler::{LoadError, Loader};
//! use fab_model::{Models, calls::Budget};
//! use fab_standins::Geometric;
//! use fab_world::{SimulatedWorld, World, WorldError, start::Start};
//!
//! const TASK: &str = r#"
//! use "lib/folding.fab"
//!
//! task corner extends folding {
//!     cloth     grid(24, 24)
//!     subgoals  { demonstrate { fold corner(back_left) -> corner(front_right) } }
//! }
//! "#;
//!
//! /// The task from memory, and what it uses from the shipped tasks.
//! struct Tasks;
//!
//! impl Loader for Tasks {
//!     fn load(&self, name: &str) -> Result<String, LoadError> {
//!         if name == "corner.fab" {
//!             return Ok(TASK.to_owned());
//!         }
//!         let tasks = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks");
//!         let text = std::fs::read_to_string(format!("{tasks}/{name}"));
//!         text.map_err(|error| LoadError { message: error.to_string() })
//!     }
//! }
//!
//! let compiled = fab_compiler::compile("corner.fab", &Tasks)?;
//! assert!(compiled.diagnostics.is_empty(), "{:?}", compiled.diagnostics);
//! let program = &compiled.programs[0];
//!
//! let make_world = || Ok::<Box<dyn World>, WorldError>(Box::new(SimulatedWorld::of(program)?));
//! let folder = tempfile::tempdir()?;
//! let interrupt = Interrupt::default();
//! // The task shows its subgoals as folds; the simulator draws their pictures.
//! let subgoals = SubgoalSet::obtain(program, folder.path(), &mut *make_world()?, &interrupt)?;
//!
//! let job = Job {
//!     program,
//!     start: &Start::flat(&program.cloth),
//!     subgoals: &subgoals,
//!     examples: &Examples::default(),
//!     make_policy: &Prompted::new(Models { vision: &Geometric, text: &Geometric }),
//!     budget: &Budget::default(), // no cap
//!     make_world: &make_world,
//!     make_expert_world: &make_world,
//!     cache: &Cache::none(),
//!     interrupt: &interrupt,
//!     horizon: None, // the task's own
//!     early_stop: true,
//!     operator: None,
//!     repetition: 0,
//!     start_number: None,
//! };
//! let run = RunFolder::create(&folder.path().join("run"))?;
//! let report = rollout::run(&job, run, &mut |_event| {})?;
//!
//! println!("{}: {} step, {} questions", report.outcome.name(), report.steps, report.queries);
//! assert_eq!((report.steps, report.queries), (1, 2));
//! // Folded in half along its diagonal.
//! assert!(report.measures.coverage_true.is_some_and(|share| (0.45..0.65).contains(&share)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Nothing here reads the environment, prints, or knows the command line.

pub mod rollout;

pub mod action;
pub mod policy;
pub mod scene;

pub mod arm_sight;
pub mod best;
pub mod demos;
pub mod draft;
pub mod error;
pub mod examples;
pub mod judgement;
pub mod outcome;
pub mod pictures;
pub mod result;
pub mod see;
pub mod subgoals;
pub mod task_files;
pub mod twins;

pub mod journal;
pub mod record;
pub mod sheet;

#[cfg(test)]
#[path = "../../../tests/recorded_data.rs"]
mod recorded;

//! Runs a suite of many rollouts, and makes tables of the results.
//!
//! ```text
//! .toml → Suite ─┐
//! tasks, models ─┴→ Bench ─→ starts → expert ends → rollouts ─→ Records ─→ Rows ─→ text, JSON, CSV, Markdown
//! ```
//!
//! A rollout is a folder; a finished one is never run again, and tables are made from the folders. Rollouts run in
//! parallel, and no figure except times depends on how many. The caller compiles tasks, finds models and prints.

pub mod metric;
pub mod on_arm;
pub mod play;
pub mod record;
pub mod rows;
pub mod starts;
pub mod statistics;
pub mod suite;
pub mod table;
pub mod vary;

mod experts;
mod first_questions;
mod lay_starts;

pub use first_questions::first_questions_of;

use fab_agent::demos::Demonstrations;
use fab_agent::examples::Examples;
use fab_agent::judgement::Operator;
use fab_agent::policy::{self, MakePolicy};
use fab_agent::rollout::{Event, RunError};
use fab_agent::subgoals::SubgoalSet;
use fab_arm::journal::JournalError;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::{Budget, LedgerError};
use fab_program::Program;
use fab_world::vary::AxisValues;
use fab_world::{About, World, WorldError};
use metric::Metric;
use on_arm::OnArm;
use serde::Serialize;
use starts::StartPoint;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use suite::{Method, Suite};
use vary::Variation;

/// Everything needed to run a suite.
pub struct Bench<'a> {
    /// The suite.
    pub suite: &'a Suite,
    /// The suite's tasks, with their starts.
    pub tasks: Vec<Task>,
    /// What to run: a task and a method each.
    pub entries: Vec<Entry<'a>>,
    /// Makes the simulated world of a program, varied by the values; equal programs and values get equal worlds. It is
    /// used for starts and expert ends, and for rollouts if there is no arm.
    pub make_world: &'a MakeWorldOf<'a>,
    /// The arm that executes rollouts, one at a time, if there is one.
    pub arm: Option<OnArm<'a>>,
    /// A non-bundled world that executes rollouts in parallel, if there is one.
    pub elsewhere: Option<OtherWorld<'a>>,
    /// The folder for run folders.
    pub out: PathBuf,
    /// Number of parallel jobs; rollouts on an arm, and those judged by an operator, run one at a time.
    pub threads: usize,
    /// Whether starts share answers.
    pub answers: Answers,
    /// Stores crumpled starts and expert ends.
    pub cache: &'a Cache,
    /// Caps on model calls for the whole suite.
    pub budget: &'a Budget,
    /// Judges after each rollout whether its task was reached, if somebody is asked; rollouts then run one at a time.
    pub operator: Option<&'a dyn Operator>,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
    /// Receives the events of each rollout with its run folder, from any thread.
    pub listen: &'a (dyn Fn(&Path, Event) + Sync),
}

fab_base::named! {
    /// Whether equal questions at several starts get one answer.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
    pub enum Answers {
        /// Each start and repeat asks anew; methods at the same start and repeat share answers.
        #[default]
        PerStart = "per_start",
        /// All starts of a repeat share the answer to an equal question.
        Shared = "shared",
    }
}

/// Makes the world of a program, which differs from the task's own in some values.
pub type MakeWorldOf<'a> =
    dyn Fn(&Program, &AxisValues) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// A world that is neither the bundled simulator nor an arm.
pub struct OtherWorld<'a> {
    /// Its description.
    pub about: About,
    /// Whether a start can be laid again exactly.
    pub repeats: bool,
    /// Makes it for a rollout of a program, given the run folder.
    pub make_world: &'a MakeRolloutWorld<'a>,
}

/// Makes the world of one rollout of a program, given the run folder.
pub type MakeRolloutWorld<'a> =
    dyn Fn(&Program, &Path) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// A task and its starts.
pub struct Task {
    /// Its name.
    pub name: String,
    /// The task itself, with its declared cloth.
    pub program: Program,
    /// Its starts.
    pub starts: Vec<StartPoint>,
}

/// A task with one method in one kind of worlds.
#[derive(Clone)]
pub struct Entry<'a> {
    /// Index of the task.
    pub task: usize,
    /// The method.
    pub method: &'a Method,
    /// How its worlds differ from the task's own.
    pub variation: Variation,
    /// Makes the policy of a rollout.
    pub make_policy: &'a dyn MakePolicy,
    /// Describes the policy.
    pub policy: policy::Description,
    /// The models that it asks, if any.
    pub models: Option<Models<'a>>,
    /// The variant's program for every grid among the starts.
    pub programs: BTreeMap<[u32; 2], Program>,
    /// The subgoal pictures of the declared cloth.
    pub subgoals: SubgoalSet,
    /// The examples of its stages.
    pub examples: Examples,
    /// Whether the policy may decide otherwise at another repeat.
    pub varies: bool,
    /// Rollouts per start, at least 1.
    pub repeats: u32,
}

/// Why a suite cannot be run or stored.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A start cannot be laid, or a world cannot be set up.
    #[error("{place}: {error}")]
    World {
        /// Task and start.
        place: String,
        /// What went wrong.
        error: WorldError,
    },
    /// A rollout could not be run or stored.
    #[error("{place}: {error}")]
    Run {
        /// The run folder.
        place: String,
        /// What went wrong.
        error: RunError,
    },
    /// A folder holds another rollout, which differs so.
    #[error(
        "`{}` holds another rollout: {}; name another `--out`, nothing is overwritten", .0.display(), .1
    )]
    Other(PathBuf, String),
    /// The record of a rollout was gone when it ended.
    #[error(
        "`{}` has lost the record of the rollout that has just ended there: something removed or changed it meanwhile. \
         Finished rollouts are kept, and the same `--out` continues from there", .0.display()
    )]
    Lost(PathBuf),
    /// The provider refuses every call, so all rollouts after the first one that failed so would fail too.
    #[error(
        "the provider refuses to answer ({}); the journal in `{}` has its message. Finished rollouts are kept, \
         and the same `--out` continues from there", .1, .0.display()
    )]
    Refused(PathBuf, fab_model::calls::Fault),
    /// An arm's journal cannot be read.
    #[error("the state in which the arm was left is unknown: {0}")]
    ArmJournal(#[from] JournalError),
    /// The suite measures something that is unknown for a real cloth.
    #[error(
        "the suite measures `{0}`, which needs particle positions, and those of a real cloth are unknown: run \
         it in the simulator or on a simulated arm; `physical` is made for a real one"
    )]
    NoParticles(&'static str),
    /// The calls of an earlier part of the suite cannot be read.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// A start is one of the examples in the prompts.
    #[error(
        "the start `{start}` of `{task}` is that of demonstration {demonstration}, which `{method}` shows the model: a result from it would not be a test; make the demonstrations again with another `--seed`"
    )]
    Demonstrated {
        /// The task.
        task: String,
        /// The method.
        method: String,
        /// The start.
        start: String,
        /// The demonstration, from 1.
        demonstration: usize,
    },
    /// A thread cannot be started.
    #[error(transparent)]
    Threads(#[from] std::io::Error),
}

impl Bench<'_> {
    /// Returns how many rollouts run in parallel: one if an operator judges or an arm executes.
    pub fn side_by_side(&self) -> usize {
        match (&self.arm, self.operator) {
            (None, None) => self.threads,
            _ => 1,
        }
    }
}

impl Entry<'_> {
    /// Returns what differs from the task's own world at a start.
    pub fn values(&self, start: &StartPoint) -> AxisValues {
        self.variation.values(start.number)
    }

    /// Returns the program for the cloth of a start.
    fn program(&self, start: &StartPoint) -> &Program {
        let program = self.programs.get(&start.grid());
        program.expect("the task is compiled for the grid of every start")
    }

    /// Returns whether rollouts end at their goal. A free model continues if a metric needs that, and the figures with
    /// the stop are computed from the same rollouts.
    pub fn stops_early(&self, metrics: &[Metric]) -> bool {
        let is_free = self.policy.models.is_none() || self.policy.is_stand_in();
        !(is_free && metrics.iter().any(|metric| metric.row().is_without_stop))
    }

    /// Returns the number of examples in the task's prompts: demonstrations, or else those written by the author.
    pub fn data_size(&self) -> usize {
        let program = self.programs.values().next();
        let stages = program.map_or(&[][..], |program| &program.stages);
        let written: usize = stages.iter().map(|stage| stage.examples.len()).sum();
        let shown = self.examples.demonstrations.as_ref();
        shown.map_or(0, Demonstrations::data_size) + written
    }
}

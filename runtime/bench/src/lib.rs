//! A suite of many rollouts, and the tables that come of it.
//!
//! ```text
//! .toml → Suite ─┐
//! tasks, models ─┴→ Bench ─→ starts → expert ends → rollouts ─→ Records ─→ Rows ─→ text, JSON, CSV, Markdown
//! ```
//!
//! A rollout is a folder; one that has ended is never run again, and tables are made of what the folders say.
//! Rollouts run side by side, and no figure but the times depends on how many. Compiling tasks, finding models
//! and printing are left to the caller.

pub mod metric;
pub mod on_arm;
pub mod play;
pub mod record;
pub mod rows;
pub mod starts;
pub mod statistics;
pub mod suite;
pub mod table;

mod experts;
mod foresee;
mod lay;

pub use foresee::first_questions_of;

use fab_agent::examples::Examples;
use fab_agent::operator::Operator;
use fab_agent::policy::{self, MakePolicy};
use fab_agent::rollout::RunError;
use fab_agent::subgoals::SubgoalSet;
use fab_arm::log::LogError;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::Models;
use fab_model::calls::{Budget, LedgerError};
use fab_model::recording::Recorder;
use fab_program::Program;
use fab_world::{About, World, WorldError};
use metric::Metric;
use on_arm::OnArm;
use starts::StartPoint;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use suite::{Method, Suite};

/// Everything that a suite needs.
pub struct Bench<'a> {
    /// What is to be measured.
    pub suite: &'a Suite,
    /// The suite's tasks, with their starts.
    pub tasks: Vec<Task>,
    /// What is done with them: a task and a method each.
    pub entries: Vec<Entry<'a>>,
    /// Makes the simulated world of a program; equal programs get equal worlds. It knows starts and expert ends, and
    /// rollouts are carried out in it where there is no arm.
    pub make_world: &'a MakeWorldOf<'a>,
    /// The arm that carries rollouts out, one at a time, where there is one.
    pub arm: Option<OnArm<'a>>,
    /// The world beside the simulated one in which rollouts are carried out, side by side, where there is one.
    pub elsewhere: Option<Elsewhere<'a>>,
    /// Where run folders are made.
    pub out: PathBuf,
    /// Jobs side by side; rollouts on an arm, and those that an operator judges, go one at a time.
    pub threads: usize,
    /// Where crumpled starts and expert ends are kept.
    pub cache: &'a Cache,
    /// Caps on what models may be asked, for the suite as a whole.
    pub budget: &'a Budget,
    /// Where questions and answers are recorded, where that is wanted.
    pub recorder: Option<&'a Recorder>,
    /// Who says after each rollout whether its task was reached, where somebody is asked; rollouts then run one at a time.
    pub operator: Option<&'a dyn Operator>,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
}

/// Makes the world of a program.
pub type MakeWorldOf<'a> = dyn Fn(&Program) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// A world that is not the bundled one, nor an arm.
pub struct Elsewhere<'a> {
    /// What it says of itself.
    pub about: About,
    /// Whether it can lay a start again as it lay.
    pub repeats: bool,
    /// Makes it for a rollout of a program, whose run folder is given.
    pub make_world: &'a MakeRolloutWorld<'a>,
}

/// Makes the world of one rollout.
pub type MakeRolloutWorld<'a> =
    dyn Fn(&Program, &Path) -> Result<Box<dyn World>, WorldError> + Sync + 'a;

/// A task and where its cloth lies at first.
pub struct Task {
    /// Its name.
    pub name: String,
    /// The task itself, with its declared cloth.
    pub program: Program,
    /// Its starts.
    pub starts: Vec<StartPoint>,
}

/// A task done by one method.
pub struct Entry<'a> {
    /// Index of the task.
    pub task: usize,
    /// The method.
    pub method: &'a Method,
    /// Makes who decides in a rollout.
    pub make_policy: &'a dyn MakePolicy,
    /// Who that is.
    pub policy: policy::Description,
    /// The models that it asks, where it asks any.
    pub models: Option<Models<'a>>,
    /// The variant's program for every grid that a start has.
    pub programs: BTreeMap<[u32; 2], Program>,
    /// The subgoal pictures, those of the declared cloth.
    pub subgoals: SubgoalSet,
    /// What its stages are told as examples.
    pub examples: Examples,
    /// Rollouts per start, at least 1.
    pub repeats: u32,
}

/// Why a suite cannot be carried out or kept.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A start cannot be laid, or a world not set up.
    #[error("{place}: {error}")]
    World {
        /// Task and start.
        place: String,
        /// What went wrong.
        error: WorldError,
    },
    /// A rollout could not be carried out or kept.
    #[error("{place}: {error}")]
    Run {
        /// The run folder.
        place: String,
        /// What went wrong.
        error: RunError,
    },
    /// A folder holds a rollout of something else.
    #[error(
        "`{}` holds another rollout: {why}; name another `--out`, nothing is overwritten", folder.display()
    )]
    Other {
        /// The run folder.
        folder: PathBuf,
        /// What differs.
        why: String,
    },
    /// The provider refuses every call, so that all further rollouts would fail alike.
    #[error(
        "the provider refuses to answer ({fault}); the journal in `{}` has its words. What has ended is kept, and the same `--out` goes on from there", folder.display()
    )]
    Refused {
        /// The rollout that found out.
        folder: PathBuf,
        /// The name of the fault.
        fault: &'static str,
    },
    /// An arm was left in the middle of a motion by an earlier part of the suite.
    #[error(
        "the rollout in `{}` left the arm in the middle of a motion: nothing is begun before a person has looked after it; `fabc robot recover {}` says how it was left", folder.display(), folder.display()
    )]
    LeftUnclear {
        /// The run folder.
        folder: PathBuf,
    },
    /// The journal of an arm cannot be read.
    #[error("how the arm was left is not known: {0}")]
    ArmLog(#[from] LogError),
    /// The suite measures what nobody knows of a real cloth.
    #[error(
        "the suite measures `{metric}`, and of a real cloth nobody knows where its particles are: run it in the simulator or on a simulated arm; `physical` is made for a real one"
    )]
    NoParticles {
        /// The metric.
        metric: &'static str,
    },
    /// The calls of an earlier part of the suite cannot be read.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
    /// No program was compiled for the grid of a start.
    #[error("{place}: no program is compiled for a cloth of {} by {} particles", grid[0], grid[1])]
    NoProgram {
        /// Task and start.
        place: String,
        /// Particles along both sides.
        grid: [u32; 2],
    },
    /// A start is one of the examples in the prompts.
    #[error(
        "the start `{start}` of `{task}` is that of demonstration {demonstration}, which `{method}` tells the model: a result from it would be no test; make the demonstrations again with another `--seed`"
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
    /// Returns how many rollouts run side by side: one person sees one at a time, and an arm does one.
    pub fn side_by_side(&self) -> usize {
        match (&self.arm, self.operator) {
            (None, None) => self.threads,
            _ => 1,
        }
    }
}

impl Entry<'_> {
    /// Returns whether rollouts end at their goal: a free model goes on where a column needs that, and the figures
    /// with the stop are taken from the same rollouts.
    pub fn stops_early(&self, metrics: &[Metric]) -> bool {
        let is_free = self.policy.models.is_none() || self.policy.is_stand_in();
        !(is_free && metrics.iter().any(|metric| metric.row().is_without_stop))
    }

    /// Returns how many examples the prompts of the task hold: demonstrations, else those that the author wrote.
    pub fn data_size(&self) -> usize {
        let program = self.programs.values().next();
        let stages = program.map_or(&[][..], |program| &program.stages);
        let written: usize = stages.iter().map(|stage| stage.examples.len()).sum();
        self.examples.data_size() + written
    }
}

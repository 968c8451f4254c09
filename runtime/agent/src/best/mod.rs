//! Searches what a task's declared actions can reach at best, by trying them in the simulator.
//!
//! ```text
//! state ─► Scene ─► every offered action ─► written, read, checked ─► tried on a copy ─► measured
//!   ▲                                                                                      │
//!   └───────────── the most promising states of each depth, ever more of them ◄────────────┘
//! ```
//!
//! In: a task, a start and bounds. Out: [`Found`]: the actions with the lowest final error, what each step left, and
//! whether all actions were tried. Scenes, reading, checks and motions are those of a rollout, so a rollout of the
//! found actions ends in the same state, bit for bit. The search looks at true particles, so its figures are an oracle's
//! and no policy's. Equal inputs give equal results on any number of threads.
//!
//! It is a beam search with growing width: 1, 2, 4 and so on. [`journal`] keeps finished trials, so that a stopped search
//! goes on where it was.

pub mod journal;

mod aim;
mod offers;
mod tree;

pub use aim::Aim;

use crate::action::Action;
use crate::policy::Finding;
use crate::record;
use crate::scene::SceneError;
use crate::subgoals::SubgoalSet;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_program::render::RenderError;
use fab_program::{Comparison, Metric, Program, Proposal};
use fab_world::start::Start;
use fab_world::{Grasp, Grip, SimulatedWorld, WorldError};
use journal::TrialJournal;
use serde::Serialize;
use tree::Tree;

/// Makes a fresh simulated world, equal to every other one that it makes.
pub type MakeSimulated<'a> = dyn Fn() -> Result<SimulatedWorld, WorldError> + Sync + 'a;

/// What to search.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// The task, compiled for the cloth of the start.
    pub program: &'a Program,
    /// Where the cloth lies at first.
    pub start: &'a Start,
    /// The subgoal pictures, which decide whether a step is retried.
    pub subgoals: &'a SubgoalSet,
    /// Makes the world.
    pub make_world: &'a MakeSimulated<'a>,
    /// Stores the states of the experts.
    pub cache: &'a Cache,
    /// The most steps, overriding the program's number.
    pub horizon: Option<u32>,
    /// How much to try.
    pub limits: Limits,
    /// Decisions of other rollouts of this task from this start, tried first: what is found is then at least as good.
    pub hints: &'a [Vec<Choice>],
    /// Finished trials, kept and found again.
    pub journal: Option<&'a TrialJournal>,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
    /// Called after each trial, from any thread, with the number of trials begun so far in the search.
    pub progress: &'a (dyn Fn(u32) + Sync),
}

impl Search<'_> {
    /// Returns the most steps of a rollout.
    fn steps(&self) -> u32 {
        self.horizon.unwrap_or(self.program.horizon)
    }
}

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Limits {
    /// The most trials, at least 1. This bounds every search: a step without any action to try ends it too.
    pub trials: u32,
    /// The most states of one depth that are gone on from, at least 1.
    pub beam: u32,
    /// Draws the order of actions that nothing ranks, and pixels of masks.
    pub seed: u64,
    /// Trials side by side, at least 1; no result depends on it.
    pub threads: usize,
}

/// What is decided in a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// An action.
    Act {
        /// The answer.
        proposal: Proposal,
        /// What it means on the table.
        action: Action,
        /// The checks that refuse it, which the task drops in the end; empty if all accept it.
        without: Vec<String>,
    },
    /// No answer that is accepted: the task skips such a step.
    Skip,
}

impl Choice {
    /// Returns whether it does the same to the cloth as another one.
    fn does(&self, other: &Choice) -> bool {
        match (self, other) {
            (Choice::Skip, Choice::Skip) => true,
            (Choice::Act { action, .. }, Choice::Act { action: other, .. }) => {
                action.grip == other.grip
            }
            _ => false,
        }
    }

    /// Returns what was decided in a step of a record; `None` if the rollout ended in it.
    pub fn of(step: &record::Step) -> Option<Choice> {
        if step.skipped.is_some() {
            return Some(Choice::Skip);
        }
        let (accepted, [action]) = (step.accepted.as_ref()?, step.action.as_deref()?) else {
            return None;
        };
        step.executed.as_ref()?;
        let mut asked = step.attempts.iter();
        let taken = asked
            .find(|asked| asked.stage == accepted.stage && asked.attempt == accepted.attempt)?;
        let Finding::Action { fields, .. } = &taken.result else {
            return None;
        };
        Some(Choice::Act {
            proposal: Proposal {
                fields: fields.clone(),
            },
            action: action.clone(),
            without: accepted.without.clone(),
        })
    }
}

/// One step on the way to a result.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// The task's step, from 1; a retried step comes twice.
    pub step: u32,
    /// What was decided.
    pub choice: Choice,
    /// What was grasped; `None` if the step was skipped.
    pub grasp: Option<Grasp>,
    /// The measure of the cloth afterwards.
    pub value: f64,
    /// How far the cloth then is from where the experts have it after this step, metres; without experts `value`, negated
    /// where more is better.
    pub behind: f64,
}

/// What results are measured by: the goal's measure, or the distance to the experts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measure {
    /// What is measured.
    pub metric: Metric,
    /// Whether a larger measure is better.
    pub more_is_better: bool,
}

impl Measure {
    /// Returns what the results of a task are measured by.
    ///
    /// Fails if the task says nowhere what is better.
    pub fn of(program: &Program) -> Result<Measure, BestError> {
        let goal = program.goal.as_ref();
        let measure = Measure {
            metric: goal.map_or(Metric::ParticleDistance, |goal| goal.metric),
            more_is_better: goal
                .is_some_and(|goal| matches!(goal.is, Comparison::Greater | Comparison::AtLeast)),
        };
        match measure.experts_lead() && program.experts.is_empty() {
            true => Err(BestError::Aimless {
                task: program.title(),
            }),
            false => Ok(measure),
        }
    }

    /// Returns a number that is lower for a better measure.
    pub fn loss(self, value: f64) -> f64 {
        match self.more_is_better {
            true => -value,
            false => value,
        }
    }

    fn experts_lead(self) -> bool {
        self.metric == Metric::ParticleDistance
    }
}

/// The result of a search.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// What is measured.
    #[serde(skip)]
    pub measure: Measure,
    /// The measure of the untouched cloth.
    pub untouched: f64,
    /// The best actions, in order, from the start to the end of a rollout; `None` if the search was stopped before, or
    /// no rollout ends.
    #[serde(skip)]
    pub best: Option<Vec<Taken>>,
    /// The best measure after each number of actions, from 1; as long as the deepest that was reached.
    pub after: Vec<f64>,
    /// The most promising actions so far, if none led to an end yet.
    #[serde(skip)]
    pub under_way: Vec<Taken>,
    /// Trials, including those that the journal knew.
    pub trials: u32,
    /// Of these, how many the journal knew.
    pub known: u32,
    /// Whether every action of every reached state was tried.
    pub exhausted: bool,
    /// The masks of which only some pixels were tried, and fields whose combinations were too many.
    pub sampled: Vec<String>,
    /// How many offered actions every check refuses that the task never drops.
    pub refused: u64,
    /// How many accepted actions no answer can state, because the reader understands something else.
    pub unreadable: u64,
    /// Whether a stop was requested.
    pub interrupted: bool,
}

impl Found {
    /// Returns the measure at the end of the best actions.
    pub fn value(&self) -> Option<f64> {
        match self.best.as_deref()? {
            [] => Some(self.untouched),
            [.., last] => Some(last.value),
        }
    }

    /// Returns the index of the step of the best actions after which the cloth lags behind most: that which loses most
    /// against the experts, or gains least. A skipped step limits nothing.
    pub fn limiting(&self) -> Option<usize> {
        let best = self.best.as_deref()?;
        let before = std::iter::once(match self.measure.experts_lead() {
            true => 0.0,
            false => self.measure.loss(self.untouched),
        });
        let before = before.chain(best.iter().map(|taken| taken.behind));
        let lost = best
            .iter()
            .zip(before)
            .map(|(taken, before)| taken.behind - before);
        // Of equals, the first.
        let worst = lost
            .enumerate()
            .filter(|(index, _)| best[*index].choice != Choice::Skip)
            .reduce(|worst, it| if it.1 > worst.1 { it } else { worst });
        worst.map(|(index, _)| index)
    }
}

/// Why there is no result.
#[derive(Debug, thiserror::Error)]
pub enum BestError {
    /// The task does not say what is better.
    #[error(
        "`{task}` declares no `goal`, no `experts` and no demonstration, so no result is better than another: declare one of them"
    )]
    Aimless {
        /// The task.
        task: String,
    },
    /// The start gives nothing to measure.
    #[error("the start `{start}` cannot be measured: {why}")]
    Unmeasured {
        /// The start.
        start: String,
        /// What is wrong.
        why: String,
    },
    /// The world failed.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The scene of a state cannot be found.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A check cannot be evaluated; happens only in a hand-edited program.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Finished trials cannot be kept.
    #[error("{0}")]
    Journal(String),
    /// A thread cannot be started.
    #[error(transparent)]
    Threads(#[from] std::io::Error),
}

/// Returns a result that was reached; `None` if a requested stop prevented it.
pub fn unless_stopped<T>(result: Result<T, BestError>) -> Result<Option<T>, BestError> {
    match result {
        Err(BestError::World(WorldError::Interrupted)) => Ok(None),
        result => result.map(Some),
    }
}

/// Tells a grip: equal grips have equal texts.
fn key_of(grip: &Grip) -> String {
    serde_json::to_string(grip).expect("a grip has string keys and finite numbers")
}

/// Searches the best actions.
///
/// Fails if the task has nothing to measure, or the world, the vision or the journal does. An interrupt is a failure only
/// before the first trial, while the experts' states are simulated.
pub fn search(search: &Search<'_>) -> Result<Found, BestError> {
    let mut tree = Tree::at_start(search)?;
    for hint in search.hints {
        tree.follow(search, hint)?;
    }
    tree.widen(search, search.limits.trials.saturating_sub(tree.trials))?;
    Ok(tree.found(search))
}

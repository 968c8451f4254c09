//! Searches what a task's declared actions can reach at best, by trying them in a world that can take an action back.
//!
//! ```text
//! state ─► Scene ─► every offered action ─► checked ─► tried on a copy of the world ─► measured
//!   ▲                                                                                      │
//!   └───────────── the most promising states of each depth, ever more of them ◄────────────┘
//! ```
//!
//! In: a task, a start and limits. Out: [`Found`]: the actions with the lowest final error, and what was left untried.
//! Scenes, checks and motions are those of a rollout, so a rollout of the found actions ends in the same state, bit for
//! bit. The search looks at true particles, so its figures are an oracle's and no policy's. Unless time ends it, equal
//! inputs give equal results on any number of threads.
//!
//! It is a beam search with growing width: 1, 2, 4 and so on. It runs in any world that repeats and knows its particles;
//! one without copies ([`fab_world::World::fork`]) executes the actions again from the start.

mod aim;
mod offers;
mod tree;

pub use aim::Aim;

use crate::action::Action;
use crate::error::RunError;
use crate::record;
use crate::rollout::Job;
use fab_program::{Metric, Program, Proposal, space};
use serde::Serialize;
use std::time::Instant;
use tree::Tree;

/// What to search.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// A rollout of the task from the start, whose policy is of no account here.
    pub job: &'a Job<'a>,
    /// How much to try.
    pub limits: Limits,
    /// The actions of another rollout of this task from this start, tried first: the result is then at least as good.
    pub hint: &'a [Choice],
    /// Called with the number of finished trials, from any thread.
    pub progress: &'a (dyn Fn(u32) + Sync),
}

/// How much is tried.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// The most trials, at least 1.
    pub trials: u32,
    /// When the search ends, but for trials that have begun.
    pub until: Option<Instant>,
    /// Draws the order of actions that nothing ranks, and pixels of masks.
    pub seed: u64,
    /// Trials side by side, at least 1.
    pub threads: usize,
}

/// An action that was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The answer.
    pub proposal: Proposal,
    /// What it means on the table.
    pub action: Action,
    /// The checks that refuse it, which the task drops in the end; empty if all accept it.
    pub without: Vec<String>,
}

impl Choice {
    /// Returns the action of a step of a record; `None` if it executed none.
    pub fn of(step: &record::Step) -> Option<Choice> {
        step.executed.as_ref()?;
        let (accepted, [action]) = (step.accepted.as_ref()?, step.action.as_deref()?) else {
            return None;
        };
        Some(Choice {
            proposal: step.proposal()?,
            action: action.clone(),
            without: accepted.without.clone(),
        })
    }
}

/// One step on the path to a result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Taken {
    /// The task's step, from 1; a retried step comes twice.
    pub step: u32,
    /// The action as an answer states it, on one line; `None` if the step is skipped.
    pub answer: Option<String>,
    /// The checks that refuse it, which the task drops in the end.
    pub without: Vec<String>,
    /// The measure of the cloth afterwards.
    pub value: f64,
    /// How far the cloth then is from where the experts have it after this step, metres; without experts `value`, negated
    /// where more is better.
    pub behind: f64,
    /// What was chosen; `None` if the step is skipped.
    #[serde(skip)]
    pub choice: Option<Choice>,
}

impl Taken {
    fn of(program: &Program, step: u32, choice: Option<Choice>, measured: [f64; 2]) -> Taken {
        let answer = choice.as_ref().map(|choice| {
            let fields = choice.proposal.fields.iter().filter_map(|(name, value)| {
                let field = program.field(name)?;
                Some(space::statement(field, &space::text(field, value)))
            });
            fields.collect::<Vec<_>>().join(", ")
        });
        let without = choice.as_ref().map(|choice| choice.without.clone());
        Taken {
            step,
            answer,
            without: without.unwrap_or_default(),
            value: measured[0],
            behind: measured[1],
            choice,
        }
    }
}

/// Why a search ended before everything was tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// All trials were used.
    Trials,
    /// The time limit.
    Time,
    /// The user stopped it.
    Interrupt,
}

/// The result of a search.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// What is measured.
    pub metric: Metric,
    /// The measure of the untouched cloth.
    pub untouched: f64,
    /// The measure at the end of the best actions; `None` if no rollout has ended.
    pub value: Option<f64>,
    /// The best actions, in order; the most promising ones if no rollout has ended yet.
    pub best: Vec<Taken>,
    /// The index of the step of the best actions that limits: it loses most against the experts, or gains least.
    pub limiting: Option<usize>,
    /// Actions that were tried.
    pub trials: u32,
    /// Whether every action of every reached state was tried.
    pub exhausted: bool,
    /// How many of the reached states offer actions that were not tried.
    pub left: usize,
    /// What ended the search; `None` if every listed action was tried.
    pub stop: Option<Stop>,
}

/// Searches the best actions. An interrupt ends it with what was found so far.
///
/// Fails if the start gives nothing to choose from, or the world or the vision fails.
pub fn search(search: &Search<'_>, aim: &Aim<'_>) -> Result<Found, RunError> {
    let mut tree = Tree::at_start(search, aim)?;
    tree.follow(search.hint)?;
    tree.widen()?;
    Ok(tree.found())
}

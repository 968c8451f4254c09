//! One rollout, from start to report.
//!
//! In: a [`Job`] and an open run folder. Out: a [`Report`], which can be recomputed from the folder. Per step: observe,
//! find keypoints, ask and judge, execute, record the step. A model's bad proposal ends a rollout with an [`Outcome`];
//! only a failing environment is an error.

mod covered;
pub mod event;
mod first;
mod timer;
mod tries;
mod turn;
mod writer;

use crate::examples::Examples;
use crate::journal::RunFolder;
use crate::judgement::Operator;
use crate::outcome::Outcome;
use crate::policy::{Asking, MakePolicy, Rehearsing};
use crate::record::{Header, Report, RunCosts};
use crate::subgoals::SubgoalSet;
use crate::twins::Twins;
use covered::Covered;
use event::At;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_base::wording::counted;
use fab_model::calls::{Budget, Ledger};
use fab_program::{ActionField, Choices, Manner, Metric, Program, manner_field};
use fab_world::expert::MakeWorld;
use fab_world::start::{RESTING_HEIGHT_M, Start};
use fab_world::{Grip, World, WorldError, WorldPoint};
use serde::{Deserialize, Serialize};
use std::ops::Deref;
use std::time::Instant;
use turn::{Memory, Turn};
use writer::RolloutWriter;

pub(crate) use tries::Tries;

pub use crate::error::RunError;
pub use crate::policy::FirstQuestion;
pub use event::Event;
pub use first::first_questions;

/// What to run.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The compiled task.
    pub program: &'a Program,
    /// The cloth's start.
    pub start: &'a Start,
    /// The subgoal pictures.
    pub subgoals: &'a SubgoalSet,
    /// The examples of the stages.
    pub examples: &'a Examples,
    /// Makes the policy.
    pub make_policy: &'a dyn MakePolicy,
    /// Caps on model calls, shared with other rollouts of the same run.
    pub budget: &'a Budget,
    /// Makes the world of the rollout.
    pub make_world: &'a MakeWorld<'a>,
    /// Makes worlds that know their particles, for expert results; a real arm must not repeat the expert's folds.
    pub make_expert_world: &'a MakeWorld<'a>,
    /// Stores expert results.
    pub cache: &'a Cache,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
    /// The most actions, overriding the program's number.
    pub horizon: Option<u32>,
    /// Whether a goal judged after each step ends the rollout; otherwise the goal is judged on the last state.
    pub early_stop: bool,
    /// Judges at the end whether the task was reached, if somebody is asked.
    pub operator: Option<&'a dyn Operator>,
    /// Distinguishes runs of one job that need independent answers; part of every request.
    pub repetition: u32,
    /// Number of the start in its suite, if questions at other starts get answers of their own; part of every request.
    pub start_number: Option<u64>,
}

impl Job<'_> {
    /// Returns the most actions of the rollout.
    pub fn horizon(&self) -> u32 {
        self.horizon.unwrap_or(self.program.horizon)
    }

    /// Returns the start that the answers are drawn for; `None` if they are drawn for all starts, or not drawn.
    pub fn drawn_for(&self) -> Option<u64> {
        let policy = self.make_policy.make();
        self.start_number
            .filter(|_| policy.varies() && policy.description().models.is_some())
    }
}

/// A finished rollout, as `fabc run --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// What was run.
    #[serde(flatten)]
    pub header: Box<Header>,
    /// The part that is the same in every run.
    #[serde(flatten)]
    pub report: Report,
    /// Durations and costs of this run.
    #[serde(flatten)]
    pub took: RunCosts,
}

impl Deref for Ended {
    type Target = Report;

    fn deref(&self) -> &Report {
        &self.report
    }
}

/// Runs a job to its end and writes everything into `folder`.
///
/// Fails if the world cannot take the start, or the folder cannot be written; any other end is an [`Outcome`] in the
/// report.
pub fn run(
    job: &Job<'_>,
    folder: RunFolder,
    progress: &mut dyn FnMut(Event),
) -> Result<Ended, RunError> {
    let begun = Instant::now();
    let mut policy = job.make_policy.make();
    policy.prepare(job.program)?;
    let who = policy.description();
    let mut world = (job.make_world)()?;
    world.reset(job.start)?;
    if who.sees_particles && world.particles().is_none() {
        return Err(RunError::Unfit(format!(
            "`{}` looks at true particles, and the world `{}` does not know where they are",
            who.name,
            world.name()
        )));
    }
    if let Some(why) = unfit(job.program, world.as_ref()) {
        return Err(RunError::Unfit(why));
    }
    let ledger = Ledger::open(folder.path(), job.budget).map_err(RunError::failed)?;
    let asking = Asking::of(ledger);
    let mut keeper =
        RolloutWriter::open(job, folder, asking, who.clone(), world.as_ref(), progress)?;
    // Some policies have nothing to rehearse; but where something real could move, their twins must be trusted too.
    if policy.rehearses() || !world.is_simulated() {
        let draws = format!("{} {}", job.start_number.unwrap_or(0), job.repetition);
        let twins = Twins::of(job.program, job.subgoals, &draws, world.is_simulated());
        if let Some(twins) = twins {
            policy = Box::new(Rehearsing::new(policy, twins));
        }
    }
    let mut memory = Memory::default();
    if let Some(note) = memory.new_crossings(world.crossings(), "at the start") {
        progress(Event::Note { note });
    }
    let mut covered = Covered::at_start(job, world.as_mut())?;
    let mut ended = None;
    let mut tries = Tries::default();
    while let (None, Some(step)) = (ended, tries.step(job.horizon())) {
        tries.number += 1;
        keeper.asking.repeats = keeper.folder.repeats();
        let action = tries.number;
        let mut turn = Turn::new(job, At { action, step }, tries.before);
        let world = world.as_mut();
        ended = turn.take(policy.as_mut(), world, &mut memory, &mut keeper, progress)?;
        if ended.is_none() {
            covered.update(job, world, turn.after.as_ref())?;
            turn.line.measures = covered.now;
            if job.early_stop && covered.meets_goal(job) {
                ended = Some(Outcome::GoalReached);
            }
        }
        let spent = keeper.keep_step(&turn)?;
        progress(Event::Motion {
            at: turn.at,
            line: Box::new(turn.line.clone()),
            spent: Box::new(spent),
        });
        tries.after(job.program.actions_per_step(), turn.line.result);
    }
    let is_goal_met = covered.meets_goal(job);
    let end = match ended {
        None => keeper.outcome_at_horizon(is_goal_met),
        Some(Outcome::PolicyStopped) if is_goal_met => Outcome::GoalReached,
        Some(outcome) => outcome,
    };
    let scored = if end.is_scored() {
        keeper.score(job, world.as_ref(), progress)
    } else {
        Ok(None)
    };
    // Goals judged after each step are already decided.
    let goal = job.program.goal.as_ref();
    let goal = goal.filter(|goal| goal.metric == Metric::ParticleDistance);
    let outcome = match scored {
        Ok(Some(distance_m)) if goal.is_some_and(|goal| goal.is_met(distance_m)) => {
            Outcome::GoalReached
        }
        Ok(_) => end,
        Err(RunError::World(WorldError::Interrupted)) => Outcome::Interrupted,
        Err(error) => return Err(error),
    };
    let ended = keeper.close(job, outcome, covered, begun.elapsed())?;
    progress(Event::End {
        report: Box::new(ended.clone()),
    });
    Ok(ended)
}

/// Returns why no action can be executed as the task says: the world has more grippers, or it refuses what the task states,
/// or every value that a field offers. It is asked about a way through the table's middle.
fn unfit(program: &Program, world: &dyn World) -> Option<String> {
    let [pick, place] = [-0.02, 0.02].map(|x| WorldPoint::new(x, 0.0, RESTING_HEIGHT_M));
    let refused =
        |manner: Manner| world.refuses(&Grip::new(pick, place).with_manner(manner).into());
    let refused_field = |field: &ActionField| {
        let Choices::Lengths { choices, .. } = &field.choices else {
            return None;
        };
        manner_field(&field.name)?;
        let mut manners = choices
            .iter()
            .map(|it| program.manner.with(&field.name, it.m));
        let first = refused(manners.next()?)?;
        manners.all(|it| refused(it).is_some()).then_some(first)
    };
    let why = if world.grippers() != 1 {
        let grippers = counted(world.grippers(), "gripper");
        format!("the task's actions are for 1 gripper, and the world has {grippers}")
    } else {
        refused(program.manner).or_else(|| program.actions.iter().find_map(refused_field))?
    };
    let (task, name) = (program.title(), world.name());
    Some(format!(
        "`{task}` cannot be executed in the world `{name}`: {why}"
    ))
}

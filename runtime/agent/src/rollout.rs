//! One rollout, from start to report.
//!
//! In: a [`Job`] and an open run folder. Out: a [`Report`]; everything that it says can be recomputed
//! from the folder. Per step: observe, find keypoints, ask and judge, execute, write the step down.
//! A model's bad proposal ends a rollout with an [`Outcome`]; only a failing environment is an error.

mod covered;
mod first;
mod score;
mod tally;
mod timer;
mod turn;
mod writer;

use crate::action::Action;
use crate::demos::DemosError;
use crate::examples::Examples;
use crate::journal::{JournalError, RunFolder};
use crate::operator::Operator;
use crate::outcome::Outcome;
use crate::policy::{Asking, Attempt, MakePolicy, PolicyError, PromptError, Step};
use crate::record::{Line, Report, Took};
use crate::result::StepResult;
use crate::scene::SceneError;
use crate::sheet::Sheet;
use crate::subgoals::SubgoalSet;
use covered::Covered;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, CallRefused, Spent};
use fab_model::recording::Recorder;
use fab_program::Program;
use fab_program::render::RenderError;
use fab_vision::VisionError;
use fab_world::expert::MakeWorld;
use fab_world::start::Start;
use fab_world::{Grasp, WorldError};
use score::{Scored, meets, score};
use serde::Serialize;
use std::ops::Deref;
use std::time::Instant;
use turn::{Memory, Turn};
use writer::Keeper;

pub use first::{FirstQuestion, first_questions};
pub use score::Score;

/// What is to be run.
pub struct Job<'a> {
    /// The compiled task.
    pub program: &'a Program,
    /// Where the cloth lies at first.
    pub start: &'a Start,
    /// The subgoal pictures.
    pub subgoals: &'a SubgoalSet,
    /// What the stages are told as examples.
    pub examples: &'a Examples,
    /// Makes who decides.
    pub make_policy: &'a dyn MakePolicy,
    /// Caps on what models may be asked, shared with other rollouts of the same run.
    pub budget: &'a Budget,
    /// Where questions and answers are recorded, where that is wanted.
    pub recorder: Option<&'a Recorder>,
    /// Makes the world of the rollout.
    pub make_world: &'a MakeWorld<'a>,
    /// Makes worlds that know their particles, for expert results; an arm's world must not be made to repeat them.
    pub make_expert_world: &'a MakeWorld<'a>,
    /// Where expert results are kept.
    pub cache: &'a Cache,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
    /// The most actions, in place of the program's own number.
    pub horizon: Option<u32>,
    /// Whether a goal that is judged after each step ends the rollout; where not, it is judged on the last state.
    pub early_stop: bool,
    /// Who says at the end whether the task was reached, where somebody is asked.
    pub operator: Option<&'a dyn Operator>,
    /// Tells apart runs of one job that want independent answers; goes into every request.
    pub repetition: u32,
}

impl Job<'_> {
    /// Returns the most actions of the rollout.
    pub fn horizon(&self) -> u32 {
        self.horizon.unwrap_or(self.program.horizon)
    }
}

/// A rollout that has ended, as `fabc run --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ended {
    /// What is the same in each run of it.
    #[serde(flatten)]
    pub report: Report,
    /// What it took this time.
    #[serde(flatten)]
    pub took: Took,
}

impl Deref for Ended {
    type Target = Report;

    fn deref(&self) -> &Report {
        &self.report
    }
}

/// What happens while a rollout runs.
#[derive(Debug)]
pub enum Event<'a> {
    /// A question was answered, or not.
    Asked {
        /// From 1.
        step: u32,
        /// The attempt.
        attempt: &'a Attempt,
    },
    /// A step was executed.
    Stepped {
        /// From 1.
        step: u32,
        /// How many there are at most.
        horizon: u32,
        /// What was executed.
        action: &'a Action,
        /// The checks that were left out to accept it.
        without: &'a [String],
        /// What was held.
        grasp: Grasp,
        /// Wall time of the whole step, seconds.
        seconds: f64,
        /// What the calls of the rollout came to so far.
        spent: Spent,
    },
    /// Nothing was executed in a step, and the rollout goes on.
    Skipped {
        /// From 1.
        step: u32,
        /// How many there are at most.
        horizon: u32,
        /// What the rollout would have ended with.
        why: Outcome,
    },
    /// The rollout ends in a step that was not done.
    Stopped {
        /// From 1.
        step: u32,
        /// How many there are at most.
        horizon: u32,
        /// Why, in words.
        why: &'a str,
    },
    /// Expert results must be simulated before the score is known.
    SimulatingExperts {
        /// How many.
        missing: usize,
        /// Of how many.
        total: usize,
    },
    /// Something that does not change the result, but that the user should know.
    Note(String),
}

/// Why a rollout could not be carried out or kept.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The run folder cannot be written.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The world cannot be set up.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The policy cannot do this task in this world.
    #[error("{0}")]
    Unfit(String),
    /// The task cannot be asked of a model that is told of points in its own way, or the program does not fit itself.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The demonstrations cannot be told to a model.
    #[error(transparent)]
    Demos(#[from] DemosError),
    /// A call could not be noted, or its answer not be kept or found.
    #[error(transparent)]
    Calls(CallRefused),
    /// The picture of the start shows nothing to ask about.
    #[error("{0}")]
    Scene(SceneError),
    /// The picture of the flat cloth cannot be compared with the camera's.
    #[error("the picture of the flat cloth cannot be used: {why}")]
    Flat {
        /// What is wrong, and what would be right.
        why: String,
    },
    /// The goal is a measure of coverage, and there is nothing to measure it on.
    #[error(
        "the task's goal is a measure of coverage, and `{world}` knows neither its cloth's particles nor a picture of the flat cloth: give it one"
    )]
    Unmeasured {
        /// The world.
        world: String,
    },
    /// A picture cannot be drawn on.
    #[error(transparent)]
    Vision(#[from] VisionError),
}

impl From<PolicyError> for RunError {
    fn from(error: PolicyError) -> Self {
        match error {
            PolicyError::Unfit(why) => RunError::Unfit(why),
            PolicyError::Render(error) => RunError::Render(error),
            PolicyError::Demos(error) => RunError::Demos(error),
            PolicyError::Calls(error) => RunError::Calls(error),
            PolicyError::Record(error) => RunError::Journal(error),
        }
    }
}

impl From<PromptError> for RunError {
    fn from(error: PromptError) -> Self {
        RunError::from(PolicyError::from(error))
    }
}

/// Runs a job to its end and writes everything into `folder`.
///
/// Fails where the world cannot take the start, or the folder cannot be written; any other end is an
/// [`Outcome`] in the report.
pub fn run(
    job: &Job<'_>,
    folder: RunFolder,
    progress: &mut dyn FnMut(Event<'_>),
) -> Result<Ended, RunError> {
    let begun = Instant::now();
    let mut policy = job.make_policy.make();
    if let Some(note) = policy.prepare(job.program)? {
        progress(Event::Note(note));
    }
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
    let asking = Asking::in_folder(folder.path(), job.budget, job.recorder);
    let asking = asking.map_err(JournalError::from)?;
    let mut keeper = Keeper::open(job, folder, asking, who.clone(), world.as_ref())?;
    let mut sheet = Sheet::new();
    let mut memory = Memory::new(job.start.digest(), who.sees_particles);
    let mut covered = Covered::at_start(job, world.as_mut())?;
    let mut end = Outcome::HorizonReached;
    let mut tries = Tries::default();
    while let Some(step) = tries.step(job) {
        tries.number += 1;
        keeper.asking.begin(match keeper.folder.repeats() {
            true => Step::Repeated,
            false => Step::New,
        });
        let mut turn = Turn::new(job, tries.number, step, tries.before);
        let mut stopped = turn.take(
            policy.as_mut(),
            world.as_mut(),
            &mut memory,
            &mut keeper,
            &mut sheet,
            progress,
        )?;
        if stopped.is_none() {
            covered.update(job, world.as_ref(), turn.after.as_ref())?;
            turn.line.measures = covered.now;
            if job.early_stop && covered.meets_goal(job) {
                stopped = Some(Outcome::GoalReached);
            }
        }
        keeper
            .folder
            .append(&Line::Step(Box::new(turn.line.clone())))?;
        keeper.count(&turn)?;
        // A plan that was asked for is no rollout that ends early.
        if let (Some(why), true) = (&turn.line.stopped, stopped != Some(Outcome::Planned)) {
            progress(Event::Stopped {
                step: tries.number,
                horizon: job.horizon(),
                why,
            });
        }
        if tries.before.is_some() && turn.line.executed.is_some() {
            keeper.tally.retries += 1;
        }
        tries.after(job, turn.line.result);
        if let Some(outcome) = stopped {
            end = outcome;
            break;
        }
    }
    if end == Outcome::HorizonReached {
        end = keeper.outcome_at_horizon(covered.meets_goal(job));
    }
    if end == Outcome::PolicyStopped && covered.meets_goal(job) {
        end = Outcome::GoalReached;
    }
    let score = match end {
        Outcome::HorizonReached | Outcome::GoalReached | Outcome::PolicyStopped => {
            score(job, world.as_ref(), &mut keeper, progress)?
        }
        _ => Scored::Absent,
    };
    let outcome = match &score {
        Scored::Interrupted => Outcome::Interrupted,
        Scored::Found(score) if meets(job.program.goal.as_ref(), score.distance_m) => {
            Outcome::GoalReached
        }
        _ => end,
    };
    keeper.close(
        job,
        outcome,
        score.found(),
        covered,
        &sheet,
        begun.elapsed(),
    )
}

/// Which step an action is for.
#[derive(Default)]
struct Tries {
    /// Actions begun.
    number: u32,
    /// Steps that are over.
    done: u32,
    /// Further actions begun for the step under way.
    retries: u32,
    /// What the last of its actions came to, where it has to be tried again.
    before: Option<StepResult>,
}

impl Tries {
    /// Returns the step under way, from 1; none where the rollout is over.
    fn step(&self, job: &Job<'_>) -> Option<u32> {
        (self.done < job.horizon()).then_some(self.done + 1)
    }

    /// Decides whether the step under way is over: its result is like the subgoal, or it was retried enough.
    fn after(&mut self, job: &Job<'_>, result: Option<StepResult>) {
        let most = job.program.actions_per_step() - 1;
        self.before = result.filter(|result| !result.is_enough && self.retries < most);
        if self.before.is_some() {
            self.retries += 1;
        } else {
            self.done += 1;
            self.retries = 0;
        }
    }
}

//! One rollout, from start to report.
//!
//! In: a [`Job`] and an open run folder. Out: a [`Report`]; everything that it says can be recomputed
//! from the folder. Per step: observe, find keypoints, ask and judge, execute, write the step down.
//! A model's bad proposal ends a rollout with an [`Outcome`]; only a failing environment is an error.

mod record;
mod score;

use crate::action::Action;
use crate::agent::{self, AgentError, Attempt, Decision, Models, Situation};
use crate::cache::Cache;
use crate::examples::Examples;
use crate::expert::MakeWorld;
use crate::interrupt::Interrupt;
use crate::journal::{JournalError, Line, RunFolder, StepLine};
use crate::model::ModelRole;
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::scene::{Scene, SceneError};
use crate::sheet::Sheet;
use crate::start::Start;
use crate::subgoals::SubgoalSet;
use crate::vision::VisionError;
use crate::world::{Grasp, World, WorldError};
use compiler::facts::Done;
use compiler::program::{Arrow, Program, Which};
use compiler::render::RenderError;
use record::{Keeper, Report, Timer};
use score::{Covered, Scored, meets, score};
use std::time::Instant;

pub use record::{Report as RolloutReport, Score};

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
    /// Who answers.
    pub models: Models<'a>,
    /// Makes the world of the rollout, and more of them for expert results.
    pub make_world: &'a MakeWorld<'a>,
    /// Where expert results are kept.
    pub cache: &'a Cache,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
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
        /// What was held.
        grasp: Grasp,
        /// Wall time of the whole step, seconds.
        seconds: f64,
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
    /// The program does not fit itself; only one edited by hand can do that.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A picture cannot be drawn on.
    #[error(transparent)]
    Vision(#[from] VisionError),
}

impl From<AgentError<JournalError>> for RunError {
    fn from(error: AgentError<JournalError>) -> Self {
        match error {
            AgentError::Render(error) => RunError::Render(error),
            AgentError::Record(error) => RunError::Journal(error),
        }
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
) -> Result<Report, RunError> {
    let begun = Instant::now();
    let mut world = (job.make_world)()?;
    world.reset(job.start)?;
    let mut keeper = Keeper::open(job, folder, world.as_ref())?;
    let mut sheet = Sheet::new();
    let mut memory = Memory::default();
    let mut covered = Covered::at_start(job, world.as_ref());
    let mut end = Outcome::HorizonReached;
    for step in 1..=job.program.horizon {
        let mut turn = Turn {
            job,
            step,
            line: StepLine {
                step,
                ..StepLine::default()
            },
            timer: Timer::default(),
        };
        let stopped = turn.take(
            world.as_mut(),
            &mut memory,
            &mut keeper,
            &mut sheet,
            progress,
        )?;
        let stopped = match stopped {
            None if covered.update(job, world.as_ref()) => Some(Outcome::GoalReached),
            stopped => stopped,
        };
        turn.line.coverage = turn.line.executed.as_ref().and(covered.now);
        turn.timer.write(&mut turn.line.seconds);
        keeper.folder.append(&Line::Step(&turn.line))?;
        keeper.count(&turn.line, &turn.timer);
        if let Some(outcome) = stopped {
            end = outcome;
            break;
        }
    }
    let score = match end {
        Outcome::HorizonReached | Outcome::GoalReached => {
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

/// What one step leaves to the next.
#[derive(Default)]
struct Memory {
    first_scene: Option<Scene>,
    last: Option<Done>,
}

/// One step under way.
struct Turn<'j> {
    job: &'j Job<'j>,
    step: u32,
    line: StepLine,
    timer: Timer,
}

impl Turn<'_> {
    /// Takes the step; returns an outcome where the rollout ends with it.
    fn take(
        &mut self,
        world: &mut dyn World,
        memory: &mut Memory,
        keeper: &mut Keeper,
        sheet: &mut Sheet,
        progress: &mut dyn FnMut(Event<'_>),
    ) -> Result<Option<Outcome>, RunError> {
        let (job, step) = (self.job, self.step);
        let begun = Instant::now();
        if job.interrupt.is_raised() {
            return Ok(self.stop(Outcome::Interrupted, "interrupted"));
        }
        let observation = match self.timer.time("observe", || world.observe()) {
            Ok(observation) => observation,
            Err(error) => return Ok(self.stop_for(&error)),
        };
        keeper.keep_picture(&mut self.line, "before", &observation.rgb)?;
        let scene = match self.timer.time("keypoints", || {
            Scene::of(job.program, &observation, memory.first_scene.as_ref())
        }) {
            Ok(scene) => scene,
            Err(error) => {
                let outcome = match &error {
                    SceneError::OutOfView { .. } => Outcome::ClothOutOfView,
                    SceneError::NoCandidates { .. } => Outcome::NoCandidates,
                    SceneError::Missing(_) | SceneError::Vision(_) => Outcome::WorldFailed,
                };
                return Ok(self.stop(outcome, &error.to_string()));
            }
        };
        self.line.scene = scene.to_json();
        memory.first_scene.get_or_insert_with(|| scene.clone());
        let last = memory.last.as_ref();
        let pictures = Pictures {
            subgoals: job.subgoals.step(step as usize - 1)?,
            annotated: match scene.annotated(job.program, &observation.rgb, last) {
                Ok(annotated) => annotated,
                Err(error) => return Ok(self.stop(Outcome::WorldFailed, &error.to_string())),
            },
            scene: observation.rgb.clone(),
            examples: job.examples.clone(),
        };
        let mut record = |attempt: &Attempt| {
            self.line
                .attempts
                .push(keeper.folder.keep_attempt(step, attempt)?);
            self.timer.add(&attempt.stage, attempt.took);
            progress(Event::Asked { step, attempt });
            Ok(())
        };
        let situation = Situation {
            program: job.program,
            scene: &scene,
            step,
            last,
            pictures: &pictures,
        };
        let proposal = match agent::decide(situation, job.models, &mut record)? {
            Decision::Act { proposal, accepted } => {
                self.line.accepted = Some(accepted);
                proposal
            }
            Decision::Stop(outcome) => {
                return Ok(self.stop(outcome, "no answer could be executed; the attempts say why"));
            }
        };
        let Some(action) = Action::lower(job.program, &proposal, &scene, &observation) else {
            return Ok(self.stop(
                Outcome::NoCandidates,
                "the answer has no pick or no place, or no cloth is in view",
            ));
        };
        let drawn = keeper.keep_action(&mut self.line, &observation.rgb, &action)?;
        let executed = match self
            .timer
            .time("act", || world.act(&action.motion, job.interrupt))
        {
            Ok(executed) => executed,
            Err(error) => {
                self.line.action = Some(action);
                return Ok(self.stop_for(&error));
            }
        };
        let after = match world.observe() {
            Ok(after) => after,
            Err(error) => return Ok(self.stop_for(&error)),
        };
        keeper.keep_picture(&mut self.line, "after", &after.rgb)?;
        keeper.keep_positions(&mut self.line, world)?;
        let shown = match &pictures.subgoals {
            Some(subgoals) => subgoals.picture(Which::Now, Arrow::Drawn),
            None => &pictures.annotated,
        };
        sheet.row(shown, drawn, after.rgb);
        let grasp = executed.grasp;
        progress(Event::Stepped {
            step,
            horizon: job.program.horizon,
            action: &action,
            grasp,
            seconds: begun.elapsed().as_secs_f64(),
        });
        memory.last = Some(Done {
            proposal,
            pick: action.pick_on_cloth_px,
            place: action.place_px,
        });
        self.line.action = Some(action);
        self.line.executed = Some(executed);
        Ok(None)
    }

    fn stop(&mut self, outcome: Outcome, why: &str) -> Option<Outcome> {
        self.line.stopped = Some(why.to_owned());
        Some(outcome)
    }

    fn stop_for(&mut self, error: &WorldError) -> Option<Outcome> {
        let outcome = match error {
            WorldError::Interrupted => Outcome::Interrupted,
            _ => Outcome::WorldFailed,
        };
        self.stop(outcome, &error.to_string())
    }
}

/// Returns the name of the model that answers a role, for headers and reports.
fn model_name<'a>(job: &Job<'a>, role: ModelRole) -> &'a str {
    job.models.of(role).name()
}

//! One step in progress: observe, find keypoints, ask and judge, execute.
//!
//! In: the job and the state left by the step before. Out: the step's line, and an outcome if the rollout ends with it.

use super::event::At;
use super::timer::Timer;
use super::writer::RolloutWriter;
use super::{Event, Job, RunError};
use crate::action::Action;
use crate::outcome::Outcome;
use crate::pictures::Pictures;
use crate::policy::{
    self, Attempt, Decision, Exchange, Exchanged, Ground, Policy, StepView, Truth,
};
use crate::record::{self, SentFiles};
use crate::result::StepResult;
use crate::scene::{Scene, SceneError};
use fab_base::wording::counted;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{Arrow, Proposal, SubgoalStep};
use fab_world::metrics::cloth_moved;
use fab_world::{Motion, World, WorldError, WorldPoint};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// State passed from one step to the next.
#[derive(Default)]
pub(super) struct Memory {
    first_scene: Option<Scene>,
    last: Option<ExecutedAction>,
    /// In how many places the simulated cloth went through itself before the action.
    crossings: usize,
    /// What the world has done since the last decision.
    executed: Option<Motion>,
    /// What was said about pictures, without its numbers.
    said: BTreeSet<String>,
}

impl Memory {
    /// Returns a note if the simulated cloth now goes through itself in more places than before.
    pub(super) fn new_crossings(&mut self, crossings: Option<usize>, when: &str) -> Option<String> {
        let crossings = crossings.unwrap_or(0);
        let before = std::mem::replace(&mut self.crossings, crossings);
        (crossings > before).then(|| {
            let places = counted(crossings, "place");
            format!(
                "{when} the simulated cloth goes through itself, as no real one does ({places})"
            )
        })
    }
}

/// One step in progress.
pub(super) struct Turn<'j> {
    job: &'j Job<'j>,
    pub at: At,
    /// The result of the previous action, if it was for the same step.
    pub before: Option<StepResult>,
    pub line: record::Step,
    /// The camera's picture after the action; `None` if nothing was done.
    pub after: Option<Observation>,
    pub timer: Timer,
}

impl<'j> Turn<'j> {
    /// Begins an action; `before` is the previous result if the step is retried.
    pub(super) fn new(job: &'j Job<'j>, at: At, before: Option<StepResult>) -> Turn<'j> {
        Turn {
            job,
            at,
            before,
            line: record::Step {
                step: at.action,
                ..record::Step::default()
            },
            after: None,
            timer: Timer::default(),
        }
    }

    /// Takes the step; returns an outcome if the rollout ends with it.
    ///
    /// A world that fails, and a picture that gives nothing to ask about, end the rollout.
    pub(super) fn take(
        &mut self,
        policy: &mut dyn Policy,
        world: &mut dyn World,
        memory: &mut Memory,
        keeper: &mut RolloutWriter,
        progress: &mut dyn FnMut(Event),
    ) -> Result<Option<Outcome>, RunError> {
        let error = match self.act(policy, world, memory, keeper, progress) {
            Err(error @ (RunError::World(_) | RunError::Scene(_))) => error,
            done => return done,
        };
        let outcome = match &error {
            RunError::World(WorldError::PlannedOnly) => Outcome::Planned,
            RunError::World(WorldError::Interrupted | WorldError::Halted { .. }) => {
                Outcome::Interrupted
            }
            RunError::Scene(SceneError::OutOfView(..)) => Outcome::ClothOutOfView,
            RunError::Scene(SceneError::NoCandidates(..) | SceneError::NoneInReach(..)) => {
                Outcome::NoCandidates
            }
            _ => Outcome::WorldFailed,
        };
        Ok(self.stop(outcome, &error.to_string()))
    }

    fn act(
        &mut self,
        policy: &mut dyn Policy,
        world: &mut dyn World,
        memory: &mut Memory,
        keeper: &mut RolloutWriter,
        progress: &mut dyn FnMut(Event),
    ) -> Result<Option<Outcome>, RunError> {
        let (job, at) = (self.job, self.at);
        let At {
            action: number,
            step,
        } = at;
        if job.interrupt.is_raised() {
            return Ok(self.stop(Outcome::Interrupted, "interrupted"));
        }
        let observation = self.timer.plan("observe", || world.observe())?;
        let file = keeper.keep_picture(number, "before", &observation.rgb)?;
        self.line.files.before = Some(file.clone());
        // The first scene is stored unfiltered: the arm's reach is not a property of the cloth.
        let first = &mut memory.first_scene;
        let reach = |point: &WorldPoint| world.out_of_reach(point);
        let refuses = |motion: &Motion| world.refuses(motion);
        let scene = self.timer.plan("keypoints", || {
            let scene = Scene::of(job.program, &observation, first.as_ref())?;
            first.get_or_insert_with(|| scene.clone());
            scene.within_reach(job.program, &observation, &reach)
        })?;
        self.line.scene = scene.to_json();
        progress(Event::Picture {
            at,
            file,
            scene: self.line.scene.clone(),
        });
        let notes = observation.notes.iter().cloned();
        for note in notes.chain(scene.beyond_the_picture()) {
            // Notes that differ only in their numbers are said once.
            if memory.said.insert(note.replace(char::is_numeric, "")) {
                let note = format!("before step {step}: {note}");
                progress(Event::Note { note });
            }
        }
        let last = memory.last.as_ref();
        let executed = memory.executed.take();
        let pictures = self.timer.plan("annotate", || {
            let subgoals = job.subgoals.step(step as usize - 1)?;
            let examples = job.examples.clone();
            let pictures =
                Pictures::of(job.program, &scene, &observation, last, subgoals, examples);
            Ok::<_, RunError>(pictures?)
        })?;
        let particles = world
            .particles()
            .filter(|_| keeper.header.policy.sees_particles);
        let asking = Instant::now();
        let run = keeper.folder.path().to_owned();
        let start = job.start.digest();
        let mut aside = Duration::ZERO;
        let RolloutWriter {
            folder,
            asking: ledger,
            end,
            ..
        } = keeper;
        let mut record = |exchanged: Exchanged<'_>| {
            let keeping = Instant::now();
            let mut sent = SentFiles::default();
            match exchanged {
                Exchanged::Question {
                    stage,
                    attempt,
                    question,
                } => {
                    sent = folder.keep_question(number, (stage, attempt), question)?;
                    progress(Event::Question {
                        at,
                        stage: stage.to_owned(),
                        attempt,
                        sent: sent.clone(),
                    });
                }
                Exchanged::Attempt(Attempt { asked, reply, took }) => {
                    let mut asked = asked.clone();
                    end.report.count(&asked);
                    self.timer.add(&asked.stage, *took);
                    aside += *took;
                    if let Some(reply) = reply {
                        let of = (asked.stage.as_str(), asked.attempt);
                        asked.reply = Some(folder.keep_reply(number, of, &reply.text)?);
                        progress(Event::Answer {
                            at,
                            stage: asked.stage.clone(),
                            attempt: asked.attempt,
                            text: reply.text.clone(),
                            took_s: took.as_secs_f64(),
                        });
                    }
                    self.line.attempts.push(asked.clone());
                    let asked = Box::new(asked);
                    progress(Event::Verdict { at, asked });
                }
                Exchanged::Rehearsed(rehearsal, took) => {
                    self.line.rehearsal = Some(rehearsal.clone());
                    self.timer.add("rehearse", took);
                    aside += took;
                }
                Exchanged::Note(note) => progress(Event::Note { note }),
            }
            aside += keeping.elapsed();
            Ok(sent)
        };
        let view = StepView {
            before: self.before,
            ground: Ground {
                program: job.program,
                scene: &scene,
                observation: &observation,
                reach: &reach,
                refuses: &refuses,
            },
            number,
            step,
            answer: 0,
            horizon: job.horizon(),
            last,
            executed: executed.as_ref(),
            pictures: &pictures,
            repetition: job.repetition,
            start_number: job.start_number,
            start: &start,
            folder: Some(&run),
            truth: particles.as_ref().map(|particles| Truth {
                start: job.start,
                particles,
            }),
        };
        let mut exchange = Exchange {
            asking: ledger,
            record: &mut record,
            interrupt: job.interrupt,
        };
        let decision = policy.decide(&view, &mut exchange)?;
        let deciding = asking.elapsed().saturating_sub(aside);
        self.timer.add_planning("prompt and verify", deciding);
        let proposal = match decision {
            Decision::Act { grips, accepted } => {
                let [proposal] = <[Proposal; 1]>::try_from(grips).map_err(|grips| {
                    RunError::Unfit(format!(
                        "the policy decided {} grips, and the world has one gripper",
                        grips.len()
                    ))
                })?;
                // Whoever decided, an action that a check refuses is not executed.
                if !policy::is_accepted(view, &proposal, &accepted)? {
                    let why = "the policy decided an action that the task's checks refuse";
                    return Ok(self.stop(Outcome::PolicyFailed, why));
                }
                self.line.accepted = Some(accepted);
                proposal
            }
            Decision::Skip(outcome) => {
                self.line.skipped = Some(outcome);
                return Ok(None);
            }
            Decision::Stop { outcome, why } => return Ok(self.stop(outcome, &why)),
        };
        let Some(action) = Action::lower(job.program, &proposal, &scene, &observation) else {
            return Ok(self.stop(
                Outcome::NoCandidates,
                "the answer has no pick or no place, or no cloth is in view",
            ));
        };
        let mut drawn = observation.rgb.clone();
        fab_vision::draw_action(&mut drawn, action.pick_on_cloth_px, action.place_px)?;
        self.line.files.action = Some(keeper.keep_picture(number, "action", &drawn)?);
        let before = world.particles();
        self.line.action = Some(vec![action.clone()]);
        let motion = Motion::from(action.grip);
        let begun = Instant::now();
        let executed = world.act(&motion, job.interrupt);
        self.timer.add("act", begun.elapsed());
        let executed = executed?;
        // It was done, whatever can be seen of it.
        self.line.executed = Some(executed.clone());
        memory.executed = Some(executed.motion());
        self.line.cloth = before
            .zip(world.particles())
            .and_then(|(before, after)| cloth_moved(&before, &after, &executed));
        self.line.crossings = world.crossings().filter(|count| *count > 0);
        let when = format!("after step {step}");
        if let Some(note) = memory.new_crossings(self.line.crossings, &when) {
            progress(Event::Note { note });
        }
        let after = world.observe()?;
        self.line.files.after = Some(keeper.keep_picture(number, "after", &after.rgb)?);
        keeper.keep_positions(&mut self.line, world)?;
        if let Some(first) = &memory.first_scene {
            self.line.result = StepResult::of(job.program, job.subgoals, step, first, &after)?;
        }
        let shown = match &pictures.subgoals {
            Some(subgoals) => subgoals.picture(SubgoalStep::Now, Arrow::Drawn),
            None => &pictures.annotated,
        };
        keeper.sheet.row(number, shown, drawn, after.rgb.clone());
        self.after = Some(after);
        memory.last = Some(action.executed(proposal));
        Ok(None)
    }

    fn stop(&mut self, outcome: Outcome, why: &str) -> Option<Outcome> {
        self.line.stopped = Some(why.to_owned());
        Some(outcome)
    }
}

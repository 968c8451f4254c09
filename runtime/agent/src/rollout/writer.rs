//! Writes a rollout's record and final report.

use super::covered::Covered;
use super::score::Score;
use super::tally::Tally;
use super::timer::Timer;
use super::turn::Turn;
use super::{Ended, Event, Job, RunError};
use crate::action::Action;
use crate::journal::{JournalError, RunFolder};
use crate::operator;
use crate::outcome::Outcome;
use crate::policy::{self, Asking};
use crate::record::{
    self, End, ExpertDistance, Header, JudgedBy, Line, Measures, Progress, Report, RunCosts, Spent,
    StartFile, StepSpent,
};
use crate::sheet::{SHEET_FILE, Sheet};
use fab_base::{digest, npy};
use fab_model::calls::Usd;
use fab_picture::png;
use fab_world::World;
use fab_world::expert::ExpertEnd;
use fab_world::start::Up;
use image::RgbImage;
use serde_json::Map;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Writes a rollout into its folder.
pub(super) struct RolloutWriter<'j> {
    pub(super) folder: RunFolder,
    pub(super) timer: Timer,
    pub(super) asking: Asking<'j>,
    run_id: String,
    world: String,
    params: String,
    policy: policy::Description,
    pub(super) tally: Tally,
    steps: u32,
    last_skip: Option<Outcome>,
    stopped: Option<String>,
    progress: Vec<Progress>,
    final_positions: Option<String>,
}

impl<'j> RolloutWriter<'j> {
    /// Writes program, start and header.
    pub(super) fn open(
        job: &Job<'_>,
        mut folder: RunFolder,
        asking: Asking<'j>,
        policy: policy::Description,
        world: &dyn World,
        progress: &mut dyn FnMut(Event),
    ) -> Result<RolloutWriter<'j>, RunError> {
        let program = serde_json::to_vec_pretty(job.program)
            .expect("a program has string keys and finite numbers");
        let program_file = folder.keep("program.json", &program)?;
        let start_file = folder.keep("start.npy", &npy::encode(&job.start.positions))?;
        folder.keep("start.json", &job.start.description())?;
        let run_id = folder.run_id().unwrap_or_else(|| new_run_id(job, &folder));
        let header = Header {
            schema: record::VERSION,
            fabc: env!("CARGO_PKG_VERSION").to_owned(),
            task: job.program.task.clone(),
            variant: job.program.variant.clone(),
            program: job.program.hash(),
            program_file,
            world: world.name().to_owned(),
            params: world.parameters(),
            code: world.code(),
            vary: world.variation(),
            policy: policy.clone(),
            start: StartFile {
                name: job.start.name.clone(),
                seed: job.start.seed,
                file: start_file,
                digest: job.start.digest(),
                grid: job.start.grid,
                up: Up::Z,
            },
            subgoals: job.subgoals.origin,
            subgoal_pictures: job.subgoals.digest(),
            horizon: job.horizon(),
            early_stop: job.early_stop,
            repetition: job.repetition,
            drawn_for: job.drawn_for(),
            attempts: job.program.verify.attempts,
            goal: job.program.goal.clone(),
        };
        let header = Box::new(header);
        folder.append(&Line::Header(header.clone()))?;
        progress(Event::Start { header });
        folder.spend(&Spent::Begin {
            run_id: run_id.clone(),
        })?;
        Ok(RolloutWriter {
            folder,
            asking,
            timer: Timer::default(),
            run_id,
            world: world.name().to_owned(),
            params: world.parameters(),
            policy,
            tally: Tally::default(),
            steps: 0,
            last_skip: None,
            stopped: None,
            progress: Vec::new(),
            final_positions: None,
        })
    }

    /// Stores a picture of an action, and returns its name.
    pub(super) fn keep_picture(
        &self,
        number: u32,
        what: &str,
        picture: &RgbImage,
    ) -> Result<String, JournalError> {
        let name = format!("step_{number}/{what}.png");
        self.folder.keep(&name, &png::encode(picture))
    }

    /// Draws the action on the picture before the step, stores the result, and returns it.
    pub(super) fn keep_action(
        &self,
        line: &mut record::Step,
        before: &RgbImage,
        action: &Action,
    ) -> Result<RgbImage, RunError> {
        let mut drawn = before.clone();
        fab_vision::draw_action(&mut drawn, action.pick_on_cloth_px, action.place_px)?;
        line.files.action = Some(self.keep_picture(line.step, "action", &drawn)?);
        Ok(drawn)
    }

    pub(super) fn keep_positions(
        &mut self,
        line: &mut record::Step,
        world: &dyn World,
    ) -> Result<(), JournalError> {
        if let Some(positions) = world.particles() {
            let name = self.folder.keep(
                &format!("step_{}/positions.npy", line.step),
                &npy::encode(&positions),
            )?;
            line.files.positions = Some(name.clone());
            line.digest = Some(digest::of_positions(&positions));
            self.final_positions = Some(name);
        }
        Ok(())
    }

    pub(super) fn keep_expert(&self, end: &ExpertEnd) -> Result<String, JournalError> {
        self.folder.keep(
            &format!("experts/{}.npy", end.sequence + 1),
            &npy::encode(&end.positions),
        )
    }

    /// Counts a step, and records its durations and costs.
    pub(super) fn count(&mut self, turn: &Turn<'_>) -> Result<(), JournalError> {
        let line = &turn.line;
        let mut seconds = Map::new();
        turn.timer.write(&mut seconds);
        let spent = self.asking.spent();
        self.folder.spend(&Spent::Step(StepSpent {
            step: line.step,
            planning_s: turn.planning_s(),
            seconds,
            cost_usd_so_far: spent.known_cost().map(Usd::dollars),
            cost_usd_at_most_so_far: spent.priced_at_most().map(Usd::dollars),
        }))?;
        self.steps += u32::from(line.executed.is_some());
        if let Some(skipped) = line.skipped {
            self.tally.skip(skipped);
            self.last_skip = Some(skipped);
        }
        self.stopped.clone_from(&line.stopped);
        if let Some(planning_s) = turn.planning_s() {
            self.tally.planned(planning_s);
        }
        if line.executed.is_some() || line.skipped.is_some() {
            self.progress.push(Progress {
                step: line.step,
                cloth: line.cloth,
                measures: line.measures,
            });
        }
        self.timer.absorb(&turn.timer);
        Ok(())
    }

    /// Returns the outcome of a rollout that took every step.
    ///
    /// A rollout in which nothing was ever executed ends as its last step would have.
    pub(super) fn outcome_at_horizon(&self, is_goal_met: bool) -> Outcome {
        match self.last_skip {
            Some(skipped) if self.steps == 0 => skipped,
            _ if is_goal_met => Outcome::GoalReached,
            _ => Outcome::HorizonReached,
        }
    }

    /// Writes contact sheet and end line, and returns the report.
    pub(super) fn close(
        mut self,
        job: &Job<'_>,
        outcome: Outcome,
        score: Option<&Score>,
        covered: Covered,
        sheet: &Sheet,
        wall: Duration,
    ) -> Result<Ended, RunError> {
        let mut seconds = Map::new();
        self.timer.write(&mut seconds);
        let spent = self.asking.spent();
        let Measures {
            coverage,
            coverage_true,
            normalized_improvement,
            normalized_improvement_true,
        } = covered.now;
        let mut report = Report {
            task: job.program.task.clone(),
            variant: job.program.variant.clone(),
            outcome,
            stopped: self.stopped.clone(),
            goal_reached: job
                .program
                .goal
                .as_ref()
                .filter(|goal| covered.judges(goal))
                .map(|_| outcome == Outcome::GoalReached),
            operator: None,
            mean_particle_distance_mm: score.map(|score| score.distance_m * 1000.0),
            judged_by: score.map(|score| JudgedBy {
                world: score.world.clone(),
                grid: [job.start.grid.dimx, job.start.grid.dimy],
            }),
            coverage_source: covered.source,
            coverage,
            coverage_true,
            normalized_improvement,
            normalized_improvement_true,
            coverage_at_start: covered.at_start.coverage,
            coverage_true_at_start: covered.at_start.coverage_true,
            progress: self.progress.clone(),
            steps: self.steps,
            skipped_steps: self.tally.skipped_steps(),
            retries: self.tally.retries,
            skipped: self.tally.skipped.clone(),
            queries: self.tally.queries,
            refusals: self.tally.refusals.clone(),
            malformed_replies: self.tally.malformed,
            policy: self.policy.title(),
            sees_particles: self.policy.sees_particles,
            model: self
                .policy
                .models
                .is_some()
                .then(|| self.policy.name.clone()),
            model_is_stand_in: self.policy.is_stand_in(),
            seed: job.start.seed,
            program: job.program.hash(),
            world: self.world.clone(),
            params: self.params.clone(),
        };
        let took = RunCosts {
            planning_s: self.tally.planning_s(),
            spent,
            calls: spent.calls,
            possibly_billed: spent.possibly_billed,
            unreported: spent.unreported,
            faults: self.asking.faults(),
            usage: spent.usage,
            cost_usd: spent.known_cost().map(Usd::dollars),
            cost_usd_at_most: spent.priced_at_most().map(Usd::dollars),
            run_dir: self.folder.path().display().to_string(),
            run_id: self.run_id.clone(),
            experts_simulated: score.map_or(0, |score| score.simulated),
            seconds,
            wall_s: wall.as_secs_f64(),
        };
        if let Some(operator) = job.operator.filter(|_| operator::is_judged(outcome)) {
            report.operator = operator.judge(&report, self.folder.path());
        }
        // A failed contact sheet must not lose a finished rollout.
        let sheet = match sheet.picture(&report).unwrap_or_default() {
            Some(picture) => Some(self.folder.keep(SHEET_FILE, &png::encode(&picture))?),
            None => None,
        };
        let experts = score.map(|score| {
            let entry = |(sequence, distance_m, file): &(usize, f64, String)| ExpertDistance {
                sequence: sequence + 1,
                file: file.clone(),
                distance_mm: distance_m * 1000.0,
                folds: job.program.experts[*sequence].folds.clone(),
            };
            score.distances.iter().map(entry).collect()
        });
        let end = End {
            report: report.clone(),
            final_positions: self.final_positions,
            nearest_expert: score.map(|score| score.sequence + 1),
            experts,
            sheet,
        };
        self.folder.append(&Line::End(Box::new(end)))?;
        self.folder.spend(&Spent::End {
            report: Box::new(took.clone()),
        })?;
        Ok(Ended { report, took })
    }
}

/// Names a run uniquely, even among runs of the same job.
fn new_run_id(job: &Job<'_>, folder: &RunFolder) -> String {
    let now = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos());
    let identity = format!(
        "{} {} {} {} {now}",
        job.program.hash(),
        job.start.digest(),
        folder.path().display(),
        std::process::id()
    );
    fab_base::digest::of(identity)[..12].to_owned()
}

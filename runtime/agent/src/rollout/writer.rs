//! Writes a rollout's record and final report.

use super::covered::Covered;
use super::timer::Timer;
use super::turn::Turn;
use super::{Ended, Event, Job, RunError};
use crate::journal::RunFolder;
use crate::outcome::Outcome;
use crate::policy::{self, Asking, Finding};
use crate::record::{
    self, Asked, End, ExpertDistance, Header, JudgedBy, Line, Report, RunCosts, Spent, StartFile,
    StepSpent,
};
use crate::sheet::{SHEET_FILE, Sheet};
use fab_base::{digest, npy};
use fab_model::calls::Usd;
use fab_picture::png;
use fab_program::verify::Verdict;
use fab_world::expert::{self, Sequences};
use fab_world::start::Up;
use fab_world::{World, metrics};
use image::RgbImage;
use std::time::{Duration, Instant};

/// Writes a rollout into its folder.
pub(super) struct RolloutWriter<'j> {
    pub(super) folder: RunFolder,
    pub(super) timer: Timer,
    pub(super) asking: Asking<'j>,
    pub(super) sheet: Sheet,
    pub(super) header: Box<Header>,
    /// What is known of the rollout so far.
    pub(super) end: End,
    /// Planning times of the actions that were asked for, seconds.
    planned_s: Vec<f64>,
    last_skip: Option<Outcome>,
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
        let header = Box::new(Header {
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
            policy,
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
        });
        folder.append(&Line::Header(header.clone()))?;
        progress(Event::Start {
            header: header.clone(),
        });
        Ok(RolloutWriter {
            folder,
            asking,
            timer: Timer::default(),
            sheet: Sheet::default(),
            header,
            end: End::default(),
            planned_s: Vec::new(),
            last_skip: None,
        })
    }

    /// Stores a picture of an action, and returns its name.
    pub(super) fn keep_picture(
        &self,
        number: u32,
        what: &str,
        picture: &RgbImage,
    ) -> Result<String, RunError> {
        let name = format!("step_{number}/{what}.png");
        self.folder.keep(&name, &png::encode(picture))
    }

    pub(super) fn keep_positions(
        &mut self,
        line: &mut record::Step,
        world: &dyn World,
    ) -> Result<(), RunError> {
        if let Some(positions) = world.particles() {
            let name = format!("step_{}/positions.npy", line.step);
            let name = self.folder.keep(&name, &npy::encode(&positions))?;
            line.files.positions = Some(name.clone());
            line.digest = Some(digest::of_positions(&positions));
            self.end.final_positions = Some(name);
        }
        Ok(())
    }

    /// Writes a step's line, counts the step, and records and returns its durations and costs.
    pub(super) fn keep_step(&mut self, turn: &Turn<'_>) -> Result<StepSpent, RunError> {
        let line = &turn.line;
        self.folder.append(&Line::Step(Box::new(line.clone())))?;
        let asked = !line.attempts.is_empty();
        let spent = StepSpent {
            step: line.step,
            planning_s: asked.then_some(turn.timer.planning.as_secs_f64()),
            seconds: turn.timer.seconds.clone(),
            so_far: self.asking.ledger.spent(),
        };
        self.folder.spend(&Spent::Step(spent.clone()))?;
        self.planned_s.extend(spent.planning_s);
        self.timer.absorb(&turn.timer);
        let report = &mut self.end.report;
        report.stopped.clone_from(&line.stopped);
        if line.executed.is_some() {
            report.steps += 1;
            report.retries += u32::from(turn.before.is_some());
        }
        if let Some(skipped) = line.skipped {
            report.skipped_steps += 1;
            *report.skipped.entry(skipped.name().to_owned()).or_default() += 1;
            self.last_skip = Some(skipped);
        }
        Ok(spent)
    }

    /// Returns the outcome of a rollout that took every step.
    ///
    /// A rollout in which nothing was ever executed ends as its last step would have.
    pub(super) fn outcome_at_horizon(&self, is_goal_met: bool) -> Outcome {
        match self.last_skip {
            Some(skipped) if self.end.report.steps == 0 => skipped,
            _ if is_goal_met => Outcome::GoalReached,
            _ => Outcome::HorizonReached,
        }
    }

    /// Compares the final state with the expert results, stores those beside it, and returns its distance from the nearest,
    /// metres.
    ///
    /// `None` if there is nothing to score, or nothing to score it against. Fails also if it is interrupted.
    pub(super) fn score(
        &mut self,
        job: &Job<'_>,
        world: &dyn World,
        progress: &mut dyn FnMut(Event),
    ) -> Result<Option<f64>, RunError> {
        let sequences = &job.program.experts;
        let particles = world.particles().filter(|_| !sequences.is_empty());
        let Some(particles) = particles else {
            return Ok(None);
        };
        let begun = Instant::now();
        let total = sequences.len();
        let results = expert::ends(
            Sequences {
                folds: sequences,
                manner: job.program.manner,
            },
            job.start,
            job.make_expert_world,
            job.cache,
            job.interrupt,
            &mut |missing| {
                let note = format!(
                    "simulating {missing} of {total} expert results to score against; they are kept for the next run"
                );
                progress(Event::Note { note });
            },
        )?;
        self.timer.add("experts", begun.elapsed());
        if let Some(note) = results.not_kept {
            progress(Event::Note { note });
        }
        let mut nearest: Option<(usize, f64)> = None;
        let mut experts = Vec::with_capacity(results.ends.len());
        for end in &results.ends {
            let distance_m = metrics::mean_particle_distance_m(&particles, &end.positions);
            let Some(distance_m) = distance_m else {
                continue;
            };
            let sequence = end.sequence + 1;
            let file = format!("experts/{sequence}.npy");
            experts.push(ExpertDistance {
                sequence,
                file: self.folder.keep(&file, &npy::encode(&end.positions))?,
                distance_mm: distance_m * 1000.0,
                folds: sequences[end.sequence].folds.clone(),
            });
            if nearest.is_none_or(|(_, least_m)| distance_m < least_m) {
                nearest = Some((sequence, distance_m));
            }
        }
        let Some((sequence, distance_m)) = nearest else {
            return Ok(None);
        };
        let end = &mut self.end;
        end.nearest_expert = Some(sequence);
        end.experts = Some(experts);
        end.report.mean_particle_distance_mm = Some(distance_m * 1000.0);
        end.report.judged_by = Some(JudgedBy {
            world: results.world,
            grid: [job.start.grid.dimx, job.start.grid.dimy],
        });
        Ok(Some(distance_m))
    }

    /// Writes contact sheet and end line, and returns the report.
    pub(super) fn close(
        mut self,
        job: &Job<'_>,
        outcome: Outcome,
        covered: Covered,
        wall: Duration,
    ) -> Result<Ended, RunError> {
        let goal = job.program.goal.as_ref().filter(|it| covered.judges(it));
        let report = &mut self.end.report;
        report.outcome = outcome;
        report.goal_reached = goal.map(|_| outcome == Outcome::GoalReached);
        report.coverage_source = covered.source;
        report.measures = covered.now;
        report.coverage_at_start = covered.at_start.coverage;
        report.coverage_true_at_start = covered.at_start.coverage_true;
        let spent = self.asking.ledger.spent();
        let n_planned = self.planned_s.len();
        let took = RunCosts {
            planning_s: (n_planned > 0)
                .then(|| self.planned_s.iter().sum::<f64>() / n_planned as f64),
            spent,
            faults: self.asking.ledger.faults().clone(),
            cost_usd: spent.known_cost().map(Usd::dollars),
            cost_usd_at_most: spent.priced_at_most().map(Usd::dollars),
            run_dir: self.folder.path().display().to_string(),
            seconds: self.timer.seconds,
            wall_s: wall.as_secs_f64(),
        };
        if let Some(operator) = job.operator.filter(|_| outcome.is_judged()) {
            report.operator = operator.judge(report, self.folder.path());
        }
        // A failed contact sheet must not lose a finished rollout.
        if let Some(picture) = self.sheet.picture(&self.header, report).unwrap_or_default() {
            self.end.sheet = Some(self.folder.keep(SHEET_FILE, &png::encode(&picture))?);
        }
        let report = report.clone();
        self.folder.append(&Line::End(Box::new(self.end)))?;
        self.folder.spend(&Spent::End {
            report: Box::new(took.clone()),
        })?;
        Ok(Ended {
            header: self.header,
            report,
            took,
        })
    }
}

impl Report {
    /// Counts a question, and a refused or unreadable answer.
    pub(super) fn count(&mut self, asked: &Asked) {
        self.queries += u32::from(asked.sent.request.is_some());
        match &asked.result {
            Finding::Action {
                verdict: Verdict::Reject { check, .. },
                ..
            } => *self.refusals.entry(check.clone()).or_default() += 1,
            Finding::Malformed(_) => self.malformed_replies += 1,
            Finding::Action { .. } | Finding::Text { .. } | Finding::Failed { .. } => {}
        }
    }
}

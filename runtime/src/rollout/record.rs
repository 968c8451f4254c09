//! What a rollout writes down, and the report it ends with.

use super::score::Covered;
use super::{Job, RunError, model_name};
use crate::action::Action;
use crate::expert::ExpertEnd;
use crate::journal::{JOURNAL_SCHEMA, JournalError, Line, RunFolder, StepLine};
use crate::model::{ModelRole, Nature};
use crate::outcome::Outcome;
use crate::sheet::Sheet;
use crate::vision;
use crate::world::World;
use crate::{digest, npy, picture};
use image::RgbImage;
use serde::Serialize;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The end of a rollout, as `fabc run --json` prints it; null where not applicable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The task's name.
    pub task: String,
    /// The variant that was run.
    pub variant: Option<String>,
    /// How it ended.
    pub outcome: Outcome,
    /// Whether the declared goal was met; null without a goal.
    pub goal_reached: Option<bool>,
    /// Mean distance to the nearest expert result, millimetres.
    pub mean_particle_distance_mm: Option<f64>,
    /// Covered share of the flat cloth's area.
    pub coverage: Option<f64>,
    /// Share of the missing coverage that was gained.
    pub normalized_improvement: Option<f64>,
    /// Executed steps.
    pub steps: u32,
    /// The model that answered; both names where the roles differ.
    pub model: String,
    /// Whether that model is an embedded stand-in and no vision-language model.
    pub model_is_stand_in: bool,
    /// The seed of the start, where one was given.
    pub seed: Option<u64>,
    /// Hash of the program.
    pub program: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// The run folder.
    pub run_dir: String,
    /// Identity of the run.
    pub run_id: String,
    /// How many expert results were simulated for the score; the others were cached.
    pub experts_simulated: usize,
    /// Wall time by what it was spent on, seconds.
    pub seconds: Map<String, Value>,
    /// Wall time of the whole run, seconds.
    pub wall_s: f64,
}

/// A final state's distances to the expert results.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Index of the nearest sequence in the program.
    pub sequence: usize,
    /// Distance to it, metres.
    pub distance_m: f64,
    /// All of them: sequence, distance in metres, file in the run folder.
    pub distances: Vec<(usize, f64, String)>,
    /// How many expert results had to be simulated.
    pub simulated: usize,
}

/// Adds up wall time by what it was spent on, in the order of first use.
#[derive(Clone, Debug, Default)]
pub(super) struct Timer {
    spent: Vec<(String, Duration)>,
}

impl Timer {
    pub(super) fn add(&mut self, what: &str, took: Duration) {
        match self.spent.iter_mut().find(|(known, _)| known == what) {
            Some((_, spent)) => *spent += took,
            None => self.spent.push((what.to_owned(), took)),
        }
    }

    pub(super) fn time<T>(&mut self, what: &str, work: impl FnOnce() -> T) -> T {
        let begun = std::time::Instant::now();
        let result = work();
        self.add(what, begun.elapsed());
        result
    }

    pub(super) fn write(&self, into: &mut Map<String, Value>) {
        for (what, spent) in &self.spent {
            into.insert(what.clone(), json!(spent.as_secs_f64()));
        }
    }
}

/// Writes a rollout into its folder.
pub(super) struct Keeper {
    pub(super) folder: RunFolder,
    pub(super) timer: Timer,
    run_id: String,
    params: String,
    steps: u32,
    final_positions: Option<String>,
}

impl Keeper {
    /// Writes program, start and header.
    pub(super) fn open(
        job: &Job<'_>,
        mut folder: RunFolder,
        world: &dyn World,
    ) -> Result<Keeper, RunError> {
        let program = serde_json::to_vec_pretty(job.program)
            .expect("a program has string keys and finite numbers");
        let program_file = folder.keep("program.json", &program)?;
        let start_file = folder.keep("start.npy", &npy::encode(&job.start.positions))?;
        let run_id = new_run_id(job, &folder);
        let model = |role| {
            let model = job.models.of(role);
            json!({ "name": model.name(), "nature": model.nature() })
        };
        let header = json!({
            "schema": JOURNAL_SCHEMA,
            "run_id": run_id,
            "fabc": env!("CARGO_PKG_VERSION"),
            "task": job.program.task,
            "variant": job.program.variant,
            "program": job.program.hash(),
            "program_file": program_file,
            "world": world.name(),
            "params": world.parameters(),
            "code": world.code(),
            "models": { "vision": model(ModelRole::Vision), "text": model(ModelRole::Text) },
            "start": {
                "name": job.start.name,
                "seed": job.start.seed,
                "file": start_file,
                "digest": job.start.digest(),
                "grid": job.start.grid,
                "up": "z",
            },
            "subgoals": job.subgoals.origin,
            "horizon": job.program.horizon,
            "attempts": job.program.verify.attempts,
            "goal": job.program.goal,
        });
        folder.append(&Line::Header(&header))?;
        Ok(Keeper {
            folder,
            timer: Timer::default(),
            run_id,
            params: world.parameters(),
            steps: 0,
            final_positions: None,
        })
    }

    pub(super) fn keep_picture(
        &self,
        line: &mut StepLine,
        what: &str,
        picture: &RgbImage,
    ) -> Result<(), JournalError> {
        let name = self.folder.keep(
            &format!("step_{}/{what}.png", line.step),
            &picture::encode(picture),
        )?;
        line.files.insert(what.to_owned(), json!(name));
        Ok(())
    }

    /// Keeps the picture before the step with the action drawn on it, and returns that picture.
    pub(super) fn keep_action(
        &self,
        line: &mut StepLine,
        before: &RgbImage,
        action: &Action,
    ) -> Result<RgbImage, RunError> {
        let mut drawn = before.clone();
        vision::draw_action(&mut drawn, action.pick_on_cloth_px, action.place_px)?;
        self.keep_picture(line, "action", &drawn)?;
        Ok(drawn)
    }

    pub(super) fn keep_positions(
        &mut self,
        line: &mut StepLine,
        world: &dyn World,
    ) -> Result<(), JournalError> {
        if let Some(positions) = world.particles() {
            let name = self.folder.keep(
                &format!("step_{}/positions.npy", line.step),
                &npy::encode(&positions),
            )?;
            line.files.insert("positions".to_owned(), json!(name));
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

    pub(super) fn count(&mut self, line: &StepLine, timer: &Timer) {
        self.steps += u32::from(line.executed.is_some());
        for (what, spent) in &timer.spent {
            self.timer.add(what, *spent);
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
    ) -> Result<Report, RunError> {
        let mut seconds = Map::new();
        self.timer.write(&mut seconds);
        let (vision, text) = (
            model_name(job, ModelRole::Vision),
            model_name(job, ModelRole::Text),
        );
        let stand_in = [ModelRole::Vision, ModelRole::Text]
            .iter()
            .any(|role| job.models.of(*role).nature() == Nature::StandIn);
        let report = Report {
            task: job.program.task.clone(),
            variant: job.program.variant.clone(),
            outcome,
            goal_reached: job
                .program
                .goal
                .as_ref()
                .map(|_| outcome == Outcome::GoalReached),
            mean_particle_distance_mm: score.map(|score| score.distance_m * 1000.0),
            coverage: covered.now,
            normalized_improvement: covered.improvement(),
            steps: self.steps,
            model: if vision == text {
                vision.to_owned()
            } else {
                format!("{vision}, {text}")
            },
            model_is_stand_in: stand_in,
            seed: job.start.seed,
            program: job.program.hash(),
            params: self.params.clone(),
            run_dir: self.folder.path().display().to_string(),
            run_id: self.run_id.clone(),
            experts_simulated: score.map_or(0, |score| score.simulated),
            seconds,
            wall_s: wall.as_secs_f64(),
        };
        // A rollout that is done is not lost for want of a picture of it.
        let sheet = match sheet.picture(&report).unwrap_or_default() {
            Some(picture) => Some(self.folder.keep("sheet.png", &picture::encode(&picture))?),
            None => None,
        };
        let experts = score.map(|score| {
            let entry = |(sequence, distance_m, file): &(usize, f64, String)| {
                json!({ "sequence": sequence + 1, "file": file, "distance_mm": distance_m * 1000.0, "folds": job.program.experts[*sequence].folds })
            };
            score.distances.iter().map(entry).collect::<Vec<_>>()
        });
        let end = json!({
            "report": report,
            "final": self.final_positions,
            "nearest_expert": score.map(|score| score.sequence + 1),
            "experts": experts,
            "sheet": sheet,
        });
        self.folder.append(&Line::End(&end))?;
        Ok(report)
    }
}

/// Names a run; two runs of the same thing have different names.
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
    crate::digest::hex(&Sha256::digest(identity))[..12].to_owned()
}

//! The types of a rollout's record, for writing and reading alike.
//!
//! `rollout.jsonl` holds a [`Header`], a [`Step`] for each action, and an [`End`]; its bytes are the same in every run
//! of the same rollout. `spent.jsonl` beside it holds what differs: durations, calls, money ([`Spent`]).
//! `docs/records.md` documents the format.

use crate::action::Action;
use crate::judgement::Judgement;
use crate::outcome::Outcome;
use crate::policy::{self, Accepted, Finding};
use crate::result::StepResult;
use crate::subgoals::Origin;
use fab_base::jsonl::Reader;
use fab_model::calls::{self, Fault, Usage};
use fab_program::{Fold, Goal, Metric, Proposal};
use fab_world::Executed;
use fab_world::metrics::ClothMoved;
use fab_world::start::{Grid, Up};
use fab_world::vary::AxisValues;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// Version of the lines.
pub const VERSION: u32 = 4;
/// Name of the file of lines in a run folder.
pub const RECORD_FILE: &str = "rollout.jsonl";
/// Name of the file beside it with durations and costs.
pub const SPENT_FILE: &str = "spent.jsonl";
/// The largest of both that is accepted, bytes.
pub const MAX_BYTES: u64 = 256 << 20;

/// One line of [`RECORD_FILE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Line {
    /// The first line: what is run.
    Header(Box<Header>),
    /// One step.
    Step(Box<Step>),
    /// The last line: the results.
    End(Box<End>),
}

/// What is run, and on what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`VERSION`] of the lines.
    pub schema: u32,
    /// Version of the program that wrote them.
    pub fabc: String,
    /// The task's name.
    pub task: String,
    /// The variant that is run.
    pub variant: Option<String>,
    /// Hash of the program.
    pub program: String,
    /// The program, in the run folder.
    pub program_file: String,
    /// The world's name.
    pub world: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// Digest of the world's code.
    pub code: String,
    /// The values in which the world differs from the task's own, by axis; absent if it does not.
    #[serde(default, skip_serializing_if = "AxisValues::is_empty")]
    pub vary: AxisValues,
    /// The policy.
    pub policy: policy::Description,
    /// The start of the rollout.
    pub start: StartFile,
    /// The origin of the subgoal pictures.
    pub subgoals: Origin,
    /// Digest of these pictures.
    pub subgoal_pictures: String,
    /// The most actions.
    pub horizon: u32,
    /// Whether a goal judged after each step ends the rollout.
    pub early_stop: bool,
    /// The number of the rollout among those of the same start.
    pub repetition: u32,
    /// The start in the suite that the answers were drawn for; absent if equal questions at all starts share them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn_for: Option<u64>,
}

/// The start of a rollout, as the run folder keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartFile {
    /// Its name.
    pub name: String,
    /// The seed that crumpled it, if it was crumpled.
    pub seed: Option<u64>,
    /// Positions of its particles, in the run folder.
    pub file: String,
    /// Digest of grid, outline and positions.
    pub digest: String,
    /// Its grid.
    pub grid: Grid,
    /// Which axis of the positions points away from the table.
    pub up: Up,
}

/// One step; every file is relative to the run folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// From 1.
    pub step: u32,
    /// The scene's keypoints in pixels, or null if the picture gave none.
    pub scene: Value,
    /// Every question of the step.
    pub attempts: Vec<Asked>,
    /// The answer that was taken, if any.
    pub accepted: Option<Accepted>,
    /// What each gripper is to do; null if nothing.
    pub action: Option<Vec<Action>>,
    /// What the world really did.
    pub executed: Option<Executed>,
    /// SHA-256 of all positions' bits after the action, as `fabc sim replay` prints it, if the world knows them.
    pub digest: Option<String>,
    /// How far the action moved the cloth; null if the world does not know its particles.
    pub cloth: Option<ClothMoved>,
    /// In how many places an edge of the simulated cloth goes through it after the action, if there is one; no real cloth has
    /// such.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crossings: Option<usize>,
    /// The cloth's coverage after the action, if the world knows it.
    #[serde(flatten)]
    pub measures: Measures,
    /// The comparison with the next subgoal after the action, if the task asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result: Option<StepResult>,
    /// What was tried on twins before the action, if the task rehearses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rehearsal: Option<RehearsedStep>,
    /// The outcome that the rollout would have ended with, if the step was skipped instead.
    pub skipped: Option<Outcome>,
    /// Why the step ended the rollout, in words.
    pub stopped: Option<String>,
    /// Pictures and positions.
    pub files: StepFiles,
}

impl Step {
    /// Returns whether an action was executed or the step was skipped; otherwise the rollout ended in it.
    pub fn is_taken(&self) -> bool {
        self.executed.is_some() || self.skipped.is_some()
    }

    /// Returns the answer that was taken, if any.
    pub fn proposal(&self) -> Option<Proposal> {
        let Accepted { stage, attempt, .. } = self.accepted.as_ref()?;
        let mut asked = self.attempts.iter();
        let taken = asked.find(|it| it.stage == *stage && it.attempt == *attempt)?;
        match &taken.result {
            Finding::Action { fields, .. } => Some(Proposal {
                fields: fields.clone(),
            }),
            _ => None,
        }
    }
}

/// What was tried on twins in a step. How long it took is in [`SPENT_FILE`], under `rehearse`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RehearsedStep {
    /// The overlap of the twins' silhouettes with the camera's cloth before the action, their mean from 0 to 1; null if
    /// there are no twins.
    pub overlap: Option<f64>,
    /// Why nothing could be tried on the twins; null if it could.
    pub aside: Option<String>,
    /// Each answer that was folded on the twins, in order.
    pub candidates: Vec<RehearsedAnswer>,
}

/// An answer that was folded on the twins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RehearsedAnswer {
    /// The number of its question, among those of the stage.
    pub attempt: u32,
    /// The mean of the declared measure; null if none is declared or a twin failed.
    pub measure: Option<f64>,
    /// The measure on each twin.
    pub twins: Vec<f64>,
    /// Why a twin failed, if one did.
    pub failed: Option<String>,
}

/// Pictures and positions of a step, in the run folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct StepFiles {
    /// The camera's picture before the action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<String>,
    /// The same with the action drawn on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub action: Option<String>,
    /// The camera's picture after the action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<String>,
    /// Positions of all particles after the action, if the world knows them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<String>,
}

/// A question, as the run folder keeps it; all null if there was none.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SentFiles {
    /// Its content address.
    pub request_key: Option<String>,
    /// The question as sent.
    pub request: Option<String>,
    /// The question in readable form, if it is a prompt.
    pub prompt: Option<String>,
}

/// One answer of a step, and its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// The stage that asked; `policy` where the policy has no stages.
    pub stage: String,
    /// The attempt's number within this stage and step, from 1.
    pub attempt: u32,
    /// The question.
    #[serde(flatten)]
    pub sent: SentFiles,
    /// The policy's note about it, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The answer, if one came.
    pub reply: Option<String>,
    /// Its meaning.
    pub result: Finding,
    /// Token usage as reported by the provider.
    pub usage: Option<Usage>,
}

impl Asked {
    /// Makes the entry of an attempt without a question and a reply.
    pub(crate) fn new(stage: &str, attempt: u32, result: Finding) -> Asked {
        Asked {
            stage: stage.to_owned(),
            attempt,
            sent: SentFiles::default(),
            note: None,
            reply: None,
            result,
            usage: None,
        }
    }
}

/// The results of a rollout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Its figures.
    pub report: Report,
    /// Final positions of all particles, in the run folder, if the world knows them.
    #[serde(rename = "final")]
    pub final_positions: Option<String>,
    /// The closest expert sequence, from 1.
    pub nearest_expert: Option<usize>,
    /// All expert sequences that it was compared with.
    pub experts: Option<Vec<ExpertDistance>>,
    /// The contact sheet, in the run folder.
    pub sheet: Option<String>,
}

/// The distance of a final state from one expert result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExpertDistance {
    /// The sequence, from 1.
    pub sequence: usize,
    /// The expert's particles, in the run folder.
    pub file: String,
    /// Mean distance of particles, millimetres.
    pub distance_mm: f64,
    /// Its folds.
    pub folds: Vec<Fold>,
}

/// One line of [`SPENT_FILE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Spent {
    /// A step was taken.
    Step(StepSpent),
    /// The rollout ended.
    End {
        /// The totals of the rollout.
        report: Box<RunCosts>,
    },
}

/// Durations and costs of a step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepSpent {
    /// From 1.
    pub step: u32,
    /// Wall time of render, vision, prompt, parse and verify, seconds; null if no action was asked for.
    pub planning_s: Option<f64>,
    /// Wall time by activity, seconds.
    pub seconds: Map<String, Value>,
    /// What the calls up to this step added up to.
    pub so_far: calls::Spent,
}

impl StepSpent {
    /// Returns the wall time of all that is timed in the step, seconds.
    pub fn took_s(&self) -> f64 {
        self.seconds.values().filter_map(Value::as_f64).sum()
    }
}

/// The cloth's coverage at one moment (protocol, section 5); null if the world does not know it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Covered share of the flat cloth's area by the source measure: SoftGym's, or by pictures.
    pub coverage: Option<f64>,
    /// The same by the true measure; null for pictures.
    pub coverage_true: Option<f64>,
    /// The gained share of the initially missing coverage, by the source measure.
    pub normalized_improvement: Option<f64>,
    /// The same by the true measure; null for pictures.
    pub normalized_improvement_true: Option<f64>,
}

impl Measures {
    /// Returns whether they meet a goal that is judged after each step: by the source measure.
    pub fn meet(&self, goal: &Goal) -> bool {
        let value = match goal.metric {
            Metric::Coverage => self.coverage,
            Metric::NormalizedImprovement => self.normalized_improvement,
            Metric::ParticleDistance => None,
        };
        value.is_some_and(|value| goal.is_met(value))
    }
}

/// What coverage is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoverageSource {
    /// The particles of a simulated cloth, by SoftGym's measure and by the true one.
    Particles,
    /// The cloth's pixels, relative to those in a picture of the flat cloth.
    Picture,
}

/// The figures of a rollout that are the same in every run of it; null if not applicable.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Why it ended before its last step, in words; for an arm, also what is verified. Null if it did not.
    pub stopped: Option<String>,
    /// Whether the declared goal was met; null without a goal, or if the world lacks what it is judged on.
    pub goal_reached: Option<bool>,
    /// The operator's judgement; null if nobody was asked or nobody answered.
    pub operator: Option<Judgement>,
    /// Mean distance to the nearest expert result, millimetres.
    pub mean_particle_distance_mm: Option<f64>,
    /// The source of these expert results; null if nothing was compared.
    pub judged_by: Option<JudgedBy>,
    /// What coverage was measured on, and so what its figures can be compared with; null if nothing was measured.
    pub coverage_source: Option<CoverageSource>,
    /// The final measures.
    #[serde(flatten)]
    pub measures: Measures,
    /// Coverage of the start, by the source measure.
    pub coverage_at_start: Option<f64>,
    /// Coverage of the start, by the true measure.
    pub coverage_true_at_start: Option<f64>,
    /// Executed steps.
    pub steps: u32,
    /// Steps without an action after which the rollout went on.
    pub skipped_steps: u32,
    /// Skipped steps by the outcome that the rollout would have ended with, e.g. `attempts_exhausted`.
    pub skipped: BTreeMap<String, u32>,
    /// Executed actions that were retries because the previous result did not match the subgoal.
    pub retries: u32,
    /// Requests sent.
    pub queries: u32,
    /// Number of refused actions by check.
    pub refusals: BTreeMap<String, u32>,
    /// Answers that could not be read.
    pub malformed_replies: u32,
}

/// The source of the expert results that a rollout was compared with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JudgedBy {
    /// Name of the world that simulated them.
    pub world: String,
    /// Particles along both sides of the cloth, in those results and in the rollout.
    pub grid: [u32; 2],
}

/// Durations and costs of a rollout, which differ between runs of the same one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunCosts {
    /// Mean time per action of render, vision, prompt, parse and verify, seconds: everything except the model, the
    /// motion, and the writing of files. Null if no action was asked for.
    pub planning_s: Option<f64>,
    /// What the calls added up to, retries and failed ones included.
    #[serde(flatten)]
    pub spent: calls::Spent,
    /// Number of failed calls by fault.
    pub faults: BTreeMap<Fault, u32>,
    /// Cost of the answers, US dollars; null if a price or a call's usage is unknown.
    pub cost_usd: Option<f64>,
    /// The most that all calls cost: those that reported no usage, or may have been billed, as reserved.
    pub cost_usd_at_most: Option<f64>,
    /// The run folder.
    pub run_dir: String,
    /// Wall time by activity, seconds.
    pub seconds: Map<String, Value>,
    /// Wall time of the whole run, seconds.
    pub wall_s: f64,
}

/// A run folder that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What was run.
    pub header: Header,
    /// Its steps, in order; the last one may have ended it.
    pub steps: Vec<Step>,
    /// Its results; `None` if it was interrupted.
    pub end: Option<End>,
    /// Durations and costs of the steps, by number; for a repeated step, the first time counts.
    pub spent: BTreeMap<u32, StepSpent>,
    /// The totals, if it ended.
    pub took: Option<RunCosts>,
}

/// Why a run folder cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// It holds no record of a rollout, or one that has not begun.
    #[error("it holds no rollout: {0}")]
    Absent(String),
    /// Another version of the program wrote it.
    #[error("its lines have version {0}, and this program reads version {VERSION}")]
    Version(u32),
    /// A file is damaged; says what is wrong.
    #[error("its {0} cannot be read: {1}")]
    Damaged(&'static str, String),
}

impl Record {
    /// Reads a run folder; a torn line at the end of a file counts as not written.
    pub fn read(folder: &Path) -> Result<Record, RecordError> {
        let damaged = |why: String| RecordError::Damaged(RECORD_FILE, why);
        let lines = Reader::open(&folder.join(RECORD_FILE), MAX_BYTES);
        let mut lines = lines.map_err(RecordError::Absent)?;
        let Some(first) = lines.next_line().map_err(damaged)? else {
            return Err(RecordError::Absent(format!("{RECORD_FILE} has no line")));
        };
        // The common part of all versions' first lines.
        let version = serde_json::from_slice::<Value>(first).ok();
        let version = version.and_then(|line| u32::try_from(line["schema"].as_u64()?).ok());
        if let Some(other) = version.filter(|version| *version != VERSION) {
            return Err(RecordError::Version(other));
        }
        let header = match serde_json::from_slice(first) {
            Ok(Line::Header(header)) => *header,
            Ok(_) => return Err(damaged("it does not begin with a header".to_owned())),
            Err(error) => return Err(damaged(format!("line 1 is damaged: {error}"))),
        };
        let mut record = Record {
            header,
            steps: Vec::new(),
            end: None,
            spent: BTreeMap::new(),
            took: None,
        };
        while let Some(line) = lines.read().map_err(damaged)? {
            match line {
                Line::Step(step) => record.steps.push(*step),
                Line::End(last) => record.end = Some(*last),
                Line::Header(_) => return Err(damaged("it has two headers".to_owned())),
            }
        }
        // A copied folder may lack it: it holds none of the rollout's figures.
        let path = folder.join(SPENT_FILE);
        if path.exists() {
            let damaged = |why: String| RecordError::Damaged(SPENT_FILE, why);
            let mut lines = Reader::open(&path, MAX_BYTES).map_err(damaged)?;
            while let Some(line) = lines.read().map_err(damaged)? {
                match line {
                    Spent::Step(step) => {
                        record.spent.entry(step.step).or_insert(step);
                    }
                    Spent::End { report } => record.took = Some(*report),
                }
            }
        }
        Ok(record)
    }
}

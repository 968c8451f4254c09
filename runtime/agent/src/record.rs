//! What a rollout writes down, and what every later reader reads: one set of types, both ways.
//!
//! `rollout.jsonl` holds a [`Header`], a [`Step`] for each action, and an [`End`]; its bytes are the same in each run of the
//! same rollout. `spent.jsonl` beside it holds what differs: times, calls, money ([`Spent`]). `docs/records.md` states the
//! format.

use crate::action::Action;
use crate::judgement::Judgement;
use crate::outcome::Outcome;
use crate::policy::{self, Accepted, Finding};
use crate::result::StepResult;
use crate::subgoals::Origin;
use fab_base::jsonl::Reader;
use fab_model::calls::{self, Usage};
use fab_program::{Fold, Goal};
use fab_world::Executed;
use fab_world::start::{Grid, Up};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// Version of the lines.
pub const VERSION: u32 = 2;
/// Name of the file of lines in a run folder.
pub const RECORD_FILE: &str = "rollout.jsonl";
/// Name of the file beside it that says what the rollout took.
pub const SPENT_FILE: &str = "spent.jsonl";
/// The largest record that is read.
pub const MAX_BYTES: u64 = 256 << 20;
/// The largest file of what was spent that is read.
pub const MAX_SPENT_BYTES: u64 = 64 << 20;

/// One line of [`RECORD_FILE`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Line {
    /// The first line: what was run.
    Header(Box<Header>),
    /// One step.
    Step(Box<Step>),
    /// The last line: what came of it.
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
    /// Who decides.
    pub policy: policy::Description,
    /// Where the cloth lies at first.
    pub start: StartFile,
    /// Where the subgoal pictures come from.
    pub subgoals: Origin,
    /// Digest of these pictures.
    pub subgoal_pictures: String,
    /// The most actions.
    pub horizon: u32,
    /// Whether a goal that is judged after each step ends the rollout.
    pub early_stop: bool,
    /// Which of the start's rollouts it is.
    pub repetition: u32,
    /// The most questions of a stage in a step.
    pub attempts: u32,
    /// The task's goal.
    pub goal: Option<Goal>,
}

/// The start of a rollout, as the run folder keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartFile {
    /// Its name.
    pub name: String,
    /// The seed by which it was crumpled, where it was.
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
    /// Keypoints in pixels, or null where the picture gave none.
    pub scene: Value,
    /// Every question of the step.
    pub attempts: Vec<Asked>,
    /// Which answer was taken, where one was.
    pub accepted: Option<Accepted>,
    /// What was to be executed, where something was.
    pub action: Option<Action>,
    /// What the world really did.
    pub executed: Option<Executed>,
    /// SHA-256 of all positions' bits after it, as `fabc sim replay` prints it, where the world knows.
    pub digest: Option<String>,
    /// How much the cloth covers after it, where the world knows.
    #[serde(flatten)]
    pub measures: Measures,
    /// The cloth after it beside the next subgoal, where the task compares them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result: Option<StepResult>,
    /// What the rollout would have ended with, where the step was skipped instead.
    pub skipped: Option<Outcome>,
    /// Why the step ended the rollout, in words.
    pub stopped: Option<String>,
    /// Pictures and positions.
    pub files: StepFiles,
}

impl Step {
    /// Returns whether something was executed, or the step was skipped; else the rollout ended in it.
    pub fn is_taken(&self) -> bool {
        self.executed.is_some() || self.skipped.is_some()
    }
}

/// Pictures and positions of a step, in the run folder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct StepFiles {
    /// What the camera saw before the action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<String>,
    /// The same with the action drawn on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub action: Option<String>,
    /// What the camera saw after the action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<String>,
    /// Positions of all particles after the action, where the world knows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub positions: Option<String>,
}

/// One answer of a step, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Asked {
    /// The stage that asked; `policy` where the policy has no stages.
    pub stage: String,
    /// Which one of this stage and step it was, from 1.
    pub attempt: u32,
    /// Content address of the question; null where nobody was asked.
    pub request_key: Option<String>,
    /// The question as it was sent, in the run folder.
    pub request: Option<String>,
    /// The same as people read it, where it is a prompt.
    pub prompt: Option<String>,
    /// What the policy says of it, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// The answer, where one came.
    pub reply: Option<String>,
    /// What it meant.
    pub result: Finding,
    /// Tokens that the provider says were used.
    pub usage: Option<Usage>,
}

/// What came of a rollout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct End {
    /// Its figures.
    pub report: Report,
    /// Positions of all particles in the end, in the run folder, where the world knows.
    #[serde(rename = "final")]
    pub final_positions: Option<String>,
    /// The expert sequence that it came nearest to, from 1.
    pub nearest_expert: Option<usize>,
    /// All expert sequences that it was compared with.
    pub experts: Option<Vec<ExpertDistance>>,
    /// The contact sheet, in the run folder.
    pub sheet: Option<String>,
}

/// How far a final state is from one expert result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExpertDistance {
    /// The sequence, from 1.
    pub sequence: usize,
    /// Its particles, in the run folder.
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
    /// The rollout began, or was gone on with.
    Begin {
        /// Identity of the run.
        run_id: String,
    },
    /// A step was taken.
    Step(StepSpent),
    /// The rollout ended.
    End {
        /// What all of it took.
        report: Box<Took>,
    },
}

/// What a step took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepSpent {
    /// From 1.
    pub step: u32,
    /// Wall time of render, vision, prompt, parse and verify, seconds; null where no action was asked for.
    pub planning_s: Option<f64>,
    /// Wall time by what it was spent on, seconds.
    pub seconds: Map<String, Value>,
    /// What the answers of this step and those before cost, US dollars; null where a price is not known.
    pub cost_usd_so_far: Option<f64>,
}

/// How much the cloth covers at one moment (protocol, section 5); null where the world does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Covered share of the flat cloth's area by the source measure: SoftGym's, or that of pictures.
    pub coverage: Option<f64>,
    /// The same, measured truly; null of pictures.
    pub coverage_true: Option<f64>,
    /// Share of the coverage missing at first that was gained, by the source measure.
    pub normalized_improvement: Option<f64>,
    /// The same, measured truly; null of pictures.
    pub normalized_improvement_true: Option<f64>,
}

/// What coverage is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CoverageSource {
    /// The particles of a simulated cloth, by SoftGym's measure and by the true one.
    Particles,
    /// The cloth's pixels, over those in a picture of the flat cloth.
    Picture,
}

/// The figures of a rollout that are the same in each run of it; null where not applicable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The task's name.
    pub task: String,
    /// The variant that was run.
    pub variant: Option<String>,
    /// How it ended.
    pub outcome: Outcome,
    /// Why it ended before its last step, in words: of an arm, what is verified; null where it did not.
    pub stopped: Option<String>,
    /// Whether the declared goal was met; null without a goal, and where the world does not know what it is judged on.
    pub goal_reached: Option<bool>,
    /// What the operator says of it; null where nobody was asked, or nobody answered.
    pub operator: Option<Judgement>,
    /// Mean distance to the nearest expert result, millimetres.
    pub mean_particle_distance_mm: Option<f64>,
    /// Whose expert results these are; null where nothing was compared.
    pub judged_by: Option<JudgedBy>,
    /// What coverage was measured on, which says what its figures can be compared with; null where nothing was measured.
    pub coverage_source: Option<CoverageSource>,
    /// Covered share of the flat cloth's area in the end, by the source measure: SoftGym's, or that of pictures.
    pub coverage: Option<f64>,
    /// The same, measured truly.
    pub coverage_true: Option<f64>,
    /// Share of the coverage missing at first that was gained, by the source measure.
    pub normalized_improvement: Option<f64>,
    /// The same, measured truly.
    pub normalized_improvement_true: Option<f64>,
    /// Coverage of the start, by the source measure.
    pub coverage_at_start: Option<f64>,
    /// Coverage of the start, measured truly.
    pub coverage_true_at_start: Option<f64>,
    /// The measures after each step, skipped ones included.
    pub progress: Vec<Progress>,
    /// Executed steps.
    pub steps: u32,
    /// Steps in which nothing was executed and the rollout went on.
    pub skipped_steps: u32,
    /// Those steps by what they would have ended the rollout with, e.g. `attempts_exhausted`.
    pub skipped: BTreeMap<String, u32>,
    /// Executed steps that were further tries, because the result before was not like the subgoal.
    pub retries: u32,
    /// Requests sent.
    pub queries: u32,
    /// Refused actions by the check that refused them.
    pub refusals: BTreeMap<String, u32>,
    /// Answers that could not be read.
    pub malformed_replies: u32,
    /// Who decided, with what a reader of the figures must know.
    pub policy: String,
    /// Whether the policy looked at the true places of particles, which no camera shows.
    pub sees_particles: bool,
    /// The model that answered; both names where the roles differ, null where no model was asked.
    pub model: Option<String>,
    /// Whether that model is an embedded stand-in and no vision-language model.
    pub model_is_stand_in: bool,
    /// The seed of the start, where one was given.
    pub seed: Option<u64>,
    /// Hash of the program.
    pub program: String,
    /// Name of the world.
    pub world: String,
    /// Hash of the world's parameters.
    pub params: String,
}

/// Whose expert results a rollout was compared with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct JudgedBy {
    /// Name of the world that they were simulated in.
    pub world: String,
    /// Particles along both sides of the cloth, in those results and in what is compared.
    pub grid: [u32; 2],
}

/// What a rollout took, which differs between two runs of the same one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Took {
    /// Mean time per action of render, vision, prompt, parse and verify, seconds: all but the model, the
    /// motion, and the writing of files. Null where no action was asked for.
    pub planning_s: Option<f64>,
    /// Calls sent to models over the network, each further try included.
    pub calls: u64,
    /// Those of them that gave no answer and may have been billed.
    pub possibly_billed: u64,
    /// Calls that failed, by what went wrong.
    pub faults: BTreeMap<String, u32>,
    /// Tokens that the providers say were used.
    pub usage: Usage,
    /// What the answers cost, US dollars; null where a price is not known.
    pub cost_usd: Option<f64>,
    /// The same with all that may have been billed.
    pub cost_usd_at_most: Option<f64>,
    /// The same sums, exactly.
    #[serde(skip)]
    pub spent: calls::Spent,
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

/// The measures after one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// From 1.
    pub step: u32,
    /// How much the cloth then covers.
    #[serde(flatten)]
    pub measures: Measures,
}

/// What the first lines of all versions have in common.
#[derive(Deserialize)]
struct Versioned {
    schema: u32,
}

/// A run folder, read.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What was run.
    pub header: Header,
    /// Its steps, in order; the last may be one that ended it.
    pub steps: Vec<Step>,
    /// What came of it; none where it was cut off.
    pub end: Option<End>,
    /// What the steps took, by their number; of a step that was done again, the first time counts.
    pub spent: BTreeMap<u32, StepSpent>,
    /// What all of it took, where it ended.
    pub took: Option<Took>,
}

/// Why a run folder cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// It holds no record of a rollout, or none that has begun.
    #[error("it holds no rollout: {0}")]
    Absent(String),
    /// Another version of the program wrote it.
    #[error("its lines have version {found}, and this program reads version {VERSION}")]
    Version {
        /// The version of its lines.
        found: u32,
    },
    /// A file is damaged.
    #[error("its {file} cannot be read: {why}")]
    Damaged {
        /// The file.
        file: &'static str,
        /// What is wrong.
        why: String,
    },
}

impl Record {
    /// Reads a run folder; a line that was cut off at the end of a file counts as not written.
    pub fn read(folder: &Path) -> Result<Record, RecordError> {
        let damaged = |why: String| RecordError::Damaged {
            file: RECORD_FILE,
            why,
        };
        let lines = Reader::open(&folder.join(RECORD_FILE), MAX_BYTES);
        let mut lines = lines.map_err(RecordError::Absent)?;
        let first = lines.next_line().map_err(damaged)?;
        let Some(first) = first else {
            return Err(RecordError::Absent(format!("{RECORD_FILE} has no line")));
        };
        let version = serde_json::from_slice(first).ok();
        if let Some(Versioned { schema }) = version.filter(|it: &Versioned| it.schema != VERSION) {
            return Err(RecordError::Version { found: schema });
        }
        let header = match serde_json::from_slice(first) {
            Ok(Line::Header(header)) => *header,
            Ok(_) => return Err(damaged("it does not begin with a header".to_owned())),
            Err(error) => return Err(damaged(format!("line 1 is damaged: {error}"))),
        };
        let (mut steps, mut end) = (Vec::new(), None);
        while let Some(line) = lines.read().map_err(damaged)? {
            match line {
                Line::Step(step) => steps.push(*step),
                Line::End(last) => end = Some(*last),
                Line::Header(_) => return Err(damaged("it has two headers".to_owned())),
            }
        }
        let (spent, took) = read_spent(folder)?;
        Ok(Record {
            header,
            steps,
            end,
            spent,
            took,
        })
    }
}

fn read_spent(folder: &Path) -> Result<(BTreeMap<u32, StepSpent>, Option<Took>), RecordError> {
    let damaged = |why: String| RecordError::Damaged {
        file: SPENT_FILE,
        why,
    };
    let path = folder.join(SPENT_FILE);
    let (mut spent, mut took) = (BTreeMap::new(), None);
    // A copied folder may lack it: no figure of the rollout stands in it.
    if !path.exists() {
        return Ok((spent, took));
    }
    let mut lines = Reader::open(&path, MAX_SPENT_BYTES).map_err(damaged)?;
    while let Some(line) = lines.read().map_err(damaged)? {
        match line {
            Spent::Begin { .. } => {}
            Spent::Step(step) => {
                spent.entry(step.step).or_insert(step);
            }
            Spent::End { report } => took = Some(*report),
        }
    }
    Ok((spent, took))
}

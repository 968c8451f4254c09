//! What a rollout comes to, as `fabc run --json` and the journal's last line say it.

use super::covered::{CoverageSource, Measures};
use crate::operator::Judgement;
use crate::outcome::Outcome;
use fab_model::calls::{Spent, Usage};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The end of a rollout, as `fabc run --json` prints it; null where not applicable.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    pub spent: Spent,
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

/// The fields that differ between two runs of the same rollout.
const PASSING: [&str; 12] = [
    "planning_s",
    "calls",
    "possibly_billed",
    "faults",
    "usage",
    "cost_usd",
    "cost_usd_at_most",
    "run_dir",
    "run_id",
    "experts_simulated",
    "seconds",
    "wall_s",
];

impl Report {
    /// Returns what is the same in each run of the same rollout, for the journal.
    pub fn lasting(&self) -> Value {
        self.part(|name| !PASSING.contains(&name))
    }

    /// Returns what it took this time.
    pub fn passing(&self) -> Value {
        self.part(|name| PASSING.contains(&name))
    }

    fn part(&self, wanted: impl Fn(&str) -> bool) -> Value {
        let whole = serde_json::to_value(self).expect("a report has string keys");
        let fields = whole.as_object().into_iter().flatten();
        let chosen = fields.filter(|(name, _)| wanted(name));
        Value::Object(
            chosen
                .map(|(name, value)| (name.clone(), value.clone()))
                .collect(),
        )
    }
}

/// The measures after one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Progress {
    /// From 1.
    pub step: u32,
    /// How much the cloth then covers.
    #[serde(flatten)]
    pub measures: Measures,
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

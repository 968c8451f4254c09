//! What recorded rollouts say about the next ones: how often a stage was asked, and how many tokens that took.
//!
//! In: a folder that holds run folders, such as a suite's. Out: sums by task, variant, models and stage. A run folder
//! that cannot be read says nothing, and is left out.

use crate::record::{RECORD_FILE, Record};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// How deep below the folder run folders are looked for; a suite keeps them three below its own.
const MOST_LEVELS: u32 = 6;
/// The most run folders that are read.
const MOST_RUNS: usize = 10_000;

/// The rollouts that say something about each other: those of one task's variant with the same models.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Setting {
    /// The task.
    pub task: String,
    /// Its variant.
    pub variant: Option<String>,
    /// The models for vision and for text.
    pub models: [String; 2],
}

/// What recorded calls of a stage took on average.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageHabit {
    /// The calls that reported their tokens.
    pub calls: u64,
    /// Questions per step.
    pub calls_per_step: f64,
    /// The part of its horizon that a rollout takes.
    pub steps_share: f64,
    /// Input tokens of a call.
    pub input_tokens: f64,
    /// Output tokens of a call, hidden ones included.
    pub output_tokens: f64,
}

/// Sums over recorded rollouts.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    rollouts: BTreeMap<Setting, Lengths>,
    stages: BTreeMap<(Setting, String), Sums>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Lengths {
    /// Steps of all rollouts, also of those that were cut off.
    steps: u64,
    /// Steps of those that ended, and the most that they might have taken.
    ended: [u64; 2],
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    asked: u64,
    reported: u64,
    input_tokens: u64,
    output_tokens: u64,
}

impl Recorded {
    /// Reads the run folders in a folder; none if it does not exist.
    pub fn below(folder: &Path) -> Recorded {
        let mut recorded = Recorded::default();
        recorded.walk(folder, MOST_LEVELS, &mut MOST_RUNS.clone());
        recorded
    }

    /// Returns what a stage usually takes; `None` if no recorded call of it reported its tokens.
    pub fn stage(&self, setting: &Setting, stage: &str) -> Option<StageHabit> {
        let lengths = self.rollouts.get(setting)?;
        let sums = self.stages.get(&(setting.clone(), stage.to_owned()))?;
        if sums.reported == 0 || lengths.steps == 0 {
            return None;
        }
        let reported = sums.reported as f64;
        let [taken, most] = lengths.ended.map(|steps| steps as f64);
        Some(StageHabit {
            calls: sums.reported,
            calls_per_step: sums.asked as f64 / lengths.steps as f64,
            steps_share: if most > 0.0 { taken / most } else { 1.0 },
            input_tokens: sums.input_tokens as f64 / reported,
            output_tokens: sums.output_tokens as f64 / reported,
        })
    }

    fn walk(&mut self, folder: &Path, levels: u32, left: &mut usize) {
        if *left == 0 {
            return;
        }
        if folder.join(RECORD_FILE).is_file() {
            *left -= 1;
            if let Ok(record) = Record::read(folder) {
                self.add(&record);
            }
            return;
        }
        if levels == 0 {
            return;
        }
        let Ok(entries) = fs::read_dir(folder) else {
            return;
        };
        let is_folder = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
        let mut folders: Vec<_> = entries
            .flatten()
            .filter(is_folder)
            .map(|it| it.path())
            .collect();
        folders.sort();
        for folder in folders {
            self.walk(&folder, levels - 1, left);
        }
    }

    fn add(&mut self, record: &Record) {
        let Some(models) = &record.header.policy.models else {
            return;
        };
        let setting = Setting {
            task: record.header.task.clone(),
            variant: record.header.variant.clone(),
            models: [models.vision.name.clone(), models.text.name.clone()],
        };
        let steps = record.steps.len() as u64;
        let lengths = self.rollouts.entry(setting.clone()).or_default();
        lengths.steps += steps;
        if record.end.is_some() {
            lengths.ended[0] += steps;
            lengths.ended[1] += u64::from(record.header.horizon);
        }
        for asked in record.steps.iter().flat_map(|step| &step.attempts) {
            let key = (setting.clone(), asked.stage.clone());
            let sums = self.stages.entry(key).or_default();
            sums.asked += 1;
            if let Some(usage) = asked.usage {
                sums.reported += 1;
                sums.input_tokens = sums.input_tokens.saturating_add(usage.input_tokens);
                sums.output_tokens = sums.output_tokens.saturating_add(usage.output_tokens);
            }
        }
    }
}

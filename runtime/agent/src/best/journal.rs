//! The journal of finished trials, so that a stopped search goes on where it was.
//!
//! In: what each trial led to, in any order. Out: a line each, and all lines of an earlier search of the same task and
//! start. A trial is told by its motions from the start on; its state is not kept, and computed again where it is needed.

use super::BestError;
use crate::result::StepResult;
use fab_base::jsonl::{Appender, Reader};
use fab_world::Grasp;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Name of the journal in the folder of a search.
pub const TRIALS_FILE: &str = "trials.jsonl";

/// The longest journal that is read, bytes: several million trials.
const MAX_BYTES: u64 = 1 << 30;

/// What a journal's trials depend on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Hash of the program.
    pub program: String,
    /// Digest of the start.
    pub start: String,
    /// Hash of the world's parameters.
    pub params: String,
    /// Digest of the world's code.
    pub code: String,
    /// Digest of the subgoal pictures.
    pub subgoals: String,
}

/// What a trial led to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialRecord {
    /// What was grasped.
    pub grasp: Grasp,
    /// The measure of the cloth; `None` if it cannot be measured.
    pub value: Option<f64>,
    /// How far the cloth is from the experts'.
    pub behind: Option<f64>,
    /// The comparison with the next subgoal picture, if the task compares.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub result: Option<StepResult>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Search(Identity),
    Trial {
        key: String,
        // The name in the file.
        #[serde(rename = "outcome")]
        record: TrialRecord,
    },
}

/// An open journal.
#[derive(Debug)]
pub struct TrialJournal {
    known: BTreeMap<String, TrialRecord>,
    file: Mutex<Appender>,
}

impl TrialJournal {
    /// Opens the journal in a folder, or begins one.
    ///
    /// Fails if it is that of another search, is damaged, or another process writes it.
    pub fn open(folder: &Path, identity: &Identity) -> Result<TrialJournal, BestError> {
        let path = folder.join(TRIALS_FILE);
        let wrong =
            |why: String| BestError::Journal(format!("cannot use `{}`: {why}", path.display()));
        let exists = path.symlink_metadata().is_ok();
        let mut file = Appender::open(&path).map_err(|error| wrong(error.to_string()))?;
        if !file.lock() {
            return Err(wrong("another fabc is writing it".to_owned()));
        }
        let mut known = BTreeMap::new();
        let mut has_header = false;
        if exists {
            let mut lines = Reader::open(&path, MAX_BYTES).map_err(wrong)?;
            while let Some(line) = lines.read::<Line>().map_err(wrong)? {
                match line {
                    Line::Search(of) if of != *identity => {
                        return Err(wrong(format!(
                            "it holds another search: its {}; name another `--out`, nothing is overwritten",
                            identity.difference(&of)
                        )));
                    }
                    Line::Search(_) => has_header = true,
                    Line::Trial { .. } if !has_header => {
                        return Err(wrong(
                            "its first line does not say what was searched".to_owned(),
                        ));
                    }
                    Line::Trial { key, record } => drop(known.insert(key, record)),
                }
            }
            file.keep(lines.whole_bytes());
        }
        if !has_header {
            let header = file.append(&Line::Search(identity.clone()));
            header.map_err(|error| wrong(error.to_string()))?;
        }
        Ok(TrialJournal {
            known,
            file: Mutex::new(file),
        })
    }

    /// Returns what a trial led to, if an earlier search finished it.
    pub(super) fn known(&self, key: &str) -> Option<&TrialRecord> {
        self.known.get(key)
    }

    /// Keeps what a trial led to.
    pub(super) fn keep(&self, key: &str, record: &TrialRecord) -> Result<(), BestError> {
        let line = Line::Trial {
            key: key.to_owned(),
            record: record.clone(),
        };
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = file.append(&line);
        kept.map_err(|error| BestError::Journal(format!("cannot keep a trial: {error}")))
    }
}

impl Identity {
    fn difference(&self, there: &Identity) -> String {
        let pairs = [
            ("program", &there.program, &self.program),
            ("start", &there.start, &self.start),
            ("simulator's parameters", &there.params, &self.params),
            ("simulator", &there.code, &self.code),
            ("subgoal pictures", &there.subgoals, &self.subgoals),
        ];
        let different = pairs.into_iter().find(|(_, there, here)| there != here);
        different.map_or(String::new(), |(what, there, here)| {
            format!("{what} is `{there}`, and this one's is `{here}`")
        })
    }
}

//! Recordings: every question with its answer in one file, so a rollout can be replayed without the model.
//!
//! In: exchanges as they happen ([`Recorder`]), or a recording ([`Replay`]). Out: JSON lines, with a header as the
//! first line. Pictures are replaced by the hash of their bytes. A line that was cut off while it was written does not
//! count.

mod difference;
mod recorder;
mod replay;

pub use recorder::Recorder;
pub use replay::Replay;

use super::{Lowering, ModelKind, Reply};
use crate::calls::Fault;
use fab_base::jsonl::Reader;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Version of the file's lines.
const SCHEMA: u32 = 1;

/// A line of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Line {
    /// The first one.
    Recording { schema: u32, fabc: String },
    /// A question and its result.
    Exchange(Exchange),
}

/// A question and its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Exchange {
    /// [`super::Request::key`].
    key: String,
    model: String,
    nature: ModelKind,
    lowering: Lowering,
    /// The request as JSON, with each picture replaced by the SHA-256 of its bytes.
    request: Value,
    #[serde(flatten)]
    outcome: Outcome,
    /// Duration, seconds.
    took_s: f64,
}

/// The result of a question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Outcome {
    Reply(Reply),
    Failure { fault: Option<Fault>, why: String },
}

/// Why a recording cannot be written or used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot use the recording `{}`: {why}", path.display())]
pub struct RecordingError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub why: String,
}

/// Hashes a question without its schema. The schema follows from the task and its scene, and recordings of earlier
/// versions have another one, or none.
fn question_key(request: &Value) -> String {
    let mut question = request.clone();
    if let Some(fields) = question.as_object_mut() {
        fields.shift_remove("schema");
    }
    fab_base::digest::of(question.to_string())
}

/// The whole lines of a recording.
#[derive(Debug, Default)]
struct Lines {
    exchanges: Vec<Exchange>,
    /// Bytes up to the end of the last whole line.
    whole_bytes: u64,
}

/// Reads a recording line by line.
fn read(path: &Path) -> Result<Lines, RecordingError> {
    let wrong = |why: String| RecordingError {
        path: path.to_owned(),
        why,
    };
    let mut reader = Reader::open(path, u64::MAX).map_err(wrong)?;
    let mut lines = Lines::default();
    loop {
        let line = reader.read();
        let number = reader.number();
        let line = line.map_err(|why| match number {
            1 => wrong(format!("it does not begin as a recording: {why}")),
            _ => wrong(why),
        })?;
        let Some(line) = line else { break };
        match (number, line) {
            (1, Line::Recording { schema: SCHEMA, .. }) => {}
            (1, Line::Recording { schema, fabc }) => {
                return Err(wrong(format!(
                    "it has version {schema}, written by fabc {fabc}; this fabc reads version {SCHEMA}"
                )));
            }
            (1, Line::Exchange(_)) => {
                return Err(wrong("its first line is missing".to_owned()));
            }
            (_, Line::Recording { .. }) => {
                return Err(wrong(format!("line {number} begins another recording")));
            }
            (_, Line::Exchange(exchange)) => lines.exchanges.push(exchange),
        }
    }
    lines.whole_bytes = reader.whole_bytes();
    Ok(lines)
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

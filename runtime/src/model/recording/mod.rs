//! Recordings: every question with its answer in one file, from which a rollout can be run again without the model.
//!
//! In: exchanges as they happen ([`Recorder`]), or such a file ([`Replay`]). Out: JSON lines, the first of which says what
//! they are. Pictures stand as the hash of their bytes. A line that was cut off while it was written is no line.

mod difference;
mod recorder;
mod replay;

pub use recorder::Recorder;
pub use replay::Replay;

use super::{Lowering, Nature, Reply};
use crate::calls::Fault;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Version of the file's lines.
const SCHEMA: u32 = 1;

/// The longest line that is read: a conversation with its pictures as hashes is a few kilobytes.
const MAX_LINE_BYTES: usize = 16 << 20;

/// A line of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Line {
    /// The first one.
    Recording { schema: u32, fabc: String },
    /// A question and what came of it.
    Exchange(Exchange),
}

/// A question and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Exchange {
    /// [`super::Request::key`].
    key: String,
    model: String,
    nature: Nature,
    lowering: Lowering,
    /// The request as JSON, each picture as the SHA-256 of its bytes.
    request: Value,
    #[serde(flatten)]
    outcome: Outcome,
    /// What it took, seconds.
    took_s: f64,
}

/// What came of a question.
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
    let information = std::fs::metadata(path).map_err(|error| wrong(error.to_string()))?;
    if !information.is_file() {
        return Err(wrong("it is no regular file".to_owned()));
    }
    let file = File::open(path).map_err(|error| wrong(error.to_string()))?;
    let mut reader = BufReader::new(file);
    let mut lines = Lines::default();
    let mut text = Vec::new();
    for number in 1.. {
        text.clear();
        let limit = MAX_LINE_BYTES as u64;
        let mut bounded = std::io::Read::take(&mut reader, limit);
        let length = bounded
            .read_until(b'\n', &mut text)
            .map_err(|error| wrong(error.to_string()))?;
        if text.last() != Some(&b'\n') {
            if length == MAX_LINE_BYTES {
                return Err(wrong(format!(
                    "line {number} is longer than {MAX_LINE_BYTES} bytes"
                )));
            }
            break;
        }
        let line: Line = serde_json::from_slice(&text).map_err(|error| {
            wrong(match number {
                1 => format!("its first line is not that of a recording: {error}"),
                _ => format!("line {number} is damaged: {error}"),
            })
        })?;
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
        lines.whole_bytes += length as u64;
    }
    Ok(lines)
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

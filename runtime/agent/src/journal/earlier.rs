//! The lines of an earlier part of the same rollout.
//!
//! In: a journal. Out: its whole lines up to the point of resuming: the header, and every step that was taken. The rest
//! (a step that ended the rollout, its end, a torn line) is written again.

use crate::record::{Line, MAX_BYTES};
use fab_base::difference;
use fab_base::jsonl::Reader;
use serde_json::Value;
use std::collections::VecDeque;
use std::path::Path;

/// Existing lines.
#[derive(Debug, Default)]
pub(super) struct ExistingLines {
    /// Those that have not been repeated yet, oldest first.
    pub lines: VecDeque<String>,
    /// How many steps there were.
    pub steps: u32,
    /// Bytes up to the end of the last line.
    pub bytes: u64,
}

impl ExistingLines {
    /// Reads a journal.
    ///
    /// Fails for a line of JSON that this program does not write: it belongs to another version, and must not be
    /// overwritten.
    pub(super) fn read(path: &Path) -> Result<ExistingLines, String> {
        let mut reader = Reader::open(path, MAX_BYTES)?;
        let mut earlier = ExistingLines::default();
        while let Some(line) = reader.next_line()? {
            match serde_json::from_slice(line) {
                Ok(Line::Header(_)) if earlier.lines.is_empty() => {}
                Ok(Line::Step(step)) if !earlier.lines.is_empty() && step.stopped.is_none() => {
                    earlier.steps += 1;
                }
                Err(error) if error.is_data() => {
                    let number = earlier.lines.len() + 1;
                    return Err(format!(
                        "line {number} is not as this version of fabc writes it: {error}"
                    ));
                }
                _ => break,
            }
            let text = String::from_utf8_lossy(line).into_owned();
            earlier.lines.push_back(text);
            earlier.bytes = reader.whole_bytes();
        }
        Ok(earlier)
    }
}

/// Names the field in which two lines differ.
pub(super) fn difference(stored: &str, now: &str) -> String {
    let object = |line: &str| serde_json::from_str::<Value>(line).unwrap_or_default();
    let (stored, now) = (object(stored), object(now));
    let line = match stored["type"].as_str() {
        Some("step") => format!("step {}", stored["step"]),
        _ => "the first line".to_owned(),
    };
    match difference::first(&stored, &now) {
        Some(found) => format!("{line} differs in {found}"),
        // The same values may be written in another way by another version.
        None => format!("{line} is written differently"),
    }
}

//! The lines of an earlier part of the same rollout.
//!
//! In: a journal. Out: its whole lines up to the point of resuming: the header, and every step that was taken. The rest
//! (a step that ended the rollout, its end, a torn line) is written again.

use super::JournalError;
use crate::record::{Line, MAX_BYTES};
use fab_base::difference;
use fab_base::jsonl::Reader;
use serde_json::Value;
use std::collections::VecDeque;
use std::path::Path;

/// Existing lines, oldest first.
#[derive(Debug, Default)]
pub(super) struct ExistingLines {
    lines: VecDeque<String>,
    /// How many lines there were.
    count: usize,
    /// Bytes up to the end of the last line.
    bytes: u64,
}

impl ExistingLines {
    /// Reads a journal.
    pub(super) fn read(path: &Path) -> Result<ExistingLines, JournalError> {
        let unreadable = |why: String| JournalError::Unreadable {
            path: path.to_owned(),
            why,
        };
        let mut reader = Reader::open(path, MAX_BYTES).map_err(unreadable)?;
        let mut earlier = ExistingLines::default();
        while let Some(line) = reader.next_line().map_err(unreadable)? {
            let text = String::from_utf8_lossy(line).into_owned();
            if !is_taken(&text, earlier.count).map_err(unreadable)? {
                break;
            }
            earlier.lines.push_back(text);
            earlier.count += 1;
            earlier.bytes = reader.whole_bytes();
        }
        Ok(earlier)
    }

    /// Returns how many bytes of the journal stay.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Returns how many steps stay.
    pub(super) fn steps(&self) -> u32 {
        // A readable journal has far fewer lines.
        u32::try_from(self.count.saturating_sub(1)).unwrap_or(u32::MAX)
    }

    /// Returns whether an existing line has not been repeated yet.
    pub(super) fn has_more(&self) -> bool {
        !self.lines.is_empty()
    }

    /// Takes a repeated line; returns whether it already existed.
    ///
    /// Fails if the existing line differs: the rollout would not be the same.
    pub(super) fn take(&mut self, line: &str) -> Result<bool, String> {
        let Some(known) = self.lines.pop_front() else {
            return Ok(false);
        };
        match known == line {
            true => Ok(true),
            false => Err(difference(&known, line)),
        }
    }
}

/// Returns whether a line stays: the first if it is a header, others if they are steps that did not end the rollout.
///
/// Fails for a line of JSON that this program does not write: it belongs to another version, and must not be
/// overwritten.
fn is_taken(line: &str, number: usize) -> Result<bool, String> {
    match serde_json::from_str(line) {
        Ok(Line::Header(_)) => Ok(number == 0),
        Ok(Line::Step(step)) => Ok(number > 0 && step.stopped.is_none()),
        Ok(Line::End(_)) => Ok(false),
        Err(error) if error.is_data() => Err(format!(
            "line {} is not as this version of fabc writes it: {error}",
            number + 1
        )),
        Err(_) => Ok(false),
    }
}

/// Names the field in which two lines differ.
fn difference(stored: &str, now: &str) -> String {
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

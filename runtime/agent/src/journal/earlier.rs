//! The lines of an earlier part of the same rollout.
//!
//! In: a journal. Out: its whole lines up to the point of resuming: the header, and every step that was taken. The rest
//! (a step that ended the rollout, its end, a torn line) is written again.

use super::JournalError;
use crate::record::{Line, MAX_BYTES};
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

/// Names the field in which two lines differ, by its path.
fn difference(then: &str, now: &str) -> String {
    let object = |line: &str| serde_json::from_str::<Value>(line).unwrap_or_default();
    let (then, now) = (object(then), object(now));
    let what = match then["type"].as_str() {
        Some("step") => format!("step {}", then["step"]),
        _ => "the first line".to_owned(),
    };
    let mut path = Vec::new();
    let (then, now) = first_difference(&then, &now, &mut path);
    format!(
        "{what} had `{}` {} and would now have {}",
        path.join("."),
        shortened(then),
        shortened(now)
    )
}

/// Descends to the first value that differs, collecting the names on the way.
fn first_difference<'v>(
    then: &'v Value,
    now: &'v Value,
    path: &mut Vec<String>,
) -> (&'v Value, &'v Value) {
    const ABSENT: &Value = &Value::Null;
    let pair = match (then, now) {
        (Value::Object(then), Value::Object(now)) => {
            let names = then.keys().chain(now.keys());
            let mut differing = names.filter(|name| then.get(*name) != now.get(*name));
            differing.next().map(|name| {
                let of =
                    |fields: &'v serde_json::Map<String, Value>| fields.get(name).unwrap_or(ABSENT);
                (name.clone(), of(then), of(now))
            })
        }
        (Value::Array(then), Value::Array(now)) => {
            let mut indices = 0..then.len().max(now.len());
            let differing = indices.find(|index| then.get(*index) != now.get(*index));
            differing.map(|index| {
                let of = |items: &'v [Value]| items.get(index).unwrap_or(ABSENT);
                (index.to_string(), of(then), of(now))
            })
        }
        _ => None,
    };
    match pair {
        Some((name, then, now)) => {
            path.push(name);
            first_difference(then, now, path)
        }
        None => (then, now),
    }
}

fn shortened(value: &Value) -> String {
    const MOST: usize = 60;
    let text = value.to_string();
    let short: String = text.chars().take(MOST).collect();
    match short.len() < text.len() {
        true => format!("{short}…"),
        false => short,
    }
}

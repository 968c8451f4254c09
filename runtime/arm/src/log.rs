//! The arm's journal: a line before each motion, synced, and one after it was verified.
//!
//! In: what is about to happen. Out: `arm.jsonl` in the run folder; so that after a crash it is known which motion may be
//! under way and whether the hand may hold cloth. A line that a crash cut short is left aside: the one before it counts.

use super::driver::Opening;
use super::route::{Act, Name, Segment};
use fab_base::jsonl::{Appender, Reader};
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Name of the journal in a run folder.
pub const ARM_FILE: &str = "arm.jsonl";

/// The longest journal that is read.
const MAX_BYTES: u64 = 64 << 20;

/// A line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// A motion is about to begin.
    Begin {
        /// The pick and place that it is part of, from 1.
        action: u32,
        /// Which part.
        segment: Name,
        /// Where the tool is to go, metres, base frame; none for a motion of the fingers.
        to_m: Option<[f64; 3]>,
        /// What the fingers are to do; none for a motion of the tool.
        hand: Option<Opening>,
        /// Where it was, metres, base frame.
        from_m: [f64; 3],
    },
    /// The motion before was verified.
    Done {
        /// Where the tool was found, metres, base frame.
        at_m: [f64; 3],
    },
    /// A motion was ended, or refused.
    Halted {
        /// Why.
        why: String,
        /// Whether the arm was verified to be stopped; null where it was not told to stop.
        stopped: Option<bool>,
    },
    /// A person let an arm go that was stopped; what is in its hand is as it was.
    Enabled {
        /// Why it may move again.
        how: String,
    },
    /// A person has looked after an arm that was left in the middle of a motion.
    Recovered {
        /// What was done.
        how: String,
    },
}

/// Why the journal cannot be written or read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{path}`: {why}")]
pub struct LogError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub why: String,
}

/// The journal of an arm that is being written.
#[derive(Debug)]
pub struct ArmLog {
    path: PathBuf,
    file: Appender,
}

impl ArmLog {
    /// Opens the journal in a run folder, to go on with it.
    pub fn open(folder: &Path) -> Result<ArmLog, LogError> {
        let path = folder.join(ARM_FILE);
        let opened = Appender::open(&path).map_err(|error| error.to_string());
        let opened = opened.and_then(|mut file| {
            let mut lines = Reader::open(&path, MAX_BYTES)?;
            while lines.next_line()?.is_some() {}
            file.keep(lines.whole_bytes());
            Ok(file)
        });
        match opened {
            Ok(file) => Ok(ArmLog { path, file }),
            Err(why) => Err(LogError { path, why }),
        }
    }

    /// Writes a line and waits until it is on the disk.
    pub fn write(&mut self, entry: &Entry) -> Result<(), LogError> {
        self.file.append(entry).map_err(|error| LogError {
            path: self.path.clone(),
            why: error.to_string(),
        })
    }

    /// Writes that a segment is about to begin.
    pub fn begin(
        &mut self,
        action: u32,
        segment: &Segment,
        from: &Isometry3<f64>,
    ) -> Result<(), LogError> {
        let (to_m, hand) = match segment.act {
            Act::Move(to) => (Some(to.translation.vector.into()), None),
            Act::Hand(opening) => (None, Some(opening)),
        };
        self.write(&Entry::Begin {
            action,
            segment: segment.name,
            to_m,
            hand,
            from_m: from.translation.vector.into(),
        })
    }
}

/// In what state a journal leaves an arm.
#[derive(Clone, Debug, PartialEq)]
pub enum Left {
    /// Nothing was begun, every motion was verified and the hand is empty, or a person has looked after it.
    Clear,
    /// A motion was begun and not verified, or it was halted, or the hand holds something.
    Unclear {
        /// The last motion that was begun.
        segment: Name,
        /// The pick and place that it is part of, from 1.
        action: u32,
        /// Where it was to go, metres, base frame.
        to_m: Option<[f64; 3]>,
        /// Whether the hand may hold cloth.
        may_hold: bool,
        /// Whether the motion itself was verified.
        is_verified: bool,
        /// Why it was halted, where it was.
        why: Option<String>,
    },
}

/// Reads in what state the journal of a run folder leaves the arm; clear where there is none.
pub fn left(folder: &Path) -> Result<Left, LogError> {
    let path = folder.join(ARM_FILE);
    if !path.exists() {
        return Ok(Left::Clear);
    }
    let wrong = |why: String| LogError {
        path: path.clone(),
        why,
    };
    let mut lines = Reader::open(&path, MAX_BYTES).map_err(wrong)?;
    let mut left = Left::Clear;
    while let Some(entry) = lines.read().map_err(wrong)? {
        left = after(left, entry);
    }
    Ok(left)
}

/// Returns the state after a line.
fn after(left: Left, entry: Entry) -> Left {
    match (left, entry) {
        (
            before,
            Entry::Begin {
                action,
                segment,
                to_m,
                ..
            },
        ) => Left::Unclear {
            segment,
            action,
            to_m,
            may_hold: segment.may_hold() || matches!(before, Left::Unclear { may_hold: true, .. }),
            is_verified: false,
            why: None,
        },
        (
            Left::Unclear {
                segment,
                action,
                to_m,
                may_hold,
                why,
                ..
            },
            Entry::Done { .. },
        ) => match may_hold && segment != Name::Release {
            true => Left::Unclear {
                segment,
                action,
                to_m,
                may_hold,
                is_verified: true,
                why,
            },
            false => Left::Clear,
        },
        (
            Left::Unclear {
                segment,
                action,
                to_m,
                may_hold,
                is_verified,
                ..
            },
            Entry::Halted { why, .. },
        ) => Left::Unclear {
            segment,
            action,
            to_m,
            may_hold,
            is_verified,
            why: Some(why),
        },
        (_, Entry::Recovered { .. }) => Left::Clear,
        (left, Entry::Done { .. } | Entry::Halted { .. } | Entry::Enabled { .. }) => left,
    }
}

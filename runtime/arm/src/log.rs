//! The arm's journal: a synced line before each motion, and one after it was verified.
//!
//! In: segments, before and after they run. Out: `arm.jsonl` in the run folder. After a crash it shows which motion may
//! be unfinished and whether the hand may hold cloth. A line that a crash truncated is ignored; the one before it
//! counts.

use super::driver::Opening;
use super::route::{Act, Segment, SegmentName};
use fab_base::jsonl::{Appender, Reader};
use fab_base::outbox::Outbox;
use nalgebra::Isometry3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the journal in a run folder.
pub const ARM_FILE: &str = "arm.jsonl";

/// The longest journal accepted.
const MAX_BYTES: u64 = 64 << 20;

/// The longest that a line may take to be on disk.
const LONGEST: Duration = Duration::from_secs(5);

/// The most lines that wait for a disk that hangs.
const MAX_WAITING: usize = 4;

/// A line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// A segment is about to start.
    Begin {
        /// The number of its pick and place, from 1.
        action: u32,
        /// Which segment.
        segment: SegmentName,
        /// Target of the tool, metres, base frame; null for a motion of the fingers.
        to_m: Option<[f64; 3]>,
        /// Target of the fingers; null for a motion of the tool.
        hand: Option<Opening>,
        /// Position of the tool at the start, metres, base frame.
        from_m: [f64; 3],
    },
    /// The segment was verified.
    Done {
        /// Measured position of the tool, metres, base frame.
        at_m: [f64; 3],
    },
    /// The segment was ended early, or refused.
    Halted {
        /// Why.
        why: String,
        /// Whether the stop was verified; null if no stop was requested.
        stopped: Option<bool>,
    },
    /// A person enabled a stopped arm; its hand is unchanged.
    Enabled {
        /// Why it may move again.
        how: String,
    },
    /// A person recovered an arm that was left in the middle of a motion.
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

/// The journal of an arm, open for writing.
#[derive(Debug)]
pub struct ArmLog {
    path: PathBuf,
    /// A disk that hangs must not hang this program.
    lines: Outbox<Entry>,
    longest: Duration,
}

impl ArmLog {
    /// Opens the journal in a run folder, to append to it.
    pub fn open(folder: &Path) -> Result<ArmLog, LogError> {
        let path = folder.join(ARM_FILE);
        match Appender::open_after_whole_lines(&path, MAX_BYTES) {
            Ok(mut file) => Ok(ArmLog::to(path, LONGEST, move |entry| {
                file.append(&entry).map_err(|error| error.to_string())
            })),
            Err(why) => Err(LogError { path, why }),
        }
    }

    /// Writes lines by a function, each of which may take `longest`.
    pub(crate) fn to(
        path: PathBuf,
        longest: Duration,
        write: impl FnMut(Entry) -> Result<(), String> + Send + 'static,
    ) -> ArmLog {
        ArmLog {
            path,
            lines: Outbox::new(MAX_WAITING, write),
            longest,
        }
    }

    /// Writes a line and waits until it is on disk; fails if that takes too long.
    pub fn write(&mut self, entry: &Entry) -> Result<(), LogError> {
        let written = self.lines.write(entry.clone(), self.longest);
        written.map_err(|why| LogError {
            path: self.path.clone(),
            why,
        })
    }

    /// Writes that a segment is about to start.
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

/// The state in which a run left an arm, according to its journal.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "left")]
pub enum RunState {
    /// No motion was started, or every motion was verified and the hand is empty, or a person recovered the arm.
    #[serde(rename = "clear")]
    Clear,
    /// A motion was started and not verified, or halted, or the hand may hold cloth.
    #[serde(rename = "unclear")]
    NeedsRecovery {
        /// The last segment that was started.
        segment: SegmentName,
        /// The number of its pick and place, from 1.
        action: u32,
        /// Its target, metres, base frame; `None` for a motion of the fingers.
        to_m: Option<[f64; 3]>,
        /// Whether the hand may hold cloth.
        may_hold: bool,
        /// Whether the segment itself was verified.
        is_verified: bool,
        /// Why it was halted, if it was.
        why: Option<String>,
    },
}

/// Returns the state in which a run left the arm, from the journal in its folder; clear if there is no journal.
pub fn run_state(folder: &Path) -> Result<RunState, LogError> {
    let path = folder.join(ARM_FILE);
    if !path.exists() {
        return Ok(RunState::Clear);
    }
    let wrong = |why: String| LogError {
        path: path.clone(),
        why,
    };
    let mut lines = Reader::open(&path, MAX_BYTES).map_err(wrong)?;
    let mut state = RunState::Clear;
    while let Some(entry) = lines.read().map_err(wrong)? {
        follow(&mut state, entry);
    }
    Ok(state)
}

/// Changes the state by one more line.
fn follow(state: &mut RunState, entry: Entry) {
    match (&mut *state, entry) {
        (
            before,
            Entry::Begin {
                action,
                segment,
                to_m,
                ..
            },
        ) => {
            *state = RunState::NeedsRecovery {
                segment,
                action,
                to_m,
                may_hold: segment.may_hold_cloth()
                    || matches!(before, RunState::NeedsRecovery { may_hold: true, .. }),
                is_verified: false,
                why: None,
            }
        }
        (
            RunState::NeedsRecovery {
                segment,
                may_hold,
                is_verified,
                ..
            },
            Entry::Done { .. },
        ) => match *may_hold && *segment != SegmentName::Release {
            true => *is_verified = true,
            false => *state = RunState::Clear,
        },
        (RunState::NeedsRecovery { why, .. }, Entry::Halted { why: halted, .. }) => {
            *why = Some(halted);
        }
        (_, Entry::Recovered { .. }) => *state = RunState::Clear,
        (_, Entry::Done { .. } | Entry::Halted { .. } | Entry::Enabled { .. }) => {}
    }
}

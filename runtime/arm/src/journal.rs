//! The arm's journal: a synced line before each motion, and one after it was verified.
//!
//! In: segments, before and after they run. Out: `arm.jsonl` in the run folder. After a crash it shows which motion may
//! be unfinished and whether the hand may hold cloth. A line that a crash truncated is ignored; the one before it
//! counts.
//!
//! `NAME.last-run.json`, beside the settings, names the run that moved the arm last, so that no run starts over an
//! unfinished motion. Two settings files for one arm do not know about each other.

use super::phase::{Event, Phase};
use super::route::{Act, Segment, SegmentName};
use fab_base::files;
use fab_base::jsonl::{Appender, Reader};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the journal in a run folder.
pub const ARM_FILE: &str = "arm.jsonl";

/// The longest journal accepted, and the longest file that names the last run.
const MAX_BYTES: u64 = 64 << 20;

/// A line of the journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Entry {
    /// A segment is about to start.
    Begin(Begun),
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
    /// A person recovered the arm.
    Recovered {
        /// What was done.
        how: String,
    },
}

/// A segment that was begun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Begun {
    /// The number of its pick and place, from 1.
    pub action: u32,
    /// Which segment.
    pub segment: SegmentName,
    /// Target of the tool, metres, base frame; null for a motion of the fingers.
    pub to_m: Option<[f64; 3]>,
}

/// Why a journal, or the file that names the last run, cannot be written or read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{path}`: {why}")]
pub struct JournalError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub why: String,
}

impl JournalError {
    fn of(path: &Path, why: impl ToString) -> JournalError {
        JournalError {
            path: path.to_owned(),
            why: why.to_string(),
        }
    }
}

/// The journal of an arm, open for writing.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Appender,
}

impl Journal {
    /// Opens the journal in a run folder, to append to it.
    pub fn open(folder: &Path) -> Result<Journal, JournalError> {
        let path = folder.join(ARM_FILE);
        match Appender::open_after_whole_lines(&path, MAX_BYTES) {
            Ok(file) => Ok(Journal { path, file }),
            Err(why) => Err(JournalError::of(&path, why)),
        }
    }

    /// Writes a line, and returns when it is on disk. The arm rests meanwhile: a disk that hangs keeps it from moving.
    pub fn write(&mut self, entry: &Entry) -> Result<(), JournalError> {
        let written = self.file.append(entry);
        written.map_err(|why| JournalError::of(&self.path, why))
    }

    /// Writes that a segment is about to start.
    pub fn begin(&mut self, action: u32, segment: &Segment) -> Result<(), JournalError> {
        self.write(&Entry::Begin(Begun {
            action,
            segment: segment.name,
            to_m: match segment.act {
                Act::Move(to) => Some(to.translation.vector.into()),
                Act::Hand(_) => None,
            },
        }))
    }
}

/// The state in which a run left an arm, according to its journal.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunState {
    /// The arm's phase after the last line.
    pub phase: Phase,
    /// Whether the hand may hold cloth.
    pub may_hold: bool,
    /// The last segment that was started since a person recovered the arm, if any was.
    #[serde(flatten)]
    pub last: Option<Begun>,
    /// Why it was halted, if it was.
    pub why: Option<String>,
}

impl RunState {
    /// Returns whether every motion was verified and the hand is empty, or a person recovered the arm.
    pub fn is_clear(&self) -> bool {
        self.phase == Phase::Ready && !self.may_hold
    }

    fn follow(&mut self, entry: Entry) {
        let event = match entry {
            Entry::Begin(begun) => {
                self.may_hold |= begun.segment.may_hold_cloth();
                self.last = Some(begun);
                self.why = None;
                Event::Begin
            }
            Entry::Done { .. } => {
                let last = self.last.as_ref();
                self.may_hold &= last.is_some_and(|last| last.segment != SegmentName::Release);
                Event::Verify
            }
            Entry::Halted { why, stopped } => {
                self.why = Some(why);
                // A segment that was refused before it began leaves the arm where it rests.
                if stopped.is_none() && self.phase == Phase::Ready {
                    return;
                }
                Event::Stop
            }
            Entry::Recovered { .. } => {
                *self = RunState::default();
                Event::Recover
            }
        };
        self.phase = self.phase.after(event);
    }
}

impl fmt::Display for RunState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let halted = self.why.as_ref();
        let halted = halted.map_or(String::new(), |why| format!("; halted: {why}"));
        let Some(last) = &self.last else {
            return write!(f, "no motion is open, and the hand holds nothing{halted}");
        };
        write!(f, "`{}` of action {} ", last.segment.name(), last.action)?;
        f.write_str(match self.phase {
            Phase::Ready => "was verified and is the last there is",
            _ => "was begun and not verified",
        })?;
        if let Some([x, y, z]) = last.to_m {
            write!(f, "; the tool was to go to {x:.3}, {y:.3}, {z:.3} m")?;
        }
        let holds = if self.may_hold {
            "may hold cloth"
        } else {
            "holds nothing"
        };
        write!(f, "; the hand {holds}{halted}")
    }
}

/// Returns the state in which a run left the arm, from the journal in its folder; clear if there is no journal.
pub fn run_state(folder: &Path) -> Result<RunState, JournalError> {
    let path = folder.join(ARM_FILE);
    let mut state = RunState::default();
    if path.exists() {
        let wrong = |why: String| JournalError::of(&path, why);
        let mut lines = Reader::open(&path, MAX_BYTES).map_err(wrong)?;
        while let Some(entry) = lines.read().map_err(wrong)? {
            state.follow(entry);
        }
    }
    Ok(state)
}

/// The contents of the file that names the last run.
#[derive(Debug, Serialize, Deserialize)]
struct LastRun {
    /// The run folder.
    run: PathBuf,
}

/// Returns the path of that file beside a settings file; a symbolic link has that of its target.
fn last_run_file(settings: &Path) -> PathBuf {
    let file = fs::canonicalize(settings);
    let file = file.unwrap_or_else(|_| settings.to_owned());
    file.with_extension("last-run.json")
}

fn last_run(settings: &Path) -> Result<Option<PathBuf>, JournalError> {
    let path = last_run_file(settings);
    if !path.exists() {
        return Ok(None);
    }
    let last = files::read_json(&path, MAX_BYTES);
    let last: LastRun = last.map_err(|why| JournalError::of(&path, why))?;
    Ok(Some(last.run))
}

/// Records beside the settings that a run is about to move the arm; its folder must exist.
pub fn record_run(settings: &Path, run: &Path) -> Result<(), JournalError> {
    // The next run may start in another folder.
    let run = fs::canonicalize(run).map_err(|error| JournalError::of(run, error))?;
    let path = last_run_file(settings);
    let text = serde_json::to_string_pretty(&LastRun { run });
    let text = text.map_err(|error| JournalError::of(&path, error))?;
    files::write_whole(&path, format!("{text}\n").as_bytes())
        .map_err(|error| JournalError::of(&path, error))
}

/// Returns how the last run left the arm of these settings, clear if there was none; fails if that is unknown, because the
/// file that names the run or the run's journal is gone or cannot be read.
pub fn left(settings: &Path) -> Result<RunState, JournalError> {
    let Some(run) = last_run(settings)? else {
        return Ok(RunState::default());
    };
    let journal = run.join(ARM_FILE);
    if !journal.is_file() {
        return Err(JournalError::of(&journal, "it is gone"));
    }
    run_state(&run)
}

/// Records what a person did to recover the arm in its last run's journal; if that is gone or cannot be read, the run is
/// forgotten.
pub fn record_recovery(settings: &Path, how: &str) -> Result<(), JournalError> {
    if left(settings).is_err() {
        let path = last_run_file(settings);
        return fs::remove_file(&path).map_err(|error| JournalError::of(&path, error));
    }
    let Some(run) = last_run(settings)? else {
        return Ok(());
    };
    let how = how.to_owned();
    Journal::open(&run)?.write(&Entry::Recovered { how })
}

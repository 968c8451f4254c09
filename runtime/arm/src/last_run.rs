//! The last run that moved an arm, recorded beside the arm's settings.
//!
//! In: a settings file, a run folder. Out: `NAME.last-run.json`, and whether a person must recover the arm before the
//! next run, so that no run starts over an unfinished motion. Two settings files for one arm do not know about each
//! other.

use super::log::{ARM_FILE, LogError, RunState, run_state};
use fab_base::files;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// The longest such file accepted.
const MAX_BYTES: u64 = 64 << 10;

/// The contents of the file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LastRun {
    /// The run folder.
    run: PathBuf,
    /// What a person did to recover the arm, if the run's own journal is gone.
    recovered: Option<String>,
}

/// Whether the arm needs recovery after its last run.
#[derive(Clone, Debug, PartialEq)]
pub enum Recovery {
    /// There was no run, or it left the arm at rest with an empty hand, or a person has recovered the arm.
    NotNeeded,
    /// A motion is unfinished, or the hand holds something.
    Needed {
        /// The run folder.
        run: PathBuf,
        /// The state in which the run left the arm.
        state: RunState,
    },
    /// The run's journal is gone, or cannot be read.
    Unknown {
        /// Where the run folder was.
        run: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Returns the path of the file that names the last run, beside a settings file; a symbolic link has that of its target.
pub fn file_beside(settings: &Path) -> PathBuf {
    let file = fs::canonicalize(settings);
    let file = file.unwrap_or_else(|_| settings.to_owned());
    file.with_extension("last-run.json")
}

/// Records that a run is about to move the arm; its folder must exist.
pub fn record(settings: &Path, run: &Path) -> Result<(), LogError> {
    // The next run may start in another folder.
    let run = fs::canonicalize(run).map_err(|error| LogError {
        path: run.to_owned(),
        why: error.to_string(),
    })?;
    write(
        settings,
        &LastRun {
            run,
            recovered: None,
        },
    )
}

/// Returns the folder of the last run; `None` if there was no run.
pub fn folder(settings: &Path) -> Result<Option<PathBuf>, LogError> {
    Ok(read(settings)?.map(|last| last.run))
}

/// Returns whether the arm needs recovery; fails if the file that names the last run cannot be read.
pub fn recovery(settings: &Path) -> Result<Recovery, LogError> {
    let Some(LastRun { run, recovered }) = read(settings)? else {
        return Ok(Recovery::NotNeeded);
    };
    if recovered.is_some() {
        return Ok(Recovery::NotNeeded);
    }
    if !run.join(ARM_FILE).is_file() {
        let why = format!("`{}` is gone", run.join(ARM_FILE).display());
        return Ok(Recovery::Unknown { run, why });
    }
    Ok(match run_state(&run) {
        Ok(RunState::Clear) => Recovery::NotNeeded,
        Ok(state) => Recovery::Needed { run, state },
        Err(error) => Recovery::Unknown {
            why: error.to_string(),
            run,
        },
    })
}

/// Records what a person did to recover an arm whose last run has lost its journal.
pub fn record_recovery(settings: &Path, how: &str) -> Result<(), LogError> {
    let Some(last) = read(settings)? else {
        return Ok(());
    };
    let recovered = Some(how.to_owned());
    write(settings, &LastRun { recovered, ..last })
}

fn read(settings: &Path) -> Result<Option<LastRun>, LogError> {
    let path = file_beside(settings);
    if !path.exists() {
        return Ok(None);
    }
    let last = files::read_json(&path, MAX_BYTES).map_err(|why| {
        let why = format!("it should name the arm's last run, and cannot be read ({why}); see to the arm, then remove it");
        LogError { path, why }
    });
    last.map(Some)
}

fn write(settings: &Path, last: &LastRun) -> Result<(), LogError> {
    let path = file_beside(settings);
    let text = serde_json::to_vec_pretty(last).map_err(|error| error.to_string());
    let written = text.and_then(|mut text| {
        text.push(b'\n');
        files::write_whole(&path, &text).map_err(|error| error.to_string())
    });
    written.map_err(|why| LogError { path, why })
}

#[cfg(test)]
mod tests;

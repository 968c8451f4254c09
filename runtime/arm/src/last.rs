//! Which run moved an arm last, kept beside the arm's settings.
//!
//! In: a settings file, a run folder. Out: `NAME.last-run.json`, and in what state that run left the arm, so that none is
//! begun over an open motion. Two settings files of one arm do not know of each other.

use super::log::{ARM_FILE, Left, LogError, left};
use fab_base::files;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// The longest such file that is read.
const MAX_BYTES: u64 = 64 << 10;

/// The file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Note {
    /// The run folder.
    run: PathBuf,
    /// What a person did about it, where its own journal cannot say so.
    recovered: Option<String>,
}

/// In what state the last run left an arm.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// There was no run, or it left the arm at rest with an empty hand, or a person has looked after it.
    Clear,
    /// A motion is open, or the hand holds something.
    Unclear {
        /// The run folder.
        run: PathBuf,
        /// What is known.
        left: Left,
    },
    /// Its journal is gone, or cannot be read.
    Unknown {
        /// Where the run folder was.
        run: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

/// Returns the file beside some settings that names the last run.
pub fn file_beside(settings: &Path) -> PathBuf {
    settings.with_extension("last-run.json")
}

/// Notes that a run is about to move the arm; its journal must be there.
pub fn note(settings: &Path, run: &Path) -> Result<(), LogError> {
    // The next run may be begun in another folder.
    let run = fs::canonicalize(run).map_err(|error| LogError {
        path: run.to_owned(),
        why: error.to_string(),
    })?;
    write(
        settings,
        &Note {
            run,
            recovered: None,
        },
    )
}

/// Returns the folder of the last run; none where there was no run.
pub fn run(settings: &Path) -> Result<Option<PathBuf>, LogError> {
    Ok(read(settings)?.map(|note| note.run))
}

/// Says in what state the last run left the arm; fails where the file that names it cannot be read.
pub fn standing(settings: &Path) -> Result<Standing, LogError> {
    let Some(Note { run, recovered }) = read(settings)? else {
        return Ok(Standing::Clear);
    };
    if recovered.is_some() {
        return Ok(Standing::Clear);
    }
    if !run.join(ARM_FILE).is_file() {
        let why = format!("`{}` is gone", run.join(ARM_FILE).display());
        return Ok(Standing::Unknown { run, why });
    }
    Ok(match left(&run) {
        Ok(Left::Clear) => Standing::Clear,
        Ok(left) => Standing::Unclear { run, left },
        Err(error) => Standing::Unknown {
            why: error.to_string(),
            run,
        },
    })
}

/// Notes what a person did about an arm whose last run has no journal any more that could say so.
pub fn recover(settings: &Path, how: &str) -> Result<(), LogError> {
    let Some(note) = read(settings)? else {
        return Ok(());
    };
    let recovered = Some(how.to_owned());
    write(settings, &Note { recovered, ..note })
}

fn read(settings: &Path) -> Result<Option<Note>, LogError> {
    let path = file_beside(settings);
    if !path.exists() {
        return Ok(None);
    }
    let read = files::read(&path, MAX_BYTES);
    let note = read.and_then(|bytes| {
        serde_json::from_slice(&bytes).map_err(|error| {
            format!("it should name the arm's last run, and cannot be read ({error}); see to the arm, then remove it")
        })
    });
    match note {
        Ok(note) => Ok(Some(note)),
        Err(why) => Err(LogError { path, why }),
    }
}

fn write(settings: &Path, note: &Note) -> Result<(), LogError> {
    let path = file_beside(settings);
    let text = serde_json::to_vec_pretty(note).map_err(|error| error.to_string());
    let written = text.and_then(|mut text| {
        text.push(b'\n');
        files::write_whole(&path, &text).map_err(|error| error.to_string())
    });
    written.map_err(|why| LogError { path, why })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    const BEGUN: &str = r#"{"type":"begin","action":2,"segment":"grasp","to_m":null,"hand":"closed","from_m":[0.4,0.1,0.02]}"#;
    const DONE: &str = r#"{"type":"done","at_m":[0.4,0.1,0.02]}"#;
    const RECOVERED: &str = r#"{"type":"recovered","how":"by hand"}"#;

    /// Settings beside a run that has such a journal of the arm; with none, without a journal.
    fn after(journal: Option<&str>) -> (tempfile::TempDir, PathBuf, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let (settings, run) = (folder.path().join("robot.toml"), folder.path().join("run"));
        fs::create_dir(&run).unwrap();
        if let Some(journal) = journal {
            fs::write(run.join(ARM_FILE), journal).unwrap();
        }
        note(&settings, &run).unwrap();
        let run = fs::canonicalize(run).unwrap();
        (folder, settings, run)
    }

    #[test]
    fn the_last_runs_journal_decides() {
        let name = |standing: &Standing| match standing {
            Standing::Clear => "clear",
            Standing::Unclear { .. } => "unclear",
            Standing::Unknown { .. } => "unknown",
        };
        let released = BEGUN.replace("grasp", "release");
        for (journal, expected) in [
            (Some(String::new()), "clear"),
            (Some(format!("{BEGUN}\n")), "unclear"),
            (Some(format!("{BEGUN}\n{DONE}\n")), "unclear"),
            (
                Some(format!("{BEGUN}\n{DONE}\n{released}\n{DONE}\n")),
                "clear",
            ),
            (Some(format!("{BEGUN}\n{RECOVERED}\n")), "clear"),
            (
                Some(format!("{{\"type\":\"flown\"}}\n{BEGUN}\n")),
                "unknown",
            ),
            (None, "unknown"),
        ] {
            let (_folder, settings, _) = after(journal.as_deref());
            let standing = standing(&settings).unwrap();
            assert_eq!(name(&standing), expected, "{journal:?}");
        }
    }

    #[test]
    fn without_a_run_the_arm_is_clear_and_another_run_takes_its_place() {
        let (folder, settings, first) = after(Some(&format!("{BEGUN}\n")));
        assert_eq!(
            standing(&folder.path().join("other.toml")).unwrap(),
            Standing::Clear
        );
        assert_eq!(run(&settings).unwrap(), Some(first));
        let second = folder.path().join("second");
        fs::create_dir(&second).unwrap();
        fs::write(second.join(ARM_FILE), "").unwrap();
        note(&settings, &second).unwrap();
        assert_eq!(standing(&settings).unwrap(), Standing::Clear);
    }

    #[test]
    fn a_run_that_is_gone_is_unknown_until_a_person_has_looked() {
        let (folder, settings, run) = after(Some(&format!("{BEGUN}\n")));
        fs::rename(&run, folder.path().join("moved")).unwrap();
        let Standing::Unknown { why, .. } = standing(&settings).unwrap() else {
            panic!("a run that is gone is known");
        };
        assert!(why.ends_with("arm.jsonl` is gone"), "{why}");
        recover(&settings, "by hand").unwrap();
        assert_eq!(standing(&settings).unwrap(), Standing::Clear);
        // What was said of one run does not hold for the next.
        note(&settings, &folder.path().join("moved")).unwrap();
        assert!(matches!(
            standing(&settings).unwrap(),
            Standing::Unclear { .. }
        ));
    }

    #[test]
    fn a_file_that_cannot_be_read_is_never_clear() {
        let (_folder, settings, _) = after(None);
        for text in [
            "",
            "{",
            "[]",
            "{\"run\": 3}",
            "{\"run\": \"x\", \"is_clear\": true}",
        ] {
            fs::write(file_beside(&settings), text).unwrap();
            let error = standing(&settings).unwrap_err().to_string();
            assert!(error.contains("then remove it"), "{text}: {error}");
        }
        fs::write(file_beside(&settings), vec![b' '; 1 << 17]).unwrap();
        assert!(standing(&settings).is_err());
    }
}

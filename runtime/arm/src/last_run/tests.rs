//! Tests of the record of the last run.

#![allow(clippy::unwrap_used)]

use super::*;

const BEGUN: &str = r#"{"type":"begin","action":2,"segment":"grasp","to_m":null,"hand":"closed","from_m":[0.4,0.1,0.02]}"#;
const DONE: &str = r#"{"type":"done","at_m":[0.4,0.1,0.02]}"#;
const RECOVERED: &str = r#"{"type":"recovered","how":"by hand"}"#;

/// Settings beside a run with this journal of the arm; without a journal if `None`.
fn after(journal: Option<&str>) -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (settings, run) = (folder.path().join("robot.toml"), folder.path().join("run"));
    fs::create_dir(&run).unwrap();
    if let Some(journal) = journal {
        fs::write(run.join(ARM_FILE), journal).unwrap();
    }
    record(&settings, &run).unwrap();
    let run = fs::canonicalize(run).unwrap();
    (folder, settings, run)
}

#[test]
fn the_last_runs_journal_decides() {
    let name = |recovery: &Recovery| match recovery {
        Recovery::NotNeeded => "not needed",
        Recovery::Needed { .. } => "needed",
        Recovery::Unknown { .. } => "unknown",
    };
    let released = BEGUN.replace("grasp", "release");
    for (journal, expected) in [
        (Some(String::new()), "not needed"),
        (Some(format!("{BEGUN}\n")), "needed"),
        (Some(format!("{BEGUN}\n{DONE}\n")), "needed"),
        (
            Some(format!("{BEGUN}\n{DONE}\n{released}\n{DONE}\n")),
            "not needed",
        ),
        (Some(format!("{BEGUN}\n{RECOVERED}\n")), "not needed"),
        (
            Some(format!("{{\"type\":\"flown\"}}\n{BEGUN}\n")),
            "unknown",
        ),
        (None, "unknown"),
    ] {
        let (_folder, settings, _) = after(journal.as_deref());
        let recovery = recovery(&settings).unwrap();
        assert_eq!(name(&recovery), expected, "{journal:?}");
    }
}

#[test]
fn without_a_run_no_recovery_is_needed_and_another_run_takes_its_place() {
    let (folder, settings, first) = after(Some(&format!("{BEGUN}\n")));
    assert_eq!(
        recovery(&folder.path().join("other.toml")).unwrap(),
        Recovery::NotNeeded
    );
    assert_eq!(super::folder(&settings).unwrap(), Some(first));
    let second = folder.path().join("second");
    fs::create_dir(&second).unwrap();
    fs::write(second.join(ARM_FILE), "").unwrap();
    record(&settings, &second).unwrap();
    assert_eq!(recovery(&settings).unwrap(), Recovery::NotNeeded);
}

#[test]
fn a_run_that_is_gone_is_unknown_until_a_person_recovers_the_arm() {
    let (folder, settings, run) = after(Some(&format!("{BEGUN}\n")));
    fs::rename(&run, folder.path().join("moved")).unwrap();
    let Recovery::Unknown { why, .. } = recovery(&settings).unwrap() else {
        panic!("a run that is gone is known");
    };
    assert!(why.ends_with("arm.jsonl` is gone"), "{why}");
    record_recovery(&settings, "by hand").unwrap();
    assert_eq!(recovery(&settings).unwrap(), Recovery::NotNeeded);
    // The recovery of one run does not count for the next.
    record(&settings, &folder.path().join("moved")).unwrap();
    assert!(matches!(
        recovery(&settings).unwrap(),
        Recovery::Needed { .. }
    ));
}

#[cfg(unix)]
#[test]
fn a_link_to_the_settings_does_not_hide_an_unfinished_motion() {
    let (folder, settings, run) = after(Some(&format!("{BEGUN}\n")));
    fs::write(&settings, "").unwrap();
    let elsewhere = folder.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    let link = elsewhere.join("other.toml");
    let to_link = elsewhere.join("third.toml");
    std::os::unix::fs::symlink(&settings, &link).unwrap();
    std::os::unix::fs::symlink("other.toml", &to_link).unwrap();
    for file in [&settings, &link, &to_link] {
        assert!(
            matches!(recovery(file).unwrap(), Recovery::Needed { .. }),
            "{file:?}"
        );
    }
    // A run that was started by the link is found by the file, too.
    fs::remove_file(file_beside(&settings)).unwrap();
    assert_eq!(recovery(&link).unwrap(), Recovery::NotNeeded);
    record(&link, &run).unwrap();
    assert!(matches!(
        recovery(&settings).unwrap(),
        Recovery::Needed { .. }
    ));
}

#[test]
fn a_file_that_cannot_be_read_is_an_error() {
    let (_folder, settings, _) = after(None);
    for text in [
        "",
        "{",
        "[]",
        "{\"run\": 3}",
        "{\"run\": \"x\", \"is_clear\": true}",
    ] {
        fs::write(file_beside(&settings), text).unwrap();
        let error = recovery(&settings).unwrap_err().to_string();
        assert!(error.contains("then remove it"), "{text}: {error}");
    }
    fs::write(file_beside(&settings), vec![b' '; 1 << 17]).unwrap();
    assert!(recovery(&settings).is_err());
}

//! Tests of the run state that a journal shows after a crash truncated it.

use super::*;
use crate::journal::{ARM_FILE, Begun, Entry, left, record_recovery, record_run, run_state};
use crate::phase::{Event, Phase};
use crate::route::SegmentName;
use crate::supervisor::{NoWatchdog, Unattended};
use std::fs;
use std::path::PathBuf;

#[test]
#[ignore = "long"]
fn a_journal_cut_anywhere_tells_whether_cloth_may_be_held() {
    let mut bench = Bench::with(&[]);
    bench.run(&mut Unattended, &mut NoWatchdog).unwrap();
    let bytes = fs::read(bench.folder().join(ARM_FILE)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for cut in 0..=bytes.len() {
        fs::write(folder.path().join(ARM_FILE), &bytes[..cut]).unwrap();
        let said = run_state(folder.path()).unwrap();
        // The expected state, from the whole lines: between the start of the grasp and the verified release.
        let text = std::str::from_utf8(&bytes[..cut]).unwrap();
        let whole = text
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n'));
        let whole: Vec<Entry> = whole
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        let begins = |name: SegmentName| {
            whole
                .iter()
                .position(|entry| matches!(entry, Entry::Begin(begun) if begun.segment == name))
        };
        let is_released = begins(SegmentName::Release).is_some_and(|begun| whole.len() > begun + 1);
        let holds = begins(SegmentName::Grasp).is_some() && !is_released;
        let is_done = matches!(whole.last(), Some(Entry::Done { .. }) | None);
        assert_eq!(said.is_clear(), is_done && !holds, "{cut}");
        assert_eq!(said.may_hold, holds, "{cut}");
        assert_eq!(said.phase == Phase::Ready, is_done, "{cut}");
    }
    assert!(run_state(folder.path()).unwrap().is_clear());
}

#[test]
#[ignore = "long"]
fn a_journal_that_was_cut_is_gone_on_with() {
    let mut bench = Bench::with(&[]);
    bench.run(&mut Unattended, &mut NoWatchdog).unwrap();
    let bytes = fs::read(bench.folder().join(ARM_FILE)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for cut in (0..=bytes.len()).step_by(7) {
        fs::write(folder.path().join(ARM_FILE), &bytes[..cut]).unwrap();
        let how = "moved away by hand".to_owned();
        let mut log = Journal::open(folder.path()).unwrap();
        log.write(&Entry::Recovered { how }).unwrap();
        assert!(run_state(folder.path()).unwrap().is_clear(), "{cut}");
    }
}

#[test]
fn a_release_that_was_not_verified_may_hold_cloth_ever_after() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = Journal::open(folder.path()).unwrap();
    let begin = |segment| {
        Entry::Begin(Begun {
            action: 1,
            segment,
            to_m: None,
        })
    };
    let halted = Entry::Halted {
        why: "interrupted".to_owned(),
        stopped: Some(true),
    };
    for entry in [
        begin(SegmentName::Release),
        halted,
        begin(SegmentName::Rise),
    ] {
        log.write(&entry).unwrap();
        let said = run_state(folder.path()).unwrap();
        assert!(said.may_hold && !said.is_clear(), "{said:?}");
    }
}

/// Somebody said no, or a motion was refused: the arm rests where it was.
#[test]
fn a_segment_that_was_refused_before_it_began_leaves_the_arm_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = Journal::open(folder.path()).unwrap();
    let halted = |stopped| Entry::Halted {
        why: "not confirmed".to_owned(),
        stopped,
    };
    log.write(&halted(None)).unwrap();
    let state = run_state(folder.path()).unwrap();
    assert!(state.is_clear(), "{state:?}");
    assert!(state.to_string().ends_with("; halted: not confirmed"));
    log.write(&halted(Some(true))).unwrap();
    assert_eq!(run_state(folder.path()).unwrap().phase, Phase::Stopped);
}

const BEGUN: &str = r#"{"type":"begin","action":2,"segment":"grasp","to_m":null}"#;
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
    record_run(&settings, &run).unwrap();
    (folder, settings, run)
}

#[test]
fn the_last_runs_journal_decides() {
    let name = |settings: &Path| match left(settings) {
        Ok(state) if state.is_clear() => "clear",
        Ok(_) => "unclear",
        Err(_) => "unknown",
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
        assert_eq!(name(&settings), expected, "{journal:?}");
        record_recovery(&settings, "by hand").unwrap();
        assert!(left(&settings).unwrap().is_clear(), "{journal:?}");
    }
}

#[test]
fn without_a_run_an_arm_is_clear_and_another_run_takes_its_place() {
    let (folder, settings, _) = after(Some(&format!("{BEGUN}\n")));
    let other = folder.path().join("other.toml");
    assert!(left(&other).unwrap().is_clear());
    record_recovery(&other, "by hand").unwrap();
    let second = folder.path().join("second");
    fs::create_dir(&second).unwrap();
    fs::write(second.join(ARM_FILE), "").unwrap();
    record_run(&settings, &second).unwrap();
    assert!(left(&settings).unwrap().is_clear());
}

#[test]
fn a_run_that_is_gone_is_unknown_until_a_person_recovers_the_arm() {
    let (folder, settings, run) = after(Some(&format!("{BEGUN}\n")));
    fs::rename(&run, folder.path().join("moved")).unwrap();
    let why = left(&settings).unwrap_err().to_string();
    assert!(why.ends_with("arm.jsonl`: it is gone"), "{why}");
    record_recovery(&settings, "by hand").unwrap();
    assert!(left(&settings).unwrap().is_clear());
    // The recovery of one run does not count for the next.
    record_run(&settings, &folder.path().join("moved")).unwrap();
    assert!(!left(&settings).unwrap().is_clear());
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
        assert!(!left(file).unwrap().is_clear(), "{file:?}");
    }
    // A run that was started by the link is found by the file, too.
    fs::remove_file(folder.path().join("robot.last-run.json")).unwrap();
    assert!(left(&link).unwrap().is_clear());
    record_run(&link, &run).unwrap();
    assert!(!left(&settings).unwrap().is_clear());
}

#[test]
fn a_last_run_that_cannot_be_read_is_unknown() {
    let (folder, settings, _) = after(None);
    for text in ["", "{", "[]", "{\"run\": 3}"] {
        fs::write(folder.path().join("robot.last-run.json"), text).unwrap();
        let error = left(&settings).unwrap_err().to_string();
        assert!(error.contains("robot.last-run.json"), "{text}: {error}");
        record_recovery(&settings, "by hand").unwrap();
        assert!(left(&settings).unwrap().is_clear(), "{text}");
    }
}

/// The diagram in the documentation has an arrow for each event that changes the phase, and no other.
#[test]
fn the_diagram_shows_every_transition() {
    let all = [Phase::Ready, Phase::Moving, Phase::Paused, Phase::Stopped];
    let events = [
        Event::Begin,
        Event::Verify,
        Event::Pause,
        Event::Stop,
        Event::Recover,
    ];
    let name = |it: &dyn std::fmt::Debug| format!("{it:?}").to_lowercase();
    let mut arrows = Vec::new();
    for (phase, event) in all
        .iter()
        .flat_map(|phase| events.map(|event| (*phase, event)))
    {
        let next = phase.after(event);
        if next != phase {
            let [phase, next, event] = [name(&phase), name(&next), name(&event)];
            arrows.push(format!("{phase} --> {next}: {event}"));
        }
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/arm.md");
    let page = std::fs::read_to_string(page).unwrap();
    let shown = page.lines().filter(|line| line.contains(" --> "));
    let shown = shown.filter(|line| !line.starts_with("[*]"));
    let mut shown: Vec<&str> = shown
        .map(|line| line.split("  ").next().unwrap_or(line))
        .collect();
    shown.sort_unstable();
    arrows.sort();
    assert_eq!(shown, arrows);
}

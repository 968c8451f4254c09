//! Tests of the run state that a journal shows after a crash truncated it.

use super::*;
use crate::driver::Opening;
use crate::log::{ARM_FILE, Entry, RunState, run_state};
use crate::route::SegmentName;
use crate::supervisor::{NoWatchdog, Unattended};
use std::fs;

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
                .position(|entry| matches!(entry, Entry::Begin { segment, .. } if *segment == name))
        };
        let is_released = begins(SegmentName::Release).is_some_and(|begun| whole.len() > begun + 1);
        let holds = begins(SegmentName::Grasp).is_some() && !is_released;
        let is_done = matches!(whole.last(), Some(Entry::Done { .. }) | None);
        match said {
            RunState::Clear => assert!(is_done && !holds, "{cut}"),
            RunState::NeedsRecovery {
                may_hold,
                is_verified,
                ..
            } => {
                assert_eq!(may_hold, holds, "{cut}");
                assert_eq!(is_verified, is_done, "{cut}");
            }
        }
    }
    assert_eq!(run_state(folder.path()), Ok(RunState::Clear));
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
        let mut log = ArmLog::open(folder.path()).unwrap();
        log.write(&Entry::Recovered { how }).unwrap();
        assert_eq!(run_state(folder.path()), Ok(RunState::Clear), "{cut}");
    }
}

#[test]
fn a_release_that_was_not_verified_may_hold_cloth_ever_after() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = ArmLog::open(folder.path()).unwrap();
    let begin = |segment| Entry::Begin {
        action: 1,
        segment,
        to_m: None,
        hand: Some(Opening::Open),
        from_m: [0.4, 0.0, 0.1],
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
        assert!(
            matches!(said, RunState::NeedsRecovery { may_hold: true, .. }),
            "{said:?}"
        );
    }
}

//! Tests of `recover`.

#![allow(clippy::unwrap_used)]

use super::*;
use fab_arm::driver::{ArmError, Commands, Opening};
use fab_arm::settings::Settings;
use fab_arm::simulated::SimulatedArm;
use serde_json::Value;
use std::fs;
use std::path::Path;

const GRASP: &str = "{\"type\":\"begin\",\"action\":2,\"segment\":\"grasp\",\"to_m\":null}\n\
{\"type\":\"halted\",\"why\":\"interrupted\",\"stopped\":true}\n";

/// A stopped arm whose last run was stopped while the fingers closed, and arguments for it.
fn left(how: Option<&str>) -> (tempfile::TempDir, PortArm<SimulatedArm>, RecoverArguments) {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks/real/simulated.toml");
    let settings = Settings::load(&shipped).unwrap();
    let port = SimulatedArm::new(&settings, None).unwrap();
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    let mut arm = PortArm::new(Box::new(port), Commands::Trajectories, fingers, tolerance);
    arm.stop().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (robot, run) = (folder.path().join("robot.toml"), folder.path().join("run"));
    fs::create_dir(&run).unwrap();
    fs::write(run.join(journal::ARM_FILE), GRASP).unwrap();
    journal::record_run(&robot, &run).unwrap();
    let arguments = RecoverArguments {
        robot,
        how: how.map(str::to_owned),
        json: true,
    };
    (folder, arm, arguments)
}

fn close(arm: &mut PortArm<SimulatedArm>) -> Result<(), ArmError> {
    arm.move_fingers(Opening::Closed, &mut |_| Ok(())).map(drop)
}

fn journal_of(folder: &tempfile::TempDir) -> String {
    fs::read_to_string(folder.path().join("run/arm.jsonl")).unwrap()
}

#[test]
fn an_arm_that_nobody_looked_after_stays_as_it_was_left() {
    for how in [None, Some(""), Some("  ")] {
        let (folder, mut arm, arguments) = left(how);
        let io = Io::in_memory();
        let failure = recover(&mut arm, &arguments, &io).unwrap_err();
        assert_eq!(failure.exit, Exit::Environment);
        assert!(failure.to_string().contains("nobody said what was done"));
        assert_eq!(journal_of(&folder), GRASP);
        assert_eq!(close(&mut arm), Err(ArmError::Stopped));
        let said = io.captured();
        assert_eq!(said.stdout, "");
        for words in [
            "`grasp` of action 2 was begun and not verified",
            "the hand may hold cloth",
            "halted: interrupted",
        ] {
            assert!(said.stderr.contains(words), "{words}: {}", said.stderr);
        }
        let asks = said
            .stderr
            .contains("`home` of the vendor's driver opens the hand");
        assert_eq!(asks, how.is_none(), "{}", said.stderr);
    }
}

#[test]
fn an_arm_moves_again_once_it_is_said_what_was_done() {
    let (folder, mut arm, mut arguments) = left(Some("taken out"));
    let io = Io::in_memory();
    assert_eq!(recover(&mut arm, &arguments, &io).unwrap(), Exit::Done);
    let told: Value = serde_json::from_str(&io.captured().stdout).unwrap();
    assert_eq!(told["left"], "unclear");
    assert_eq!(told["phase"], "stopped");
    assert_eq!(told["segment"], "grasp");
    assert_eq!(told["may_hold"], true);
    assert_eq!(told["recovered"], "taken out");
    let line = "{\"type\":\"recovered\",\"how\":\"taken out\"}\n";
    assert_eq!(journal_of(&folder), format!("{GRASP}{line}"));
    close(&mut arm).unwrap();

    arguments.how = None;
    let io = Io::in_memory();
    assert_eq!(recover(&mut arm, &arguments, &io).unwrap(), Exit::Done);
    let told: Value = serde_json::from_str(&io.captured().stdout).unwrap();
    assert_eq!(
        (&told["left"], &told["recovered"]),
        (&Value::from("clear"), &Value::Null)
    );
    // It is clear, and stopped: then it is asked for again.
    arm.stop().unwrap();
    assert!(recover(&mut arm, &arguments, &Io::in_memory()).is_err());
    arguments.how = Some("the cable hung".to_owned());
    recover(&mut arm, &arguments, &Io::in_memory()).unwrap();
    close(&mut arm).unwrap();
}

#[test]
fn a_run_that_is_gone_is_forgotten() {
    let (folder, mut arm, arguments) = left(Some("by hand"));
    fs::remove_dir_all(folder.path().join("run")).unwrap();
    let io = Io::in_memory();
    recover(&mut arm, &arguments, &io).unwrap();
    let told: Value = serde_json::from_str(&io.captured().stdout).unwrap();
    assert_eq!(told["left"], "unknown");
    assert!(io.captured().stderr.contains("arm.jsonl`: it is gone"));
    assert!(journal::left(&arguments.robot).unwrap().is_clear());
}

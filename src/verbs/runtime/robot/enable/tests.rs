//! Tests of `enable`.

#![allow(clippy::unwrap_used)]

use super::*;
use fab_arm::driver::{ArmError, Opening, PortArm};
use fab_arm::settings::Settings;
use fab_arm::simulated::{SimulatedArm, Simulation};
use std::fs;

#[test]
fn an_arm_is_enabled_and_its_run_still_needs_recovery() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks/real/simulated.toml");
    let settings = Settings::load(&shipped).unwrap();
    let port = SimulatedArm::new(Simulation::of(&settings).unwrap(), None);
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    let mut arm = PortArm::by_poses(port, Guard::level(&settings), fingers, tolerance);
    let folder = tempfile::tempdir().unwrap();
    let (robot, run) = (folder.path().join("robot.toml"), folder.path().join("run"));
    fs::create_dir(&run).unwrap();
    let begun = "{\"type\":\"begin\",\"action\":1,\"segment\":\"lift\",\"to_m\":null,\"hand\":null,\"from_m\":[0.4,0.1,0.02]}\n";
    fs::write(run.join(ARM_FILE), begun).unwrap();
    last_run::record(&robot, &run).unwrap();

    arm.stop().unwrap();
    let mut watch = |_: &_| Ok(());
    let moved = arm.move_fingers(Opening::Closed, &mut watch);
    assert_eq!(moved, Err(ArmError::Stopped));
    enable(&mut arm, &robot, "the cable hung").unwrap();
    arm.move_fingers(Opening::Closed, &mut watch).unwrap();
    let line = "{\"type\":\"enabled\",\"how\":\"the cable hung\"}\n";
    let journal = fs::read_to_string(run.join(ARM_FILE)).unwrap();
    assert_eq!(journal, format!("{begun}{line}"));
    let open = unfinished_note(&robot).unwrap();
    assert!(open.contains("the hand may hold cloth"), "{open}");
    // Without a run there is nothing to record, but the arm is enabled.
    arm.stop().unwrap();
    enable(&mut arm, &folder.path().join("other.toml"), "again").unwrap();
    arm.move_fingers(Opening::Open, &mut watch).unwrap();
}

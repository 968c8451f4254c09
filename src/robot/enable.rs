//! `fabc robot enable`: lets a stopped arm go, because a person said so.
//!
//! In: the arm's settings, and words. Out: an arm that takes motion again, found so by a goal that is none, and a line of
//! the last run's journal. What the hand holds, and what that run left open, stays as it is.

use super::recover::{BY_NOBODY, in_words, words};
use super::{connect, standing};
use crate::cli::robot::EnableArguments;
use crate::exit::{Exit, Failure};
use crate::output;
use fab_arm::driver::Arm;
use fab_arm::last;
use fab_arm::last::Standing;
use fab_arm::log::{ARM_FILE, ArmLog, Entry};
use serde_json::json;
use std::path::Path;

const QUESTION: &str = "Let go, it moves as soon as it is told to: is its way free, and a physical stop in reach? \
Why it was stopped and may go, in a few words; nothing to leave it stopped:";

/// Asks, and lets the arm go.
pub fn run(arguments: &EnableArguments) -> Result<Exit, Failure> {
    let robot = &arguments.robot;
    let nothing = "it ends with the program that moves it, and is never left stopped";
    let settings = connect::settings_of_real(robot, nothing)?;
    standing::claim(robot).map_err(Failure::environment)?;
    if let Some(note) = left_open(robot) {
        output::talk(&format!("note: {note}"));
    }
    let how = words(arguments.how.as_ref(), QUESTION);
    if how.is_empty() {
        return Err(Failure::environment(format!(
            "{BY_NOBODY}, so that the arm is left as it is"
        )));
    }
    let mut arm = connect::arm(&settings).map_err(Failure::environment)?;
    let_go(arm.as_mut(), robot, &how)?;
    match arguments.json {
        true => output::json(&json!({ "enabled": true, "how": how })),
        false => output::data("let go: the arm takes motion again"),
    }
    Ok(Exit::Done)
}

/// Lets an arm go, and notes it where its last run has a journal.
fn let_go(arm: &mut dyn Arm, robot: &Path, how: &str) -> Result<(), Failure> {
    arm.enable().map_err(|error| {
        Failure::environment(format!(
            "the arm was told that it may move again, and it is not verified that it can: {error}"
        ))
    })?;
    let run = last::run(robot).ok().flatten();
    let Some(run) = run.filter(|run| run.join(ARM_FILE).is_file()) else {
        return Ok(());
    };
    let entry = Entry::Enabled {
        how: how.to_owned(),
    };
    let written = ArmLog::open(&run).and_then(|mut log| log.write(&entry));
    written.map_err(|error| {
        Failure::environment(format!(
            "the arm is let go, and that could not be noted: {error}"
        ))
    })
}

/// Says what the last run left open: to be let go does not settle it.
fn left_open(robot: &Path) -> Option<String> {
    match last::standing(robot) {
        Ok(Standing::Clear) => None,
        Ok(Standing::Unclear { left, .. }) => {
            Some(format!("the last run left it so: {}", in_words(&left)))
        }
        Ok(Standing::Unknown { why, .. }) => Some(format!(
            "in what state the last run left it is not known: {why}"
        )),
        Err(error) => Some(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use fab_arm::driver::{ArmError, Opening, PortArm};
    use fab_arm::settings::Settings;
    use fab_arm::simulated::{SimulatedArm, Simulation};
    use std::fs;

    #[test]
    fn an_arm_is_let_go_and_its_run_stays_open() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tasks/real/simulated.toml");
        let settings = Settings::load(&shipped).unwrap();
        let port = SimulatedArm::new(Simulation::of(&settings).unwrap(), None);
        let (fingers, tolerance) = (settings.fingers, settings.tolerance);
        let mut arm = PortArm::by_poses(port, &settings.model, fingers, tolerance);
        let folder = tempfile::tempdir().unwrap();
        let (robot, run) = (folder.path().join("robot.toml"), folder.path().join("run"));
        fs::create_dir(&run).unwrap();
        let begun = "{\"type\":\"begin\",\"action\":1,\"segment\":\"lift\",\"to_m\":null,\"hand\":null,\"from_m\":[0.4,0.1,0.02]}\n";
        fs::write(run.join(ARM_FILE), begun).unwrap();
        last::note(&robot, &run).unwrap();

        arm.stop().unwrap();
        let mut watch = |_: &_| Ok(());
        let moved = arm.move_fingers(Opening::Closed, &mut watch);
        assert_eq!(moved, Err(ArmError::Stopped));
        let_go(&mut arm, &robot, "the cable hung").unwrap();
        arm.move_fingers(Opening::Closed, &mut watch).unwrap();
        let line = "{\"type\":\"enabled\",\"how\":\"the cable hung\"}\n";
        let journal = fs::read_to_string(run.join(ARM_FILE)).unwrap();
        assert_eq!(journal, format!("{begun}{line}"));
        let open = left_open(&robot).unwrap();
        assert!(open.contains("the hand may hold cloth"), "{open}");
        // Without a run there is nothing to note, and the arm is let go all the same.
        arm.stop().unwrap();
        let_go(&mut arm, &folder.path().join("other.toml"), "again").unwrap();
        arm.move_fingers(Opening::Open, &mut watch).unwrap();
    }
}

//! Arms that a URDF and settings describe, through the command: checked, planned for, and folding in simulation.

use super::support::{Captured, fabc, finish, root};
use fab_arm::journal::run_state;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn settings(name: &str) -> PathBuf {
    root().join("tests/fixtures/arms").join(name)
}

/// Runs a Double Triangle in a folder.
fn folded(folder: &Path, robot: &Path, options: &[&str]) -> Captured {
    let task = root().join("tasks/real/double_triangle.fab");
    finish(
        fabc(folder)
            .args(["run", task.to_str().unwrap(), "--world", "arm"])
            .args(["--robot", robot.to_str().unwrap(), "--json", "--out", "run"])
            .args(options),
    )
}

/// Folds with an arm, and checks how it ended.
fn folds(robot: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let output = folded(folder.path(), robot, &[]);
    let report: Value = serde_json::from_str(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", output.stderr));
    assert_eq!(report["outcome"], "goal_reached", "{report}");
    let run = folder.path().join("run");
    assert!(run_state(&run).unwrap().is_clear());
    let journal = std::fs::read_to_string(run.join("arm.jsonl")).unwrap();
    let count = |kind: &str| journal.matches(&format!("\"type\":\"{kind}\"")).count();
    assert_eq!(count("begin"), count("done"));
    assert!(count("begin") >= 24, "{}", count("begin"));
}

/// Plans with an arm, and checks the plan.
fn plans(robot: &Path, model: &str, n_joints: usize) {
    let folder = tempfile::tempdir().unwrap();
    let output = folded(folder.path(), robot, &["--plan-only"]);
    let report: Value = serde_json::from_str(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", output.stderr));
    assert_eq!(report["outcome"], "planned", "{report}");
    let plan = std::fs::read_to_string(folder.path().join("run/plan.json")).unwrap();
    let plan: Value = serde_json::from_str(&plan).unwrap();
    assert_eq!(plan["model"], model);
    assert_eq!(plan["refused"], Value::Null);
    let joints = plan["segments"][2]["joints_deg"].as_array().unwrap();
    assert_eq!(joints.len(), n_joints, "{plan}");
}

/// Brings the settings of an arm whose description is not part of this repository into a folder, beside it.
fn brought(folder: &Path, name: &str) -> PathBuf {
    let robots = std::env::var_os("FABC_PEER_ROBOTS")
        .expect("make test-all names the descriptions of robots");
    let descriptions = Path::new(&robots).join("example-robot-data");
    std::os::unix::fs::symlink(descriptions, folder.join("example-robot-data")).unwrap();
    let text = std::fs::read_to_string(settings(name)).unwrap();
    let calibration = root().join("tasks/real/simulated.calibration.toml");
    let beside = "../../../tasks/real/simulated.calibration.toml";
    assert!(text.contains(beside));
    let robot = folder.join(name);
    std::fs::write(&robot, text.replace(beside, calibration.to_str().unwrap())).unwrap();
    robot
}

#[test]
fn a_described_arm_is_planned_for() {
    plans(&settings("seven.toml"), "seven", 7);
}

#[test]
fn arm_and_jaco_are_one_world() {
    let folder = tempfile::tempdir().unwrap();
    let task = root().join("tasks/real/double_triangle.fab");
    for world in ["arm", "jaco"] {
        let output = finish(fabc(folder.path()).args([
            "run",
            task.to_str().unwrap(),
            "--world",
            world,
            "--robot",
            "none.toml",
        ]));
        assert_eq!(output.code, 2, "{world}: {}", output.stderr);
        assert!(
            output.stderr.contains("none.toml"),
            "{world}: {}",
            output.stderr
        );
    }
    let output =
        finish(fabc(folder.path()).args(["run", task.to_str().unwrap(), "--world", "arms"]));
    assert_eq!(output.code, 64);
    assert!(
        output.stderr.contains("`jaco` is another name"),
        "{}",
        output.stderr
    );
}

#[test]
fn faults_of_a_description_are_told_with_those_of_the_settings() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(settings("seven.toml")).unwrap();
    let text = text.replace(
        "urdf = \"seven.urdf\"",
        &format!("urdf = {:?}", settings("seven.urdf")),
    );
    let text = text.replace(
        "max_speed_deg_s = 120",
        "max_speed_deg_s = 700.0\nmax_deg = 400.0",
    );
    let text = text.replace("lift_m = 0.05", "lift_m = 0.001");
    std::fs::write(folder.path().join("robot.toml"), text).unwrap();
    let output = finish(fabc(folder.path()).args(["robot", "check", "--robot", "robot.toml"]));
    assert_eq!(output.code, 2);
    for part in [
        "the limits of the joint `seven` are",
        "`motion.lift_m` is `0.001`",
    ] {
        assert!(output.stderr.contains(part), "{part}: {}", output.stderr);
    }
}

#[test]
#[ignore = "long"]
fn the_made_up_arm_folds_a_double_triangle() {
    folds(&settings("seven.toml"));
}

#[test]
#[ignore = "needs example-robot-data"]
fn peer_robots_a_ur5_plans_and_folds_in_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let robot = brought(folder.path(), "ur5.toml");
    plans(&robot, "ur5", 6);
    folds(&robot);
}

#[test]
#[ignore = "needs example-robot-data"]
fn peer_robots_a_panda_plans_and_folds_in_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let robot = brought(folder.path(), "panda.toml");
    plans(&robot, "panda", 7);
    folds(&robot);
}

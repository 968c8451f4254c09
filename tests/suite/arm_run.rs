//! `fabc run --world jaco` with the simulated arm: the whole loop, without a robot.

use super::support::{Captured, bring_robot, fabc, finish, root};
use fab_arm::journal::run_state;
use serde_json::Value;

#[test]
fn the_simulated_arm_folds_a_double_triangle() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let robot = root().join("tasks/real/simulated.toml");
    let task = root().join("tasks/real/double_triangle.fab");
    let output = finish(
        fabc(folder.path())
            .args(["run", task.to_str().unwrap(), "--world", "jaco"])
            .args(["--robot", robot.to_str().unwrap(), "--json", "--out"])
            .arg(&run),
    );
    let report: Value = serde_json::from_str(&output.stdout).unwrap();
    assert_eq!(report["outcome"], "goal_reached", "{report}");
    assert_eq!(output.code, 0);
    // Every motion was recorded before it and verified after it, and the hand is empty.
    assert!(run_state(&run).unwrap().is_clear());
    let journal = std::fs::read_to_string(run.join("arm.jsonl")).unwrap();
    let count = |kind: &str| journal.matches(&format!("\"type\":\"{kind}\"")).count();
    assert_eq!(count("begin"), count("done"));
    assert!(count("begin") >= 24, "{}", count("begin"));
    assert_eq!(count("halted"), 0);

    let again = finish(fabc(folder.path()).args(["resume"]).arg(&run));
    assert_eq!(again.code, 0, "an ended run has nothing to go on with");
}

#[test]
fn an_arm_without_settings_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.toml");
    let task = root().join("tasks/real/double_triangle.fab");
    let output = finish(
        fabc(folder.path())
            .args(["run", task.to_str().unwrap(), "--world", "jaco"])
            .args(["--robot", missing.to_str().unwrap(), "--out"])
            .arg(folder.path().join("run")),
    );
    assert_eq!(output.code, 2);
    let said = output.stderr;
    assert!(said.contains("none.toml"), "{said}");
}

/// Runs the fold with changed arm settings, and returns the folder and the output.
fn planned(edits: &[(&str, &str)]) -> (tempfile::TempDir, Captured) {
    let folder = tempfile::tempdir().unwrap();
    bring_robot(folder.path(), edits);
    let task = root().join("tasks/real/double_triangle.fab");
    let output = finish(
        fabc(folder.path())
            .args(["run", task.to_str().unwrap(), "--world", "jaco"])
            .args(["--plan-only", "--out", "run", "--json"]),
    );
    (folder, output)
}

#[test]
#[ignore = "long"]
fn a_plan_is_drawn_and_nothing_moves() {
    let (folder, output) = planned(&[]);
    let report: Value = serde_json::from_str(&output.stdout).unwrap();
    assert_eq!(report["outcome"], "planned", "{report}");
    assert_eq!(report["steps"], 0, "{report}");
    assert_eq!(output.code, 0);
    let run = folder.path().join("run");
    let read = std::fs::read(run.join("plan.json")).unwrap();
    let plan: Value = serde_json::from_slice(&read).unwrap();
    assert_eq!(report["plan"], plan);
    let names: Vec<&str> = plan["segments"]
        .as_array()
        .unwrap()
        .iter()
        .map(|segment| segment["name"].as_str().unwrap())
        .collect();
    assert_eq!((names[0], names[12], names.len()), ("rise", "rest", 13));
    let drawn = image::open(run.join("plan.png")).unwrap();
    assert_eq!((drawn.width(), drawn.height()), (720, 720));
    // The journal of motions does not exist.
    assert!(!run.join("arm.jsonl").exists());
}

#[test]
#[ignore = "long"]
fn a_plan_that_is_not_possible_is_drawn_up_to_there() {
    let zone = "rest_m = [0.30, -0.40, 0.25]\nkeep_out = [{ name = 'lamp', min_m = [0.44, -0.01, 0.0], max_m = [0.46, 0.01, 0.06] }]";
    let (folder, output) = planned(&[("rest_m = [0.30, -0.40, 0.25]", zone)]);
    let report: Value = serde_json::from_str(&output.stdout).unwrap();
    assert_eq!(report["outcome"], "world_failed", "{report}");
    assert_eq!(output.code, 2);
    let why = report["plan"]["refused"].as_str().unwrap_or_default();
    assert!(why.contains("`lamp`"), "{report}");
    assert!(folder.path().join("run/plan.png").exists());
}

#[test]
fn plans_are_for_arms_alone() {
    let folder = tempfile::tempdir().unwrap();
    let task = root().join("tasks/double_triangle.fab");
    let output = finish(fabc(folder.path()).args(["run", task.to_str().unwrap(), "--plan-only"]));
    assert_eq!(output.code, 64);
    let said = output.stderr;
    assert!(said.contains("--world arm"), "{said}");
}

/// Whoever gives one of them believes that an arm is watched.
#[test]
fn options_of_an_arm_are_refused_in_another_world() {
    let folder = tempfile::tempdir().unwrap();
    let task = root().join("tasks/double_triangle.fab");
    for world in ["sim", "exec:true"] {
        for option in [
            &["--robot", "robot.toml"][..],
            &["--confirm", "none"],
            &["--hold-to-run"],
        ] {
            for verb in [&["run", task.to_str().unwrap()], &["bench", "physical"]] {
                let mut command = fabc(folder.path());
                let said = finish(command.args(verb).args(["--world", world]).args(option));
                assert_eq!(said.code, 64, "{verb:?} {option:?}: {}", said.stderr);
                for words in [option[0], " are for an arm, and nothing is moved by one"] {
                    assert!(said.stderr.contains(words), "{}", said.stderr);
                }
            }
        }
    }
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
#[ignore = "long"]
fn a_camera_that_was_moved_since_its_calibration_is_noticed_before_anything_moves() {
    for (from, to) in [
        (
            "camera_offset_m = [0.012, -0.008]",
            "camera_offset_m = [0.020, -0.008]",
        ),
        ("camera_turn_deg = 1.5", "camera_turn_deg = 2.0"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        bring_robot(folder.path(), &[(from, to)]);
        let task = root().join("tasks/real/double_triangle.fab");
        let output = finish(
            fabc(folder.path())
                .args(["run", task.to_str().unwrap(), "--world", "jaco"])
                .args(["--out", "run", "--json"]),
        );
        assert_eq!(output.code, 2, "{to}");
        let report: Value = serde_json::from_str(&output.stdout).unwrap();
        assert_eq!(report["outcome"], "world_failed", "{report}");
        let why = report["stopped"].as_str().unwrap();
        assert!(
            why.contains("it was moved since it was calibrated, by"),
            "{why}"
        );
        let journal = std::fs::read(folder.path().join("run/arm.jsonl")).unwrap();
        assert!(journal.is_empty(), "it moved");
    }
}

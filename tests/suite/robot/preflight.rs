//! An arm that must not be moved: left in mid-motion by its last run, used by another program, or missing.

use super::super::support::{Captured, fabc, finish, project, root};
use super::{GRASP, ROBOT, left, robot};
use fab_arm::journal::{record_recovery, record_run};
use std::fs;
use std::path::Path;

/// Settings of a real arm, which this build may not support.
fn real() -> String {
    let ros = "[ros]\nmaster = \"http://localhost:1\"\narm = \"/j2n6s200_driver\"\n";
    ROBOT
        .replace("driver = \"simulated\"", "driver = \"kinova\"")
        .replace(
            "source = \"simulated\",",
            "source = \"directory\", folder = \"shots\",",
        )
        + ros
}

/// Puts a calibration beside the settings.
fn bring_calibration(folder: &Path) {
    for ending in ["toml", "png"] {
        let shipped = root().join(format!("tasks/real/simulated.calibration.{ending}"));
        fs::copy(shipped, folder.join(format!("lab.{ending}"))).unwrap();
    }
}

/// Runs a fold with the arm of `robot.toml`, without asking anybody.
fn run_of(folder: &Path) -> Captured {
    let mut command = fabc(folder);
    let task = project("tasks/real/double_triangle.fab");
    command.args(["run", &task, "--world", "jaco", "--robot", "robot.toml"]);
    finish(command.args(["--confirm", "none", "--out", "next"]))
}

#[test]
fn an_arm_that_a_run_left_in_the_middle_is_not_moved_again_before_a_person_has_looked() {
    let folder = left();
    fs::write(folder.path().join("robot.toml"), real()).unwrap();
    let run = fs::canonicalize(folder.path().join("run")).unwrap();
    bring_calibration(folder.path());
    let settings = folder.path().join("robot.toml");
    record_run(&settings, &run).unwrap();
    let refused = |why: &str| {
        let said = run_of(folder.path());
        assert_eq!(said.code, 2);
        for words in [
            "nothing is moved, because of how the last run with the arm of `robot.toml` ended: ",
            why,
            "`fabc robot recover --robot robot.toml`",
        ] {
            assert!(said.stderr.contains(words), "{words}: {}", said.stderr);
        }
    };
    let passes = || {
        record_recovery(&settings, "taken out").unwrap();
        let said = run_of(folder.path());
        assert!(!said.stderr.contains("the last run"), "{}", said.stderr);
    };
    refused("`grasp` of action 2 was begun and not verified");
    passes();

    // The next run was cut off, and its folder was deleted.
    fs::write(run.join("arm.jsonl"), GRASP).unwrap();
    fs::rename(&run, folder.path().join("elsewhere")).unwrap();
    refused("arm.jsonl`: it is gone");
    passes();
}

/// A second name for the settings file is a name for the same arm.
#[cfg(unix)]
#[test]
fn a_symbolic_link_does_not_hide_how_a_run_left_the_arm() {
    let folder = left();
    fs::write(folder.path().join("lab.toml"), real()).unwrap();
    record_run(&folder.path().join("lab.toml"), &folder.path().join("run")).unwrap();
    let link = folder.path().join("robot.toml");
    std::os::unix::fs::symlink("lab.toml", &link).unwrap();
    let said = run_of(folder.path());
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("`grasp` of action 2"),
        "{}",
        said.stderr
    );
    record_recovery(&link, "by hand").unwrap();
    assert!(!run_of(folder.path()).stderr.contains("`grasp` of action 2"));
}

#[test]
fn an_arm_that_another_program_uses_is_left_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let settings = folder.path().join("robot.toml");
    fs::write(&settings, real()).unwrap();
    bring_calibration(folder.path());
    let held = fs::File::open(&settings).unwrap();
    held.try_lock().unwrap();
    let run = || run_of(folder.path());
    let words = "another fabc uses the arm of `robot.toml`: wait until it has ended";
    let said = run();
    assert_eq!(said.code, 2);
    assert!(said.stderr.contains(words), "{}", said.stderr);
    drop(held);
    assert!(!run().stderr.contains(words));
}

#[test]
fn a_wrong_name_is_not_clear() {
    let folder = tempfile::tempdir().unwrap();
    let said = robot(folder.path(), &["recover", "--robot", "robto.toml"], "x\n");
    assert_eq!(said.code, 2);
    assert!(said.stderr.contains("`robto.toml`"), "{}", said.stderr);
    assert_eq!(robot(folder.path(), &["recover"], "").code, 64);
}

#[test]
fn a_simulated_arm_is_neither_recovered_nor_guided() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    let said = robot(
        folder.path(),
        &["recover", "--robot", "robot.toml", "--how", "x"],
        "",
    );
    assert_eq!((said.code, said.stdout.as_str()), (2, ""));
    let words = "the arm of `robot.toml` is simulated: it ends with the program that moves it, so there is nothing to recover";
    assert!(said.stderr.contains(words), "{}", said.stderr);
    let mut command = fabc(folder.path());
    let said = finish(command.args(["calibrate", "--robot", "robot.toml", "--jog"]));
    assert_eq!(said.code, 2);
    let words = "is simulated: nobody can guide it to a point; give points with `--pairs`";
    assert!(said.stderr.contains(words), "{}", said.stderr);
    let mut command = fabc(folder.path());
    let said = finish(command.args(["calibrate", "--robot", "robot.toml"]));
    assert_eq!(said.code, 64, "{}", said.stderr);
}

/// Without ROS, a real arm is out of reach; the message says what would be right.
#[cfg(not(feature = "ros"))]
#[test]
fn a_build_without_ros_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), real()).unwrap();
    for arguments in [
        &["robot", "recover", "--robot", "robot.toml", "--how", "x"][..],
        &["calibrate", "--robot", "robot.toml", "--jog"],
        &["robot", "watchdog", "--robot", "robot.toml"],
    ] {
        let mut command = fabc(folder.path());
        let said = finish(command.args(arguments));
        assert_eq!((said.code, said.stdout.as_str()), (2, ""), "{arguments:?}");
        assert!(said.stderr.contains("without"), "{}", said.stderr);
        assert!(
            said.stderr.contains("`ros`") || said.stderr.contains("`--features ros`"),
            "{}",
            said.stderr
        );
    }
}

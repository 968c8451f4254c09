//! `fabc run --world jaco` with the arm that is simulated: the whole loop, without a robot.

use super::support::{fabc, root};
use runtime::arm::log::{Left, left};
use serde_json::Value;

#[test]
fn the_simulated_arm_folds_a_double_triangle() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let robot = root().join("tasks/real/simulated.toml");
    let task = root().join("tasks/real/double_triangle.fab");
    let output = fabc(folder.path())
        .args(["run", task.to_str().unwrap(), "--world", "jaco"])
        .args(["--robot", robot.to_str().unwrap(), "--json", "--out"])
        .arg(&run)
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["outcome"], "goal_reached", "{report}");
    assert_eq!(output.status.code(), Some(0));
    // Every motion was written down before it and verified after it, and the hand is empty.
    assert_eq!(left(&run).unwrap(), Left::Clear);
    let journal = std::fs::read_to_string(run.join("arm.jsonl")).unwrap();
    let count = |kind: &str| journal.matches(&format!("\"type\":\"{kind}\"")).count();
    assert_eq!(count("begin"), count("done"));
    assert!(count("begin") >= 24, "{}", count("begin"));
    assert_eq!(count("halted"), 0);

    let again = fabc(folder.path())
        .args(["resume"])
        .arg(&run)
        .output()
        .unwrap();
    assert_eq!(
        again.status.code(),
        Some(0),
        "an ended run has nothing to go on with"
    );
}

#[test]
fn an_arm_without_settings_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none.toml");
    let task = root().join("tasks/real/double_triangle.fab");
    let output = fabc(folder.path())
        .args(["run", task.to_str().unwrap(), "--world", "jaco"])
        .args(["--robot", missing.to_str().unwrap(), "--out"])
        .arg(folder.path().join("run"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("none.toml"), "{said}");
}

//! `fabc robot`: says what an arm reaches, names unusable settings, and lets nothing move with them.

mod preflight;

use super::support::{Captured, fabc, finish, project, root};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const ROBOT: &str = "\
name = \"lab\"
model = \"j2n6s200\"
driver = \"simulated\"
calibration = \"lab.toml\"
table = { center_m = [0.45, 0.0, 0.02] }
workspace = { min_m = [0.3, -0.3, 0.01], max_m = [0.75, 0.3, 0.5], rest_m = [0.35, -0.25, 0.3] }
fingers = { count = 2, open = 0.0, closed = 6400.0, tolerance = 200.0 }
camera = { source = \"simulated\", window_px = [0, 0, 480] }
";

const GRASP: &str = "\
{\"type\":\"begin\",\"action\":2,\"segment\":\"grasp\",\"to_m\":null}
{\"type\":\"halted\",\"why\":\"interrupted\",\"stopped\":true}
";

fn robot(folder: &Path, arguments: &[&str], typed: &str) -> Captured {
    finish(fabc(folder).arg("robot").args(arguments).stdin(typed))
}

/// A folder with a run that was stopped while the fingers closed.
fn left() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("run")).unwrap();
    fs::write(folder.path().join("run/arm.jsonl"), GRASP).unwrap();
    folder
}

fn check(folder: &Path, settings: &str) -> (i32, Value) {
    fs::write(folder.join("robot.toml"), settings).unwrap();
    let mut command = fabc(folder);
    let said = finish(command.args(["robot", "check", "--robot", "robot.toml", "--json"]));
    (said.code, serde_json::from_str(&said.stdout).unwrap())
}

#[test]
fn an_arm_that_is_set_up_is_told_what_it_reaches() {
    let folder = simulated(&[]);
    let settings = fs::read_to_string(folder.path().join("robot.toml")).unwrap();
    let (code, read) = check(folder.path(), &settings);
    assert_eq!(code, 0, "{read}");
    assert_eq!(read["calibration"]["made_on"], "2026-11-22");
    let left_out_mm = read["calibration"]["left_out_rms_mm"].as_f64().unwrap();
    assert!((0.1..4.0).contains(&left_out_mm), "{read}");
    assert_eq!(read["faults"], Value::Array(Vec::new()));
    let reached: Vec<bool> = read["reach"]
        .as_array()
        .unwrap()
        .iter()
        .map(|place| place["why_not"].is_null())
        .collect();
    // The far corners are 0.92 m away, and the arm reaches 0.70 m.
    assert_eq!(reached, [true, true, true, true, false, false], "{read}");
    let mut command = fabc(folder.path());
    let said = finish(command.args(["robot", "check", "--robot", "robot.toml"]));
    assert_eq!(said.code, 0);
    assert_eq!(
        said.stdout.matches(": reached").count(),
        4,
        "{}",
        said.stdout
    );
}

#[test]
fn an_arm_that_cannot_be_used_is_named_by_what_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let (code, read) = check(folder.path(), ROBOT);
    assert_eq!((code, &read["calibration"]), (2, &Value::Null));
    let fault = read["faults"][0].as_str().unwrap();
    assert!(
        fault.contains("`lab.toml` is not a usable calibration"),
        "{fault}"
    );
    let far = ROBOT.replace("rest_m = [0.35, -0.25, 0.3]", "rest_m = [0.74, 0.29, 0.3]");
    let (code, read) = check(folder.path(), &far);
    assert_eq!((code, read["reach"][1]["why_not"].is_string()), (2, true));
    let (code, read) = check(folder.path(), &ROBOT.replace("count = 2", "count = 4"));
    assert_eq!(code, 2);
    assert!(
        read["error"]
            .as_str()
            .unwrap()
            .contains("`fingers.count` is `4`"),
        "{read}"
    );
}

/// The shipped simulated arm, with edits of its settings, and its calibration.
fn simulated(edits: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let shipped = root().join("tasks/real");
    for ending in ["toml", "png"] {
        let calibration = format!("simulated.calibration.{ending}");
        fs::copy(shipped.join(&calibration), folder.path().join(&calibration)).unwrap();
    }
    let mut settings = fs::read_to_string(shipped.join("simulated.toml")).unwrap();
    for (from, to) in edits {
        assert!(settings.contains(from), "{from}");
        settings = settings.replacen(from, to, 1);
    }
    fs::write(folder.path().join("robot.toml"), settings).unwrap();
    folder
}

/// Edits of the shipped settings; why check refuses them, and what to do about it.
type Refused = (
    &'static [(&'static str, &'static str)],
    &'static str,
    &'static str,
);

const REFUSED: [Refused; 4] = [
    (
        &[
            (
                "center_m = [0.45, 0.0, 0.02]",
                "center_m = [0.45, 0.0, 0.12]",
            ),
            (
                "min_m = [0.15, -0.525, 0.01]",
                "min_m = [0.15, -0.525, 0.11]",
            ),
        ],
        "mm from the height in `table.center_m`; at most 10 mm are accepted",
        "; correct `robot.toml`, or touch points anew",
    ),
    (
        &[(
            "center_m = [0.45, 0.0, 0.02]",
            "center_m = [0.25, 0.0, 0.02]",
        )],
        "mm from `table.center_m`; at most 50 mm are accepted",
        "; correct `robot.toml`, or touch points anew",
    ),
    (
        &[("simulated.calibration.toml", "none.toml")],
        "`none.toml` is not a usable calibration",
        "touch points anew: `fabc calibrate --robot robot.toml --pairs FILE`",
    ),
    (
        &[(
            "rest_m = [0.30, -0.40, 0.25]",
            "rest_m = [0.74, -0.50, 0.25]",
        )],
        "the rest (0.740, -0.500, 0.250) is out of reach",
        "; state another `workspace.rest_m`",
    ),
];

#[test]
fn what_check_refuses_is_neither_planned_nor_run() {
    nothing_moves(&REFUSED[..1]);
}

#[test]
#[ignore = "long"]
fn whatever_check_refuses_is_neither_planned_nor_run() {
    nothing_moves(&REFUSED[1..]);
    let said = robot(
        simulated(&[]).path(),
        &["check", "--robot", "robot.toml"],
        "",
    );
    let next = "next: `fabc run TASK --world arm --robot robot.toml --plan-only`\n";
    assert_eq!((said.code, said.stderr.as_str()), (0, next));
}

fn nothing_moves(cases: &[Refused]) {
    let task = project("tasks/real/double_triangle.fab");
    for (edits, why, cure) in cases {
        let folder = simulated(edits);
        let said = robot(folder.path(), &["check", "--robot", "robot.toml"], "");
        assert_eq!(said.code, 2, "{why}: {}", said.stdout);
        assert!(said.stdout.contains(cure), "{cure}: {}", said.stdout);
        for more in [&["--plan-only"][..], &[]] {
            let mut command = fabc(folder.path());
            command.args(["run", &task, "--world", "jaco", "--robot", "robot.toml"]);
            let said = finish(command.args(["--out", "run"]).args(more));
            assert_eq!(said.code, 2, "{more:?}");
            for words in ["nothing is planned or moved", why, cure] {
                assert!(said.stderr.contains(words), "{words}: {}", said.stderr);
            }
            assert!(!folder.path().join("run/arm.jsonl").exists());
        }
    }
}

#[test]
fn a_watchdog_that_could_stop_nothing_does_not_say_that_it_is_ready() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    let said = robot(
        folder.path(),
        &["watchdog", "--robot", "robot.toml"],
        "beat\n",
    );
    assert_eq!((said.code, said.stdout.as_str()), (2, ""));
    assert!(said.stderr.contains("cannot be stopped from outside"));
}

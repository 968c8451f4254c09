//! A suite on a simulated arm: one rollout at a time, each with the arm's journal; interrupted suites, and failing
//! arms.

use super::bench::project;
use super::physical::SUITE;
use super::support::{Captured, bring_robot, fabc, finish};
use fab_arm::journal::run_state;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with a simulated arm and a suite of two folds of a small cloth.
fn lab(edits: &[(&str, &str)]) -> TempDir {
    let folder = project(&SUITE.replace("count = 3", "count = 2"));
    let task = folder.path().join("tasks/tiny.fab");
    let text = fs::read_to_string(&task).unwrap();
    let on_table = text
        .replace("lib/folding.fab", "lib/real.fab")
        .replace("extends folding", "extends real_folding");
    fs::write(&task, on_table).unwrap();
    bring_robot(folder.path(), edits);
    folder
}

/// Runs the suite on the arm, with these lines typed.
fn carried(folder: &Path, more: &[&str], lines: &str) -> Captured {
    finish(
        fabc(folder)
            .args(["bench", "tiny", "--world", "jaco", "--json", "--out", "out"])
            .args(more)
            .stdin(lines),
    )
}

fn document(said: &Captured) -> Value {
    serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{}", said.stderr))
}

#[test]
#[ignore = "long"]
fn rollouts_go_one_at_a_time_and_the_operator_judges_each() {
    let lab = lab(&[]);
    let said = carried(lab.path(), &["--operator"], "y\n\nn\nh\nthe hand slipped\n");
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert!(said.stderr.contains("1 at a time"), "{}", said.stderr);
    let table = document(&said);
    assert_eq!(table["rollouts"]["finished"], 2);
    let row = &table["rows"][0];
    assert_eq!(row["metric"], "reached_by_operator");
    assert_eq!(row["value"], 0.5);
    assert_eq!(row["causes"], serde_json::json!({ "hardware": 1 }));
    let note = row["note"].as_str().unwrap();
    assert!(note.contains("a rehearsal on a simulated arm"), "{note}");
    for start in ["start-000-1", "start-001-1"] {
        let run = lab.path().join("out/tiny/plain").join(start);
        assert!(fs::metadata(run.join("arm.jsonl")).unwrap().len() > 1000);
        assert!(run_state(&run).unwrap().is_clear());
        let journal = fs::read_to_string(run.join("rollout.jsonl")).unwrap();
        assert!(journal.contains("\"world\":\"simulated_arm\""));
    }

    let again = carried(lab.path(), &["--operator"], "");
    assert_eq!(document(&again)["rollouts"]["found"], 2);
    assert!(!again.stderr.contains("Was the task reached?"));
    assert_eq!(document(&again)["rows"][0]["value"], 0.5);

    // The same rollouts in the simulator count as different ones.
    let other = finish(fabc(lab.path()).args(["bench", "tiny", "--out", "out"]));
    assert_eq!(other.code, 2, "{}", other.stderr);
    assert!(
        other.stderr.contains("it differs in `params`"),
        "{}",
        other.stderr
    );
}

#[test]
#[ignore = "long"]
fn what_was_cut_off_is_named_and_an_arm_left_in_a_motion_is_not_moved() {
    let lab = lab(&[]);
    assert_eq!(carried(lab.path(), &[], "").code, 0);
    let run = lab.path().join("out/tiny/plain/start-001-1");
    let journal = fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let (whole, _) = journal.trim_end().rsplit_once('\n').unwrap();
    fs::write(run.join("rollout.jsonl"), format!("{whole}\n")).unwrap();
    let before = fs::read(run.join("arm.jsonl")).unwrap();
    let is_named = |said: &Captured| {
        assert_eq!(said.code, 3, "{}", said.stderr);
        let table = document(said);
        assert_eq!(table["rollouts"]["finished"], 1);
        assert_eq!(
            table["cut_off"],
            serde_json::json!(["out/tiny/plain/start-001-1"])
        );
        assert!(
            said.stderr.contains("was interrupted earlier"),
            "{}",
            said.stderr
        );
    };
    is_named(&carried(lab.path(), &[], ""));
    assert_eq!(fs::read(run.join("arm.jsonl")).unwrap(), before, "it moved");

    fs::remove_dir_all(&run).unwrap();
    let anew = carried(lab.path(), &[], "");
    assert_eq!(anew.code, 0, "{}", anew.stderr);
    assert_eq!(document(&anew)["rollouts"]["finished"], 2);
}

#[test]
#[ignore = "long"]
fn an_arm_or_a_camera_that_fails_ends_the_suite() {
    // Cloth stops the fingers at 512 from `closed`, which is then neither cloth nor closed.
    let strict = ("cloth = 200.0 ", "cloth = 3000.0 ");
    let moved = ("camera_turn_deg = 1.5", "camera_turn_deg = 1.9");
    for (edit, is_clear, wanted) in [
        (strict, false, "the fingers are at"),
        (moved, true, "it was moved since it was calibrated, by"),
    ] {
        let lab = lab(&[edit]);
        let said = carried(lab.path(), &[], "");
        assert_eq!(said.code, 2, "{}", said.stderr);
        let table = document(&said);
        assert_eq!(table["rollouts"]["finished"], 1, "{table}");
        assert_eq!(
            table["rows"][0]["outcomes"],
            serde_json::json!({ "world_failed": 1 })
        );
        let left = &table["arm_left"];
        assert_eq!(left["is_clear"], is_clear, "{left}");
        let why = left["why"].as_str().unwrap();
        assert!(why.contains(wanted), "{why}");
        assert!(said.stderr.contains(why), "{}", said.stderr);
        assert!(!lab.path().join("out/tiny/plain/start-001-1").exists());
    }
}

#[test]
fn suites_and_options_that_an_arm_cannot_do_are_refused() {
    let driver = ("driver = \"simulated\"", "driver = \"kinova\"");
    let camera = (
        "source = \"simulated\"",
        "source = \"directory\"\nfolder = \"shots\"",
    );
    let ros = (
        "[simulated]",
        "[ros]\nmaster = \"http://localhost:1\"\narm = \"/j2n6s200_driver\"\n\n[simulated]",
    );
    let real = lab(&[driver, camera, ros]);
    let distances = SUITE
        .replace(
            "\"reached_by_operator\", ",
            "\"mean_particle_distance_mm\", ",
        )
        .replace(
            "lie = \"operator\"\ncount = 3",
            "lie = \"flat\"\nsides = [28]\nturns_deg = [0]",
        )
        .replace("\"reached_by_operator\"", "\"mean_particle_distance_mm\"")
        .replace("\"share\"", "\"mean\"");
    fs::write(real.path().join("tasks/suites/tiny.toml"), &distances).unwrap();
    let said = carried(real.path(), &["--confirm", "none"], "");
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(
        said.stderr.contains(
            "the suite measures `mean_particle_distance_mm`, which needs particle positions"
        ),
        "{}",
        said.stderr
    );

    let simulated = lab(&[]);
    let said = carried(simulated.path(), &["--jobs", "2"], "");
    assert_eq!(said.code, 64, "{}", said.stderr);
    assert!(
        said.stderr.contains("`--jobs 2` is for the simulator"),
        "{}",
        said.stderr
    );
}

#[test]
#[ignore = "long"]
fn the_operator_of_a_single_run_is_asked_too() {
    let lab = lab(&[]);
    let ask = |more: &[&str]| {
        let lines = "no\ndetection\na corner lay hidden\n";
        finish(
            fabc(lab.path())
                .args(["run", "tasks/tiny.fab", "--operator"])
                .args(more)
                .stdin(lines),
        )
        .stdout
    };
    let report: Value = serde_json::from_str(&ask(&["--json"])).unwrap();
    assert_eq!(
        report["operator"],
        serde_json::json!({ "reached": false, "why": "detection", "words": "a corner lay hidden" })
    );
    let told = ask(&["--world", "jaco"]);
    assert!(
        told.contains("the operator says: not reached, for detection: a corner lay hidden"),
        "{told}"
    );
}

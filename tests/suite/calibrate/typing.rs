//! Points typed one per line: each is judged at once, and none is lost.

use super::{json, lab};
use crate::suite::support::{Captured, fabc, finish};
use fab_arm::calibration::{Calibration, Pair, csv_line};
use std::fs;
use std::path::Path;

/// Calibrates with typed lines.
fn typed(folder: &Path, lines: &str, more: &[&str]) -> Captured {
    finish(
        fabc(folder)
            .args(["calibrate", "--robot", "robot.toml"])
            .args(more)
            .stdin(lines),
    )
}

#[test]
fn typed_points_are_judged_as_they_come_and_kept() {
    let (folder, pairs) = lab();
    let mut lines: Vec<String> = pairs.iter().map(csv_line).collect();
    let mut slip = pairs[9];
    slip.base_m[0] += 0.05;
    lines.insert(9, csv_line(&slip));
    lines.insert(10, "undo".to_owned());
    lines.insert(3, "what?".to_owned());
    lines.push("done".to_owned());
    let said = typed(folder.path(), &lines.join("\n"), &["--grid", "4x4"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    insta::assert_snapshot!(said.stderr);
    assert!(folder.path().join("lab.grid.png").exists());
    let read = Calibration::load(&folder.path().join("lab.toml")).unwrap();
    assert_eq!(read.pairs, pairs);
    let kept = fs::read_to_string(folder.path().join("lab.pairs.csv")).unwrap();
    assert_eq!(kept.lines().count(), 17);
}

#[test]
fn an_interrupted_session_is_gone_on_with() {
    let (folder, pairs) = lab();
    let lines =
        |pairs: &[Pair]| -> String { pairs.iter().map(|pair| csv_line(pair) + "\n").collect() };
    // The input ends after five points, as after a crash.
    let said = typed(folder.path(), &lines(&pairs[..5]), &[]);
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains("5 distinct points are too few"),
        "{}",
        said.stderr
    );
    let more = ["--pairs", "lab.pairs.csv", "--more", "--json"];
    let said = typed(folder.path(), &lines(&pairs[5..]), &more);
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(json(&said)["points"].as_array().unwrap().len(), 16);
    assert!(
        said.stderr
            .contains("the points of an earlier session are in `lab.pairs.csv.before`"),
        "{}",
        said.stderr
    );
}

//! The action and observation space that `fabc check --json` prints.

use super::support::{bring_library, fabc, finish};
use serde_json::Value;
use std::fs;

/// A field of every kind, in two tasks.
const TASKS: &str = r#"
use "lib/folding.fab"
use "lib/smoothing.fab"

task gripped extends folding {
    cloth grid(24, 24)
    subgoals { demonstrate { fold corner(back_right) -> corner(front_left) } }
    actions {
        pick:  any of cloth
        place: one of corners, center
        grip:  one of "soft", "firm"
        lift:  one of 10mm, 30mm
        speed: one of 200mm/s, 500mm/s
    }
}

task pulled extends smoothing_by_corners {
    cloth grid(42, 42, start: crumpled)
    horizon 10
}
"#;

#[test]
fn spaces_name_each_field_with_its_choices_and_units_and_what_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    fs::write(folder.path().join("tasks.fab"), TASKS).unwrap();
    let said = finish(fabc(folder.path()).args(["check", "tasks.fab", "--json"]));
    assert_eq!(said.code, 0, "{}", said.stdout);
    let checked: Value = serde_json::from_str(&said.stdout).unwrap();
    let mut lines = String::new();
    let tasks = checked["tasks"].as_array().unwrap().iter();
    for task in tasks.filter(|task| task["variant"].is_null()) {
        lines += &format!("{}\n", task["task"]);
        let Value::Object(seen) = &task["spaces"]["observation"] else {
            panic!("{task}");
        };
        for (name, space) in seen.iter().filter(|(name, _)| *name != "keypoints") {
            lines += &format!("  {name}: {space}\n");
        }
        let fields = task["spaces"]["action"]["grips"][0].as_array().unwrap();
        for space in seen["keypoints"].as_array().unwrap().iter().chain(fields) {
            lines += &format!("  {space}\n");
        }
    }
    insta::assert_snapshot!(lines);
}

//! Pins the exit code and every field of each verb's JSON: scripts of users rely on both.
//!
//! Values are left out. They have tests of their own, and many differ from run to run.

use super::support::{bring_library, bring_robot, fabc, finish};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;

/// One fold with a test.
const TASK: &str = r#"
use "lib/folding.fab"

task small extends folding {
    cloth grid(25, 25)
    subgoals { demonstrate { fold corner(back_left) -> corner(front_right) } }

    test "a pick beside the corners is refused" {
        given corners = (50px, 60px), (180px, 170px)
        given center  = (115px, 115px)
        given cloth   = (50px, 60px) to (180px, 170px)
        reply "Pick Point = (1, 1), Place Point = (50, 60)"
        expect reject(offered)
    }
}
"#;

/// The same with demonstrations.
const TAUGHT: &str = r#"
use "small.fab"

task taught extends small {
    variant in_context { demos plan from "demos.jsonl" }
}
"#;

/// The same with a mistake, whose diagnostic has labels and help.
const WRONG: &str = r#"
use "small.fab"

task wrong extends small {
    check far { distance(pick, place) > 20mm } else "Too near."
}
"#;

/// A suite of one rollout.
const SUITE: &str = r#"
about = "One small fold."
statistic = "mean"
metrics = ["mean_particle_distance_mm"]
repeats = 1
tasks = ["small.fab"]
[starts]
lie = "flat"
sides = [25]
turns_deg = [0]
[[method]]
name = "plain"
"#;

/// A line for each verb: what follows `fabc`, without `--json`. Later lines use the files of earlier ones.
const COMMANDS: &str = "\
new smoothing heap
new library hem
new fold napkin
check small.fab
check wrong.fab
check absent.fab
test small.fab
vocabulary
render small.fab --why
build small.fab --out built
snap small.fab
review
subgoals small.fab
run small.fab --out run
run small.fab --model openai:gpt-6.2-sol --omit temperature --estimate
run small.fab --model nobody
resume run
sim render run/step_1/positions.npy --dims 25x25 --up z -o seen.png
sim render run/step_1/positions.npy --dims 25x25 --up z --depth -o depth.png
see small.fab --image seen.png --depth depth.png
demos taught.fab --variant in_context --count 1
bench suite.toml --out suite
models openai
doctor
robot check --robot robot.toml
sim crumple --dims 10x10 -o starts
sim export starts/crumpled_10x10_0.npy -o heap.obj
sim record --size 24 --move -0.07,0.07:0.05,-0.05 -o fold.gif
run small.fab --out filmed --video
sim time --size 25
best small.fab --trials 4 --out best";

/// Collects the paths of all fields: `tasks[].name`.
fn collect(value: &Value, path: &str, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                let path = format!("{path}.{name}");
                collect(value, &path, found);
                found.insert(path);
            }
        }
        Value::Array(items) => {
            for item in items {
                collect(item, &format!("{path}[]"), found);
            }
        }
        _ => {}
    }
}

#[test]
fn every_verb_keeps_the_fields_of_its_json_and_its_exit_codes() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    bring_robot(folder.path(), &[]);
    for (name, text) in [
        ("small.fab", TASK),
        ("wrong.fab", WRONG),
        ("suite.toml", SUITE),
        ("taught.fab", TAUGHT),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let mut shown = String::new();
    for command in COMMANDS.lines() {
        let said = finish(fabc(folder.path()).args(command.split(' ')).arg("--json"));
        let value: Value = serde_json::from_str(&said.stdout)
            .unwrap_or_else(|error| panic!("{command}: {error}\n{}{}", said.stdout, said.stderr));
        let mut fields = BTreeSet::new();
        collect(&value, "", &mut fields);
        writeln!(shown, "fabc {command}\n  exit code {}", said.code).unwrap();
        for field in fields {
            writeln!(shown, "  {}", field.trim_start_matches('.')).unwrap();
        }
    }
    insta::assert_snapshot!(shown);
}

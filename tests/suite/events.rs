//! `--events`: what happens in rollouts, as lines of JSON.

use super::bench::project;
use super::support::{bring_library, fabc, finish};
use fab_agent::rollout::event::{Event, Line};
use std::collections::BTreeMap;
use std::fs;

/// One fold on a small cloth.
const TASK: &str = r#"
use "lib/folding.fab"

task small extends folding {
    cloth grid(24, 24)
    subgoals { demonstrate { fold corner(back_left) -> corner(front_right) } }
}
"#;

/// The random policy at two starts of `tiny`.
const SUITE: &str = r#"
about = "One small fold, at random."
statistic = "mean"
metrics = ["mean_particle_distance_mm"]
repeats = 1
tasks = ["../tiny.fab"]
[starts]
lie = "flat"
sides = [28, 30]
turns_deg = [0]
[[method]]
name = "random"
policy = "random:1"
"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    fs::write(folder.path().join("small.fab"), TASK).unwrap();
    folder
}

/// Reads lines and checks that they come back as they were written, in the order of their times.
fn lines(text: &str) -> Vec<Line> {
    let lines: Vec<Line> = text
        .lines()
        .map(|line| {
            let read: Line = serde_json::from_str(line).unwrap();
            assert_eq!(serde_json::to_string(&read).unwrap(), line);
            read
        })
        .collect();
    assert!(lines.is_sorted_by_key(|line| line.at_s));
    lines
}

fn names(text: &str) -> Vec<String> {
    let name = |line| {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        value["event"].as_str().unwrap().to_owned()
    };
    text.lines().map(name).collect()
}

#[test]
fn a_run_writes_each_event_with_its_time_and_files_that_exist() {
    let folder = folder();
    let run = [
        "run",
        "small.fab",
        "--model",
        "geometric",
        "--events",
        "events.jsonl",
        "--json",
        "--out",
        "run",
    ];
    let said = finish(fabc(folder.path()).args(run));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let text = fs::read_to_string(folder.path().join("events.jsonl")).unwrap();
    let step = [
        "picture", "question", "answer", "verdict", "question", "answer", "verdict", "motion",
    ];
    let names = names(&text);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let without = |what: &str| {
        names
            .iter()
            .copied()
            .filter(|name| *name != what)
            .collect::<Vec<_>>()
    };
    assert_eq!(without("note"), [&["start"][..], &step, &["end"]].concat());
    let mut answer = String::new();
    for Line { run, event, .. } in lines(&text) {
        assert_eq!(run, "run");
        let files = match event {
            Event::Start { header } => vec![Some(header.program_file)],
            Event::Picture { at, file, scene } => {
                assert_eq!((at.action, at.step), (1, 1));
                assert!(scene["corners"].is_array(), "{scene}");
                vec![Some(file)]
            }
            Event::Question { sent, .. } => vec![sent.request, sent.prompt],
            Event::Answer { text, .. } => {
                answer = text;
                Vec::new()
            }
            Event::Verdict { asked, .. } => {
                let file = asked.reply.unwrap();
                let stored = fs::read_to_string(folder.path().join("run").join(&file));
                assert_eq!(stored.unwrap(), answer);
                vec![Some(file)]
            }
            Event::Motion { line, .. } => {
                let executed = line.executed.unwrap();
                assert_eq!((line.action.unwrap().len(), executed.grips.len()), (1, 1));
                let files = line.files;
                vec![files.before, files.action, files.after, files.positions]
            }
            Event::End { report } => {
                let printed: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
                assert_eq!(serde_json::to_value(report).unwrap(), printed);
                Vec::new()
            }
            _ => Vec::new(),
        };
        for file in files {
            let file = file.expect("a file");
            assert!(folder.path().join("run").join(&file).is_file(), "{file}");
        }
    }
}

#[test]
fn events_on_stdout_send_the_report_to_stderr_and_exclude_a_document() {
    let folder = folder();
    let run = |more: &[&str]| {
        let run = ["run", "small.fab", "--policy", "random:1", "--events"];
        finish(fabc(folder.path()).args(run).args(more))
    };
    let said = run(&["-", "--out", "run"]);
    assert_eq!(names(&said.stdout).last().unwrap(), "end");
    assert!(
        said.stderr.contains("\noutcome: horizon_reached\n"),
        "{}",
        said.stderr
    );
    let refused = run(&["-", "--json"]);
    assert_eq!(refused.code, 64);
    let why = "`--events -` and `--json` both write to stdout: give `--events FILE`";
    assert!(refused.stderr.contains(why), "{}", refused.stderr);
    let unwritable = run(&["absent/events.jsonl"]);
    assert_eq!(unwritable.code, 2);
    assert!(
        unwritable
            .stderr
            .contains("cannot write `absent/events.jsonl`"),
        "{}",
        unwritable.stderr
    );
    assert!(!folder.path().join("runs").exists(), "a run was begun");
}

#[test]
fn a_suite_writes_the_events_of_all_its_rollouts() {
    let folder = project(SUITE);
    let bench = ["bench", "tiny", "--out", "out", "--events", "events.jsonl"];
    let said = finish(fabc(folder.path()).args(bench));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let text = fs::read_to_string(folder.path().join("events.jsonl")).unwrap();
    let mut rollouts: BTreeMap<String, [usize; 3]> = BTreeMap::new();
    for Line { run, event, .. } in lines(&text) {
        let counts = rollouts.entry(run).or_default();
        counts[0] += usize::from(matches!(event, Event::Start { .. }));
        counts[1] += usize::from(matches!(event, Event::Motion { .. }));
        counts[2] += usize::from(matches!(event, Event::End { .. }));
    }
    assert_eq!(rollouts.len(), 2, "{rollouts:?}");
    for (run, counts) in rollouts {
        let [starts, motions, ends] = counts;
        assert!(motions > 0, "{run}");
        assert_eq!([starts, ends], [1; 2], "{run}");
        assert!(
            folder.path().join(&run).join("rollout.jsonl").is_file(),
            "{run}"
        );
    }
}

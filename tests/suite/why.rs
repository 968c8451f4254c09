//! `fabc render --why` and `--reply`: each prompt line is traced to its file, and what is shown is what is sent.

use super::support::{bring_library, fabc, finish, project, root};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn rendered(folder: &Path, arguments: &[&str]) -> Value {
    let said = finish(fabc(folder).arg("render").args(arguments).arg("--json"));
    assert_eq!(said.code, 0, "{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map(Vec::as_slice).unwrap_or_default()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

/// Every text of a stage, by message and part.
fn texts(stage: &Value) -> Vec<String> {
    let parts = list(&stage["messages"])
        .iter()
        .flat_map(|message| list(&message["parts"]));
    parts
        .filter_map(|part| part["text"].as_str().map(str::to_owned))
        .collect()
}

#[test]
fn every_stretch_of_a_prompt_stands_in_the_line_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("double_straight", None),
        ("double_straight", Some("in_context")),
        ("double_straight", Some("without_center_pivoting")),
        ("cupboard", None),
        ("smoothing", None),
        ("smoothing", Some("paper_text")),
    ];
    for (task, variant) in cases {
        let file = project(&format!("tasks/{task}.fab"));
        let mut arguments = vec![file.as_str(), "--why"];
        arguments.extend(variant.into_iter().flat_map(|name| ["--variant", name]));
        let shown = rendered(folder.path(), &arguments);
        let mut looked_at = 0;
        for stage in list(&shown["stages"]) {
            for stretch in list(&stage["why"]["stretches"]) {
                let at = |key: &str| stretch[key].as_u64().unwrap() as usize;
                let part = &stage["messages"][at("message")]["parts"][at("part")];
                let words = &text(&part["text"])[at("start")..at("end")];
                let (Some(file), None) = (stretch["file"].as_str(), stretch["value"].as_str())
                else {
                    continue;
                };
                if file.ends_with(".jsonl") {
                    continue;
                }
                let source = fs::read_to_string(file).unwrap();
                let line = source.lines().nth(at("line") - 1).unwrap();
                // A placeholder with a constant value is filled when the task is compiled.
                let is_there = line.contains(words.trim()) || line.contains("{{");
                assert!(is_there, "{task} {variant:?}: `{words}` is not in `{line}`");
                looked_at += 1;
            }
        }
        assert!(looked_at > 10, "{task} {variant:?}: {looked_at}");
    }
}

#[test]
fn all_that_is_said_is_led_back_but_for_blank_lines_between_texts() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/double_straight.fab");
    let arguments = [&file, "--variant", "in_context", "--why"];
    let shown = rendered(folder.path(), &arguments);
    for stage in list(&shown["stages"]) {
        for (number, message) in list(&stage["messages"]).iter().enumerate() {
            for (part, shown) in list(&message["parts"]).iter().enumerate() {
                let Some(words) = shown["text"].as_str() else {
                    continue;
                };
                let mut rest = words.to_owned();
                let stretches = list(&stage["why"]["stretches"]).iter().rev();
                for stretch in stretches.filter(|it| it["message"] == number && it["part"] == part)
                {
                    let at = |key: &str| stretch[key].as_u64().unwrap() as usize;
                    rest.replace_range(at("start")..at("end"), "");
                }
                assert_eq!(rest.trim(), "", "of {words}");
            }
        }
    }
}

#[test]
fn a_component_is_named_with_what_it_weighs_and_costs() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/double_straight.fab");
    let stage = ["--stage", "describe", "--why"];
    let said = finish(fabc(folder.path()).args(["render", &file]).args(stage));
    assert!(
        said.stdout.contains("[center_pivoting, "),
        "{}",
        said.stdout
    );
    assert!(
        said.stdout.contains("2 pictures are not counted"),
        "{}",
        said.stdout
    );
    let model = ["--model", "openai:gpt-6.2-sol"];
    let shown = rendered(
        folder.path(),
        &[&[file.as_str()][..], &stage, &model].concat(),
    );
    let weights = &shown["stages"][0]["why"]["estimated_tokens"];
    let of = |name: &str| {
        let found = list(&weights["components"]).iter();
        found
            .clone()
            .find(|weight| weight["said_by"] == name)
            .unwrap()
            .clone()
    };
    assert_eq!(of("picture: subgoal 0 with arrow")["at_least"], 59);
    assert!(of("visual_context")["at_least"].as_u64() > Some(50));
    assert!(
        weights["all"]["cost_nano_usd"].as_u64() > of("visual_context")["cost_nano_usd"].as_u64()
    );
    assert_eq!(weights["pictures_not_counted"], 0);
    let unknown = ["--model", "openai:nobody", "--why"];
    let said = finish(fabc(folder.path()).args(["render", &file]).args(unknown));
    for words in [
        "2 pictures are not counted: how many tokens one has for openai:nobody is not known",
        "the price of openai:nobody is not known",
    ] {
        assert!(said.stdout.contains(words), "{}", said.stdout);
    }
}

#[test]
fn an_answer_is_followed_by_the_correction_that_a_rollout_would_send() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/double_straight.fab");
    let refused = "Pick Point = (1, 1)\nPlace Point = (182, 167)";
    let unreadable = "I would rather not.";
    let accepted = "Pick Point = (182, 56)\nPlace Point = (182, 167)";
    let mut arguments = vec![file.as_str(), "--stage", "plan"];
    for reply in [refused, unreadable, accepted] {
        arguments.extend(["--reply", reply]);
    }
    let shown = rendered(folder.path(), &arguments);
    let stage = &shown["stages"][0];
    let findings: Vec<&str> = list(&stage["findings"]).iter().map(text).collect();
    assert_eq!(
        findings,
        [
            "refused by `offered`\n  `pick` from `Pick Point = (1, 1)` at byte 0\n  `place` from `Place Point = (182, 167)` at byte 20",
            "`pick` cannot be read",
            "accepted\n  `pick` from `Pick Point = (182, 56)` at byte 0\n  `place` from `Place Point = (182, 167)` at byte 23",
        ]
    );
    let roles: Vec<&str> = list(&stage["messages"])
        .iter()
        .map(|message| text(&message["role"]))
        .collect();
    assert_eq!(
        roles,
        ["system", "user", "assistant", "user", "assistant", "user"]
    );
    let texts = texts(stage);
    assert_eq!(texts[2], refused);
    assert!(texts[3].contains("(1, 1)"), "{}", texts[3]);
    let weighed = |arguments: &[&str]| {
        let shown = rendered(folder.path(), &[arguments, &["--why"]].concat());
        shown["stages"][0]["why"]["estimated_tokens"]["all"]["at_least"].clone()
    };
    assert_eq!(weighed(&arguments), weighed(&arguments[..3]));
    // A fourth answer has no question.
    arguments.extend(["--reply", accepted]);
    let said = finish(fabc(folder.path()).arg("render").args(&arguments));
    assert_eq!(said.code, 64, "{}", said.stderr);
}

#[test]
fn a_check_that_refuses_is_led_back_to_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = project("tasks/smoothing.fab");
    let first = rendered(folder.path(), &[&file]);
    let corners = texts(&first["stages"][0]).join("\n");
    let listed = corners.split("The corners are ").nth(1).unwrap();
    let pick = &listed[..listed.find(')').unwrap() + 1];
    let inward = ["0 deg", "180 deg"].map(|direction| {
        let reply = format!("Pick Point = {pick}\nDirection = {direction}\nDistance = 0.1 edge");
        let shown = rendered(folder.path(), &[&file, "--why", "--reply", &reply]);
        shown["stages"][0].clone()
    });
    // One of two opposite directions leads inward.
    let refused = inward
        .iter()
        .find(|stage| text(&stage["findings"][0]).starts_with("refused by `outward`"))
        .unwrap();
    let stretches = list(&refused["why"]["stretches"]);
    let correction = stretches
        .iter()
        .rfind(|it| it["said_by"] == "check.outward")
        .unwrap();
    assert!(text(&correction["file"]).ends_with("tasks/lib/smoothing.fab"));
}

/// The bytes of every picture in a folder.
fn pictures(folder: &Path) -> Vec<Vec<u8>> {
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let pictures = files.filter(|path| path.extension().is_some_and(|it| it == "png"));
    pictures.map(|path| fs::read(path).unwrap()).collect()
}

#[test]
#[ignore = "long"]
fn render_shows_word_for_word_what_a_run_sends() {
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    let task = fs::read_to_string(root().join("tasks/double_triangle.fab")).unwrap();
    fs::write(folder.path().join("task.fab"), task).unwrap();
    for (start, variant) in [("3", None), ("5", Some("without_output_format"))] {
        let mut common = vec!["task.fab", "--start", start];
        common.extend(variant.into_iter().flat_map(|name| ["--variant", name]));
        let run = format!("run{start}");
        finish(
            fabc(folder.path())
                .arg("run")
                .args(&common)
                .args(["--out", &run]),
        );
        let mut answers = Vec::new();
        let mut sent = Vec::new();
        let journal = fs::read_to_string(folder.path().join(&run).join("rollout.jsonl")).unwrap();
        let step: Value = serde_json::from_str(journal.lines().nth(1).unwrap()).unwrap();
        for attempt in list(&step["attempts"]) {
            let file = |key: &str| folder.path().join(&run).join(text(&attempt[key]));
            answers.push(fs::read_to_string(file("reply")).unwrap());
            sent.push(fs::read_to_string(file("request")).unwrap());
        }
        let mut arguments = common.clone();
        for answer in &answers {
            arguments.extend(["--reply", answer]);
        }
        arguments.extend(["--out", "shown"]);
        let shown = rendered(folder.path(), &arguments);
        assert_eq!(list(&shown["stages"]).len(), sent.len());
        let kept = pictures(&folder.path().join(&run).join("images"));
        let drawn = pictures(&folder.path().join("shown"));
        assert_eq!(drawn.len(), 2);
        assert!(drawn.iter().all(|png| kept.contains(png)), "start {start}");
        for (stage, request) in list(&shown["stages"]).iter().zip(&sent) {
            let request: Value = serde_json::from_str(request).unwrap();
            assert_eq!(texts(stage), texts(&request), "start {start}");
        }
    }
}

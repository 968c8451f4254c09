//! How much a model thinks, stated on the command line, in a suite's method, and in a stage.

use super::paid_answers::suite;
use super::provider::Provider;
use super::provider_commands::{calls, command};
use super::support::finish;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn asked(provider: &Provider) -> Vec<Value> {
    let seen = provider.seen();
    let bodies = seen
        .got
        .iter()
        .map(|body| serde_json::from_slice(body).unwrap());
    bodies.collect()
}

/// Runs a verb with the provider; returns the exit code, the report, and what was said.
fn with(folder: &Path, provider: &Provider, arguments: &[&str]) -> (i32, Value, String) {
    let mut all = arguments.to_vec();
    all.extend([
        "--json",
        "--model",
        "compatible:geometric",
        "--allow-unknown-price",
        "--no-cache",
    ]);
    all.extend(["--base-url", provider.base_url()]);
    let said = finish(&mut command(folder, &all));
    let report = serde_json::from_str(&said.stdout).unwrap_or(Value::Null);
    (said.code, report, said.stderr)
}

#[test]
fn reasoning_on_the_command_line_is_sent_with_room_beside_the_answer() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let run = |more: &[&str]| {
        let provider = Provider::reliable();
        let mut arguments = vec!["run", "tasks/tiny.fab"];
        arguments.extend(more);
        let (code, report, said) = with(folder.path(), &provider, &arguments);
        assert!(code == 0 && report["outcome"].is_string(), "{said}");
        asked(&provider)
    };
    let plain = run(&[]);
    let low = run(&["--reasoning", "low"]);
    let omitted = run(&["--reasoning", "low", "--omit", "reasoning"]);
    assert!(plain.len() >= 2);
    assert_eq!(omitted, plain);
    assert_eq!(plain.len(), low.len());
    for (plain, low) in plain.iter().zip(&low) {
        assert_eq!(plain["reasoning_effort"], Value::Null);
        assert_eq!(low["reasoning_effort"], "low");
        let longest = plain["max_tokens"].as_u64().unwrap();
        assert_eq!(low["max_tokens"], longest + 1024);
    }
}

#[test]
fn a_method_states_its_own_reasoning_and_the_command_line_overrides_it() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let file = folder.path().join("tasks/suites/tiny.toml");
    let bare = fs::read_to_string(&file).unwrap();
    let provider = Provider::reliable();
    let output = |method: &str, more: &[&str]| {
        fs::write(&file, format!("{bare}{method}\n")).unwrap();
        let mut arguments = vec!["bench", "tiny", "--out", "out", "--estimate"];
        arguments.extend(more);
        let (code, estimate, said) = with(folder.path(), &provider, &arguments);
        assert_eq!(code, 0, "{said}");
        let most = |name: &str| estimate[name]["at_most"].as_u64().unwrap();
        (most("output_tokens"), most("calls"))
    };
    let (bare_tokens, calls_at_most) = output("", &[]);
    let hidden = |tokens: u64| (bare_tokens + tokens * calls_at_most, calls_at_most);
    assert_eq!(output("reasoning = \"low\"", &[]), hidden(1024));
    let high = ["--reasoning", "high"];
    assert_eq!(output("reasoning = \"low\"", &high), hidden(16_384));
    let none = ["--reasoning", "none"];
    assert_eq!(output("reasoning = \"medium\"", &none), hidden(0));
    assert_eq!(calls(&provider), 0);
}

#[test]
fn reasoning_that_cannot_be_stated_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let provider = Provider::reliable();
    for (arguments, code, named) in [
        (
            &["--reasoning", "2048"][..],
            2,
            "`2048 tokens`, and it accepts `none`, `low`, `medium`, `high`",
        ),
        (&["--reasoning", "2048 tokens"], 2, "`--omit reasoning`"),
        (
            &["--reasoning", "much"],
            64,
            "a number of tokens from 1 to 100000",
        ),
        (
            &["--reasoning", "0"],
            64,
            "a number of tokens from 1 to 100000",
        ),
    ] {
        let mut all = vec!["run", "tasks/tiny.fab"];
        all.extend(arguments);
        let (found, _, said) = with(folder.path(), &provider, &all);
        assert_eq!(found, code, "{said}");
        assert!(said.contains(named), "{said}");
    }
    let file = folder.path().join("tasks/suites/tiny.toml");
    let bare = fs::read_to_string(&file).unwrap();
    for (method, named) in [
        (
            "reasoning = 100001",
            "`method.reasoning`: 100001 is not from 1 to 100000",
        ),
        (
            "reasoning = 0",
            "`method.reasoning`: 0 is not from 1 to 100000",
        ),
        (
            "reasoning = \"much\"",
            "`none`, `low`, `medium`, `high` or a number of tokens",
        ),
        ("policy = \"expert\"\nreasoning = \"low\"", "asks no model"),
    ] {
        fs::write(&file, format!("{bare}{method}\n")).unwrap();
        let (code, _, said) = with(folder.path(), &provider, &["bench", "tiny", "--out", "out"]);
        assert!(code != 0 && said.contains(named), "{code}: {said}");
    }
    assert_eq!(calls(&provider), 0);
}

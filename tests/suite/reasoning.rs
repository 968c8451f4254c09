//! How much a model thinks, stated on the command line, in a suite's method, and in a stage.

use super::paid_answers::suite;
use super::provider_commands::command;
use super::support::finish;
use fab_standins::Geometric;
use fab_test_provider::{Provider, Question};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

fn asked(provider: &Provider) -> Vec<Value> {
    provider.questions().iter().map(Question::json).collect()
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
        let provider = Provider::of(Geometric);
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
fn the_command_line_overrides_a_method_and_a_method_overrides_a_stage() {
    const PLAN: &str = "model text, temperature 0, tokens 769";
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let file = folder.path().join("tasks/suites/tiny.toml");
    let bare = fs::read_to_string(&file).unwrap();
    let library = folder.path().join("tasks/lib/folding.fab");
    let bare_library = fs::read_to_string(&library).unwrap();
    assert!(bare_library.contains(PLAN));
    let provider = Provider::of(Geometric);
    // Returns the hidden tokens that a call of the one stage and a call of the other may take together.
    let hidden = |stage: &str, method: &str, more: &[&str]| {
        let staged = bare_library.replace(PLAN, &format!("{PLAN}{stage}"));
        fs::write(&library, staged).unwrap();
        fs::write(&file, format!("{bare}{method}\n")).unwrap();
        let mut arguments = vec!["bench", "tiny", "--out", "out", "--estimate"];
        arguments.extend(more);
        let (code, estimate, said) = with(folder.path(), &provider, &arguments);
        assert_eq!(code, 0, "{said}");
        let most = |name: &str| estimate["at_most"][name].as_u64().unwrap();
        2 * most("output_tokens") / most("calls") - 1000 - 769
    };
    let (low, high, none) = (
        ", reasoning low",
        "reasoning = \"high\"",
        ["--reasoning", "none"],
    );
    assert_eq!(hidden("", "", &[]), 0);
    assert_eq!(hidden(low, "", &[]), 1024);
    assert_eq!(hidden("", high, &[]), 2 * 16_384);
    assert_eq!(hidden(low, high, &[]), 2 * 16_384);
    assert_eq!(hidden(low, "", &none), 0);
    assert_eq!(hidden("", high, &none), 0);
    assert_eq!(hidden(low, high, &none), 0);
    assert_eq!(hidden(low, "", &["--reasoning", "medium"]), 2 * 4096);
    assert_eq!(provider.calls(), 0);

    // What a stage states is sent with its own questions alone.
    let staged = bare_library.replace(PLAN, &format!("{PLAN}{low}"));
    fs::write(&library, staged).unwrap();
    for (more, efforts) in [(&[][..], [None, Some("low")]), (&none, [Some("none"); 2])] {
        let provider = Provider::of(Geometric);
        let arguments = [&["run", "tasks/tiny.fab"], more].concat();
        let (code, _, said) = with(folder.path(), &provider, &arguments);
        assert_eq!(code, 0, "{said}");
        let sent = asked(&provider);
        let found: Vec<Option<&str>> = sent
            .iter()
            .map(|it| it["reasoning_effort"].as_str())
            .collect();
        assert_eq!(found[..2], efforts, "{more:?}");
    }
}

#[test]
#[ignore = "long"]
fn tables_show_visible_and_hidden_tokens_apart() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let thoughts = json!({ "reasoning_tokens": 40 });
    let thinks = json!({ "prompt_tokens": 100, "completion_tokens": 49, "completion_tokens_details": thoughts });
    let reports_none = json!({ "prompt_tokens": 100, "completion_tokens": 9 });
    for (out, usage, expected) in [
        ("thinks", thinks, (18.0, Some(80.0))),
        ("reports_none", reports_none, (18.0, None)),
    ] {
        let provider = Provider::start(move |_, question| {
            let answer = question.answer_of(&Geometric);
            answer.edit(|body| body["usage"] = usage.clone())
        });
        let arguments = ["bench", "tiny", "--repeats", "1", "--out", out];
        let (code, document, said) = with(folder.path(), &provider, &arguments);
        assert_eq!(code, 0, "{said}");
        let row = &document["rows"][0];
        // Two answers for one action.
        let found = (
            row["visible_tokens"].as_f64().unwrap(),
            row["hidden_tokens"].as_f64(),
        );
        assert_eq!(found, expected, "{row}");
        let read = |name: &str| fs::read_to_string(folder.path().join(out).join(name)).unwrap();
        let is_shown =
            read("table.md").contains("| visible tokens/action | hidden tokens/action |");
        assert_eq!(is_shown, expected.1.is_some(), "{}", read("table.md"));
        let csv = read("table.csv");
        // The last column is what was varied: nothing.
        let cells = if expected.1.is_some() {
            ",18,80,"
        } else {
            ",18,,"
        };
        assert!(csv.lines().nth(1).unwrap().ends_with(cells), "{csv}");
    }
}

#[test]
fn reasoning_that_cannot_be_stated_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let provider = Provider::of(Geometric);
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
    assert_eq!(provider.calls(), 0);
}

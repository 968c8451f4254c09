//! Which questions go out with a schema of their answer, and what a suite's table says about it.

use super::paid_answers::suite;
use super::provider_commands::command;
use super::support::{finish, root};
use fab_bench::suite::Suite;
use fab_standins::Geometric;
use fab_test_provider::{Provider, Question};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Runs a verb with a server whose support for schemas is unknown; returns each question's format, and what was said.
fn formats(folder: &Path, arguments: &[&str]) -> (Vec<Value>, String) {
    let provider = Provider::of(Geometric);
    let model = ["--model", "compatible:geometric", "--allow-unknown-price"];
    let rest = ["--no-cache", "--base-url", provider.base_url()];
    let said = finish(&mut command(folder, &[arguments, &model, &rest].concat()));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let questions = provider.questions();
    let bodies = questions.iter().map(Question::json);
    let formats =
        bodies.map(|body| body["response_format"]["json_schema"]["schema"]["required"].clone());
    (formats.collect(), said.stdout + &said.stderr)
}

#[test]
fn each_stage_is_asked_with_its_schema_unless_it_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let (asked, _) = formats(folder.path(), &["run", "tasks/tiny.fab"]);
    let of_stages = [json!(["instructions"]), json!(["reason", "pick", "place"])];
    assert_eq!(asked, of_stages);
    let (asked, _) = formats(
        folder.path(),
        &["run", "tasks/tiny.fab", "--omit", "schema"],
    );
    assert_eq!(asked, [Value::Null, Value::Null]);
}

#[test]
fn a_suite_may_ask_in_the_prompts_own_format_and_its_table_says_which_way_was_asked() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let file = folder.path().join("tasks/suites/tiny.toml");
    let usual = fs::read_to_string(&file).unwrap();
    let own = usual.replace("repeats = 2", "structured = false");
    let (with_schema, in_words) = (
        "Asked: with a schema where the server enforces it.",
        "Asked: in the prompt's own format.",
    );
    for (out, text, more, expected) in [
        ("usual", &usual, &[][..], with_schema),
        ("own", &own, &[], in_words),
        ("omitted", &usual, &["--omit", "schema"], in_words),
    ] {
        fs::write(&file, text).unwrap();
        let bench = [
            "bench",
            "tiny",
            "--repeats",
            "1",
            "--limit",
            "1",
            "--out",
            out,
        ];
        let (asked, said) = formats(folder.path(), &[&bench, more].concat());
        let is_plain = asked.iter().all(Value::is_null);
        assert_eq!(is_plain, expected == in_words, "{out}: {asked:?}");
        assert!(said.contains(expected), "{said}");
        let read = |name: &str| fs::read_to_string(folder.path().join(out).join(name)).unwrap();
        assert!(read("table.md").contains(expected));
        let table: Value = serde_json::from_str(&read("table.json")).unwrap();
        assert_eq!(table["structured"], expected == with_schema);
    }
}

#[test]
fn shipped_suites_that_ablate_the_prompt_or_quote_the_paper_ask_without_a_schema() {
    let mut own_format = Vec::new();
    for entry in fs::read_dir(root().join("tasks/suites")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let suite = Suite::parse(&fs::read_to_string(&path).unwrap()).unwrap();
        let is_compared = !suite.quotes.is_empty() || name.starts_with("ablation");
        assert_eq!(!suite.structured, is_compared, "{name}");
        own_format.extend((!suite.structured).then_some(name));
    }
    own_format.sort();
    let expected = [
        "ablation-folding",
        "ablation-smoothing",
        "folding",
        "physical",
        "smoothing",
    ];
    assert_eq!(own_format, expected);
}

//! Suites with a provider: which rollouts share an answer, and where a cap ends them.

use super::provider_commands::{FACTS, command};
use super::support::{Captured, Fabc, bring_library, finish};
use fab_model::calls::ledger;
use fab_standins::Geometric;
use fab_test_provider::Provider;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

/// One fold of a small cloth. All of its starts look alike, so every rollout puts the same two questions.
const TASK: &str = "\
use \"lib/folding.fab\"
use \"lib/experts.fab\"

task tiny extends folding {
    cloth grid(28, 28)
    goal  particle_distance < 40mm
    subgoals {
        demonstrate {
            fold corner(back_right) -> corner(front_left)
        }
    }
}
";

/// Prepares a suite with this many equal starts, each with these repeats, for each of these methods.
fn suite(folder: &Path, starts: usize, repeats: usize, methods: &[&str]) {
    let tasks = folder.join("tasks");
    fs::create_dir_all(tasks.join("suites")).unwrap();
    bring_library(&tasks);
    fs::write(tasks.join("tiny.fab"), TASK).unwrap();
    let turns = vec!["0"; starts].join(", ");
    let mut suite = format!(
        "about = \"One small fold.\"\nstatistic = \"mean\"\n\
         metrics = [\"mean_particle_distance_mm\", \"goal_reached\"]\nrepeats = {repeats}\n\
         tasks = [\"../tiny.fab\"]\n[starts]\nlie = \"flat\"\nsides = [28]\nturns_deg = [{turns}]\n"
    );
    for method in methods {
        suite.push_str(&format!("[[method]]\nname = \"{method}\"\n"));
    }
    fs::write(tasks.join("suites/tiny.toml"), suite).unwrap();
    fs::write(folder.join("facts.toml"), FACTS).unwrap();
}

fn bench(folder: &Path, provider: &Provider, more: &[&str]) -> Fabc {
    let arguments = [
        "bench",
        "tiny",
        "--json",
        "--out",
        "out",
        "--jobs",
        "8",
        "--model",
        "compatible:geometric",
        "--models",
        "facts.toml",
        "--omit",
        "temperature",
        "--base-url",
        provider.base_url(),
    ];
    command(folder, &[&arguments, more].concat())
}

fn document(said: &Captured) -> Value {
    serde_json::from_str(&said.stdout).unwrap_or_else(|_| panic!("{}", said.stderr))
}

/// Asserts that the provider got two different questions, each this often.
fn assert_asked(provider: &Provider, times: usize) {
    let counts: Vec<usize> = provider.counts().into_values().collect();
    assert_eq!(counts, [times; 2]);
}

#[test]
#[ignore = "long"]
fn every_start_and_repeat_asks_anew_and_a_killed_suite_buys_nothing_twice() {
    let folder = tempfile::tempdir().unwrap();
    for kill_after in [None, Some(1), Some(9), Some(30), Some(47)] {
        let folder = folder.path().join(format!("{kill_after:?}"));
        suite(&folder, 12, 2, &["asked"]);
        let provider = Provider::of(Geometric);
        if let Some(count) = kill_after {
            let mut child = bench(&folder, &provider, &[])
                .process()
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            let begun = Instant::now();
            while provider.calls() < count {
                assert!(begun.elapsed() < Duration::from_secs(240));
                thread::sleep(Duration::from_millis(1));
            }
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let said = finish(&mut bench(&folder, &provider, &[]));
        assert_eq!(said.code, 0, "{kill_after:?}: {}", said.stderr);
        let document = document(&said);
        assert_eq!(document["rollouts"]["finished"], 24);
        let spent = &document["calls"];
        let cut = spent["possibly_billed"].as_u64().unwrap() as usize;
        // A call is noted before it is sent, so the kill may have come between.
        let noted = spent["calls"].as_u64().unwrap() as usize;
        assert!(
            provider.calls() <= noted && noted <= 48 + cut,
            "{kill_after:?}: {noted}"
        );
        assert!(cut <= 8, "{kill_after:?}: {cut}");
        // 24 rollouts put two questions each; only calls under way at the kill are sent again.
        assert!(provider.calls() <= 48 + cut, "{kill_after:?}");
        assert!(provider.counts().values().all(|count| *count >= 24));
        assert_eq!(provider.counts().len(), 2);
        if kill_after.is_none() {
            assert_asked(&provider, 24);
            assert_eq!(document["answers"], "per_start");
            assert_eq!(document["rows"][0]["answers"], "per_start");
            assert_eq!(document["rows"][0]["clusters"], Value::Null);
            assert_eq!(document["rows"][0]["n"], 12);
            assert_ne!(document["rows"][0]["ci95"], Value::Null);
        }
    }
}

#[test]
#[ignore = "long"]
fn methods_at_one_start_and_repeat_share_an_equal_question_and_estimates_count_it_once() {
    const TERSE: &str = "    variant terse {\n        component few_words \"Use few words.\"\n        say few_words in plan after point_format\n    }\n}\n";
    // Two starts with two repeats: four rollouts of each method.
    for (another, requests) in [
        ("", [4, 4].as_slice()),
        // The description is the same question, the plan is not.
        ("variant = \"terse\"\n", &[4, 4, 4]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        suite(folder.path(), 2, 2, &["one", "another"]);
        let change = |name: &str, change: &dyn Fn(String) -> String| {
            let path = folder.path().join(name);
            fs::write(&path, change(fs::read_to_string(&path).unwrap())).unwrap();
        };
        change("tasks/tiny.fab", &|task| {
            format!("{}{TERSE}", task.trim_end().trim_end_matches('}'))
        });
        change("tasks/suites/tiny.toml", &|suite| suite + another);
        let provider = Provider::of(Geometric);
        let likely = |more: &[&str]| {
            let said = finish(&mut bench(
                folder.path(),
                &provider,
                &[&["--estimate"], more].concat(),
            ));
            document(&said)["likely"]["calls"].as_u64().unwrap() as usize
        };
        // A step that misses its subgoal is tried again, so 1.4 questions are likely for each.
        let tried = |n_questions: usize| (14 * n_questions + 5) / 10;
        let once = requests.iter().copied().map(tried).sum::<usize>();
        assert_eq!(likely(&[]), once, "{another}");
        assert_eq!(likely(&["--no-cache"]), 4 * tried(4));
        assert_eq!(provider.calls(), 0);
        let said = finish(&mut bench(folder.path(), &provider, &[]));
        assert_eq!(said.code, 0, "{}", said.stderr);
        assert_eq!(document(&said)["rollouts"]["finished"], 8);
        let counts: Vec<usize> = provider.counts().into_values().collect();
        assert_eq!(counts, requests);
    }
}

#[test]
#[ignore = "long"]
fn shared_answers_are_stated_and_clustered_and_not_mixed_with_others() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    suite(folder, 3, 2, &["asked"]);
    let provider = Provider::of(Geometric);
    let said = finish(&mut bench(folder, &provider, &["--share-answers"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_asked(&provider, 2);
    let shared = document(&said);
    assert_eq!(shared["answers"], "shared");
    let row = |document: &Value, metric: &str| {
        let mut rows = document["rows"].as_array().unwrap().iter();
        rows.find(|row| row["metric"] == metric).cloned().unwrap()
    };
    let distance = row(&shared, "mean_particle_distance_mm");
    assert_eq!(
        (
            &distance["answers"],
            &distance["clusters"],
            &distance["ci95"]
        ),
        (&json!("shared"), &json!(1), &Value::Null)
    );
    // Wilson's interval of one success in one trial, not in three.
    let [low, high] = [0, 1].map(|at| row(&shared, "goal_reached")["ci95"][at].as_f64().unwrap());
    assert!(low < 0.21 && high == 1.0, "{low} {high}");
    let read = |name: &str| fs::read_to_string(folder.join("out").join(name)).unwrap();
    for (name, stated) in [
        ("table.md", "Answers are shared (`--share-answers`)"),
        ("table.md", "3 x 2, 1 cluster"),
        ("table.csv", ",shared,1,"),
        ("table.json", "\"answers\": \"shared\""),
    ] {
        assert!(read(name).contains(stated), "{name}: {}", read(name));
    }
    let mixed = finish(&mut bench(folder, &provider, &[]));
    assert_eq!(mixed.code, 2, "{}", mixed.stderr);
    assert!(
        mixed.stderr.contains("`drawn_for` (recorded ")
            && mixed.stderr.contains("`--share-answers` decides"),
        "{}",
        mixed.stderr
    );

    let replay = |more: &[&str]| {
        let arguments = ["bench", "tiny", "--json", "--model", "replay:out"];
        finish(&mut command(folder, &[&arguments, more].concat()))
    };
    let replayed = replay(&["--out", "again", "--share-answers"]);
    assert_eq!(replayed.code, 0, "{}", replayed.stderr);
    assert_eq!(
        row(&document(&replayed), "mean_particle_distance_mm")["value"],
        distance["value"]
    );
    let refused = replay(&["--out", "alone"]);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(
        refused.stderr.contains("`--share-answers` replays it") && !folder.join("alone").exists(),
        "{}",
        refused.stderr
    );
    assert_asked(&provider, 2);
}

/// Returns what each call of the suite reserved and what it reported.
fn ledger_lines(folder: &Path) -> Vec<(u64, Option<u64>)> {
    let mut calls = Vec::new();
    for run in fs::read_dir(folder.join("out/tiny/asked")).unwrap() {
        let Ok(text) = fs::read_to_string(run.unwrap().path().join(ledger::LEDGER_FILE)) else {
            continue;
        };
        let lines: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        for begun in lines.iter().filter(|line| line["type"] == "begin") {
            let ended = |line: &&Value| line["type"] == "answered" && line["call"] == begun["call"];
            let cost = lines
                .iter()
                .find(ended)
                .and_then(|line| line["reply"]["cost"].as_u64());
            calls.push((begun["at_most"].as_u64().unwrap(), cost));
        }
    }
    calls
}

/// Starts a provider whose answers report these tokens, in and out.
fn reporting(input: u64, output: u64) -> Provider {
    Provider::start(move |_, question| {
        let usage = json!({ "prompt_tokens": input, "completion_tokens": output });
        let answer = question.answer_of(&Geometric);
        answer.edit(|body| body["usage"] = usage)
    })
}

#[test]
#[ignore = "long"]
fn a_cap_ends_a_suite_only_when_it_is_reached_whatever_the_provider_reports() {
    let folder = tempfile::tempdir().unwrap();
    let prepared = |name: &str| {
        let folder = folder.path().join(name);
        suite(&folder, 12, 1, &["asked"]);
        folder
    };
    // What a call reserves here; eight at once need about eight times as much.
    let honest = prepared("honest");
    let provider = reporting(100, 10);
    let said = finish(&mut bench(&honest, &provider, &[]));
    assert_eq!((said.code, provider.calls()), (0, 24), "{}", said.stderr);
    let all = ledger_lines(&honest);
    let most = all.iter().map(|(at_most, _)| *at_most).max().unwrap();
    let cap = |nano: u64| format!("{:.9}", nano as f64 / 1e9);

    let tight = prepared("tight");
    let provider = reporting(100, 10);
    let twice = cap(24 * 300_000 + 2 * most);
    let said = finish(&mut bench(&tight, &provider, &["--max-cost", &twice]));
    assert_eq!((said.code, provider.calls()), (0, 24), "{}", said.stderr);

    let silent = prepared("silent");
    let provider = reporting(0, 0);
    let said = finish(&mut bench(
        &silent,
        &provider,
        &["--max-cost", &cap(6 * most)],
    ));
    assert_eq!(said.code, 3, "{}", said.stderr);
    let capped = document(&said);
    let sent = provider.calls() as u64;
    assert!((6..24).contains(&sent), "{sent}");
    let spent = &capped["calls"];
    assert_eq!(
        (&spent["cost_nano_usd"], &spent["unreported"]),
        (&json!(0), &json!(sent))
    );
    let possibly = spent["possibly_nano_usd"].as_u64().unwrap();
    assert!(
        possibly <= 6 * most && possibly > 5 * most,
        "{possibly} of {most}"
    );
    assert!(
        said.stderr
            .contains("tokens at least 0 in, 0 out, at most "),
        "{}",
        said.stderr
    );
    let said = finish(&mut bench(
        &silent,
        &provider,
        &["--max-cost", &cap(25 * most)],
    ));
    assert_eq!((said.code, provider.calls()), (0, 24), "{}", said.stderr);
    let row = &document(&said)["rows"][0];
    assert_eq!(row["cost"], Value::Null);
    assert!(row["cost_at_most"].as_f64().unwrap() > 0.0, "{row}");
    let table = fs::read_to_string(silent.join("out/table.md")).unwrap();
    assert!(table.contains("| at most 0.0"), "{table}");

    let dear = prepared("dear");
    // At 2 and 10 USD a million tokens: ten times of all that a call may cost.
    let tokens = 10 * most / 2000;
    let provider = reporting(tokens, 1);
    let room = 12 * most;
    let said = finish(&mut bench(&dear, &provider, &["--max-cost", &cap(room)]));
    assert_eq!(said.code, 3, "{}", said.stderr);
    let spent = document(&said)["calls"]["cost_nano_usd"].as_u64().unwrap();
    let mut beyond: Vec<u64> = ledger_lines(&dear)
        .iter()
        .map(|(at_most, cost)| cost.unwrap().saturating_sub(*at_most))
        .collect();
    beyond.sort_unstable_by(|a, b| b.cmp(a));
    assert!(beyond[0] > 0);
    assert!(
        spent <= room + beyond.iter().take(8).sum::<u64>(),
        "{spent} of {room}"
    );
}

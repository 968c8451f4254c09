//! The command with a paid provider: cached answers, roles, interrupts, and suites with a cap.

use super::provider_commands::{command, run};
use super::support::{bring_library, finish, project};
use fab_standins::Geometric;
use fab_test_provider::{Provider, Response};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

const KEY: &str = "sk-nobodys-0123456789";

#[test]
#[ignore = "long"]
fn answers_are_kept_for_the_next_run_and_bought_anew_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let omit = ["--omit", "temperature"];
    let bought = |more: &[&str]| {
        let before = provider.calls();
        let (code, report, said) = run(folder.path(), &provider, &[&omit, more].concat());
        assert_eq!(code, 0, "{said}");
        assert_eq!(
            report["calls"].as_u64().unwrap() as usize,
            provider.calls() - before
        );
        provider.calls() - before
    };
    assert_eq!(bought(&[]), 4);
    assert_eq!(bought(&[]), 0);
    assert_eq!(bought(&["--no-cache"]), 4);
}

#[test]
#[ignore = "long"]
fn roles_go_to_different_models() {
    let folder = tempfile::tempdir().unwrap();
    let (vision, text) = (Provider::of(Geometric), Provider::of(Geometric));
    let task = project("tasks/double_triangle.fab");
    let urls = [
        format!("vision={}", vision.base_url()),
        format!("text={}", text.base_url()),
    ];
    let said = finish(
        command(
            folder.path(),
            &[
                "run",
                &task,
                "--allow-unknown-price",
                "--model",
                "vision=openai-chat:geometric",
                "--model",
                "text=compatible:geometric",
                "--base-url",
                &urls[0],
                "--base-url",
                &urls[1],
            ],
        )
        .env("OPENAI_API_KEY", KEY),
    );
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!((vision.calls(), text.calls()), (2, 2));
    let holds = |provider: &Provider, what: &str| {
        let questions = provider.questions();
        questions
            .iter()
            .all(|it| String::from_utf8_lossy(&it.body).contains(what))
    };
    assert!(holds(&vision, "data:image/png;base64,"));
    assert!(holds(&text, "Method of folding") && !holds(&text, "data:image"));
}

#[cfg(unix)]
#[test]
#[ignore = "long"]
fn an_interrupt_ends_a_waiting_call_and_the_run_goes_on_later() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::start(|number, question| match number {
        2 => Response::status(200).delay(Duration::from_secs(3600)),
        _ => question.answer_of(&Geometric),
    });
    let task = project("tasks/double_triangle.fab");
    let mut child = command(
        folder.path(),
        &[
            "run",
            &task,
            "--out",
            "run",
            "--allow-unknown-price",
            "--model",
            "compatible:geometric",
            "--base-url",
            provider.base_url(),
        ],
    )
    .process()
    .stdout(Stdio::null())
    .stderr(Stdio::null())
    .spawn()
    .unwrap();
    while provider.calls() < 3 {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended before the third call"
        );
        thread::sleep(Duration::from_millis(5));
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let begun = Instant::now();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    assert!(
        begun.elapsed() < Duration::from_secs(60),
        "the call was waited for"
    );
    let said = finish(&mut command(folder.path(), &["resume", "run", "--json"]));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(
        (&report["calls"], &report["possibly_billed"]),
        (&json!(5), &json!(1))
    );
    assert_eq!(provider.calls(), 5);
}

#[test]
fn a_cap_that_could_not_be_held_lets_nothing_through() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let omit = ["--omit", "temperature,tokens", "--max-cost", "5"];
    let (code, report, said) = run(folder.path(), &provider, &omit);
    assert_eq!((code, provider.calls()), (3, 0), "{said}");
    assert_eq!(report["outcome"], "budget_exhausted");
    assert!(said.contains("cannot be enforced"), "{said}");
}

#[test]
fn a_probe_keeps_to_its_caps() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let probe = |more: &[&str]| {
        let arguments = [
            "probe",
            "compatible:geometric",
            "--allow-unknown-price",
            "--base-url",
            provider.base_url(),
        ];
        finish(&mut command(folder.path(), &[&arguments, more].concat()))
    };
    let said = probe(&["--max-calls", "1"]);
    assert_eq!((said.code, provider.calls()), (3, 1), "{}", said.stderr);
    assert!(
        said.stderr.contains("the cap of 1 call is reached"),
        "{}",
        said.stderr
    );
    let said = probe(&["--max-cost", "1"]);
    assert_eq!((said.code, provider.calls()), (3, 1), "{}", said.stderr);
    assert!(
        said.stderr.contains("cannot be enforced"),
        "{}",
        said.stderr
    );
    // The stand-in cannot state a dot's position, which the probe must find out. Four questions are about the interface.
    let said = probe(&[]);
    assert_eq!(
        (said.code, provider.calls()),
        (3, 1 + 4 + 2),
        "{}",
        said.stderr
    );
    assert!(said.stdout.contains("0 of 12 dots"), "{}", said.stdout);
}

#[test]
#[ignore = "long"]
fn what_a_cut_call_cost_is_not_known_where_the_price_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::start(|_, question| question.answer_of(&Geometric).cut());
    let task = project("tasks/double_triangle.fab");
    let said = finish(&mut command(
        folder.path(),
        &[
            "run",
            &task,
            "--json",
            "--allow-unknown-price",
            "--model",
            "compatible:geometric",
            "--base-url",
            provider.base_url(),
        ],
    ));
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!((said.code, &report["possibly_billed"]), (2, &json!(3)));
    assert_eq!(
        (&report["cost_usd"], &report["cost_usd_at_most"]),
        (&Value::Null, &Value::Null)
    );
    assert!(said.stderr.contains("asked again in"), "{}", said.stderr);
}

#[test]
#[ignore = "long"]
fn a_suite_ends_at_a_provider_that_refuses_and_goes_on_when_it_does_not() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let bench = |provider: &Provider| {
        finish(&mut command(
            folder.path(),
            &[
                "bench",
                "tiny",
                "--json",
                "--out",
                "out",
                "--jobs",
                "1",
                "--model",
                "compatible:geometric",
                "--allow-unknown-price",
                "--base-url",
                provider.base_url(),
            ],
        ))
    };
    let broke = Provider::start(|number, question| match number {
        0..3 => question.answer_of(&Geometric),
        _ => Response::error(429, "insufficient_quota", "you have no credit left"),
    });
    let said = bench(&broke);
    assert_eq!(said.code, 2, "{}", said.stderr);
    assert!(said.stderr.contains("quota_exhausted"), "{}", said.stderr);
    assert_eq!(broke.calls(), 4, "no further rollout is begun");
    let paid = Provider::of(Geometric);
    let said = bench(&paid);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let document: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(document["rollouts"]["finished"], 4);
    assert_eq!(paid.calls(), 8 - 3, "what was answered is not bought again");
}

/// A suite of one small task with two starts and two rollouts each.
pub fn suite(folder: &Path) {
    let tasks = folder.join("tasks");
    fs::create_dir_all(tasks.join("suites")).unwrap();
    bring_library(&tasks);
    let task = "use \"lib/folding.fab\"\nuse \"lib/experts.fab\"\n\ntask tiny extends folding {\n    cloth   grid(28, 28)\n    goal    particle_distance < 40mm\n    subgoals {\n        demonstrate {\n            fold corner(back_right) -> corner(front_left)\n        }\n    }\n}\n";
    fs::write(tasks.join("tiny.fab"), task).unwrap();
    let suite = "about = \"One small fold.\"\nstatistic = \"mean\"\nmetrics = [\"mean_particle_distance_mm\"]\nrepeats = 2\ntasks = [\"../tiny.fab\"]\n[starts]\nlie = \"flat\"\nsides = [28, 30]\nturns_deg = [0]\n[[method]]\nname = \"asked\"\n";
    fs::write(tasks.join("suites/tiny.toml"), suite).unwrap();
}

#[test]
#[ignore = "long"]
fn a_suite_stops_at_its_cap_and_goes_on_with_a_higher_one() {
    let folder = tempfile::tempdir().unwrap();
    suite(folder.path());
    let provider = Provider::of(Geometric);
    let bench = |more: &[&str]| {
        let mut arguments = vec![
            "bench",
            "tiny",
            "--json",
            "--out",
            "out",
            "--jobs",
            "2",
            "--model",
            "compatible:geometric",
            "--allow-unknown-price",
            "--base-url",
            provider.base_url(),
        ];
        arguments.extend(more);
        let said = finish(&mut command(folder.path(), &arguments));
        let document = serde_json::from_str::<Value>(&said.stdout);
        (
            said.code,
            document.unwrap_or_else(|_| panic!("{}", said.stderr)),
        )
    };
    let (code, estimate) = bench(&["--estimate"]);
    assert_eq!((code, provider.calls()), (0, 0));
    assert_eq!(
        estimate["likely"]["calls"], 12,
        "two stages, two starts, two rollouts each, and 1.4 tries of a step"
    );

    let (code, capped) = bench(&["--max-calls", "3"]);
    assert_eq!((code, provider.calls()), (3, 3));
    assert_eq!(capped["capped"], true);
    let (code, still) = bench(&["--max-calls", "3"]);
    assert_eq!(
        (code, provider.calls()),
        (3, 3),
        "the cap counts earlier parts: {still}"
    );
    let (code, whole) = bench(&[]);
    assert_eq!(code, 0, "{whole}");
    assert_eq!(whole["rollouts"]["finished"], 4);
    // Repeats ask the same words, and one stage also does at both starts, but each buys its own answer.
    let mut counts: Vec<usize> = provider.counts().into_values().collect();
    counts.sort_unstable();
    assert_eq!(counts, [2, 2, 4]);
    assert_eq!(whole["calls"]["calls"], json!(provider.calls()));

    let replayed = finish(&mut command(
        folder.path(),
        &[
            "bench",
            "tiny",
            "--json",
            "--out",
            "again",
            "--model",
            "replay:out",
        ],
    ));
    assert_eq!(replayed.code, 0, "{}", replayed.stderr);
    let replayed: Value = serde_json::from_str(&replayed.stdout).unwrap();
    assert_eq!(replayed["rows"][0]["value"], whole["rows"][0]["value"]);
    assert_eq!(replayed["rows"][0]["repeats"], 2);
}

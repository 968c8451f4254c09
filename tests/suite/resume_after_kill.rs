//! `fabc run` with a provider, killed at many points and resumed: nothing is bought twice and nothing is lost.

use super::support::{Fabc, bring_library, fabc, finish, project};
use fab_model::calls::ledger;
use fab_standins::Geometric;
use fab_test_provider::{Provider, Response};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A task of two steps on a cloth so small that a rollout takes a moment.
const TASK: &str = "\
use \"lib/folding.fab\"
use \"lib/experts.fab\"

task small extends folding {
    cloth   grid(28, 28)
    horizon 2
    subgoals {
        demonstrate {
            fold corner(back_right) -> corner(front_left)
            fold corner(front_right) -> corner(back_left)
        }
    }
}
";

/// The command, with the run's own cache of answers.
fn command(folder: &Path, arguments: &[&str]) -> Fabc {
    let mut command = fabc(folder);
    command
        .args(arguments)
        .env("FABC_CACHE_DIR", folder.join("cache"));
    command
}

fn run_arguments(provider: &Provider) -> [String; 9] {
    [
        "run",
        "small.fab",
        "--out",
        "run",
        "--model",
        "compatible:geometric",
        "--allow-unknown-price",
        "--base-url",
        provider.base_url(),
    ]
    .map(str::to_owned)
}

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let command = command(folder, arguments);
    command
        .process()
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn prepare(folder: &Path) {
    bring_library(folder);
    fs::write(folder.join("small.fab"), TASK).unwrap();
}

/// Waits until `reached` is true or the process has ended; returns whether it has ended.
fn ended_before(child: &mut Child, reached: impl Fn() -> bool) -> bool {
    let begun = Instant::now();
    while !reached() {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "neither reached nor ended"
        );
        thread::sleep(Duration::from_millis(1));
    }
    false
}

#[test]
#[ignore = "long"]
fn a_run_killed_now_and_then_loses_nothing_and_buys_nothing_twice() {
    let few = [(0, 40), (1, 3), (2, 3), (3, 150)].into_iter();
    kill_at(few.collect());
}

#[test]
#[ignore = "long"]
fn a_run_killed_at_any_point_loses_nothing_and_buys_nothing_twice() {
    let every = (0..=6).flat_map(|calls| [0, 3, 15, 60, 150].map(|ms| (calls, ms)));
    kill_at(every.collect());
}

/// Kills a run at each moment, resumes it, and compares it with an undisturbed one.
///
/// - `moments`: after this many received calls or sent answers, and this many milliseconds later.
fn kill_at(moments: Vec<(usize, u64)>) {
    let whole = tempfile::tempdir().unwrap();
    prepare(whole.path());
    let provider = Provider::of(Geometric);
    let arguments = run_arguments(&provider);
    let said = finish(&mut command(
        whole.path(),
        &arguments.each_ref().map(String::as_str),
    ));
    assert_eq!(said.code, 0, "{}", said.stderr);
    let questions = provider.counts().len();
    assert!(questions >= 4, "{questions}");
    let journal = fs::read_to_string(whole.path().join("run/rollout.jsonl")).unwrap();

    let (mut killed, n_moments) = (0, moments.len());
    for (number, (calls, after_ms)) in moments.into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        prepare(folder.path());
        let provider = Provider::of(Geometric);
        let arguments = run_arguments(&provider);
        let arguments = arguments.each_ref().map(String::as_str);
        let mut child = start(folder.path(), &arguments);
        let by_calls = number % 2 == 0;
        let reached = || match by_calls {
            true => provider.calls() >= calls,
            false => provider.answered() >= calls,
        };
        if !ended_before(&mut child, reached) {
            thread::sleep(Duration::from_millis(after_ms));
            child.kill().unwrap();
            killed += 1;
        }
        child.wait().unwrap();
        let what = format!("killed {after_ms} ms after {calls} calls");
        let run = folder.path().join("run");
        let said = match run.join("run.json").exists() {
            true => finish(&mut command(folder.path(), &["resume", "run"])),
            // It was killed before it recorded how it was started, and thus before anything was sent.
            false => {
                assert_eq!(provider.calls(), 0, "{what}");
                let _ = fs::remove_dir_all(&run);
                finish(&mut command(folder.path(), &arguments))
            }
        };
        assert_eq!(said.code, 0, "{what}: {}", said.stderr);
        let spent = ledger::read(&run).unwrap().spent;
        let counts = provider.counts();
        assert_eq!(counts.len(), questions, "{what}");
        let again: usize = counts.values().map(|count| count - 1).sum();
        // Only a call that was in progress when the process died may be sent again.
        assert!(
            again as u64 <= spent.possibly_billed,
            "{what}: {again} sent again"
        );
        assert!(spent.possibly_billed <= 1, "{what}");
        assert_eq!(
            fs::read_to_string(run.join("rollout.jsonl")).unwrap(),
            journal,
            "{what}"
        );
        let answers = |run: &Path| ledger::read(run).unwrap().answered;
        assert!(
            answers(&run)
                .keys()
                .eq(answers(&whole.path().join("run")).keys()),
            "{what}: the ledgers differ"
        );
    }
    assert!(
        2 * killed > n_moments,
        "only {killed} of {n_moments} runs were killed"
    );
}

#[test]
#[ignore = "long"]
fn no_artefact_holds_the_key() {
    const CANARY: &str = "sk-canary-7f3A9+q/Zz01==";
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    // The provider echoes the key in its answers.
    let echo = format!("your key is {CANARY}\n");
    let provider = Provider::start(move |number, question| match number {
        0 => Response::status(200).json("<html>bad gateway</html>"),
        4 => {
            let message = format!("wrong key: {CANARY}");
            Response::error(401, "invalid_api_key", &message).header("x-your-key", CANARY)
        }
        _ => question.answer_of(&Geometric).edit(|body| {
            let text = &mut body["choices"][0]["message"]["content"];
            *text = (echo.clone() + text.as_str().unwrap()).into();
        }),
    });
    let arguments = run_arguments(&provider);
    let mut command = command(folder.path(), &arguments.each_ref().map(String::as_str));
    let said = finish(
        command
            .env("FABC_COMPATIBLE_KEY", CANARY)
            .env("RUST_BACKTRACE", "1"),
    );
    assert_eq!(said.code, 2, "the fifth call is refused: {}", said.stderr);
    assert!(said.stderr.contains("not_authorised"), "{}", said.stderr);
    let keys = [CANARY, &CANARY[3..]];
    let mut files = vec![
        ("stdout".to_owned(), said.stdout),
        ("stderr".to_owned(), said.stderr),
    ];
    collect(folder.path(), &mut files);
    assert!(files.len() > 15, "{}", files.len());
    let hidden = files
        .iter()
        .filter(|(_, text)| text.contains("[key]"))
        .count();
    assert!(
        hidden >= 3,
        "answers, ledger and messages show that something was hidden"
    );
    for (name, text) in files {
        for key in keys {
            assert!(!text.contains(key), "{name} holds the key");
        }
    }
    let questions = provider.questions();
    let holds_key = |body: &[u8]| String::from_utf8_lossy(body).contains(CANARY);
    assert!(!questions.iter().any(|it| holds_key(&it.body)));
}

fn collect(folder: &Path, files: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else {
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            files.push((path.display().to_string(), text));
        }
    }
}

#[test]
#[ignore = "long"]
fn shipped_tasks_run_with_a_provider_as_with_the_stand_in() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let report = |arguments: &[&str]| {
        let mut command = fabc(folder.path());
        let said = finish(
            command
                .args(["run", &project("tasks/double_triangle.fab"), "--json"])
                .args(arguments),
        );
        assert_eq!(said.code, 0, "{}", said.stderr);
        serde_json::from_str::<Value>(&said.stdout).unwrap()
    };
    let embedded = report(&["--out", "embedded"]);
    let served = report(&[
        "--out",
        "served",
        "--model",
        "compatible:geometric",
        "--allow-unknown-price",
        "--no-cache",
        "--base-url",
        provider.base_url(),
    ]);
    for field in ["outcome", "mean_particle_distance_mm", "steps", "queries"] {
        assert_eq!(served[field], embedded[field], "{field}");
    }
    assert_eq!(served["calls"], 4);
    assert_eq!(served["cost_usd"], Value::Null);
    assert!(served["usage"]["input_tokens"].as_u64().unwrap() > 0);
}

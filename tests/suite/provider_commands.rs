//! The command with a provider, before anything is sent: estimates, settings, rejections, and prompts as they would be
//! sent.

use super::support::{Fabc, fabc, finish, project};
use fab_standins::Geometric;
use fab_test_provider::Provider;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Facts that give the embedded model behind `compatible` a price, and say that it does not support a temperature.
pub const FACTS: &str = "\
[[model]]
provider = \"compatible\"
id = \"geometric\"
vision = true
temperature = { only = [1] }
price = [{ input = 2, output = 10 }]
image_tokens = { flat = { at_least = 59, at_most = 59 } }
as_of = \"2026-11-21\"
source = \"a test\"
";

/// The command, with the test's own files and cache.
pub fn command(folder: &Path, arguments: &[&str]) -> Fabc {
    let mut command = fabc(folder);
    command
        .args(arguments)
        .env("FABC_CACHE_DIR", folder.join("cache"))
        .env("XDG_CONFIG_HOME", folder.join("config"))
        .env_remove("OPENAI_API_KEY");
    command
}

/// Runs double_triangle with the provider as `compatible:geometric`.
pub fn run(folder: &Path, provider: &Provider, more: &[&str]) -> (i32, Value, String) {
    fs::write(folder.join("facts.toml"), FACTS).unwrap();
    let task = project("tasks/double_triangle.fab");
    let mut arguments = vec![
        "run",
        &task,
        "--json",
        "--model",
        "compatible:geometric",
        "--models",
        "facts.toml",
        "--base-url",
        provider.base_url(),
    ];
    arguments.extend(more);
    let said = finish(&mut command(folder, &arguments));
    let report = serde_json::from_str(&said.stdout).unwrap_or(Value::Null);
    (said.code, report, said.stderr)
}

#[test]
#[ignore = "long"]
fn an_estimate_sends_nothing_and_holds_what_the_run_then_costs() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let (code, estimate, _) = run(
        folder.path(),
        &provider,
        &["--estimate", "--omit", "temperature"],
    );
    assert_eq!(code, 0);
    assert_eq!(provider.calls(), 0);
    assert!(
        !folder.path().join("runs").exists(),
        "an estimate makes no run folder"
    );
    let (code, report, said) = run(folder.path(), &provider, &["--omit", "temperature"]);
    assert_eq!(code, 0, "{said}");
    let within = |what: &str, value: u64| {
        let most = estimate["at_most"][what].as_u64();
        assert!(Some(value) <= most, "{what}: {value}, at most {most:?}");
    };
    within("calls", report["calls"].as_u64().unwrap());
    within(
        "input_tokens",
        report["usage"]["input_tokens"].as_u64().unwrap(),
    );
    within(
        "output_tokens",
        report["usage"]["output_tokens"].as_u64().unwrap(),
    );
    within(
        "cost_nano_usd",
        (report["cost_usd"].as_f64().unwrap() * 1e9).round() as u64,
    );
}

#[test]
fn a_setting_that_the_model_does_not_take_is_named_before_anything_is_sent() {
    let folder = tempfile::tempdir().unwrap();
    let provider = Provider::of(Geometric);
    let (code, report, said) = run(folder.path(), &provider, &[]);
    assert_eq!((code, provider.calls()), (2, 0));
    assert_eq!(report["outcome"], Value::Null);
    assert!(!folder.path().join("runs").exists(), "nothing was begun");
    assert!(
        said.contains("temperature") && said.contains("0.2") && said.contains("--omit"),
        "{said}"
    );
}

#[test]
fn an_estimate_needs_no_key_and_says_what_will_be_refused() {
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_triangle.fab");
    let estimate = |more: &[&str]| {
        let all = [
            &["run", &task, "--model", "openai:gpt-6.2-sol", "--estimate"],
            more,
        ]
        .concat();
        finish(&mut command(folder.path(), &all))
    };
    let refused = estimate(&[]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("`temperature` 0.2"),
        "{}",
        refused.stderr
    );
    let said = estimate(&["--omit", "temperature"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert!(
        said.stdout.starts_with("likely: calls 6, ") && said.stdout.contains("\nat most: calls "),
        "{}",
        said.stdout
    );
}

#[test]
fn a_key_in_the_place_of_a_name_is_not_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_triangle.fab");
    let key = "sk-aaaaaaaaaaaaaaaaa";
    let name = format!("openai:{key}");
    for more in [&[][..], &["--allow-unknown-price"]] {
        let all = [&["run", task.as_str(), "--model", &name], more].concat();
        let said = finish(command(folder.path(), &all).env("OPENAI_API_KEY", key));
        assert_eq!(said.code, 64, "{}", said.stderr);
        assert!(!said.stderr.contains(key), "{}", said.stderr);
    }
}

#[test]
fn what_cannot_be_asked_is_refused_with_what_would_help() {
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_triangle.fab");
    fs::write(
        folder.path().join("bad.toml"),
        "[[model]]\nprovider = \"openai\"\nid = \"x\"\nprise = 3\n",
    )
    .unwrap();
    let cases: [(&[&str], i32, &str); 11] = [
        (
            &["--model", "openai:gpt-6.2-sol"],
            2,
            "set OPENAI_API_KEY in the environment, or write",
        ),
        (
            &["--model", "opena:gpt-6.2-sol"],
            64,
            "there is no provider `opena`",
        ),
        (&["--model", "openai:"], 64, "openai:"),
        (
            &["--model", "compatible:x", "--allow-unknown-price"],
            64,
            "--base-url URL",
        ),
        (
            &["--model", "litellm:x"],
            2,
            "costs is not known; `--allow-unknown-price`",
        ),
        (
            &["--model", "vision=geometric"],
            64,
            "`--model` names one thing for each role",
        ),
        (
            &["--model", "geometric", "--model", "random"],
            64,
            "`--model` names one thing for each role",
        ),
        (
            &[
                "--model=geometric",
                "--model=vision=geometric",
                "--model=text=random",
            ],
            64,
            "`--model` names one thing for each role",
        ),
        (
            &[
                "--model",
                "ollama:x",
                "--base-url",
                "http://me:secret@localhost/v1",
            ],
            64,
            "base URL",
        ),
        (&["--model", "ollama:x", "--models", "bad.toml"], 2, "prise"),
        (&["--max-cost=-1"], 64, "write an amount of US dollars"),
    ];
    for (arguments, code, expected) in cases {
        let all = [&["run", task.as_str(), "--out", "run"], arguments].concat();
        let said = finish(&mut command(folder.path(), &all));
        assert_eq!(said.code, code, "{arguments:?}: {}", said.stderr);
        assert!(
            said.stderr.contains(expected),
            "{arguments:?}: {}",
            said.stderr
        );
        assert!(!said.stderr.contains("secret"), "{}", said.stderr);
        assert!(
            !folder.path().join("run").exists(),
            "{arguments:?} left a run folder"
        );
    }
}

#[test]
fn a_prompt_is_shown_as_one_model_would_be_sent_it() {
    let folder = tempfile::tempdir().unwrap();
    let shown = |more: &[&str]| {
        let task = project("tasks/double_straight.fab");
        let all = [&["render", task.as_str(), "--stage", "plan"], more].concat();
        let said = finish(&mut command(folder.path(), &all));
        assert_eq!(said.code, 0, "{}", said.stderr);
        said.stdout
    };
    assert!(shown(&[]).contains("Pick Point = (x, y)"));
    assert_eq!(shown(&["--model", "geometric"]), shown(&[]));
    let turned = shown(&["--model", "google:gemini-robotics-er-2-preview"]);
    assert!(
        turned.contains("Pick Point = [y, x]") && turned.contains("thousandths"),
        "{turned}"
    );
    assert!(shown(&["--marks"]).contains("1 at ("));
}

#[test]
#[ignore = "long"]
fn the_variables_that_name_a_proxy_are_named_where_a_proxy_answers() {
    use std::io::{Read, Write};
    let folder = tempfile::tempdir().unwrap();
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let proxy = format!("http://{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.read(&mut [0; 4096]);
            let _ = stream.write_all(
                b"HTTP/1.1 407 Proxy Authentication Required\r\ncontent-length: 0\r\nconnection: close\r\n\r\n",
            );
            // Closing with unread bytes would reset the connection.
            while stream.read(&mut [0; 4096]).is_ok_and(|count| count > 0) {}
        }
    });
    let task = project("tasks/double_straight.fab");
    let arguments = [
        "run",
        &task,
        "--model",
        "compatible:a-model",
        "--allow-unknown-price",
        "--base-url",
        "http://models.example/v1",
    ];
    let mut command = command(folder.path(), &arguments);
    for name in [
        "http_proxy",
        "no_proxy",
        "NO_PROXY",
        "ALL_PROXY",
        "all_proxy",
    ] {
        command.env_remove(name);
    }
    command.env("HTTP_PROXY", &proxy);
    let output = command.process().output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    for words in [
        "no server can be reached at `models.example:80`",
        "the proxy if `HTTPS_PROXY` or `HTTP_PROXY` names one",
    ] {
        assert!(said.contains(words), "{said}");
    }
}

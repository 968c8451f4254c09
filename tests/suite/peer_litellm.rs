//! Whole rollouts with pictures through a LiteLLM proxy, in front of the embedded model or with scripted answers.

use super::support::{fabc, finish, project};
use fab_providers::catalogue::Catalogue;
use fab_standins::Geometric;
use fab_test_provider::Provider;
use serde_json::Value;
use std::fs;
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A key that the proxy accepts: long enough, and not a real one.
const KEY: &str = "sk-fabc-peer-test-0123456789abcdef";

/// A process that is ended with the test, and with it those that it started in its group.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let group = format!("-{}", self.0.id());
        let _ = Command::new("kill")
            .args(["-9", "--", &group])
            .stderr(Stdio::null())
            .status();
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Builds the environment if it is missing, and returns its folder.
fn environment() -> PathBuf {
    let python = std::env::var("FABC_PEER_PYTHON").expect(
        "FABC_PEER_PYTHON names no Python 3; `make test-all` sets it, or says what is missing",
    );
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("litellm");
    let wanted = fs::read(project("tests/peers/litellm-requirements.txt")).unwrap();
    let installed = place.join("installed.txt");
    if fs::read(&installed).is_ok_and(|there| there == wanted) {
        return place;
    }
    let run = |program: &Path, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
    };
    let python = Path::new(&python);
    let folder = place.display().to_string();
    run(python, &["-m", "venv", "--clear", "--without-pip", &folder]);
    let requirements = project("tests/peers/litellm-requirements.txt");
    run(
        python,
        &[
            "-m",
            "pip",
            "--python",
            &folder,
            "install",
            "--quiet",
            // Most of the time would go into bytecode of modules that are never used.
            "--no-compile",
            "--only-binary",
            ":all:",
            "-r",
            &requirements,
        ],
    );
    fs::write(installed, wanted).unwrap();
    place
}

/// Returns the line that `fabc doctor` prints for a proxy, with values in place of its capitals.
fn start_line(port: u16) -> String {
    let catalogue = Catalogue::builtin();
    let mut providers = catalogue.providers().iter();
    let litellm = providers
        .find(|provider| provider.name == "litellm")
        .unwrap();
    let line = litellm.start.as_ref().unwrap();
    let line = line
        .replace("sk-YOURS", KEY)
        .replace("FILE.yaml", "proxy.yaml");
    format!("{line} --port {port}")
}

/// Starts the proxy in front of an address as `fabc doctor` says, and returns the proxy's own.
fn proxy(folder: &Path, behind: &str) -> (Running, String) {
    let scripted = |name: &str, reply: &str| {
        format!(
            "  - model_name: {name}\n    litellm_params: {{ model: openai/any, api_key: none, mock_response: \"{reply}\" }}\n"
        )
    };
    let config = [
        "model_list:\n".to_owned(),
        format!(
            "  - model_name: geometric\n    litellm_params: {{ model: lm_studio/geometric, api_base: \"{behind}\", api_key: none }}\n"
        ),
        scripted("limited", "litellm.RateLimitError"),
        scripted("broken", "litellm.InternalServerError"),
        scripted("chatty", "I would rather talk about the weather."),
        // Its own retries would hide from fabc what it answers.
        "router_settings: { num_retries: 0 }\n".to_owned(),
    ];
    fs::write(folder.join("proxy.yaml"), config.concat()).unwrap();
    // A free port; nothing else asks for one before the proxy starts.
    let port = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let log = fs::File::create(folder.join("proxy.log")).unwrap();
    let programs = environment().join("bin");
    let path = std::env::var("PATH").unwrap_or_default();
    let child = Command::new("sh")
        .args(["-c", &start_line(port)])
        .process_group(0)
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", programs.display()))
        .env_remove("LITELLM_MASTER_KEY")
        .env("LITELLM_LOCAL_MODEL_COST_MAP", "True")
        .stdout(log.try_clone().unwrap())
        .stderr(log)
        .spawn()
        .unwrap();
    let mut running = Running(child);
    let begun = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        let ended = running.0.try_wait().unwrap();
        let log = || fs::read_to_string(folder.join("proxy.log")).unwrap_or_default();
        assert!(ended.is_none(), "the proxy ended: {}", log());
        assert!(
            begun.elapsed() < Duration::from_secs(300),
            "the proxy does not listen: {}",
            log()
        );
        thread::sleep(Duration::from_millis(200));
    }
    (running, format!("http://127.0.0.1:{port}"))
}

/// A run through the proxy, and its expected result.
struct Case<'a> {
    model: &'a str,
    key: Option<&'a str>,
    /// How many calls it may send, and sends.
    calls: u64,
    code: i32,
    outcome: &'a str,
    fault: &'a str,
    /// What it says.
    words: &'a str,
}

#[test]
#[ignore = "needs LiteLLM from PyPI"]
fn peer_litellm_carries_whole_rollouts_with_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let provider = Provider::of(Geometric);
    let (_proxy, address) = proxy(folder, provider.base_url());
    let v1 = format!("{address}/v1");
    let run = |out: &str, key: Option<&str>, more: &[&str]| {
        let task = project("tasks/double_triangle.fab");
        let mut command = fabc(folder);
        command.args([
            "run",
            &task,
            "--json",
            "--no-cache",
            "--allow-unknown-price",
        ]);
        command.args(["--out", out]);
        for variable in ["LITELLM_API_KEY", "OPENAI_API_KEY", "ANTHROPIC_API_KEY"] {
            match key {
                Some(key) => command.env(variable, key),
                None => command.env_remove(variable),
            };
        }
        let said = finish(command.args(more));
        let report = serde_json::from_str::<Value>(&said.stdout);
        let report = report.unwrap_or_else(|_| panic!("{}", said.stderr));
        (said.code, report, said.stderr)
    };
    let (_, embedded, _) = run("embedded", None, &[]);
    for (out, model, base_url) in [
        ("chat", "litellm:geometric", &v1),
        ("responses", "openai:geometric", &v1),
        ("messages", "anthropic:geometric", &address),
    ] {
        let (code, report, said) = run(out, Some(KEY), &["--model", model, "--base-url", base_url]);
        assert_eq!(code, 0, "{model}: {said}");
        assert_eq!(report["calls"], 4, "{model}");
        assert_eq!(
            report["mean_particle_distance_mm"], embedded["mean_particle_distance_mm"],
            "{model}"
        );
    }

    let wrong = Some("sk-fabc-wrong-0123456789abcdef");
    let not_accepted = "does not accept the key";
    let failed = |model, key, fault, words| Case {
        model,
        key,
        calls: 1,
        code: 2,
        outcome: "model_failed",
        fault,
        words,
    };
    let capped = |model, key, calls, fault, words| Case {
        calls,
        code: 3,
        outcome: "budget_exhausted",
        ..failed(model, key, fault, words)
    };
    let key = Some(KEY);
    let cases = [
        Case {
            outcome: "malformed_reply",
            ..capped("litellm:chatty", key, 3, "", "the weather")
        },
        capped("litellm:limited", key, 2, "rate_limited", "asked again in"),
        capped("litellm:broken", key, 2, "server_failed", "asked again in"),
        capped("litellm:chatty", None, 1, "server_failed", "asked again in"),
        failed(
            "litellm:unknown",
            key,
            "bad_request",
            "the server does not serve `unknown`",
        ),
        failed("litellm:chatty", wrong, "not_authorised", not_accepted),
        failed("openai:chatty", wrong, "not_authorised", not_accepted),
        failed("anthropic:chatty", wrong, "not_authorised", not_accepted),
    ];
    // They mostly wait before they ask again.
    thread::scope(|scope| {
        for (number, case) in cases.iter().enumerate() {
            let (run, address, v1) = (&run, &address, &v1);
            scope.spawn(move || {
                let base_url = if case.model.starts_with("anthropic") {
                    address
                } else {
                    v1
                };
                let arguments = [
                    "--model",
                    case.model,
                    "--base-url",
                    base_url,
                    "--max-calls",
                    &case.calls.to_string(),
                ];
                let (code, report, said) = run(&format!("case_{number}"), case.key, &arguments);
                let about = format!("{number} {}: {said}", case.model);
                assert_eq!(
                    (code, report["outcome"].as_str()),
                    (case.code, Some(case.outcome)),
                    "{about}"
                );
                assert_eq!(report["calls"], case.calls, "{about}");
                let faults = report["faults"].as_object().unwrap().keys();
                assert!(
                    faults.eq(Some(case.fault).filter(|it| !it.is_empty())),
                    "{about}"
                );
                assert!(said.contains(case.words), "{about}");
            });
        }
    });
}

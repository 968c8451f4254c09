//! A whole rollout over the endpoint, and the command that serves it.

use super::server::{Server, send};
use super::{CHAT, data_url};
use crate::suite::support::{Trial, fabc, finish, interrupt, project, small_task};
use fab_model::Models;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Part, Reply, Request};
use fab_standins::Geometric;
use fab_world::Look;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read};
use std::net::SocketAddr;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::Arc;

/// Asks a served model like any client.
struct Client(SocketAddr);

impl Model for Client {
    fn name(&self) -> &str {
        "geometric"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let messages: Vec<Value> = request
            .messages
            .iter()
            .map(|message| {
                let parts: Vec<Value> = message
                    .parts
                    .iter()
                    .map(|part| match part {
                        Part::Text(text) => json!({ "type": "text", "text": text }),
                        Part::Image(png) => {
                            json!({ "type": "image_url", "image_url": { "url": data_url(png) } })
                        }
                    })
                    .collect();
                json!({ "role": message.speaker, "content": parts })
            })
            .collect();
        let mut body = json!({ "model": "geometric", "messages": messages, "temperature": request.temperature, "max_tokens": request.max_tokens });
        if let Some(schema) = &request.schema {
            body["response_format"] = json!({ "type": "json_schema", "json_schema": { "name": "action", "strict": true, "schema": schema } });
        }
        let (status, answer) = send(self.0, "POST", CHAT, &body.to_string());
        assert_eq!(status, 200, "{answer}");
        Ok(Reply::text(
            answer["choices"][0]["message"]["content"].as_str().unwrap(),
        ))
    }
}

#[test]
#[ignore = "long"]
fn a_rollout_over_the_endpoint_is_the_rollout_without_it() {
    let program = small_task();
    let folder = tempfile::tempdir().unwrap();
    let trial = Trial::new(&program, folder.path(), Look::default());
    let direct = trial.run_stand_in(&folder.path().join("direct"));
    let server = Server::of(Arc::new(Geometric));
    let client = Client(server.address);
    let models = Models {
        vision: &client,
        text: &client,
    };
    let served = trial.run(models, &folder.path().join("served"), &mut |_| {});
    assert_eq!(
        (served.outcome, served.steps, served.queries),
        (direct.outcome, direct.steps, direct.queries)
    );
    assert_eq!(
        actions(&folder.path().join("served")),
        actions(&folder.path().join("direct"))
    );
}

fn actions(run: &std::path::Path) -> Vec<Value> {
    let journal = std::fs::read_to_string(run.join("rollout.jsonl")).unwrap();
    let lines = journal
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let actions: Vec<Value> = lines
        .filter_map(|line| line.get("action").cloned())
        .collect();
    assert!(!actions.is_empty());
    actions
}

/// Starts the command on a free port; returns what it printed about itself.
fn started(folder: &std::path::Path) -> (Child, BufReader<ChildStdout>, Value) {
    started_with(folder, "geometric")
}

fn started_with(folder: &std::path::Path, model: &str) -> (Child, BufReader<ChildStdout>, Value) {
    let mut child = fabc(folder)
        .args(["serve", "--port", "0", "--json", "--model", model])
        .process()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut said = String::new();
    while !said.trim_end().ends_with('}') {
        assert!(stdout.read_line(&mut said).unwrap() > 0, "{said}");
    }
    let said = serde_json::from_str(&said).unwrap();
    (child, stdout, said)
}

#[cfg(unix)]
#[test]
fn the_command_says_where_it_listens_and_ends_on_an_interrupt() {
    let folder = tempfile::tempdir().unwrap();
    let (mut child, mut stdout, said) = started(folder.path());
    let port = said["port"].as_u64().unwrap();
    let address = SocketAddr::from(([127, 0, 0, 1], port as u16));
    assert_eq!(said["base_url"], format!("http://127.0.0.1:{port}/v1"));
    assert_eq!(
        send(address, "GET", "/v1/models", "").1["data"][0]["id"],
        said["model"]
    );
    let taken = finish(fabc(folder.path()).args(["serve", "--port", &port.to_string()]));
    assert_eq!(taken.code, 2, "{}", taken.stderr);
    assert!(
        taken.stderr.contains("`--port 0` takes any free port"),
        "{}",
        taken.stderr
    );
    interrupt(child.id());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let mut rest = String::new();
    stdout.read_to_string(&mut rest).unwrap();
    assert_eq!(rest, "", "stdout is one document");
    let mut talk = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut talk)
        .unwrap();
    assert_eq!(talk.lines().count(), 1, "{talk}");
}

#[test]
#[ignore = "long"]
fn a_recording_is_served_to_a_whole_rollout() {
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_triangle.fab");
    let run = |more: &[&str]| {
        let said = finish(fabc(folder.path()).args(["run", &task]).args(more));
        assert_eq!(said.code, 0, "{}", said.stderr);
    };
    run(&["--out", "recorded", "--record", "recording.jsonl"]);
    let (mut child, _stdout, said) = started_with(folder.path(), "replay:recording.jsonl");
    let (base_url, name) = (
        said["base_url"].as_str().unwrap(),
        said["model"].as_str().unwrap(),
    );
    let model = format!("compatible:{name}");
    run(&[
        "--out",
        "served",
        "--no-cache",
        "--allow-unknown-price",
        "--model",
        &model,
        "--base-url",
        base_url,
    ]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(
        actions(&folder.path().join("served")),
        actions(&folder.path().join("recorded"))
    );
}

#[test]
fn the_command_lends_no_model_of_a_provider() {
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "openai:gpt-6.2-sol",
        "ollama:any",
        "nobody:any",
        "vision=openai:any",
    ] {
        let refused = finish(fabc(folder.path()).args(["serve", "--port", "0", "--model", name]));
        assert_eq!((refused.code, refused.stdout.as_str()), (64, ""), "{name}");
        for part in [name, "a provider's model", "`geometric`", "`replay:FILE`"] {
            assert!(refused.stderr.contains(part), "{}", refused.stderr);
        }
    }
    let help = finish(fabc(folder.path()).args(["serve", "--help"]));
    assert!(
        help.stdout.contains("an embedded model or a recording"),
        "{}",
        help.stdout
    );
    assert!(!help.stdout.contains("PROVIDER"), "{}", help.stdout);
}

/// Runs a script of `tests/peers` with the served stand-in and the pictures of a rendered stage.
fn peer(script: &str) {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let folder = tempfile::tempdir().unwrap();
    let task = project("tasks/double_triangle.fab");
    let rendered =
        finish(fabc(folder.path()).args(["render", &task, "--out", "rendered", "--json"]));
    assert_eq!(rendered.code, 0, "{}", rendered.stderr);
    std::fs::write(folder.path().join("rendered.json"), rendered.stdout).unwrap();
    let (mut child, _stdout, said) = started(folder.path());
    let output = Command::new(python)
        .current_dir(folder.path())
        // Nothing but the server can be reached.
        .envs([
            ("HTTP_PROXY", "http://127.0.0.1:9"),
            ("HTTPS_PROXY", "http://127.0.0.1:9"),
            ("NO_PROXY", "127.0.0.1"),
        ])
        .env("HOME", folder.path())
        .arg(project(&format!("tests/peers/{script}")))
        .args([
            said["base_url"].as_str().unwrap(),
            "rendered.json",
            "rendered",
        ])
        .output();
    child.kill().unwrap();
    child.wait().unwrap();
    let output = output.unwrap();
    assert!(
        output.status.success(),
        "{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
#[ignore = "needs Python with the openai package"]
fn peer_the_official_openai_client_parses_every_answer_stream_and_refusal() {
    peer("openai_client.py");
}

#[test]
#[ignore = "needs Python with the inspect_ai package"]
fn peer_an_evaluator_of_others_finishes_with_a_log_of_the_answers() {
    peer("inspect_eval.py");
}

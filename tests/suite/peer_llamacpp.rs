//! llama.cpp's own server, with tiny models of random weights: answers to words and to a picture, and the failures that it
//! words itself. It is started with the line that `fabc doctor` prints; a script stands in for the program `llama-server`,
//! because PyPI has the server only as a library.

use super::support::{fabc, finish, project};
use fab_base::interrupt::Interrupt;
use fab_model::calls::{Budget, Fault, Ledger};
use fab_model::{Message, Model, ModelError, Part, Png, Request, Speaker};
use fab_program::pointing::Notation;
use fab_program::{ModelRole, PixelPoint, Read, Value, reply};
use fab_providers::Remote;
use fab_providers::catalogue::Catalogue;
use fab_providers::remote::{Answers, BaseUrl, Gate, Key, Retry, Settings, Shared, Wire};
use serde_json::json;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

/// The key that the server wants.
const KEY: &str = "sk-fabc-peer-test-0123456789abcdef";

/// A server, which ends with its input.
struct Server {
    process: Child,
    address: String,
}

impl Server {
    /// Starts a server with a line, in a folder with the models.
    fn start(folder: &Path, line: &str) -> Server {
        let log = fs::File::create(folder.join("server.log")).unwrap();
        let path = std::env::var("PATH").unwrap_or_default();
        let mut process = Command::new("sh")
            .args(["-c", &format!("exec {line} --port 0 --api-key {KEY}")])
            .env("PATH", format!("{}:{path}", folder.display()))
            .current_dir(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(process.stdout.take().unwrap())
            .read_line(&mut address)
            .unwrap();
        let address = address.trim().to_owned();
        let log = fs::read_to_string(folder.join("server.log")).unwrap_or_default();
        assert!(address.starts_with("http://"), "{line}: {log}");
        Server { process, address }
    }

    /// Asks once, below a path of the server.
    fn ask(&self, path: &str, key: Option<&str>, request: &Request) -> Result<String, ModelError> {
        let base = BaseUrl::parse(&format!("{}{path}", self.address)).unwrap();
        let mut settings = Settings {
            key: key.map(|key| Key::new("FABC_LLAMACPP_KEY", key).unwrap()),
            retry: Retry {
                calls: 1,
                ..Retry::default()
            },
            ..Settings::new("llamacpp", "MODEL.gguf", Wire::OpenaiChat, base)
        };
        settings.profile.provider.key_env = vec!["FABC_LLAMACPP_KEY".to_owned()];
        let shared = Shared {
            gate: Arc::new(Gate::new(1)),
            answers: Arc::new(Answers::none()),
            interrupt: Interrupt::default(),
            tell: Arc::new(|_| {}),
            hidden: Vec::new(),
        };
        let model = Remote::new(settings, shared).unwrap();
        model
            .ask(request, &mut Ledger::unwritten(&Budget::default()))
            .map(|reply| reply.text)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Writes the models into a folder, and a program `llama-server`.
fn prepare(folder: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let script = project("tests/peers/llamacpp_server.py");
    let output = Command::new(&python)
        .args([&script, "write"])
        .arg(folder)
        .output();
    let output = output.unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let program = folder.join("llama-server");
    fs::write(
        &program,
        format!("#!/bin/sh\nexec '{python}' '{script}' serve \"$@\"\n"),
    )
    .unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
}

/// Asks with the schemas of a shipped task, by default: whatever random weights draw, an answer that was not cut off states
/// offered values.
fn assert_offered_values_alone(server: &Server) {
    let program = super::support::task("double_straight");
    let point = |u| Value::Point(PixelPoint { u, v: 41 });
    let offered: Vec<(String, Vec<Value>)> = program
        .actions
        .iter()
        .map(|field| (field.name.clone(), vec![point(41), point(182)]))
        .collect();
    let (mut n_actions, mut n_texts) = (0, 0);
    for repetition in 0..12 {
        for stage in &program.stages {
            let schema = reply::for_stage(&program, stage, &Notation::pixels(), &offered);
            // Another question each time, since the server draws the same for the same one.
            let words = format!("fold it, number {repetition}");
            let messages = vec![Message::text(Speaker::User, words)];
            let request = Request {
                max_tokens: Some(1500),
                temperature: Some(1.0),
                schema: Some(schema.clone()),
                ..Request::new(ModelRole::Text, messages)
            };
            let text = match server.ask("/v1", Some(KEY), &request) {
                Ok(text) => text,
                Err(ModelError::Failed {
                    fault: Fault::Truncated,
                    ..
                }) => continue,
                Err(error) => panic!("{error}"),
            };
            let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
            let names: Vec<&String> = answer.as_object().unwrap().keys().collect();
            match stage.read {
                Read::Text { .. } => {
                    assert_eq!(names, ["instructions"]);
                    n_texts += 1;
                }
                Read::Action => {
                    assert_eq!(names, ["reason", "pick", "place"]);
                    for name in ["pick", "place"] {
                        let values = schema["properties"][name]["enum"].as_array().unwrap();
                        assert!(values.contains(&answer[name]), "{text}");
                    }
                    let read = reply::read_action(&program, &text).unwrap();
                    assert_eq!(read.repairs, [""; 0], "{text}");
                    n_actions += 1;
                }
            }
        }
    }
    assert!(
        n_actions >= 3 && n_texts >= 3,
        "{n_actions} and {n_texts} were whole"
    );
}

#[test]
#[ignore = "needs llama.cpp from PyPI"]
fn peer_llamacpp_answers_and_its_failures_are_understood() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let catalogue = Catalogue::builtin();
    let mut providers = catalogue.providers().iter();
    let llamacpp = providers
        .find(|provider| provider.name == "llamacpp")
        .unwrap();
    let line = llamacpp.start.as_ref().unwrap();
    let question = |text: &str| {
        let messages = vec![Message::text(Speaker::User, text)];
        Request {
            max_tokens: Some(64),
            // A drawn token may be the end of the text, where the answer must be cut off.
            temperature: Some(0.0),
            ..Request::new(ModelRole::Text, messages)
        }
    };

    // Random weights say nothing of sense, unless a schema leaves them no choice.
    let mut bound = question("fold it");
    bound.schema = Some(json!({
        "type": "object",
        "properties": { "pick": { "const": "left" } },
        "required": ["pick"],
        "additionalProperties": false,
    }));
    let picture = Png::new(fab_picture::png::encode(&image::RgbImage::new(224, 224)));
    let mut shown = bound.clone();
    shown.messages[0].parts.push(Part::Image(picture));
    let server = Server::start(folder.path(), line);
    for request in [&bound, &shown] {
        let text = server.ask("/v1", Some(KEY), request).unwrap();
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(answer, json!({ "pick": "left" }));
    }
    assert_offered_values_alone(&server);
    drop(server);

    let server = Server::start(folder.path(), "llama-server --model MODEL.gguf");
    for (path, key, request, fault, words) in [
        (
            "/v1",
            Some(KEY),
            &question("fold it"),
            Fault::Truncated,
            "cut off",
        ),
        (
            "/v1",
            Some(KEY),
            &shown,
            Fault::BadRequest,
            "takes no pictures as it is served",
        ),
        (
            "/v1",
            Some(KEY),
            &question(&"x".repeat(9000)),
            Fault::BadRequest,
            "longer than the model's context",
        ),
        (
            "/v1",
            Some("sk-another-key"),
            &question("fold it"),
            Fault::NotAuthorised,
            "does not accept the key from `FABC_LLAMACPP_KEY`",
        ),
        (
            "/v1",
            None,
            &question("fold it"),
            Fault::NotAuthorised,
            "no key was sent, since `FABC_LLAMACPP_KEY` is not set",
        ),
        (
            "/llm",
            Some(KEY),
            &question("fold it"),
            Fault::BadRequest,
            "its interface lies elsewhere",
        ),
    ] {
        let error = server.ask(path, key, request).unwrap_err();
        let ModelError::Failed {
            fault: found, why, ..
        } = &error
        else {
            panic!("{error}");
        };
        assert_eq!(*found, fault, "{why}");
        assert!(why.contains(words), "{why}");
        assert!(!why.contains("sk-"), "{why}");
    }

    let facts = format!(
        "[[provider]]\nname = \"llamacpp\"\nbase_url = \"{}/v1\"\nas_of = \"2027-01-01\"\nsource = \"us\"\n",
        server.address
    );
    fs::write(folder.path().join("facts.toml"), facts).unwrap();
    for (key, line) in [
        (None, "missing  llamacpp: answers at http://127.0.0.1:"),
        (
            Some(KEY),
            "ready    llamacpp: serves MODEL.gguf at http://127.0.0.1:",
        ),
    ] {
        let mut doctor = fabc(folder.path());
        doctor
            .env("XDG_CONFIG_HOME", folder.path())
            .env("FABC_CACHE_DIR", folder.path())
            .args(["doctor", "--models", "facts.toml"]);
        if let Some(key) = key {
            doctor.env("FABC_LLAMACPP_KEY", key);
        }
        let said = finish(&mut doctor);
        assert!(said.stdout.contains(line), "{}", said.stdout);
    }
}

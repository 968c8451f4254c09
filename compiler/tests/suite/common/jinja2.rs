//! Python's jinja2 as a peer, with the settings for which templates are written.

#![allow(dead_code, clippy::unwrap_used)]

use serde_json::Value;
use std::io::Write;
use std::process::{Command, Stdio};

/// The Python program that renders its input: a JSON list of `[template, values]` in, a list of texts out.
const PEER: &str = "
import json, sys, jinja2
environment = jinja2.Environment(undefined=jinja2.StrictUndefined, keep_trailing_newline=True, autoescape=False)
print(json.dumps([environment.from_string(text).render(**values) for text, values in json.load(sys.stdin)]))
";

/// Renders each `[template, values]`.
pub fn rendered(asked: &[Value]) -> Vec<String> {
    let python = std::env::var_os("FABC_PEER_PYTHON").expect("make test-all names a Python");
    let mut peer = Command::new(python)
        .args(["-c", PEER])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = peer.stdin.take().unwrap();
    stdin
        .write_all(&serde_json::to_vec(asked).unwrap())
        .unwrap();
    drop(stdin);
    let answered = peer.wait_with_output().unwrap();
    assert!(answered.status.success());
    let answers: Vec<String> = serde_json::from_slice(&answered.stdout).unwrap();
    assert_eq!(answers.len(), asked.len());
    answers
}

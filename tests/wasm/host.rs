//! Builds the WebAssembly module and calls it in node; the tests of two packages include this file.

use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// Calls a function of the module with JSON, and returns its answer.
///
/// - `root`: the checkout.
/// - `target`: a folder for the build, which the tests share.
pub fn call(root: &Path, target: &Path, function: &str, input: &Value) -> Value {
    let folder = target.join("wasm");
    let built = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned()))
        .args(["build", "--locked", "--target", "wasm32-unknown-unknown"])
        .arg("--manifest-path")
        .arg(root.join("tests/wasm/Cargo.toml"))
        .arg("--target-dir")
        .arg(&folder)
        .status();
    assert!(built.unwrap().success());
    let mut node = Command::new("node")
        .arg(root.join("tests/wasm/call.mjs"))
        .arg(folder.join("wasm32-unknown-unknown/debug/fabc_wasm.wasm"))
        .arg(function)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let input = input.to_string();
    node.stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    let output = node.wait_with_output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

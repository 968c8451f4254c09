//! The compiler gives the same bytes in WebAssembly.
//!
//! `make test-all` runs this if node and the standard library of wasm32-unknown-unknown are available
//! (scripts/wasm-parts.sh).

use crate::common::{Memory, workspace};
use fab_compiler::diag;
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Builds the module and returns its file.
fn module() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wasm");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let status = Command::new(cargo)
        .args(["build", "--locked", "--target", "wasm32-unknown-unknown"])
        .arg("--manifest-path")
        .arg(workspace().join("tests/wasm/Cargo.toml"))
        .arg("--target-dir")
        .arg(&folder)
        .status()
        .unwrap();
    assert!(status.success());
    folder.join("wasm32-unknown-unknown/debug/fabc_wasm.wasm")
}

fn in_node(module: &Path, entry: &str, files: &Memory) -> Value {
    let mut node = Command::new("node")
        .arg(workspace().join("tests/wasm/compile.mjs"))
        .arg(module)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let input = json!({ "entry": entry, "files": files.0 }).to_string();
    node.stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    let output = node.wait_with_output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

fn here(entry: &str, files: &Memory) -> Value {
    let compiled = fab_compiler::compile(entry, files).unwrap();
    json!({
        "programs": compiled.programs,
        "diagnostics": diag::to_json(&compiled.diagnostics, &compiled.sources),
    })
}

#[test]
#[ignore = "needs node and the standard library of wasm32-unknown-unknown"]
fn peer_node_compiles_in_webassembly_what_is_compiled_here() {
    let module = module();
    let read = |name: &str| fs::read_to_string(workspace().join("tasks").join(name)).unwrap();
    let names = ["double_straight.fab", "lib/folding.fab", "lib/experts.fab"];
    let shipped = Memory(names.map(|name| (name.to_owned(), read(name))).into());
    let compiled = here(names[0], &shipped);
    // The task, and its ablations.
    assert_eq!(compiled["programs"][0]["task"], "double_straight");
    assert!(compiled["programs"].as_array().unwrap().len() > 1);
    assert_eq!(in_node(&module, names[0], &shipped), compiled);
    // The deepest nesting must fit its stack too; pest's own guard does not work there.
    let open = fab_grammar::MAX_NESTING - 3;
    let deep = format!(
        "task t {{ verify {{ check c {{ {}a{} }} else \"x\" }} }}\n",
        "(".repeat(open),
        ")".repeat(open)
    );
    let deepest = Memory::of([("deep.fab", &deep)]);
    assert_eq!(
        in_node(&module, "deep.fab", &deepest),
        here("deep.fab", &deepest)
    );
}

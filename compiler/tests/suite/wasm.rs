//! The compiler gives the same bytes in WebAssembly.
//!
//! `make test-all` runs this if node and the standard library of wasm32-unknown-unknown are available
//! (scripts/wasm-parts.sh).

#[path = "../../../tests/wasm/host.rs"]
mod host;

use crate::common::{Memory, workspace};
use fab_compiler::diag;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

fn in_node(entry: &str, files: &Memory) -> Value {
    let input = json!({ "entry": entry, "files": files.0 });
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    host::call(&workspace(), target, "compile", &input)
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
    let read = |name: &str| fs::read_to_string(workspace().join("tasks").join(name)).unwrap();
    let names = ["double_straight.fab", "lib/folding.fab", "lib/experts.fab"];
    let shipped = Memory(names.map(|name| (name.to_owned(), read(name))).into());
    let compiled = here(names[0], &shipped);
    // The task, and its ablations.
    assert_eq!(compiled["programs"][0]["task"], "double_straight");
    assert!(compiled["programs"].as_array().unwrap().len() > 1);
    assert_eq!(in_node(names[0], &shipped), compiled);
    // The deepest nesting must fit its stack too; pest's own guard does not work there.
    let open = fab_grammar::MAX_NESTING - 3;
    let deep = format!(
        "task t {{ verify {{ check c {{ {}a{} }} else \"x\" }} }}\n",
        "(".repeat(open),
        ")".repeat(open)
    );
    let deepest = Memory::of([("deep.fab", &deep)]);
    assert_eq!(in_node("deep.fab", &deepest), here("deep.fab", &deepest));
}

//! Tests against foreign programs; `make test-peers` runs them.

use super::support::{fabc, finish, project};
use std::process::Command;

#[test]
#[ignore = "needs Python with numpy: make test-peers"]
fn peer_python_recomputes_the_printed_error_from_the_journal() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-peers sets FABC_PEER_PYTHON");
    let folder = tempfile::tempdir().unwrap();
    let said = finish(fabc(folder.path()).args([
        "run",
        &project("tasks/double_triangle.fab"),
        "--json",
        "--out",
        "run",
    ]));
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    let output = Command::new(python)
        .arg(project("tests/peers/recompute_error.py"))
        .arg(folder.path().join("run"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let recomputed: f64 = String::from_utf8(output.stdout)
        .unwrap()
        .trim()
        .parse()
        .unwrap();
    let printed = report["mean_particle_distance_mm"].as_f64().unwrap();
    assert!(
        (recomputed - printed).abs() < 1e-6,
        "Python has {recomputed}, fabc printed {printed}"
    );
}

//! Tests against third-party programs; `make test-all` runs them.

use super::support::{bring_library, fabc, finish, project};
use fab_agent::record::Record;
use std::io::Write;
use std::process::Command;
use std::time::Instant;

#[test]
#[ignore = "needs Python with numpy"]
fn peer_python_recomputes_the_printed_error_from_the_journal() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
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

/// Checks MuJoCo's final cloth: its silhouette against the subgoal's, and its distance from the bundled cloth.
#[test]
#[ignore = "needs Python with mujoco"]
fn peer_mujoco_folds_double_triangle_as_a_world_in_another_language() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let folder = tempfile::tempdir().unwrap();
    let world = format!(
        "exec:'{python}' '{}'",
        project("docs/examples/mujoco_world.py")
    );
    let task = project("tasks/double_triangle.fab");
    let begun = Instant::now();
    let said = finish(fabc(folder.path()).args(["run", &task, "--world", &world, "--out", "run"]));
    assert!([0, 3].contains(&said.code), "{}", said.stderr);
    let seconds = begun.elapsed().as_secs_f64();
    let record = Record::read(&folder.path().join("run")).unwrap();
    assert_eq!(record.header.world, "mujoco");
    let last = record.steps.last().unwrap().result.unwrap();
    assert!(last.subgoal == 2 && last.overlap >= 0.85, "{last:?}");
    let report = record.end.unwrap().report;
    let judged_by = report.judged_by.unwrap();
    assert_eq!(
        (judged_by.world.as_str(), judged_by.grid),
        ("sim", [55, 55])
    );
    let distance_mm = report.mean_particle_distance_mm.unwrap();
    // Written past the test's output capture: how close another simulator comes is always of interest.
    let figures = format!(
        "MuJoCo's cloth ends {distance_mm:.1} mm from the bundled cloth's, overlaps the subgoal by {:.3}, after {seconds:.0} s\n",
        last.overlap
    );
    std::io::stderr().write_all(figures.as_bytes()).unwrap();
    assert!(distance_mm < 40.0, "{figures}");
}

#[test]
#[ignore = "needs Python with mujoco"]
fn peer_mujoco_keeps_the_promises_of_every_world() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let folder = tempfile::tempdir().unwrap();
    let world = format!(
        "exec:'{python}' '{}'",
        project("docs/examples/mujoco_world.py")
    );
    let said = finish(fabc(folder.path()).args(["world", "check", &world]));
    assert_eq!(said.code, 0, "{}{}", said.stdout, said.stderr);
}

/// What the page of policies teaches: random pulls, the script's fit, and a rollout with the file that it wrote.
#[test]
#[ignore = "needs Python with jax and onnxruntime"]
fn peer_jax_fits_a_network_to_stored_pulls_and_fabc_plays_it() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let folder = tempfile::tempdir().unwrap();
    bring_library(folder.path());
    let short = "use \"lib/smoothing.fab\"\n\ntask short extends smoothing_by_corners {
    cloth   grid(42, 42, start: crumpled)\n    goal    normalized_improvement > 0.95\n    horizon 5\n}\n";
    std::fs::write(folder.path().join("short.fab"), short).unwrap();
    let run = |policy: &str, start: &str, out: &str| {
        let arguments = [
            "run",
            "short.fab",
            "--policy",
            policy,
            "--start",
            start,
            "--out",
            out,
        ];
        let said = finish(fabc(folder.path()).args(arguments));
        assert!([0, 3].contains(&said.code), "{}", said.stderr);
    };
    for start in ["0", "1", "2"] {
        run("random:1", start, &format!("pulls/{start}"));
    }
    let fitted = Command::new(python)
        .arg(project("scripts/smoother/fit.py"))
        .args(["pulls", "own.onnx"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&fitted.stdout);
    let why = String::from_utf8_lossy(&fitted.stderr);
    assert!(fitted.status.success(), "{why}");
    assert!(
        printed.contains("by random policy, seed 1) from 3 starts of short;"),
        "{printed}"
    );
    run("onnx:own.onnx", "3", "own");
    let record = Record::read(&folder.path().join("own")).unwrap();
    assert_eq!(record.steps.len(), 5);
}

//! A start with another cloth than the task's: everything that depends on the cloth then follows the start.

use super::bad_starts::write_npy;
use super::support::{fabc, finish, project};
use serde_json::Value;
use std::path::Path;

/// Runs the steered task, with distances in `edge`, from a flat start of that grid; returns the recorded program.
fn kept_program(folder: &Path, [dimx, dimy]: [u32; 2]) -> Value {
    let text = std::fs::read_to_string(project("tests/fixtures/tasks/steered.fab")).unwrap();
    let text = text
        .replace("10mm, 20mm, 40mm", "0.1edge, 0.2edge, 0.5edge")
        .replace("Distance = 10 mm", "Distance = 0.1 edge");
    std::fs::write(folder.join("task.fab"), text).unwrap();
    let body: Vec<u8> = (0..dimx * dimy)
        .flat_map(|index| {
            let right = 0.00625 * ((index % dimx) as f32 - dimx as f32 / 2.0);
            let back = 0.00625 * (dimy as f32 / 2.0 - (index / dimx) as f32);
            [right, back, 0.005]
        })
        .flat_map(f32::to_le_bytes)
        .collect();
    let start = folder.join("start.npy");
    write_npy(&start, "<f4", &format!("({}, 3)", dimx * dimy), &body);
    let dims = format!("{dimx}x{dimy}");
    let mut command = fabc(folder);
    command.args(["run", "task.fab", "--out", "run", "--start", "start.npy"]);
    // The compiled program is recorded however the rollout ends.
    let said = finish(command.args(["--dims", &dims, "--up", "z", "--json"]));
    assert!(![1, 64].contains(&said.code), "{}", said.stderr);
    let report: Value = serde_json::from_str(&said.stdout).unwrap();
    let program = std::fs::read_to_string(folder.join("run/program.json")).unwrap();
    let program: Value = serde_json::from_str(&program).unwrap();
    let flat = report["coverage_true_at_start"].as_f64().unwrap();
    assert!((flat - 1.0).abs() < 1e-4, "{flat}");
    program
}

#[test]
fn lengths_in_edge_and_coverage_are_those_of_the_start() {
    for grid in [[17, 17], [21, 13], [9, 15]] {
        let folder = tempfile::tempdir().unwrap();
        let program = kept_program(folder.path(), grid);
        assert_eq!(program["cloth"]["dimx"], grid[0]);
        assert_eq!(program["cloth"]["dimy"], grid[1]);
        let edge_m = 0.00625 * f64::from(grid[0].max(grid[1]) - 1);
        let choices = &program["actions"][2]["choices"]["choices"];
        let half_m = choices[2]["m"].as_f64().unwrap();
        assert!((half_m - 0.5 * edge_m).abs() < 1e-12, "{half_m}");
    }
}

#[test]
fn a_start_that_is_too_large_for_a_cloth_is_told_with_its_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(project("tests/fixtures/tasks/steered.fab")).unwrap();
    std::fs::write(folder.path().join("task.fab"), text).unwrap();
    let body: Vec<u8> = (0..201 * 2)
        .flat_map(|index| {
            [
                0.00625 * (index % 201) as f32,
                0.00625 * (index / 201) as f32,
                0.005,
            ]
        })
        .flat_map(f32::to_le_bytes)
        .collect();
    write_npy(&folder.path().join("start.npy"), "<f4", "(402, 3)", &body);
    let mut command = fabc(folder.path());
    command.args(["run", "task.fab", "--start", "start.npy"]);
    let said = finish(command.args(["--dims", "201x2", "--up", "z"]));
    assert_eq!(said.code, 1, "{}", said.stderr);
    assert!(said.stderr.contains("201 by 2"), "{}", said.stderr);
    assert!(!folder.path().join("runs").exists());
}

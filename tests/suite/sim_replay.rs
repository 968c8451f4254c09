//! `sim replay` through the command itself: a small fold, and one recorded demonstration of each task.

use super::bad_starts::write_npy;
use super::sim_verbs::told;
use crate::recorded_data::recorded_data;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A flat cloth in the recorded frame (y up), as bytes.
pub(super) fn flat(dimx: usize, dimy: usize) -> Vec<u8> {
    let point = |index: usize| {
        let (ix, iy) = (index % dimx, index / dimx);
        [0.00625 * ix as f32, 0.005, 0.00625 * iy as f32]
    };
    (0..dimx * dimy)
        .flat_map(point)
        .flat_map(f32::to_le_bytes)
        .collect()
}

/// A recorded data set of one small fold that ends as it began; a test damages it.
pub(super) fn data_set(folder: &Path) -> Value {
    let entry = folder.join("set/Fold/00");
    fs::create_dir_all(&entry).unwrap();
    for name in ["init_pos.npy", "final_pos.npy"] {
        write_npy(&entry.join(name), "<f4", "(80, 3)", &flat(10, 8));
    }
    let manifest = json!({ "entries": [{
        "task": "Fold", "id": 0, "dir": "set/Fold/00",
        "dimx": 10, "dimy": 8, "spacing_m": 0.00625,
        "steps": [{
            "pick_world_m": [0.0, 0.005, 0.0],
            "place_world_m": [0.02, 0.005, 0.02],
            "pick_keypoint": 0,
        }],
    }]});
    write_manifest(folder, &manifest);
    manifest
}

pub(super) fn write_manifest(folder: &Path, manifest: &Value) {
    fs::write(folder.join("set/manifest.json"), manifest.to_string()).unwrap();
}

#[test]
fn a_replay_measures_how_far_the_cloth_ends_from_the_recorded_end() {
    let folder = tempfile::tempdir().unwrap();
    data_set(folder.path());
    let value = told(folder.path(), &["replay", "set"]);
    let entry = &value["entries"][0];
    assert_eq!(entry["grasped_as_recorded"], true, "{value}");
    assert!(entry["steps"].as_u64().unwrap() > 100);
    let error_mm = entry["error_mm"].as_f64().unwrap();
    // The recorded end is the start; the picker's sphere is as large as this cloth, and pushes it too.
    assert!((1.0..100.0).contains(&error_mm), "{error_mm} mm");
    let row =
        json!({ "task": "Fold", "n": 1, "mean_mm": error_mm, "sd_mm": 0.0, "max_mm": error_mm });
    assert_eq!(value["rows"], json!([row]));

    // With the simulated result as the recorded end, the error is zero.
    let grid = fab_sim::Grid::new(10, 8, 0.00625).unwrap();
    let start: Vec<[f32; 3]> = (0..80)
        .map(|index| {
            [
                0.00625 * (index % 10) as f32,
                -0.00625 * (index / 10) as f32,
                0.005,
            ]
        })
        .collect();
    let mut cloth =
        fab_sim::Simulator::from_positions(grid, &start, &fab_sim::Params::default()).unwrap();
    cloth
        .pick_and_place([0.0, 0.0], [0.02, -0.02], &|| false)
        .unwrap();
    let end: Vec<u8> = cloth
        .positions()
        .iter()
        .flat_map(|[x, y, z]| [*x, *z, -*y])
        .flat_map(f32::to_le_bytes)
        .collect();
    let path = folder.path().join("set/Fold/00/final_pos.npy");
    write_npy(&path, "<f4", "(80, 3)", &end);
    let value = told(folder.path(), &["replay", "set"]);
    assert_eq!(value["entries"][0]["error_mm"], 0.0, "{value}");
    assert_eq!(value["entries"][0]["digest"], cloth.digest());
}

#[test]
#[ignore = "long"]
fn a_replay_of_recorded_folds_is_equal_on_any_number_of_threads() {
    let test = "a_replay_of_recorded_folds_is_equal_on_any_number_of_threads";
    let Some(data) = recorded_data(test) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let set = data.join("folding120").display().to_string();
    let alone = told(
        folder.path(),
        &["replay", &set, "--ids", "10", "--threads", "1"],
    );
    let together = told(
        folder.path(),
        &["replay", &set, "--ids", "10", "--threads", "3"],
    );
    assert_eq!(alone, together);
    let rows = alone["rows"].as_array().unwrap();
    let names: Vec<&str> = rows
        .iter()
        .map(|row| row["task"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["AllCornersInward", "CornersEdgesInward", "DoubleStraight"]
    );
    for (row, limit_mm) in rows.iter().zip([3.0, 5.0, 35.0]) {
        assert_eq!(
            (row["n"].as_u64(), row["sd_mm"].as_f64()),
            (Some(1), Some(0.0))
        );
        assert!(row["mean_mm"].as_f64().unwrap() < limit_mm, "{row}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn only_the_tasks_and_ids_that_are_asked_for_are_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = data_set(folder.path());
    let entry = manifest["entries"][0].clone();
    manifest["entries"] = [("Roll", 3), ("Fold", 1), ("Fold", 2)]
        .map(|(task, id)| {
            let mut entry = entry.clone();
            entry["task"] = json!(task);
            entry["id"] = json!(id);
            entry
        })
        .into();
    write_manifest(folder.path(), &manifest);
    let replayed = |arguments: &[&str]| -> Vec<String> {
        let value = told(folder.path(), &[&["replay", "set"], arguments].concat());
        let entries = value["entries"].as_array().unwrap();
        let name = |entry: &Value| format!("{} {}", entry["task"].as_str().unwrap(), entry["id"]);
        entries.iter().map(name).collect()
    };
    assert_eq!(replayed(&[]), ["Roll 3", "Fold 1", "Fold 2"]);
    assert_eq!(replayed(&["--ids", "2,3"]), ["Roll 3", "Fold 2"]);
    assert_eq!(replayed(&["--task", "Fold"]), ["Fold 1", "Fold 2"]);
    assert_eq!(replayed(&["--task", "Fold", "--ids", "1"]), ["Fold 1"]);
}

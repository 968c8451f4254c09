//! The `sim` verbs through the command itself: small cloths, and one recorded demonstration of each task.

use super::bad_starts::write_npy;
use super::support::{Said, fabc, finish, project};
use crate::recorded_data::recorded_data;
use runtime::start::Start;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Runs a verb of `sim` to its end.
fn said(folder: &Path, arguments: &[&str]) -> Said {
    finish(fabc(folder).arg("sim").args(arguments))
}

/// Runs a verb of `sim` that succeeds, and returns its JSON.
fn told(folder: &Path, arguments: &[&str]) -> Value {
    let said = said(folder, &[arguments, &["--json"]].concat());
    assert_eq!(said.code, 0, "{arguments:?}\n{}", said.stderr);
    let value: Value = serde_json::from_str(&said.stdout).unwrap();
    assert_eq!(value["params"], sim::Params::default().hash(), "{value}");
    value
}

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

/// A recorded data set of one small fold, which ends as it began; a test spoils it.
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

    // What was simulated, recorded as the end, leaves no error.
    let grid = sim::Grid::new(10, 8, 0.00625).unwrap();
    let start: Vec<[f32; 3]> = (0..80)
        .map(|index| {
            [
                0.00625 * (index % 10) as f32,
                -0.00625 * (index / 10) as f32,
                0.005,
            ]
        })
        .collect();
    let mut cloth = sim::Simulator::from_positions(grid, &start, &sim::Params::default()).unwrap();
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
#[cfg(unix)]
fn an_interrupted_replay_keeps_what_is_finished() {
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().unwrap();
    let mut manifest = data_set(folder.path());
    let entry = manifest["entries"][0].clone();
    // Far more than can be done before the signal.
    manifest["entries"] = (0..5000).map(|_| entry.clone()).collect();
    write_manifest(folder.path(), &manifest);
    let mut command = fabc(folder.path());
    command.args(["sim", "replay", "set", "--json"]);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(1500));
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let n = value["entries"].as_array().unwrap().len();
    assert!(n < 5000, "{n} were replayed in a moment");
    assert_eq!(value["rows"].as_array().unwrap().len(), n.min(1));
}

#[test]
fn time_counts_steps_springs_and_memory_and_gives_equal_bits() {
    let folder = tempfile::tempdir().unwrap();
    let value = told(folder.path(), &["time", "--size", "25"]);
    // 10 up, 43 along a diagonal of 0.212 m, 10 down, 50 of settling.
    for (field, expected) in [
        ("particles", json!(625)),
        ("steps", json!(113)),
        ("substeps", json!(sim::Params::default().substeps)),
        ("constraints", json!(3502)),
        ("self_contact", json!(true)),
    ] {
        assert_eq!(value[field], expected, "`{field}` of {value}");
    }
    for field in ["cpu_ms_per_step", "wall_ms_per_step", "peak_mb"] {
        assert!(value[field].as_f64().unwrap() > 0.0, "`{field}` of {value}");
    }
    let two = told(folder.path(), &["time", "--size", "25", "--threads", "2"]);
    assert_eq!(two["digest"], value["digest"]);
    assert_eq!(value["digest"].as_str().unwrap().len(), 64);
}

#[test]
fn crumpled_cloths_are_starts_and_the_same_again() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let call = [
        "crumple", "--dims", "12x10", "--seed", "5", "--count", "3", "-o", "starts",
    ];
    let value = told(here, &call);
    let starts = value["starts"].as_array().unwrap();
    let seeds: Vec<u64> = starts
        .iter()
        .map(|it| it["seed"].as_u64().unwrap())
        .collect();
    assert_eq!(seeds, [5, 6, 7]);
    let covered: Vec<f64> = starts
        .iter()
        .map(|it| it["coverage"].as_f64().unwrap())
        .collect();
    let mean = covered.iter().sum::<f64>() / 3.0;
    assert_eq!(value["coverage"]["mean"].as_f64(), Some(mean));
    assert_eq!(
        value["coverage"]["max"].as_f64(),
        covered.iter().copied().reduce(f64::max)
    );
    // Read back as any start is, by the description beside it.
    for start in starts {
        let read = Start::load(&here.join(start["file"].as_str().unwrap()), None).unwrap();
        assert_eq!((read.grid.dimx, read.grid.dimy), (12, 10));
        assert_eq!(start["digest"], read.digest());
        assert_eq!(
            runtime::metrics::coverage(&read.positions, &read.grid),
            start["coverage"].as_f64()
        );
    }
    let bytes = fs::read(here.join("starts/crumpled_12x10_6.npy")).unwrap();
    assert_eq!(told(here, &call), value);
    assert_eq!(
        fs::read(here.join("starts/crumpled_12x10_6.npy")).unwrap(),
        bytes
    );
    // One seed alone, and nothing kept.
    let alone = told(here, &["crumple", "--dims", "12,10", "--seed", "6"]);
    assert_eq!(alone["starts"][0]["digest"], starts[1]["digest"]);
    assert_eq!(alone["starts"][0]["file"], Value::Null);
}

#[test]
fn a_start_of_somebody_else_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("crumpled_6x6_0.npy"), "mine").unwrap();
    let said = said(here, &["crumple", "--size", "6", "-o", "."]);
    assert_eq!(said.code, 2, "{}", said.stdout);
    assert!(
        said.stderr.contains("crumpled_6x6_0.npy` is there already"),
        "{}",
        said.stderr
    );
    assert_eq!(fs::read(here.join("crumpled_6x6_0.npy")).unwrap(), b"mine");
}

/// Writes a flat cloth of 40 by 30 particles, its middle at the table's centre, as positions with z up.
fn flat_state(folder: &Path) {
    let positions: Vec<u8> = (0..1200)
        .flat_map(|index| {
            let (ix, iy) = (index % 40, index / 40);
            [
                0.00625 * (ix as f32 - 19.5),
                0.00625 * (14.5 - iy as f32),
                0.005,
            ]
        })
        .flat_map(f32::to_le_bytes)
        .collect();
    write_npy(&folder.join("state.npy"), "<f4", "(1200, 3)", &positions);
    let frame = json!({ "dimx": 40, "dimy": 30, "spacing_m": 0.00625, "up": "z" });
    fs::write(folder.join("state.json"), frame.to_string()).unwrap();
}

#[test]
fn the_cameras_draw_colour_and_depth() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    flat_state(here);
    let value = told(here, &["render", "state.npy"]);
    assert_eq!(
        (&value["file"], &value["size_px"]),
        (&json!("state.png"), &json!(224))
    );
    let picture = runtime::picture::load(&here.join("state.png")).unwrap();
    let top = sim::Look::default().top;
    // 39 by 29 spacings, 6.25 mm each, seen from 0.645 m: 102.2 by 76.0 pixels.
    let orange = |picture: &image::RgbImage, at: [u32; 2]| picture.get_pixel(at[0], at[1]).0 == top;
    assert!(
        orange(&picture, [112, 112]) && orange(&picture, [63, 112]) && orange(&picture, [112, 76])
    );
    assert!(!orange(&picture, [59, 112]) && !orange(&picture, [112, 72]));
    let cloth_px = value["cloth_px"].as_f64().unwrap();
    assert!((cloth_px / (102.2 * 76.0) - 1.0).abs() < 0.02, "{cloth_px}");

    // The smoothing camera has the cloth's long side upright.
    let value = told(
        here,
        &[
            "render",
            "state.npy",
            "--camera",
            "smoothing",
            "-o",
            "s.png",
        ],
    );
    assert_eq!(value["size_px"], 720);
    let picture = runtime::picture::load(&here.join("s.png")).unwrap();
    assert!(orange(&picture, [360, 270]) && !orange(&picture, [270, 360]));

    told(
        here,
        &[
            "render",
            "state.npy",
            "--depth",
            "--size",
            "64",
            "-o",
            "d.png",
        ],
    );
    let picture = runtime::picture::load(&here.join("d.png")).unwrap();
    assert_eq!(picture.dimensions(), (64, 64));
    // The whole part of 255 times 0.65 m, and times 0.645 m.
    assert_eq!(
        (picture.get_pixel(0, 0).0, picture.get_pixel(32, 32).0),
        ([165; 3], [164; 3])
    );
}

#[test]
fn exported_positions_are_a_start_in_the_world_frame() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_npy(&here.join("recorded.npy"), "<f4", "(80, 3)", &flat(10, 8));
    let call = [
        "export",
        "recorded.npy",
        "--dims",
        "10x8",
        "--up",
        "y",
        "-o",
        "world.npy",
    ];
    let value = told(here, &call);
    assert_eq!(value["files"], json!(["world.npy", "world.json"]));
    let read = Start::load(&here.join("world.npy"), None).unwrap();
    assert_eq!((read.grid.dimx, read.grid.dimy), (10, 8));
    assert_eq!(read.positions[0], [0.0, 0.0, 0.005]);
    assert_eq!(read.positions[79], [9.0 * 0.00625, -7.0 * 0.00625, 0.005]);
    // Its own files are replaced, and those of others are not.
    told(here, &call);
    fs::write(here.join("world.json"), "{}").unwrap();
    let refused = said(here, &call);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("`world.json` is there already"),
        "{}",
        refused.stderr
    );
    assert_eq!(fs::read(here.join("world.json")).unwrap(), b"{}");
}

#[test]
fn every_verb_of_the_simulator_is_in_its_guide_and_in_the_readme() {
    let folder = tempfile::tempdir().unwrap();
    let help = said(folder.path(), &["--help"]).stdout;
    let guide = fs::read_to_string(project("docs/simulator.md")).unwrap();
    let readme = fs::read_to_string(project("README.md")).unwrap();
    for verb in ["replay", "time", "crumple", "render", "export"] {
        assert!(
            help.contains(&format!("\n  {verb} ")),
            "no `{verb}` in\n{help}"
        );
        let heading = format!("\n## `fabc sim {verb}");
        assert!(guide.contains(&heading), "no `{verb}` in docs/simulator.md");
        assert!(
            readme.contains(&format!("`fabc sim {verb}")),
            "no `{verb}` in README.md"
        );
    }
}

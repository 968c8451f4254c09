//! Bad input to the `sim` verbs: one message with the value and what would be right, the documented exit code.

use super::bad_input::refused;
use super::bad_starts::write_npy;
use super::sim_replay::{data_set, flat, write_manifest};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Checks that a `sim` verb refuses its input.
fn sim_refused(folder: &Path, call: &str, code: i32, words: &[&str]) {
    let arguments: Vec<&str> = std::iter::once("sim").chain(call.split(' ')).collect();
    refused(folder, &arguments, code, words);
}

#[test]
fn numbers_that_no_cloth_or_machine_has() {
    let folder = tempfile::tempdir().unwrap();
    data_set(folder.path());
    fs::write(folder.path().join("9x9.txt"), "#########\n".repeat(9)).unwrap();
    for (call, words) in [
        ("time --size 24", &["24", "25..=200"][..]),
        ("time --size 201", &["201", "25..=200"]),
        ("time --threads 0", &["0", "1..=256"]),
        ("replay set --threads 0", &["0", "1..=256"]),
        ("replay set --threads 257", &["257", "1..=256"]),
        ("replay set --ids 0,7,9", &["these ids: `7`, `9`"]),
        ("replay set --ids one", &["'one'"]),
        (
            "replay set --task fold",
            &["has that task", "those of `Fold`"],
        ),
        ("crumple --dims 0x8", &["`--dims 0x8`", "at least 2"]),
        (
            "crumple --dims 4000000000x8",
            &["`4000000000`", "`2` to `200`"],
        ),
        ("crumple --dims 8by8", &["`--dims 8by8`", "`55x44`"]),
        ("crumple --dims 8x201", &["`201`", "`2` to `200`"]),
        (
            "crumple --dims 9x8 --outline 9x9.txt",
            &["--outline", "--dims"],
        ),
        ("crumple --count 0", &["0", "1..=10000"]),
        (
            "measure coton",
            &["no material `coton`", "did you mean `cotton`", "fabc ships"],
        ),
    ] {
        sim_refused(folder.path(), call, 64, words);
    }
    let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(
        left.len(),
        2,
        "a refused call left something behind: {left:?}"
    );
}

#[test]
fn a_damaged_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    sim_refused(
        here,
        "replay set",
        2,
        &["`set/manifest.json` lists no recorded demonstrations"],
    );
    let whole = data_set(here);
    fs::write(here.join("set/manifest.json"), "{").unwrap();
    sim_refused(here, "replay set", 2, &["manifest", "EOF"]);
    fs::write(here.join("set/manifest.json"), "[".repeat(100_000)).unwrap();
    sim_refused(here, "replay set", 2, &["manifest"]);
    write_manifest(here, &json!({ "entries": [] }));
    sim_refused(here, "replay set", 2, &["`entries` are empty"]);
    write_manifest(here, &json!({ "entries": [7] }));
    sim_refused(here, "replay set", 2, &["manifest", "integer `7`"]);
    // Each change of a whole entry, and its message.
    let step = |name: &str, value: Value| {
        let mut step = whole["entries"][0]["steps"][0].clone();
        step[name] = value;
        json!([step])
    };
    for (field, value, words) in [
        ("id", json!(-1), &["-1"][..]),
        ("dimx", json!(0), &["`0`", "`2` to `200`"]),
        ("dimx", json!(4_000_000_000u32), &["`2` to `200`"]),
        ("dimy", json!(9), &["80 particles", "10 by 9 has 90"]),
        ("spacing_m", json!(null), &["null"]),
        ("spacing_m", json!(0.0), &["`0`", "`0.001` to `0.1`"]),
        (
            "spacing_m",
            json!(0.001),
            &["mostly lie 6.25 mm apart", "1.00 mm"],
        ),
        ("steps", json!([]), &["`Fold` 0", "no `steps`"]),
        (
            "steps",
            step("pick_keypoint", json!(8)),
            &["`Fold` 0", "`pick_keypoint` 8", "0 to 7"],
        ),
        (
            "steps",
            step("pick_world_m", json!([0.0, 0.0])),
            &["invalid length 2"],
        ),
        (
            "steps",
            step("place_world_m", json!([1e39, 0.0, 0.0])),
            &["`Fold` 0", "`inf`", "`2` m"],
        ),
        ("dir", json!("set/Fold/01"), &["set/Fold/01/init_pos.npy"]),
    ] {
        let mut manifest = whole.clone();
        manifest["entries"][0][field] = value;
        write_manifest(here, &manifest);
        sim_refused(here, "replay set", 2, words);
    }
}

#[test]
fn damaged_positions_of_a_demonstration() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    data_set(here);
    let [start, end] =
        ["init_pos.npy", "final_pos.npy"].map(|it| here.join("set/Fold/00").join(it));
    let mut broken = flat(10, 8);
    broken[12 * 5..12 * 5 + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut far = flat(10, 8);
    far[0..4].copy_from_slice(&5.0f32.to_le_bytes());
    write_npy(&end, "<f4", "(80, 3)", &broken);
    sim_refused(
        here,
        "replay set",
        2,
        &["final_pos.npy", "NaN at particle 5"],
    );
    write_npy(
        &end,
        "<f4",
        "(9223372036854775807, 9223372036854775807)",
        &broken,
    );
    sim_refused(
        here,
        "replay set",
        2,
        &["final_pos.npy", "promises more numbers"],
    );
    fs::remove_file(&end).unwrap();
    sim_refused(here, "replay set", 2, &["final_pos.npy"]);
    fs::create_dir(&end).unwrap();
    sim_refused(here, "replay set", 2, &["final_pos.npy", "it is a folder"]);
    fs::remove_dir(&end).unwrap();
    write_npy(&end, "<f4", "(80, 3)", &flat(10, 8));
    write_npy(&start, "<f4", "(80, 3)", &far);
    sim_refused(here, "replay set", 2, &["`Fold` 0", "`0`", "`5`"]);
}

#[test]
fn states_and_outputs_that_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_npy(&here.join("state.npy"), "<f4", "(80, 3)", &flat(10, 8));
    for verb in ["render", "export"] {
        let out = if verb == "render" { "o.png" } else { "o.npy" };
        for (call, code, words) in [
            ("nowhere.npy", 2, &["`nowhere.npy`"][..]),
            ("state.npy", 2, &["`state.json`", "--dims 55x44 --up y"]),
            ("state.npy --dims 10x8", 64, &["--up"]),
            (
                "state.npy --dims 10x9 --up y",
                2,
                &["80 particles", "10 by 9 has 90"],
            ),
            ("state.npy --dims 10by8 --up y", 64, &["`--dims 10by8`"]),
            (
                "state.npy --dims 4000000000x4000000000 --up y",
                2,
                &["80 particles"],
            ),
            ("state.npy --dims 10x8 --up x", 64, &["'x'", "y, z"]),
        ] {
            sim_refused(here, &format!("{verb} {call} -o {out}"), code, words);
        }
    }
    let state = "state.npy --dims 10x8 --up y";
    for (call, code, words) in [
        (
            format!("render {state} -o o.jpg"),
            64,
            &["`-o o.jpg`", "`.png`"][..],
        ),
        (format!("render {state} -o no/o.png"), 2, &["`no/o.png`"]),
        (
            format!("render {state} -o o.png --size 0"),
            64,
            &["`0`", "`16` to `2048`"],
        ),
        (
            format!("render {state} -o o.png --size 4000000000"),
            64,
            &["`16` to `2048`"],
        ),
        (
            format!("render {state} -o o.png --camera robot"),
            64,
            &["'robot'", "folding, smoothing"],
        ),
        (
            format!("export {state} -o o.ply"),
            64,
            &["`-o o.ply`", "`.npy`", "`.obj`"],
        ),
        (format!("export {state} -o no/o.npy"), 2, &["`no/o.json`"]),
        (
            format!("export {state} -o state.npy"),
            64,
            &["`-o state.npy`", "the file that is read"],
        ),
        (
            format!("export {state} -o ./state.npy"),
            64,
            &["the file that is read"],
        ),
    ] {
        sim_refused(here, &call, code, words);
    }
    let square = |side: usize| format!("{}\n", "#".repeat(side)).repeat(side);
    let call = "crumple --outline outline.txt -o starts";
    for (letters, words) in [
        ("##\n#?\n".to_owned(), &["row 2, column 2", "`?`"][..]),
        ("###\n##\n".to_owned(), &["row 2", "fill rows"]),
        (square(201), &["`201`", "`2` to `200`"]),
        (String::new(), &["`0`"]),
        (square(1), &["`1`", "`2` to `200`"]),
        (
            "#.\n..\n".to_owned(),
            &["1 particles", "at least 4, in a square"],
        ),
        (
            "###\n##.\n..#\n".to_owned(),
            &["row 1, column 3", "no square"],
        ),
        (
            "##.##\n##.##\n".to_owned(),
            &["row 1, column 4", "not joined to row 1, column 1"],
        ),
        (
            "##..\n####\n..##\n".to_owned(),
            &["in parts", "must share two neighbouring"],
        ),
    ] {
        fs::write(here.join("outline.txt"), &letters).unwrap();
        sim_refused(here, call, 2, &[&["`outline.txt`"], words].concat());
    }
    fs::write(here.join("outline.txt"), [0xff]).unwrap();
    sim_refused(here, call, 2, &["not UTF-8"]);
    let gone = call.replace("outline.txt", "gone.txt");
    sim_refused(here, &gone, 2, &["`gone.txt`"]);
    let folder = call.replace("outline.txt", ".");
    sim_refused(here, &folder, 2, &["directory"]);
    fs::write(here.join("file"), "").unwrap();
    sim_refused(here, "crumple --dims 4x4 -o file", 2, &["`file`"]);
    let left = fs::read_dir(here).unwrap().count();
    assert_eq!(left, 3, "a refused call left something behind");
}

#[test]
fn outlines_in_a_description_that_cannot_be() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_npy(&here.join("state.npy"), "<f4", "(80, 3)", &flat(10, 8));
    let rows = |row: &str, count: usize| json!(vec![row; count]);
    for (outline, words) in [
        (json!("##"), &["state.json", "expected a sequence"][..]),
        (json!([1]), &["state.json", "expected a string"]),
        (rows("##########", 7), &["has 7 rows", "would be 8"]),
        (rows("#########", 8), &["row 1", "9 letters", "be 10"]),
        (rows("#####?????", 8), &["`state.npy`", "column 6", "`?`"]),
        (rows("#.#.#.#.#.", 8), &["`state.npy`", "no square"]),
        (rows("..........", 8), &["`state.npy`", "0 particles"]),
        (rows("        ##", 8), &["`state.npy`", "column 1", "` `"]),
    ] {
        let description =
            json!({ "dimx": 10, "dimy": 8, "spacing_m": 0.00625, "up": "y", "outline": outline });
        fs::write(here.join("state.json"), description.to_string()).unwrap();
        sim_refused(here, "export state.npy -o o.obj", 2, words);
        sim_refused(here, "render state.npy -o o.png", 2, words);
    }
    let left = fs::read_dir(here).unwrap().count();
    assert_eq!(left, 2, "a refused call left something behind");
}

//! Impossible starts of a cloth: refused before anything is run or written.

use super::bad_input::{demonstrated, no_run_in, refused};
use super::support::{fabc, finish};
use std::fs;
use std::path::Path;

/// Runs the task from a start of 8 by 8 particles.
pub(super) const RUN: [&str; 8] = [
    "run",
    "small.fab",
    "--start",
    "start.npy",
    "--dims",
    "8x8",
    "--up",
    "y",
];

/// Writes a .npy file of the given type, shape and bytes.
pub(super) fn write_npy(path: &Path, kind: &str, shape: &str, body: &[u8]) {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(body);
    fs::write(path, bytes).unwrap();
}

fn flat(count: usize) -> Vec<u8> {
    let position = |index: usize| {
        [
            0.00625 * (index % 8) as f32,
            0.005,
            0.00625 * (index / 8) as f32,
        ]
    };
    (0..count)
        .flat_map(position)
        .flat_map(f32::to_le_bytes)
        .collect()
}

#[test]
fn a_start_of_the_wrong_shape_or_with_nan() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    demonstrated(here);
    refused(here, &RUN, 2, &["`start.npy`"]);
    fs::write(here.join("start.npy"), "no numbers").unwrap();
    refused(here, &RUN, 2, &["not a usable .npy file", "(particles, 3)"]);
    write_npy(&here.join("start.npy"), "<f4", "(63, 3)", &flat(63));
    refused(here, &RUN, 2, &["63 particles", "8 by 8 has 64"]);
    write_npy(&here.join("start.npy"), "<f4", "(96, 2)", &flat(64));
    refused(here, &RUN, 2, &["[96, 2]", "[particles, 3]"]);
    write_npy(&here.join("start.npy"), "<i4", "(64, 3)", &flat(64));
    refused(here, &RUN, 2, &["<i4"]);
    write_npy(&here.join("start.npy"), "<f2", "(64, 3)", &[0; 384]);
    refused(here, &RUN, 2, &["'<f2'", "(particles, 4)"]);
    fs::write(here.join("start.npy"), b"PK\x03\x04").unwrap();
    refused(here, &RUN, 2, &["`.npz`", "`numpy.save`"]);
    fs::write(here.join("start.json"), b"\xff\xfe{\0").unwrap();
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &flat(64));
    refused(here, &RUN[..4], 2, &["`start.json`", "UTF-16"]);
    fs::remove_file(here.join("start.json")).unwrap();
    write_npy(
        &here.join("start.npy"),
        "<f4",
        "(4000000000000, 3)",
        &flat(64),
    );
    refused(here, &RUN, 2, &["promises more numbers"]);
    for shape in [
        "(18446744073709551615, 3)",
        "(9223372036854775807, 9223372036854775807, 3)",
    ] {
        write_npy(&here.join("start.npy"), "<f4", shape, &flat(64));
        refused(here, &RUN, 2, &["promises more numbers"]);
    }
    fs::write(here.join("start.npy"), b"\x93NUMPY\x02\x00\x00\x00\x00\xff").unwrap();
    refused(here, &RUN, 2, &["truncated"]);
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &flat(60));
    refused(here, &RUN, 2, &["`start.npy`"]);
    let mut broken = flat(64);
    broken[12 * 5..12 * 5 + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &broken);
    refused(here, &RUN, 2, &["NaN at particle 5"]);
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &flat(64));
    refused(
        here,
        &["run", "small.fab", "--start", "start.npy"],
        2,
        &["`start.json`", "--dims 55x44 --up y"],
    );
    refused(
        here,
        &[
            "run",
            "small.fab",
            "--start",
            "start.npy",
            "--dims",
            "8by8",
            "--up",
            "y",
        ],
        64,
        &["`--dims 8by8`"],
    );
    refused(
        here,
        &["run", "small.fab", "--dims", "8x8", "--up", "y"],
        64,
        &["--start FILE.npy"],
    );
    assert!(no_run_in(here), "a refused start made a run folder");
    let said = finish(fabc(here).args(RUN));
    assert!(
        said.code == 0 || said.code == 3,
        "the right start is refused: {}",
        said.stderr
    );
}

#[test]
fn a_start_that_no_cloth_can_have() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    demonstrated(here);
    let mut apart = flat(64);
    apart[0..4].copy_from_slice(&5.0f32.to_le_bytes());
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &apart);
    refused(here, &RUN, 2, &["start.npy", "cannot be laid"]);
    for (scale, said) in [(0.0, "lie 0.00 mm apart"), (0.5, "3.1"), (1.2, "7.50 mm")] {
        let numbers = flat(64);
        let numbers = numbers.as_chunks().0.iter();
        let scaled = numbers.flat_map(|it| (scale * f32::from_le_bytes(*it)).to_le_bytes());
        let scaled: Vec<u8> = scaled.collect();
        write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &scaled);
        refused(here, &RUN, 2, &[said, "6.25 mm in the flat cloth"]);
    }
    assert!(no_run_in(here), "a refused start made a run folder");
}

#[test]
fn a_start_with_an_outline_is_none_of_a_rollout() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    demonstrated(here);
    write_npy(&here.join("start.npy"), "<f4", "(64, 3)", &flat(64));
    let description = serde_json::json!({
        "dimx": 8, "dimy": 8, "spacing_m": 0.00625, "up": "y", "outline": vec!["####...."; 8]
    });
    fs::write(here.join("start.json"), description.to_string()).unwrap();
    let call = ["run", "small.fab", "--start", "start.npy"];
    let words = ["`start.npy`", "has an outline", "whole cloth"];
    refused(here, &call, 2, &words);
    assert!(no_run_in(here), "a refused start made a run folder");
}

#[test]
fn a_run_begins_where_another_one_was() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    demonstrated(here);
    let run = |start: &str, out: &str| {
        let call = ["run", "small.fab", "--start", start, "--out", out];
        let said = finish(fabc(here).args(call).args(["--policy", "expert"]));
        assert!([0, 3].contains(&said.code), "{start}: {}", said.stderr);
    };
    let positions = |file: &str| fs::read(here.join(file)).unwrap();
    run("3", "first");
    run("first", "second");
    assert_eq!(
        positions("second/start.npy"),
        positions("first/step_1/positions.npy")
    );
    run("first/start.npy", "third");
    run("second/step_1/positions.npy", "fourth");
    assert_eq!(
        positions("fourth/start.npy"),
        positions("second/step_1/positions.npy")
    );
    refused(
        here,
        &[
            "run",
            "small.fab",
            "--start",
            "first",
            "--dims",
            "9x9",
            "--up",
            "z",
        ],
        2,
        &["64 particles", "9 by 9 has 81"],
    );
    refused(
        here,
        &["run", "small.fab", "--start", "."],
        2,
        &["holds no run"],
    );
}

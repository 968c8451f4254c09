//! `fabc calibrate`: points from a file; each mistake is named, and nothing is written.

use super::support::{Captured, fabc, finish, project};
use fab_arm::calibration::{Calibration, Pair, csv_line};
use image::{Luma, Rgb, RgbImage};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const ROBOT: &str = "\
name = \"lab\"
model = \"j2n6s200\"
driver = \"simulated\"
calibration = \"lab.toml\"

[table]
center_m = [0.45, 0.0, 0.02]

[workspace]
min_m = [0.15, -0.525, 0.01]
max_m = [0.75, 0.525, 0.5]
rest_m = [0.30, -0.40, 0.25]

[fingers]
count = 2
open = 0.0
closed = 6400.0
tolerance = 200.0

[camera]
source = \"directory\"
folder = \"shots\"
window_px = [80, 0, 480]

[camera.intrinsics]
size_px = [640, 480]
focal_px = [600.0, 600.0]
middle_px = [320.0, 240.0]
";

/// A folder with an arm's settings, a picture of its table, and 16 points over it.
fn lab() -> (TempDir, Vec<Pair>) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), ROBOT).unwrap();
    fs::create_dir(folder.path().join("shots")).unwrap();
    table().save(folder.path().join("shots/0001.png")).unwrap();
    let depth = image::ImageBuffer::<Luma<u16>, _>::new(640, 480);
    depth
        .save(folder.path().join("shots/0001.depth.png"))
        .unwrap();
    let pairs = (0..16).map(|index| {
        let at = |step: i32| 0.1 + 0.8 * f64::from(step) / 3.0;
        touched([80.0 + 480.0 * at(index % 4), 480.0 * at(index / 4)], index)
    });
    (folder, pairs.collect())
}

/// A table of irregular sheets, so that the registration has features to find.
fn table() -> RgbImage {
    RgbImage::from_fn(640, 480, |u, v| {
        let sheet = (u / 23) * 7919 + (v / 19) * 104_729;
        let shade = 60 + (sheet.wrapping_mul(2_654_435_761) >> 25) as u8;
        Rgb([shade, shade, shade / 2 + 40])
    })
}

/// The arm's reading at a pixel, with the camera a metre above; off by half a millimetre in varying directions.
fn touched(pixel: [f64; 2], index: i32) -> Pair {
    let off = |salt: i32| f64::from((index * 7 + salt) % 5 - 2) * 0.00025;
    let round = |number: f64| (number * 10_000.0).round() / 10_000.0;
    let base_m = [
        round(0.45 - (pixel[1] - 240.0) / 600.0 + off(1)),
        round(-(pixel[0] - 320.0) / 600.0 + off(3)),
        round(0.02 + off(0)),
    ];
    Pair { pixel, base_m }
}

fn write_pairs(folder: &Path, pairs: &[Pair]) {
    let lines: String = pairs.iter().map(|pair| csv_line(pair) + "\n").collect();
    fs::write(folder.join("pairs.csv"), lines).unwrap();
}

fn calibrate(folder: &Path, more: &[&str]) -> Captured {
    let mut command = fabc(folder);
    finish(
        command
            .args(["calibrate", "--robot", "robot.toml"])
            .args(more),
    )
}

fn json(said: &Captured) -> Value {
    serde_json::from_str(&said.stdout).unwrap()
}

#[test]
fn good_points_are_written_with_their_errors() {
    let (folder, pairs) = lab();
    write_pairs(folder.path(), &pairs);
    let said = calibrate(folder.path(), &["--pairs", "pairs.csv"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    assert_eq!(said.stderr, "");
    insta::assert_snapshot!(said.stdout);
    let read = Calibration::load(&folder.path().join("lab.toml")).unwrap();
    assert_eq!(read.pairs, pairs);
    assert!(read.reference.is_some());
    let drawn = image::open(folder.path().join("lab.points.png"))
        .unwrap()
        .into_rgb8();
    let differing = drawn
        .pixels()
        .zip(table().pixels())
        .filter(|(a, b)| a != b)
        .count();
    assert!((500..30_000).contains(&differing), "{differing} pixels");
}

#[test]
#[ignore = "long"]
fn its_json_has_the_fields_that_scripts_rely_on() {
    let (folder, pairs) = lab();
    write_pairs(folder.path(), &pairs);
    let said = calibrate(folder.path(), &["--pairs", "pairs.csv", "--json"]);
    assert_eq!(said.code, 0, "{}", said.stderr);
    let value = json(&said);
    assert_eq!(value["file"], "lab.toml");
    assert_eq!(value["made_on"].as_str().unwrap().len(), 10);
    assert_eq!(value["points"].as_array().unwrap().len(), 16);
    for field in ["pixel", "base_m"] {
        assert!(!value["points"][0][field].is_null(), "{field}");
    }
    assert_eq!(value["left_out_mm"].as_array().unwrap().len(), 16);
    let error_mm = value["left_out_rms_mm"].as_f64().unwrap();
    assert!((0.05..1.5).contains(&error_mm), "{value}");
    let corners = value["corners"].as_array().unwrap();
    assert_eq!(corners.len(), 4);
    for corner in corners {
        assert!(corner["error_mm"].as_f64().unwrap() < 1.5, "{corner}");
    }
}

/// A mistake that a person makes.
type Change = fn(&mut Vec<Pair>);

#[test]
#[ignore = "long"]
fn each_slip_is_named_and_nothing_is_written() {
    let cases: [(&str, Change); 9] = [
        ("a point 23 mm off", |it| it[6].base_m[0] += 0.023),
        ("a pixel swapped", |it| it[1].pixel.reverse()),
        ("a sign lost", |it| it[3].base_m[1] *= -1.0),
        ("all x and y swapped", |it| {
            it.iter_mut().for_each(|it| it.base_m.swap(0, 1))
        }),
        ("both signs lost", |it| {
            it.iter_mut()
                .for_each(|it| (it.base_m[0], it.base_m[1]) = (-it.base_m[0], -it.base_m[1]))
        }),
        ("millimetres", |it| {
            it.iter_mut()
                .for_each(|it| it.base_m = it.base_m.map(|m| (m * 1000.0).round()))
        }),
        ("two rows 25 mm apart", |it| {
            *it = (0..16)
                .map(|n| {
                    touched(
                        [
                            100.0 + f64::from(n % 8) * 60.0,
                            230.0 + 15.0 * f64::from(n / 8),
                        ],
                        n,
                    )
                })
                .collect()
        }),
        ("one line", |it| {
            *it = (0..16)
                .map(|n| touched([100.0 + f64::from(n) * 30.0, 230.0], 0))
                .collect()
        }),
        ("seven points", |it| it.truncate(7)),
    ];
    let (folder, pairs) = lab();
    let mut all = String::new();
    for (name, change) in cases {
        let mut pairs = pairs.clone();
        change(&mut pairs);
        write_pairs(folder.path(), &pairs);
        let said = calibrate(folder.path(), &["--pairs", "pairs.csv"]);
        assert_eq!((said.code, said.stdout.as_str()), (2, ""), "{name}");
        all += &format!("{name}:\n{}\n", said.stderr);
        assert!(!folder.path().join("lab.toml").exists(), "{name}");
        assert!(folder.path().join("lab.points.png").exists(), "{name}");
    }
    insta::assert_snapshot!(all);
}

#[test]
fn only_a_limit_on_errors_may_be_raised() {
    let (folder, mut pairs) = lab();
    // If every other point is off, the fault is not that of a few points.
    for pair in pairs.iter_mut().step_by(2) {
        pair.base_m[0] += 0.012;
    }
    write_pairs(folder.path(), &pairs);
    let refused = calibrate(folder.path(), &["--pairs", "pairs.csv"]);
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains(
            "mm from where the others put them (root mean square); at most 4 mm are accepted"
        ),
        "{}",
        refused.stderr
    );
    let raised = calibrate(folder.path(), &["--pairs", "pairs.csv", "--limit", "10"]);
    assert_eq!(raised.code, 0, "{}", raised.stderr);
    assert!(
        raised.stdout.contains("the limit is 10 mm"),
        "{}",
        raised.stdout
    );
    for limit in ["0", "-1", "nan", "1000"] {
        let said = calibrate(folder.path(), &["--pairs", "pairs.csv", "--limit", limit]);
        assert_eq!(said.code, 2, "{limit}");
        assert!(
            said.stderr
                .contains("it must be larger than 0 and at most 20"),
            "{}",
            said.stderr
        );
    }
}

#[test]
fn doubts_are_said() {
    let (folder, mut pairs) = lab();
    pairs[6].base_m[0] += 0.008;
    write_pairs(folder.path(), &pairs);
    RgbImage::new(640, 480)
        .save(folder.path().join("plain.png"))
        .unwrap();
    let said = calibrate(
        folder.path(),
        &["--pairs", "pairs.csv", "--image", "plain.png"],
    );
    assert_eq!(said.code, 0, "{}", said.stderr);
    insta::assert_snapshot!(said.stderr);
    fs::remove_file(folder.path().join("shots/0001.png")).unwrap();
    let said = calibrate(folder.path(), &["--pairs", "pairs.csv"]);
    assert_eq!(said.code, 2);
    assert!(
        said.stderr.contains(
            "it holds no picture `NAME.png` or `NAME.jpg`; or give a picture with `--image PNG`"
        ),
        "{}",
        said.stderr
    );
}

#[test]
fn wrong_input_is_said_with_its_place() {
    let (folder, pairs) = lab();
    write_pairs(folder.path(), &pairs);
    fs::write(
        folder.path().join("bad.csv"),
        "u,v,x,y,z\n1,2,0.3,oops,0.1\n",
    )
    .unwrap();
    RgbImage::new(64, 48)
        .save(folder.path().join("small.png"))
        .unwrap();
    let cases: [(&[&str], i32, &str); 6] = [
        (
            &["--pairs", "bad.csv"],
            2,
            "the points in `bad.csv` cannot be used: line 2: `oops` is not a number",
        ),
        (
            &["--pairs", "none.csv"],
            2,
            "the points in `none.csv` cannot be used",
        ),
        (&["--pairs", "shots"], 2, "it is a directory, not a file"),
        (
            &["--pairs", "pairs.csv", "--image", "small.png"],
            2,
            "the camera's intrinsics are for a picture of 640 x 480 px, and the picture has 64 x 48 px",
        ),
        (
            &["--pairs", "pairs.csv", "--image", "none.png"],
            2,
            "cannot read `none.png`",
        ),
        (&[], 64, "--pairs"),
    ];
    for (arguments, code, wanted) in cases {
        let said = calibrate(folder.path(), arguments);
        assert_eq!(said.code, code, "{arguments:?}: {}", said.stderr);
        assert!(
            said.stderr.contains(wanted),
            "{arguments:?}: {}",
            said.stderr
        );
    }
    let said = calibrate(folder.path(), &["--pairs", "bad.csv", "--json"]);
    assert_eq!(json(&said)["exit"], 2);
}

/// A build with the feature finds them: the book and a peer test run it.
#[test]
#[cfg(not(feature = "tags"))]
fn a_tag_is_refused_with_the_build_that_would_find_it() {
    let (folder, _) = lab();
    fs::write(folder.path().join("tags.csv"), "tag7,0.5,0.1,0.02\n").unwrap();
    let said = calibrate(folder.path(), &["--pairs", "tags.csv"]);
    assert_eq!(said.code, 2, "{}", said.stderr);
    let wanted = "line 1: `tag7` is unknown: ";
    assert!(said.stderr.contains(wanted), "{}", said.stderr);
    let command = "cargo install --path . --features tags";
    assert!(said.stderr.contains(command), "{}", said.stderr);
}

/// Sixteen AprilTags that OpenCV drew, as a known camera sees them; the arm touches their middles.
#[test]
#[ignore = "needs Python with OpenCV"]
fn peer_opencv_draws_tags_by_which_a_known_camera_is_found() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    for seed in 0..10 {
        let (folder, _) = lab();
        let path = folder.path();
        let drawn = Command::new(&python)
            .args([
                project("tests/peers/tags_on_table.py"),
                path.display().to_string(),
            ])
            .arg(seed.to_string())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&drawn.stderr);
        assert!(drawn.status.success(), "{stderr}");
        let said = calibrate(
            path,
            &["--pairs", "points.csv", "--image", "tags.png", "--json"],
        );
        assert_eq!(said.code, 0, "seed {seed}: {}", said.stderr);
        let rms_mm = json(&said)["left_out_rms_mm"].as_f64().unwrap();
        assert!(rms_mm < 0.4, "seed {seed}: {rms_mm} mm");
        let made = Calibration::load(&path.join("lab.toml")).unwrap();
        let truth = fs::read_to_string(path.join("truth.json")).unwrap();
        let truth: Value = serde_json::from_str(&truth).unwrap();
        for shown in truth["shown"].as_array().unwrap() {
            let pixel = serde_json::from_value(shown["pixel"].clone()).unwrap();
            let [x, y, z]: [f64; 3] = serde_json::from_value(shown["base_m"].clone()).unwrap();
            let found = made.table_from_pixel(pixel).unwrap();
            let off_mm = (found - nalgebra::Point3::new(x, y, z)).norm() * 1000.0;
            assert!(off_mm < 0.5, "seed {seed}, {pixel:?}: {off_mm} mm off");
        }
    }
}

//! Pictures that people bring: photographs of phones, transparent drawings, depth with dropouts, cloths that leave the
//! picture. What is done to them is said, and a model sees what a person sees.

use super::bad_input::{demonstrated, write_task};
use super::bad_starts::{RUN, write_npy};
use super::see::{FOLDING, SIDE_PX};
use super::support::{Captured, fabc, finish, project};
use image::{ImageBuffer, Luma, Rgb, RgbImage, Rgba, RgbaImage};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Runs `fabc see` by depth on `picture` and `depth.png`; returns its document and what it said.
fn seen(folder: &Path, picture: &str) -> (Value, String) {
    let task = project(FOLDING);
    let by_depth = ["see", &task, "--variant", "by_depth", "--json"];
    let brought = ["--image", picture, "--depth", "depth.png"];
    let Captured {
        code,
        stdout,
        stderr,
    } = finish(fabc(folder).args(by_depth).args(brought));
    assert_eq!(code, 0, "{stderr}");
    (serde_json::from_str(&stdout).unwrap(), stderr)
}

/// Writes a depth picture in millimetres.
fn write_depth(path: &Path, [width, height]: [u32; 2], depth_mm: impl Fn(u32, u32) -> u16) {
    let levels = ImageBuffer::from_fn(width, height, |column, row| Luma([depth_mm(column, row)]));
    levels.save(path).unwrap();
}

#[test]
fn a_photograph_and_its_depth_are_cut_alike() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    // The cloth fills the middle half of the middle square.
    let is_cloth = |column, row| (200..440).contains(&column) && (120..360).contains(&row);
    write_depth(&file("depth.png"), [640, 480], |column, row| {
        if is_cloth(column, row) { 640 } else { 650 }
    });
    for size in [[640, 480], [1600, 1200]] {
        let picture = RgbImage::from_pixel(size[0], size[1], Rgb([90; 3]));
        // The name says PNG, and the content decides.
        picture
            .save_with_format(file("a.png"), image::ImageFormat::Jpeg)
            .unwrap();
        let (found, said) = seen(folder.path(), "a.png");
        assert_eq!(found["masks"]["cloth"]["area_px"], 112 * 112);
        assert_eq!(found["keypoints"]["center"], json!([[111, 111]]));
        let told = format!(
            "note: the picture has {} x {} px: its middle square of {} px is taken, scaled to the camera's 224 px",
            size[0], size[1], size[1]
        );
        assert_eq!(said.trim_end(), told);
    }
}

#[test]
fn dropouts_of_a_depth_camera_make_no_corners() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    RgbImage::new(SIDE_PX, SIDE_PX).save(file("a.png")).unwrap();
    let depth_mm = |column, row| match (60..150).contains(&column) && (80..170).contains(&row) {
        true => 640,
        false => 650,
    };
    // A tenth of the readings, scattered by a generator of residues.
    let is_missing =
        |column: u32, row: u32| (row * SIDE_PX + column).wrapping_mul(2_654_435_761) % 1000 < 100;
    write_depth(&file("depth.png"), [SIDE_PX; 2], depth_mm);
    let (whole, said) = seen(folder.path(), "a.png");
    assert_eq!(said, "");
    write_depth(&file("depth.png"), [SIDE_PX; 2], |column, row| {
        if is_missing(column, row) {
            0
        } else {
            depth_mm(column, row)
        }
    });
    let (found, said) = seen(folder.path(), "a.png");
    assert!(
        said.contains("of 50176 pixels of the depth picture have no reading;"),
        "{said}"
    );
    assert_eq!(
        found["keypoints"]["corners"].as_array().unwrap().len(),
        4,
        "{found}"
    );
    let area = |of: &Value| of["masks"]["cloth"]["area_px"].as_f64().unwrap();
    assert!((area(&found) / area(&whole) - 1.0).abs() < 0.01, "{found}");
}

#[test]
fn a_cloth_that_leaves_the_picture_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let told = "`cloth` reaches the picture's right border: its corners and center are those of its visible part";
    RgbImage::new(SIDE_PX, SIDE_PX).save(file("a.png")).unwrap();
    for (first, is_told) in [(174, true), (133, false)] {
        write_depth(&file("depth.png"), [SIDE_PX; 2], |column, row| {
            match (first..first + 90).contains(&column) && (80..170).contains(&row) {
                true => 640,
                false => 650,
            }
        });
        let (_, said) = seen(folder.path(), "a.png");
        assert_eq!(said.contains(told), is_told, "{first}: {said}");
    }

    demonstrated(folder.path());
    let lies_at = |index: usize| {
        [
            0.25 + 0.00625 * (index % 8) as f32,
            0.005,
            0.00625 * (index / 8) as f32,
        ]
    };
    let body: Vec<u8> = (0..64)
        .flat_map(lies_at)
        .flat_map(f32::to_le_bytes)
        .collect();
    write_npy(&file("start.npy"), "<f4", "(64, 3)", &body);
    let said = finish(fabc(folder.path()).args(RUN)).stderr;
    assert_eq!(
        said.matches("reaches the picture's right border").count(),
        1,
        "{said}"
    );
    assert!(said.contains("note: before step 1: `cloth`"), "{said}");
}

#[test]
fn a_transparent_subgoal_is_white_in_the_prompt() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    write_task(
        here,
        "image \"a.png\" arrow (60px, 60px) -> (150px, 150px)\nimage \"b.png\"",
    );
    // Green hides under what is transparent.
    let drawing = RgbaImage::from_fn(224, 224, |column, row| {
        let is_cloth = (50..170).contains(&column) && (50..170).contains(&row);
        Rgba(if is_cloth {
            [200, 60, 20, 255]
        } else {
            [0, 255, 0, 0]
        })
    });
    for name in ["a.png", "b.png"] {
        drawing.save(here.join(name)).unwrap();
    }
    let rendered = finish(fabc(here).args(["render", "small.fab", "--out", "out"]));
    assert_eq!(rendered.code, 0, "{}", rendered.stderr);
    let mut n_pictures = 0;
    for entry in fs::read_dir(here.join("out")).unwrap() {
        let path = entry.unwrap().path();
        let Ok(picture) = image::open(&path) else {
            continue;
        };
        n_pictures += 1;
        assert!(
            picture
                .to_rgb8()
                .pixels()
                .all(|pixel| pixel.0 != [0, 255, 0]),
            "{}",
            path.display()
        );
    }
    assert!(n_pictures > 0);
}

#[test]
fn a_task_in_utf_16_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let text: Vec<u8> = "task t { }"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    fs::write(
        folder.path().join("a.fab"),
        [b"\xff\xfe", &text[..]].concat(),
    )
    .unwrap();
    let said = finish(fabc(folder.path()).args(["check", "a.fab"]));
    assert_eq!(said.code, 2);
    let told = "cannot read `a.fab`: it is text in UTF-16; save it as UTF-8";
    assert!(said.stderr.contains(told), "{}", said.stderr);
}

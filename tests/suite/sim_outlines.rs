//! Cloths with missing particles in the `sim` verbs: crumpled, described, drawn and exported again.

use super::bad_starts::write_npy;
use super::sim_verbs::told;
use super::support::project;
use fab_sim::{Grid, Mask, mesh};
use fab_world::metrics;
use fab_world::start::{Outline, Start};
use serde_json::Value;
use std::fs;
use std::path::Path;

const SPACING_M: f32 = 0.00625;

/// A letter T, 16 by 14 particles: 8 rows for the bar, 6 for the stem.
fn letter() -> String {
    let bar = format!("{}\n", "#".repeat(16)).repeat(8);
    bar + &"....########....\n".repeat(6)
}

/// Crumples two letters into `starts`; returns the document.
fn crumple(here: &Path) -> Value {
    fs::write(here.join("letter.txt"), letter()).unwrap();
    let call = [
        "crumple",
        "--outline",
        "letter.txt",
        "--count",
        "2",
        "-o",
        "starts",
    ];
    told(here, &call)
}

fn positions_in(here: &Path, start: &Value) -> Start {
    Start::load(&here.join(start["file"].as_str().unwrap()), None).unwrap()
}

#[test]
fn outlined_cloths_are_measured_against_their_own_area() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let value = crumple(here);
    let mask = Mask::parse(&letter(), SPACING_M).unwrap();
    for (seed, start) in value["starts"].as_array().unwrap().iter().enumerate() {
        assert_eq!(
            start["file"],
            format!("starts/crumpled_letter_16x14_{seed}.npy")
        );
        let read = positions_in(here, start);
        assert_eq!(start["digest"], read.digest());
        assert_eq!((read.grid.dimx, read.grid.dimy), (16, 14));
        assert_eq!(read.outline, Some(Outline::new(&letter())));
        let there: Vec<[f32; 3]> = (0..16 * 14)
            .filter(|&index| mask.has(index))
            .map(|index| read.positions[index])
            .collect();
        // SoftGym's measure, divided by its value for the flat letter, whose box is 16 by 14 spacings.
        let laid: Vec<[f32; 3]> = (0..16 * 14)
            .filter(|&index| mask.has(index))
            .map(|index| {
                let [x, y] = [(index % 16) as f32 / 15.0, (index / 16) as f32 / 13.0];
                [16.0 * SPACING_M * x, -14.0 * SPACING_M * y, 0.0]
            })
            .collect();
        let area = |points: &[[f32; 3]]| metrics::covered_area_m2(points, 0.00625).unwrap();
        let covered = start["coverage"].as_f64().unwrap();
        let expected = area(&there) / area(&laid);
        assert!((covered - expected).abs() < 2e-3, "{covered}, {expected}");
        // The true area: 15 by 7 cells of the bar, 7 by 6 of the stem.
        let under_m2 = metrics::true_covered_area_m2(&read.positions, &mesh::triangles(&mask));
        let flat_m2 = f64::from(15 * 7 + 7 * 6) * f64::from(SPACING_M).powi(2);
        let truly = start["true_coverage"].as_f64().unwrap();
        assert!(
            (truly - under_m2.unwrap() / flat_m2).abs() < 1e-9,
            "{start}"
        );
    }
    // The same again from the cache; one more missing particle makes another cloth.
    assert_eq!(crumple(here), value);
    fs::write(here.join("letter.txt"), letter().replacen('#', ".", 1)).unwrap();
    let other = told(here, &["crumple", "--outline", "letter.txt"]);
    assert_ne!(
        other["starts"][0]["digest"], value["starts"][0]["digest"],
        "an outline got the heap of another one"
    );
}

#[test]
fn a_start_with_an_outline_is_drawn_and_exported_without_naming_it_again() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    crumple(here);
    let file = "starts/crumpled_letter_16x14_0.npy";
    // The outline file is not needed: the description holds the outline.
    fs::remove_file(here.join("letter.txt")).unwrap();
    told(here, &["render", file, "-o", "heap.png"]);
    let value = told(here, &["export", file, "-o", "heap.obj"]);
    assert_eq!(value["particles"], 16 * 8 + 8 * 6);
    // Exporting and reading again gives the same cloth.
    told(here, &["export", file, "-o", "again.npy"]);
    told(here, &["export", "again.npy", "-o", "again.obj"]);
    let bytes = |name: &str| fs::read(here.join(name)).unwrap();
    assert_eq!(bytes("again.obj"), bytes("heap.obj"));
    // The positions of missing particles do not matter, unless nothing says that they are missing.
    let start = Start::load(&here.join(file), None).unwrap();
    let mask = Mask::parse(&letter(), SPACING_M).unwrap();
    let moved: Vec<u8> = (0..16 * 14)
        .map(|index| match mask.has(index) {
            true => start.positions[index],
            false => [0.2, 0.2, 0.1],
        })
        .flat_map(|point| point.map(f32::to_le_bytes).concat())
        .collect();
    write_npy(&here.join("moved.npy"), "<f4", "(224, 3)", &moved);
    let description = here.join(file).with_extension("json");
    fs::copy(description, here.join("moved.json")).unwrap();
    told(here, &["render", "moved.npy", "-o", "moved.png"]);
    assert_eq!(bytes("moved.png"), bytes("heap.png"));
    let call = ["--dims", "16x14", "--up", "z", "-o", "whole.png"];
    told(here, &[&["render", "moved.npy"], &call[..]].concat());
    assert_ne!(bytes("whole.png"), bytes("heap.png"));
}

#[test]
fn an_outline_without_gaps_is_the_whole_cloth() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("full.txt"), "############\n".repeat(10)).unwrap();
    let outlined = told(here, &["crumple", "--outline", "full.txt"]);
    let whole = told(here, &["crumple", "--dims", "12x10"]);
    assert_eq!(outlined, whole);
}

#[test]
fn a_crumpled_t_shirt_lies_in_a_heap_on_the_middle_of_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let outline = project("sim/outlines/t_shirt.txt");
    let value = told(here, &["crumple", "--outline", &outline, "-o", "starts"]);
    let mask = Mask::parse(&fs::read_to_string(&outline).unwrap(), SPACING_M).unwrap();
    assert_eq!(mask.grid(), Grid::new(50, 50, SPACING_M).unwrap());
    let start = &value["starts"][0];
    let covered = start["coverage"].as_f64().unwrap();
    assert!((0.32..=0.63).contains(&covered), "{start}");
    let truly = start["true_coverage"].as_f64().unwrap();
    assert!((0.8..1.1).contains(&(truly / covered)), "{start}");
    let read = positions_in(here, start);
    let mut mean = [0.0; 2];
    for (index, point) in read.positions.iter().enumerate() {
        if mask.has(index) {
            assert!(point[2] > 0.0, "particle {index} at {point:?}");
            mean[0] += f64::from(point[0]) / mask.count() as f64;
            mean[1] += f64::from(point[1]) / mask.count() as f64;
        } else {
            assert_eq!(*point, [0.0; 3], "missing particle {index}");
        }
    }
    assert!(mean.iter().all(|at| at.abs() < 1e-4), "{mean:?}");
}

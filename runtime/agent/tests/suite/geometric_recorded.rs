//! The stand-in model against recorded expert demonstrations: from the recorded subgoal pictures to words,
//! and from words and detected corners to the points that the expert picked and placed.
//!
//! Needs `FABC_REFERENCE_DATA`; without it the tests count as skipped.
#[path = "../../../../tests/recorded_data.rs"]
mod recorded;

use fab_model::calls::{Budget, Ledger};
use fab_model::{Message, Model, ModelRole, Part, Png, Request, Speaker};
use fab_picture::{DepthImage, centroid, depth_mask};
use fab_program::{PixelPoint, Response};
use fab_standins::Geometric;
use fab_vision::{CornerSearch, corners};
use image::{GrayImage, Luma};
use recorded::recorded_data;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The farthest that a chosen point may be from the recorded one, pixels. Detected corners are off by up to 4.
const NEAR_PX: f64 = 6.0;

fn ask(role: ModelRole, parts: Vec<Part>) -> String {
    let messages = vec![Message {
        speaker: Speaker::User,
        parts,
    }];
    let request = Request::new(role, messages);
    Geometric
        .ask(&request, &mut Ledger::unwritten(&Budget::default()))
        .unwrap()
        .text
}

/// Puts a step of a task's recorded subgoal pictures into words.
fn instruction(root: &Path, task: &str, step: usize) -> String {
    let picture = |name: String| {
        let path = root.join("subgoals").join(task).join(name);
        Part::Image(Png::new(std::fs::read(path).unwrap()))
    };
    let parts = vec![
        Part::Text("Describe the step.".to_owned()),
        picture(format!("rgbviz_{step}.png")),
        picture(format!("rgb_{}.png", step + 1)),
    ];
    let reply = ask(ModelRole::Vision, parts);
    let line = reply
        .lines()
        .find_map(|line| line.strip_prefix("Instructions: "));
    line.unwrap_or_else(|| panic!("{task} {step}: {reply}"))
        .trim_end_matches('.')
        .to_owned()
}

/// Lets the stand-in choose a pick and a place; pixel centres.
fn planned(instruction: &str, corners: &[PixelPoint], center: PixelPoint) -> [[f64; 2]; 2] {
    let listed: Vec<String> = corners.iter().map(ToString::to_string).collect();
    let text = format!(
        "- Method of folding: {instruction}\n- Cloth corners: {}\n- Cloth center: {center}",
        listed.join(", ")
    );
    let reply = ask(ModelRole::Text, vec![Part::Text(text)]);
    ["Pick Point = (", "Place Point = ("].map(|label| {
        let line = reply
            .lines()
            .find_map(|line| line.strip_prefix(label)?.strip_suffix(')'));
        let (u, v) = line
            .and_then(|point| point.split_once(", "))
            .unwrap_or_else(|| panic!("{reply}"));
        [u, v].map(|number| number.parse::<f64>().unwrap() + 0.5)
    })
}

fn levels(folder: &Path, step: usize) -> GrayImage {
    image::open(folder.join(format!("depth_{step}.png")))
        .unwrap()
        .into_luma8()
}

/// A recorded depth image, 8-bit levels of 1/255 m, as metres.
fn depth(levels: &GrayImage) -> DepthImage {
    DepthImage::from_fn(levels.width(), levels.height(), |column, row| {
        Luma([f32::from(levels.get_pixel(column, row).0[0]) / 255.0])
    })
}

/// The corners of the cloth in a recorded depth image.
fn corners_in(levels: &GrayImage) -> Vec<PixelPoint> {
    let depth = depth(levels);
    let mask = depth_mask(&depth, 0.646);
    let search = CornerSearch {
        of: fab_program::Sight::Depth,
        block_px: 3,
        image_px: 128,
        max: 27,
        quality: 0.04,
        spacing_px: 10.0,
        response: Response::Harris { k: 0.04 },
    };
    // The detector looks at the depth alone.
    let unseen = image::RgbImage::new(depth.width(), depth.height());
    let found = corners(&depth, &unseen, &mask, &search).unwrap();
    found.into_iter().map(|corner| corner.pixel).collect()
}

/// The centre of the cloth in a recorded depth image.
fn center_in(levels: &GrayImage) -> PixelPoint {
    centroid(&depth_mask(&depth(levels), 0.646)).unwrap().pixel
}

/// Turns an image about its middle, clockwise as seen, without blending depths.
fn turned(levels: &GrayImage, degrees: f64) -> GrayImage {
    let table = Luma([165]);
    GrayImage::from_fn(levels.width(), levels.height(), |column, row| {
        let [u, v] = turned_point([f64::from(column) + 0.5, f64::from(row) + 0.5], -degrees);
        if u < 0.0 || v < 0.0 {
            return table;
        }
        levels
            .get_pixel_checked(u as u32, v as u32)
            .copied()
            .unwrap_or(table)
    })
}

/// Turns a point of a 224 px image about its middle, clockwise as seen.
fn turned_point([u, v]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (right, down) = (u - 112.0, v - 112.0);
    [
        112.0 + right * cos - down * sin,
        112.0 + right * sin + down * cos,
    ]
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

struct RecordedStep {
    folder: PathBuf,
    rotation_deg: f64,
    index: usize,
    pick: [f64; 2],
    place: [f64; 2],
}

/// All recorded steps of a task whose pictures are at hand.
fn recorded_steps(root: &Path, task: &str) -> Vec<RecordedStep> {
    let text = std::fs::read_to_string(root.join("folding120/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&text).unwrap();
    let mut steps = Vec::new();
    for entry in manifest["entries"].as_array().unwrap() {
        let folder = root.join(entry["dir"].as_str().unwrap());
        if entry["task"] != task || !folder.exists() {
            continue;
        }
        for step in entry["steps"].as_array().unwrap() {
            let point = |list: &str| [0, 1].map(|axis| step[list][axis].as_f64().unwrap());
            steps.push(RecordedStep {
                folder: folder.clone(),
                rotation_deg: entry["rotation_deg"].as_f64().unwrap(),
                index: step["step"].as_u64().unwrap() as usize,
                pick: point("pick_px"),
                place: point("place_px"),
            });
        }
    }
    steps
}

#[test]
#[ignore = "long"]
fn straight_folds_are_planned_as_the_expert_did_them() {
    let Some(root) = recorded_data("straight_folds_are_planned_as_the_expert_did_them") else {
        return;
    };
    let said: Vec<String> = (0..3)
        .map(|step| instruction(&root, "DoubleStraight", step))
        .collect();
    let steps = recorded_steps(&root, "DoubleStraight");
    assert!(steps.len() >= 60, "{} steps", steps.len());
    let mut worst = 0.0_f64;
    for step in &steps {
        let listed = corners_in(&levels(&step.folder, step.index));
        let center = center_in(&levels(&step.folder, 0));
        let [pick, place] = planned(&said[step.index], &listed, center);
        let off = [distance(pick, step.pick), distance(place, step.place)];
        let name = step.folder.display();
        assert!(
            off.iter().all(|&off| off <= NEAR_PX),
            "{name} step {}: {off:?}",
            step.index
        );
        worst = worst.max(off[0]).max(off[1]);
    }
    println!("worst of {} steps: {worst:.1} px", steps.len());
}

/// The available recordings may have two angles only. Turned depth images stand in for the others; their stair-stepped
/// edges make the detector report more than the corners.
#[test]
#[ignore = "long"]
fn straight_folds_are_planned_alike_when_the_recorded_cloth_is_turned() {
    let Some(root) =
        recorded_data("straight_folds_are_planned_alike_when_the_recorded_cloth_is_turned")
    else {
        return;
    };
    let said: Vec<String> = (0..3)
        .map(|step| instruction(&root, "DoubleStraight", step))
        .collect();
    let (mut worst, mut n_listed) = (0.0_f64, 0);
    let steps = recorded_steps(&root, "DoubleStraight");
    for step in steps.iter().filter(|step| step.rotation_deg == 0.0) {
        for degrees in [-60.0, -30.0, 30.0, 60.0] {
            let listed = corners_in(&turned(&levels(&step.folder, step.index), degrees));
            let center = center_in(&turned(&levels(&step.folder, 0), degrees));
            n_listed = n_listed.max(listed.len());
            let [pick, place] = planned(&said[step.index], &listed, center);
            let off = [
                distance(pick, turned_point(step.pick, degrees)),
                distance(place, turned_point(step.place, degrees)),
            ];
            let name = step.folder.display();
            assert!(
                off.iter().all(|&off| off <= NEAR_PX),
                "{name} by {degrees}: {off:?}"
            );
            worst = worst.max(off[0]).max(off[1]);
        }
    }
    assert!(
        n_listed > 6,
        "turned edges should bring more than the corners: {n_listed}"
    );
    println!("worst: {worst:.1} px; up to {n_listed} listed corners");
}

#[test]
#[ignore = "long"]
fn folds_to_the_center_are_planned_as_the_expert_did_them() {
    let Some(root) = recorded_data("folds_to_the_center_are_planned_as_the_expert_did_them") else {
        return;
    };
    let said: Vec<String> = (0..4)
        .map(|step| instruction(&root, "AllCornersInward", step))
        .collect();
    let steps = recorded_steps(&root, "AllCornersInward");
    assert!(steps.len() >= 80, "{} steps", steps.len());
    let mut worst = [0.0_f64; 2];
    for step in &steps {
        let listed = corners_in(&levels(&step.folder, step.index));
        let center = center_in(&levels(&step.folder, 0));
        let [pick, place] = planned(&said[step.index], &listed, center);
        // A square turned by more than 45 degrees starts with another, equally right corner.
        if step.rotation_deg <= 45.0 {
            worst[0] = worst[0].max(distance(pick, step.pick));
        }
        // The recorded expert stops a tenth of the way before the center.
        worst[1] = worst[1].max(distance(place, step.place));
    }
    println!(
        "worst pick {:.1} px, worst place {:.1} px",
        worst[0], worst[1]
    );
    assert!(
        worst[0] <= NEAR_PX && worst[1] <= 2.0 * NEAR_PX,
        "{worst:?}"
    );
}

#[test]
fn the_second_fold_of_a_triangle_joins_its_sharp_corners() {
    let Some(root) = recorded_data("the_second_fold_of_a_triangle_joins_its_sharp_corners") else {
        return;
    };
    let said = instruction(&root, "DoubleTriangle", 1);
    let seen = levels(&root.join("subgoals/DoubleTriangle"), 1);
    let (listed, center) = (corners_in(&seen), center_in(&seen));
    let [pick, place] = planned(&said, &listed, center);
    // The arrow drawn on the recorded picture runs along the long side, from lower right to upper left.
    assert!(distance(pick, [182.0, 183.0]) <= NEAR_PX, "{pick:?}");
    assert!(distance(place, [40.0, 43.0]) <= NEAR_PX, "{place:?}");
}

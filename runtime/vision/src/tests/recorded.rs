//! Detectors and drawings against recorded results of the original pipeline.
//!
//! Needs `FABC_REFERENCE_DATA`; without it these tests count as skipped.

use super::super::*;
use super::{corners_by_depth, harris};
use crate::recorded::recorded_data;
use fab_picture::DepthImage;
use fab_picture::SubpixelPoint;
use fab_picture::depth_mask;
use fab_program::{Response, Sight};
use image::Luma;
use serde_json::Value;
use std::path::Path;

fn manifest(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("manifest.json")).unwrap()).unwrap()
}

fn gray(path: impl AsRef<Path>) -> image::GrayImage {
    image::open(path).unwrap().into_luma8()
}

fn recorded_points(list: &Value) -> Vec<[i64; 2]> {
    let point = |point: &Value| [point[0].as_i64().unwrap(), point[1].as_i64().unwrap()];
    list.as_array().unwrap().iter().map(point).collect()
}

/// Truncates coordinates, as the recordings do.
fn truncated(found: Vec<[f32; 2]>) -> Vec<[i64; 2]> {
    found
        .into_iter()
        .map(|point| point.map(|value| value as i64))
        .collect()
}

#[test]
fn harris_corners_match_the_recorded_lists_in_order() {
    let Some(root) = recorded_data("harris_corners_match_the_recorded_lists_in_order") else {
        return;
    };
    let mut n_pictures = 0;
    for fixture in manifest(&root.join("vision/harris128"))["fixtures"]
        .as_array()
        .unwrap()
    {
        let path = root.join(fixture["file"].as_str().unwrap());
        // Held-out pictures are listed too, but may be absent.
        if !path.exists() {
            continue;
        }
        let found = truncated(corners_of_gray(&gray(&path), &harris()).unwrap());
        assert_eq!(
            found,
            recorded_points(&fixture["corners"]),
            "{}",
            path.display()
        );
        n_pictures += 1;
    }
    assert!(n_pictures >= 100, "{n_pictures} pictures");
}

#[test]
fn shi_tomasi_corners_match_the_recorded_lists_in_order() {
    let Some(root) = recorded_data("shi_tomasi_corners_match_the_recorded_lists_in_order") else {
        return;
    };
    let fixtures = manifest(&root.join("vision/shi_tomasi"));
    let mut n_pictures = 0;
    for fixture in fixtures["fixtures"].as_array().unwrap() {
        let path = root.join(fixture["dir"].as_str().unwrap()).join("gray.png");
        if !path.exists() {
            continue;
        }
        let search = CornerSearch {
            of: Sight::Mask,
            image_px: 720,
            max: fixture["corner_limit"].as_u64().unwrap() as u32,
            quality: 0.1,
            spacing_px: 20.0,
            block_px: 3,
            response: Response::ShiTomasi,
        };
        let found = truncated(corners_of_gray(&gray(&path), &search).unwrap());
        assert_eq!(
            found,
            recorded_points(&fixture["recorded_corners"]),
            "{}",
            path.display()
        );
        n_pictures += 1;
    }
    assert!(n_pictures >= 10, "{n_pictures} pictures");
}

#[test]
#[ignore = "long"]
fn every_recorded_pick_is_near_a_detected_corner() {
    let Some(root) = recorded_data("every_recorded_pick_is_near_a_detected_corner") else {
        return;
    };
    let (mut worst_px, mut n_steps) = (0.0_f64, 0);
    for entry in manifest(&root.join("folding120"))["entries"]
        .as_array()
        .unwrap()
    {
        let folder = root.join(entry["dir"].as_str().unwrap());
        if !folder.exists() {
            continue;
        }
        for step in entry["steps"].as_array().unwrap() {
            let levels = gray(folder.join(format!("depth_{}.png", step["step"])));
            let depth = DepthImage::from_fn(levels.width(), levels.height(), |column, row| {
                Luma([f32::from(levels.get_pixel(column, row).0[0]) / 255.0])
            });
            let mask = depth_mask(&depth, 0.646);
            let found = corners_by_depth(&depth, &mask, &harris()).unwrap();
            assert!(found.len() <= 27, "{}", folder.display());
            assert!(
                found.iter().all(|corner| mask.contains(corner.pixel)),
                "{}",
                folder.display()
            );
            let pick = [0, 1].map(|axis| step["pick_px"][axis].as_f64().unwrap());
            let off =
                |corner: &SubpixelPoint| (corner.at[0] - pick[0]).hypot(corner.at[1] - pick[1]);
            worst_px = found
                .iter()
                .map(off)
                .fold(f64::INFINITY, f64::min)
                .max(worst_px);
            n_steps += 1;
        }
    }
    println!("worst of {n_steps} steps: {worst_px:.1} px");
    assert!(n_steps >= 200, "{n_steps} steps");
    assert!(worst_px <= 5.0, "{worst_px} px");
}

#[test]
fn subgoal_arrows_are_drawn_where_they_were_recorded() {
    let Some(root) = recorded_data("subgoal_arrows_are_drawn_where_they_were_recorded") else {
        return;
    };
    let subgoals = manifest(&root.join("subgoals"));
    let mut n_pictures = 0;
    for (task, entry) in subgoals.as_object().unwrap() {
        // One task's recorded drawings are rotated against its pictures.
        if entry["rgbviz_orientation"] != "same as rgb" {
            continue;
        }
        for step in 0..entry["num_steps"].as_u64().unwrap() as usize {
            let point = |list: &str| {
                Some([
                    entry[list][step][0].as_f64()?,
                    entry[list][step][1].as_f64()?,
                ])
            };
            let (Some(tail), Some(tip)) = (point("pick_px"), point("place_px")) else {
                continue;
            };
            let picture = |kind: &str| {
                let path = root.join(format!("subgoals/{task}/{kind}_{step}.png"));
                image::open(path).unwrap().into_rgb8()
            };
            let (ground, mut drawn) = (picture("rgb"), picture("rgb"));
            draw_arrow(&mut drawn, tail, tip).unwrap();
            let mut apart = super::apart(&ground, [&drawn, &picture("rgbviz")], [0; 3]);
            // The recorded line starts in the middle of the ring, ours at the ring.
            let middle = fab_program::PixelPoint::new(tail[0] as i32, tail[1] as i32);
            apart.retain(|at| at.distance_px(middle) > 2.0);
            assert_eq!(apart, [], "{task} step {step}");
            n_pictures += 1;
        }
    }
    assert!(n_pictures >= 8, "{n_pictures} pictures");
}

//! The camera against recorded pictures of the same cloths, and against recorded points.

use crate::recorded;
use crate::recorded::Demonstration;
use fab_sim::{ImageUp, Look, TopDownCamera};

const SIDE: usize = 224;
const TASKS: [&str; 3] = ["AllCornersInward", "CornersEdgesInward", "DoubleStraight"];

/// Reads a recorded 8-bit PNG as rows of pixels of `channels` bytes.
fn recorded_picture(demo: &Demonstration, name: &str, channels: usize) -> Vec<u8> {
    let file = std::fs::File::open(demo.folder.join(name)).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!((info.width, info.height), (SIDE as u32, SIDE as u32));
    assert_eq!(info.color_type.samples(), channels);
    bytes.truncate(info.buffer_size());
    bytes
}

/// Returns where a recorded picture shows cloth, by depth: levels are floor(255 depth), and the table is 165.
fn cloth_by_depth(demo: &Demonstration, image: usize) -> Vec<bool> {
    let levels = recorded_picture(demo, &format!("depth_{image}.png"), 1);
    levels.into_iter().map(|level| level <= 164).collect()
}

/// Returns where a recorded picture shows cloth, by colour: the tiles are grey, and shading does not change
/// saturation.
///
/// Saturation is 1 on the orange top, 0.42 on the pink underside and 0.01 on the tiles. A pixel counts as cloth if at
/// least half of it is covered: half top and half tile has 0.51 and more green than blue, half underside 0.21 and
/// less.
fn cloth_by_colour(demo: &Demonstration, image: usize) -> Vec<bool> {
    let is_cloth = |pixel: &[u8]| {
        let [red, green, blue] = [0, 1, 2].map(|channel| f32::from(pixel[channel]));
        let (low, high) = (red.min(green).min(blue), red.max(green).max(blue));
        let half = if green > blue { 0.51 } else { 0.21 };
        high - low > half * high
    };
    let rgb = recorded_picture(demo, &format!("rgb_{image}.png"), 3);
    rgb.chunks(3).map(is_cloth).collect()
}

/// Draws every demonstration's start and end, and compares masks pixel by pixel. On average at least 0.99 of the
/// union is common, and at least `least` at every single start and end.
fn compare(
    demos: &[Demonstration],
    rule: &str,
    cloth: fn(&Demonstration, usize) -> Vec<bool>,
    least: [f64; 2],
) {
    let camera = TopDownCamera::new(0.65, 45f32.to_radians(), SIDE as u32).unwrap();
    for task in TASKS {
        for (moment, least) in ["start", "end"].into_iter().zip(least) {
            let mut overlaps = Vec::new();
            for demo in demos.iter().filter(|demo| demo.task == task) {
                let (points, image) = match moment {
                    "start" => (&demo.start, 0),
                    _ => (&demo.end, demo.actions.len()),
                };
                let frame = camera.render(demo.grid, points, &Look::default());
                let drawn = frame.depth_m.iter().map(|depth| 255.0 * depth < 165.0);
                let recorded = cloth(demo, image);
                assert_eq!([frame.depth_m.len(), recorded.len()], [SIDE * SIDE; 2]);
                let (mut both, mut either) = (0u32, 0u32);
                for (drawn, recorded) in drawn.zip(recorded) {
                    both += u32::from(drawn && recorded);
                    either += u32::from(drawn || recorded);
                }
                let overlap = f64::from(both) / f64::from(either);
                overlaps.push((overlap, demo.id));
            }
            let n = overlaps.len();
            let mean = overlaps.iter().map(|(overlap, _)| overlap).sum::<f64>() / n as f64;
            let (min, id) =
                overlaps.iter().fold(
                    (1.0, 0),
                    |worst: (f64, u64), &one| {
                        if one.0 < worst.0 { one } else { worst }
                    },
                );
            println!("{task} {moment}, {rule}: IoU mean {mean:.4}, min {min:.4} (id {id}), n {n}");
            assert!(n >= 20, "{task}: {n} demonstrations");
            assert!(mean >= 0.99, "{task} {moment}, {rule}: mean IoU {mean:.4}");
            assert!(min >= least, "{task} {id} {moment}, {rule}: IoU {min:.4}");
        }
    }
}

#[test]
#[ignore = "long"]
fn recorded_starts_and_ends_cover_the_recorded_pixels() {
    let name = "recorded_starts_and_ends_cover_the_recorded_pixels";
    let Some(demos) = recorded::demonstrations(name) else {
        return;
    };
    compare(&demos, "depth", cloth_by_depth, [0.98, 0.98]);
}

#[test]
#[ignore = "long"]
fn recorded_starts_and_ends_cover_the_coloured_pixels() {
    let name = "recorded_starts_and_ends_cover_the_coloured_pixels";
    let Some(demos) = recorded::demonstrations(name) else {
        return;
    };
    compare(&demos, "colour", cloth_by_colour, [0.98, 0.98]);
}

/// Recorded pick points are three-dimensional; the corners from which they were chosen are pixels.
#[test]
fn recorded_smoothing_picks_project_onto_a_recorded_corner() {
    let name = "recorded_smoothing_picks_project_onto_a_recorded_corner";
    let Some(root) = recorded::data::recorded_data(name) else {
        return;
    };
    let text = std::fs::read_to_string(root.join("vision/shi_tomasi/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let camera = TopDownCamera::new(1.0, 45f32.to_radians(), 720).unwrap();
    let camera = camera.with_up(ImageUp::X);
    let mut offsets_px = Vec::new();
    for fixture in manifest["fixtures"].as_array().unwrap() {
        // A recorded action that was edited by hand has no point.
        let Some(point) = fixture["pick_world_m"].as_array() else {
            continue;
        };
        let [x, up, z] = [0, 1, 2].map(|axis| point[axis].as_f64().unwrap() as f32);
        let [column, row] = camera.project([x, -z, up]);
        let corners = fixture["recorded_corners"].as_array().unwrap();
        let offset_px = corners
            .iter()
            .map(|corner| [0, 1].map(|axis| corner[axis].as_f64().unwrap() as f32))
            .map(|corner| (corner[0] - column).hypot(corner[1] - row))
            .fold(f32::INFINITY, f32::min);
        // One corner was beside the cloth, so the nearest cloth pixel was picked instead.
        assert!(offset_px < 1.01, "{}: {offset_px} px", fixture["name"]);
        offsets_px.push(offset_px);
    }
    println!("picks to corners: {offsets_px:.4?} px");
    assert!(offsets_px.len() >= 5, "{} pairs", offsets_px.len());
    let exact = offsets_px.iter().filter(|offset| **offset < 0.01).count();
    assert!(exact + 1 >= offsets_px.len(), "{offsets_px:?}");
}

#[test]
fn recorded_folding_picks_project_onto_the_recorded_pixels() {
    let name = "recorded_folding_picks_project_onto_the_recorded_pixels";
    let Some(root) = recorded::data::recorded_data(name) else {
        return;
    };
    let text = std::fs::read_to_string(root.join("folding120/manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    let camera = TopDownCamera::new(0.65, 45f32.to_radians(), SIDE as u32).unwrap();
    let (mut n_points, mut worst_px) = (0, 0f32);
    for entry in manifest["entries"].as_array().unwrap() {
        for step in entry["steps"].as_array().unwrap() {
            for (world, pixel) in [("pick_world_m", "pick_px"), ("place_world_m", "place_px")] {
                let number = |name: &str, axis: usize| step[name][axis].as_f64().unwrap() as f32;
                let [x, up, z] = [0, 1, 2].map(|axis| number(world, axis));
                let [column, row] = camera.project([x, -z, up]);
                let off = (column - number(pixel, 0)).hypot(row - number(pixel, 1));
                worst_px = worst_px.max(off);
                n_points += 1;
            }
        }
    }
    println!("folding picks and places: worst {worst_px:.5} px, n {n_points}");
    assert!(n_points >= 400, "{n_points} points");
    assert!(worst_px < 0.01, "{worst_px} px");
}

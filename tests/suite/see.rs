//! `fabc see`: keypoints and layers on a picture of the user's, as a rollout finds and draws them.
//!
//! In: `tests/fixtures/tasks/recorded_*.fab`, and recorded pictures with what OpenCV found in them.

use super::steered::steered_but;
use super::support::{ProjectFiles, fabc, finish, project, world};
use crate::recorded_data::recorded_data;
use fab_agent::scene::Scene;
use fab_agent::see::{SeeInput, see};
use fab_picture::Mask;
use fab_picture::png;
use fab_program::scene::SceneView;
use fab_program::{PixelPoint, Program};
use fab_vision::{bounding_box, box_center};
use fab_world::start::Start;
use image::{ImageBuffer, Luma, Rgb, RgbImage};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const SMOOTHING: &str = "tests/fixtures/tasks/recorded_smoothing.fab";
pub(super) const FOLDING: &str = "tests/fixtures/tasks/recorded_folding.fab";

fn program(file: &str, variant: Option<&str>) -> Program {
    let compiled = fab_compiler::compile(file, &ProjectFiles).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    let mut programs = compiled.programs.into_iter();
    programs
        .find(|program| program.variant.as_deref() == variant)
        .unwrap()
}

fn fixtures(root: &Path, folder: &str) -> Vec<Value> {
    let manifest = fs::read_to_string(root.join(folder).join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    manifest["fixtures"].as_array().unwrap().clone()
}

/// Runs `fabc see … --json` in a folder and returns its document.
fn seen(folder: &Path, arguments: &[&str]) -> Value {
    let said = finish(fabc(folder).arg("see").args(arguments).arg("--json"));
    assert_eq!(said.code, 0, "{arguments:?}\n{}", said.stderr);
    serde_json::from_str(&said.stdout).unwrap()
}

/// The place of a recorded action: the middle of the purple ring around it.
fn place_shown(drawing: &RgbImage) -> PixelPoint {
    let purple = Mask::from_fn(drawing.width(), drawing.height(), |column, row| {
        drawing.get_pixel(column, row).0 == [128, 0, 128]
    });
    box_center(bounding_box(&purple).unwrap())
}

/// The pixels that a drawing on a picture changed.
fn marks(ground: &RgbImage, drawing: &RgbImage) -> Mask {
    Mask::from_fn(ground.width(), ground.height(), |column, row| {
        ground.get_pixel(column, row) != drawing.get_pixel(column, row)
    })
}

#[test]
#[ignore = "long"]
fn recorded_smoothing_pictures_give_their_corners_in_order_and_their_annotations_in_place() {
    let test =
        "recorded_smoothing_pictures_give_their_corners_in_order_and_their_annotations_in_place";
    let Some(root) = recorded_data(test) else {
        return;
    };
    let mut last_place = None;
    let (mut n_pictures, mut n_annotated) = (0, 0);
    for fixture in fixtures(&root, "vision/shi_tomasi") {
        let folder = root.join(fixture["dir"].as_str().unwrap());
        if !folder.exists() {
            continue;
        }
        let name = fixture["name"].as_str().unwrap();
        // Each series starts again from step 0.
        let is_first = name.ends_with("_step_0");
        last_place = last_place.filter(|_| !is_first);
        let out = tempfile::tempdir().unwrap();
        let (task, image) = (project(SMOOTHING), folder.join("aug.png"));
        let mut arguments = vec![task.as_str(), "--image", image.to_str().unwrap()];
        if fixture["corner_limit"] == 10 {
            arguments.extend(["--variant", "ten"]);
        }
        let place: String;
        if let Some(PixelPoint { u, v }) = last_place {
            place = format!("{u},{v}");
            arguments.extend(["--last-place", &place]);
        }
        arguments.extend(["--out", "pictures"]);
        let said = seen(out.path(), &arguments);
        let bounds = |side: &str| fixture["bounds_px"][side].clone();
        let expected = json!({
            "corners": fixture["recorded_corners"],
            // The recordings call the largest row the top.
            "frame": [[bounds("left"), bounds("bottom")], [bounds("right"), bounds("top")]],
            "center": [fixture["center_px"]],
        });
        assert_eq!(said["keypoints"], expected, "{name}");
        // If the previous action is not recorded, its rings cannot be drawn.
        if is_first || last_place.is_some() {
            let ground = png::load(&image).unwrap();
            let drawings = [
                folder.join("processed.png"),
                out.path().join("pictures/annotated.png"),
            ];
            let marks = drawings.map(|path| marks(&ground, &png::load(&path).unwrap()));
            for [own, other] in [[0, 1], [1, 0]].map(|sides| sides.map(|side| &marks[side])) {
                let lone = |at: &PixelPoint| !other.is_within(2, at.u as u32, at.v as u32);
                let lone: Vec<_> = own.pixels().filter(lone).collect();
                assert_eq!(lone, [], "{name}");
            }
            n_annotated += 1;
        }
        last_place = Some(folder.join("vis.png"))
            .filter(|path| path.exists())
            .map(|path| place_shown(&png::load(&path).unwrap()));
        n_pictures += 1;
    }
    assert!(
        n_pictures >= 10 && n_annotated >= 10,
        "{n_pictures}, {n_annotated}"
    );
}

#[test]
#[ignore = "long"]
fn recorded_folding_pictures_give_their_corners_in_order_and_their_center() {
    let test = "recorded_folding_pictures_give_their_corners_in_order_and_their_center";
    let Some(root) = recorded_data(test) else {
        return;
    };
    let (program, folder) = (program(FOLDING, None), tempfile::tempdir().unwrap());
    let (task, mut n_pictures) = (project(FOLDING), 0);
    for fixture in fixtures(&root, "vision/harris128") {
        let path = root.join(fixture["file"].as_str().unwrap());
        // Held-out pictures are listed too, but may be absent.
        if !path.exists() {
            continue;
        }
        let expected = json!({ "corners": fixture["corners"], "center": [fixture["center"]] });
        let brought = SeeInput {
            rgb: png::load(&path).unwrap(),
            depth_m: None,
            last_place: None,
        };
        let found: serde_json::Map<String, Value> = see(&program, brought)
            .unwrap()
            .scene
            .keypoints()
            .into_iter()
            .map(|(name, points)| (name.to_owned(), json!(points)))
            .collect();
        assert_eq!(Value::Object(found), expected, "{}", path.display());
        if n_pictures % 40 == 0 {
            let said = seen(folder.path(), &[&task, "--image", path.to_str().unwrap()]);
            assert_eq!(said["keypoints"], expected, "{}", path.display());
        }
        n_pictures += 1;
    }
    assert!(n_pictures >= 280, "{n_pictures} pictures");
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        0,
        "written without `--out`"
    );
}

#[test]
fn recorded_depth_pictures_show_a_corner_at_each_recorded_pick() {
    let test = "recorded_depth_pictures_show_a_corner_at_each_recorded_pick";
    let Some(root) = recorded_data(test) else {
        return;
    };
    let (folder, task) = (tempfile::tempdir().unwrap(), project(FOLDING));
    let manifest = fs::read_to_string(root.join("folding120/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let mut n_steps = 0;
    for entry in manifest["entries"].as_array().unwrap() {
        let demonstration = root.join(entry["dir"].as_str().unwrap());
        // Only every eighth: another test checks all of them, without the command.
        if !demonstration.exists() || entry["id"].as_u64().unwrap() % 8 != 0 {
            continue;
        }
        let step = &entry["steps"][0];
        let file = |kind: &str| format!("{}/{kind}_0.png", demonstration.display());
        let (image, depth) = (file("rgb"), file("depth"));
        let by_depth = [
            "--variant",
            "by_depth",
            "--image",
            &image,
            "--depth",
            &depth,
        ];
        let said = seen(folder.path(), &[&[task.as_str()], &by_depth[..]].concat());
        let pick = [0, 1].map(|axis| step["pick_px"][axis].as_f64().unwrap());
        let corners: Vec<[f64; 2]> =
            serde_json::from_value(said["keypoints"]["corners"].clone()).unwrap();
        let off = |at: &[f64; 2]| (at[0] + 0.5 - pick[0]).hypot(at[1] + 0.5 - pick[1]);
        let nearest_px = corners.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(nearest_px <= 5.0, "{image}: {nearest_px} px");
        n_steps += 1;
    }
    assert!(n_steps >= 10, "{n_steps} steps");
}

#[test]
fn what_is_seen_is_what_a_rollout_sees() {
    let program = program("tests/fixtures/tasks/steered.fab", None);
    let mut world = world(&program).unwrap();
    world.reset(&Start::flat(&program.cloth)).unwrap();
    let observation = world.observe().unwrap();
    let expected = Scene::of(&program, &observation, None).unwrap();
    let place = PixelPoint::new(60, 70);
    for last_place in [None, Some(place)] {
        let brought = SeeInput {
            rgb: observation.rgb.clone(),
            depth_m: Some(observation.depth_m.clone()),
            last_place,
        };
        let seen = see(&program, brought).unwrap();
        assert_eq!(seen.scene.to_json(), expected.to_json());
        let is_red = |pixel: &Rgb<u8>| pixel.0 == [255, 0, 0];
        assert_eq!(seen.annotated.pixels().any(is_red), last_place.is_some());
        let names = seen.stages.iter().map(|(name, _)| name.as_str());
        let kept = program
            .layers
            .iter()
            .filter(|layer| last_place.is_some() || !layer.uses_last());
        let keypoints = program
            .keypoints
            .iter()
            .map(|keypoint| keypoint.name.as_str());
        let wanted = keypoints.chain(kept.map(|layer| layer.name.as_str()));
        assert!(names.eq(wanted), "{:?}", seen.stages.len());
        assert!(seen.stages.last().unwrap().1 == seen.annotated);
    }
}

/// Side of the picture that `by_depth` takes.
pub(super) const SIDE_PX: u32 = 224;

/// Writes a grey picture in which a rectangle stands for the cloth.
pub(super) fn write_depth<T: image::Primitive>(path: &Path, cloth: T, table: T)
where
    Luma<T>: image::PixelWithColorType<Subpixel = T>,
    [T]: image::EncodableLayout,
{
    let is_cloth = |column, row| (60..150).contains(&column) && (80..170).contains(&row);
    ImageBuffer::from_fn(SIDE_PX, SIDE_PX, |column, row| {
        Luma([if is_cloth(column, row) { cloth } else { table }])
    })
    .save(path)
    .unwrap();
}

#[test]
fn depth_counts_255_levels_a_metre_in_8_bits_and_millimetres_in_16() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    RgbImage::new(SIDE_PX, SIDE_PX).save(file("a.png")).unwrap();
    write_depth::<u8>(&file("8.png"), 164, 165);
    write_depth::<u16>(&file("16.png"), 645, 650);
    // One level or one millimetre is enough to tell cloth from table.
    write_depth::<u16>(&file("limit.png"), 645, 646);
    let task = project(FOLDING);
    for depth in ["8.png", "16.png", "limit.png"] {
        let by_depth = [
            &task,
            "--variant",
            "by_depth",
            "--image",
            "a.png",
            "--depth",
            depth,
        ];
        let said = seen(folder.path(), &by_depth);
        assert_eq!(said["masks"]["cloth"]["area_px"], 90 * 90, "{depth}");
        assert_eq!(said["keypoints"]["center"], json!([[104, 124]]), "{depth}");
        assert_eq!(
            said["keypoints"]["corners"].as_array().unwrap().len(),
            4,
            "{depth}"
        );
    }
}

#[test]
fn the_middle_of_the_picture_is_that_of_a_box_around_all_of_it() {
    for side_px in [224, 195] {
        let size = format!("image: {side_px}px");
        let program = steered_but(&[
            ("image: 224px", size.as_str()),
            (
                "middles = edge_middles",
                "all = mask(hue: 0deg to 360deg, saturation: 0 to 1, value: 0 to 1)
                 borders = bounding_box(all)
                 boxed = center(borders)
                 picture = center()
                 middles = edge_middles",
            ),
        ]);
        let mut world = world(&program).unwrap();
        world.reset(&Start::flat(&program.cloth)).unwrap();
        let scene = Scene::of(&program, &world.observe().unwrap(), None).unwrap();
        let middle = (side_px - 1) / 2;
        assert_eq!(
            scene.points("picture"),
            Some(vec![PixelPoint::new(middle, middle)])
        );
        assert_eq!(scene.points("picture"), scene.points("boxed"));
    }
}

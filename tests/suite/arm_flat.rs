//! The picture of the flat cloth on an arm's table: from the settings, or of the simulated table.

use super::support::{self, bring_robot, fabc, finish};
use fab_arm::supervisor::Unattended;
use fab_arm::world::{ArmWorld, Files};
use fab_world::World;
use fab_world::start::Start;
use image::RgbImage;
use std::path::Path;

const WINDOW: &str = "window_px = [0, 0, 720]";

/// Names a picture of the flat cloth in the settings.
fn name_flat(folder: &Path) {
    let named = format!("{WINDOW}\nflat = \"flat.png\"");
    bring_robot(folder, &[(WINDOW, &named)]);
}

fn arm(folder: &Path) -> ArmWorld {
    let robot = folder.join("robot.toml");
    let image_px = support::small_task().camera.image_px;
    support::simulated_arm(&robot, image_px, Box::new(Unattended), None)
}

/// Counts the pixels that are as colourful as the cloth.
fn cloth_px(picture: &RgbImage) -> usize {
    let spread = |pixel: &image::Rgb<u8>| {
        pixel.0.iter().max().unwrap_or(&0) - pixel.0.iter().min().unwrap_or(&0)
    };
    picture.pixels().filter(|pixel| spread(pixel) > 60).count()
}

#[test]
#[ignore = "long"]
fn a_simulated_table_shows_the_same_cloth_flat() {
    let folder = tempfile::tempdir().unwrap();
    bring_robot(folder.path(), &[]);
    let mut world = arm(folder.path());
    assert!(world.flat_cloth().is_none(), "no cloth was laid yet");
    let cloth = support::small_task().cloth;
    let mut folded = Start::flat(&cloth);
    for [x, _, z] in &mut folded.positions {
        if *x > 0.0 {
            (*x, *z) = (-*x, 0.015);
        }
    }
    world.reset(&folded).unwrap();
    let flat = world.flat_cloth().unwrap();
    let share = cloth_px(&world.observe().unwrap().rgb) as f64 / cloth_px(&flat.rgb) as f64;
    assert!((share - 0.5).abs() < 0.05, "half of it is seen: {share}");
    world.reset(&Start::flat(&cloth)).unwrap();
    let share = cloth_px(&world.observe().unwrap().rgb) as f64 / cloth_px(&flat.rgb) as f64;
    assert!((share - 1.0).abs() < 0.03, "all of it is seen: {share}");
}

#[test]
fn a_picture_that_is_named_is_cut_to_the_window_and_counts_into_the_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("robot.toml");
    name_flat(folder.path());
    let mut picture = RgbImage::new(720, 720);
    picture.put_pixel(719, 0, image::Rgb([255; 3]));
    picture.save(folder.path().join("flat.png")).unwrap();
    let world = arm(folder.path());
    let side_px = support::small_task().camera.image_px;
    let seen = world.flat_cloth().unwrap();
    assert_eq!(seen.rgb.dimensions(), (side_px, side_px));
    assert!(seen.rgb.get_pixel(side_px - 1, 0).0[0] > 0);
    assert!(
        seen.depth_m.pixels().all(|depth| depth.0[0] == 0.0),
        "nobody measured its depth"
    );
    let first = Files::load(&robot).unwrap().about;
    assert_eq!(
        (
            first.name.as_str(),
            first.parameters.clone(),
            first.code.clone()
        ),
        (world.name(), world.parameters(), world.code())
    );
    picture.put_pixel(5, 5, image::Rgb([1; 3]));
    picture.save(folder.path().join("flat.png")).unwrap();
    assert_ne!(
        Files::load(&robot).unwrap().about.parameters,
        first.parameters
    );
}

#[test]
fn a_picture_that_cannot_be_used_is_told_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    name_flat(folder.path());
    let run = || {
        let task = support::project("tasks/real/double_triangle.fab");
        finish(fabc(folder.path()).args(["run", &task, "--world", "jaco", "--out", "run"]))
    };
    let missing = run();
    assert_eq!(missing.code, 2);
    assert!(
        missing
            .stderr
            .contains("`camera.flat`, the picture of the flat cloth: cannot read"),
        "{}",
        missing.stderr
    );
    RgbImage::new(640, 480)
        .save(folder.path().join("flat.png"))
        .unwrap();
    let small = run();
    assert_eq!(small.code, 2);
    assert!(
        small
            .stderr
            .contains("has 640 x 480 px, and the calibrated camera's own pictures have 720 x 720"),
        "{}",
        small.stderr
    );
    assert!(!folder.path().join("run").exists());
}

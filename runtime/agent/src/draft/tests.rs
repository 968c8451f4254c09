//! Tests that drafting recovers the folds of known pictures.
#![allow(clippy::unwrap_used)]

use super::*;
use fab_picture::png;

use fab_program::ClothPoint;
use fab_world::{SimulatedWorld, World};
use std::path::{Path, PathBuf};

fn make_world(camera: &program::Camera) -> Result<Box<dyn World>, WorldError> {
    let world = SimulatedWorld::new(camera, program::Picker::PutDown)?;
    Ok(Box::new(world))
}

fn drafted(pictures: &[NamedPicture]) -> Result<Draft, RunError> {
    draft(pictures, None, &make_world, &Interrupt::default(), &|_| {})
}

fn load(paths: &[PathBuf]) -> Vec<NamedPicture> {
    let load = |path: &PathBuf| NamedPicture {
        name: path.file_name().unwrap().to_str().unwrap().to_owned(),
        picture: png::load(path).unwrap(),
    };
    paths.iter().map(load).collect()
}

const TASKS: [&str; 8] = [
    "double_triangle",
    "double_straight",
    "all_corners_inward",
    "corners_edges_inward",
    "cupboard",
    "house",
    "open_envelope",
    "sash",
];

/// The pinned pictures of a shipped task, and the arrows of its steps.
fn pinned(task: &str) -> (Vec<NamedPicture>, Vec<ArrowPx>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tasks")
        .join(format!("{task}.subgoals"));
    let pins = std::fs::read_to_string(folder.join("pins.json")).unwrap();
    let pins: serde_json::Value = serde_json::from_str(&pins).unwrap();
    let arrows: Vec<ArrowPx> = serde_json::from_value(pins["arrows"].clone()).unwrap();
    let paths: Vec<PathBuf> = (0..=arrows.len())
        .map(|number| folder.join(format!("{number}.png")))
        .collect();
    (load(&paths), arrows)
}

fn off_px(found: &ArrowPx, right: &ArrowPx) -> f64 {
    let off = |end: usize| (found[end][0] - right[end][0]).hypot(found[end][1] - right[end][1]);
    off(0).max(off(1))
}

/// Asserts that every step's arrow was proposed in the right place.
fn check(task: &str, draft: &Draft, arrows: &[ArrowPx], within_px: f64) {
    assert_eq!(draft.steps.len(), arrows.len(), "{task}");
    for (number, (step, right)) in draft.steps.iter().zip(arrows).enumerate() {
        let off = off_px(&step.arrow, right);
        let said = format!("{task}, step {number}: {off:.1} px off, {step:?}");
        assert!(off <= within_px, "{said}");
    }
}

#[test]
#[ignore = "long"]
fn folds_are_proposed_for_every_shipped_task() {
    for task in TASKS {
        let (pictures, arrows) = pinned(task);
        let draft = drafted(&pictures).unwrap();
        for (step, right) in draft.steps.iter().zip(&arrows) {
            let (off, sure) = (off_px(&step.arrow, right), step.is_sure());
            eprintln!(
                "{task}: {off:.1} px off, overlap {:.3}, sure: {sure}, next {:?}",
                step.overlap, step.next_best
            );
        }
        let is_house = task == "house";
        let within_px = if is_house { 2.0 } else { 10.0 };
        check(task, &draft, &arrows, within_px);
        let depth = if task == "double_straight" { 44 } else { 55 };
        assert_eq!([draft.cloth.dimx, draft.cloth.dimy], [55, depth], "{task}");
        if is_house {
            assert!(draft.steps.iter().all(DraftStep::is_sure), "{draft:?}");
            let untouched = draft.untouched_m;
            assert!((untouched - 0.025).abs() < 0.001, "{untouched}");
        }
    }
}

/// The recorded pictures of a fold, without arrows.
fn recorded(test: &str, fold: &str) -> Option<(Vec<NamedPicture>, Vec<Option<ArrowPx>>)> {
    let folder = crate::recorded::recorded_data(test)?.join("subgoals");
    let manifest = std::fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    let [picks, places] = ["pick_px", "place_px"].map(|name| {
        let points: Vec<Option<[f64; 2]>> =
            serde_json::from_value(manifest[fold][name].clone()).unwrap();
        points
    });
    let arrows: Vec<_> = picks
        .into_iter()
        .zip(places)
        .map(|(pick, place)| Some([pick?, place?]))
        .collect();
    let paths: Vec<PathBuf> = (0..=arrows.len())
        .map(|number| folder.join(fold).join(format!("rgb_{number}.png")))
        .collect();
    Some((load(&paths), arrows))
}

#[test]
#[ignore = "long"]
fn folds_are_proposed_from_every_recorded_picture() {
    let test = "folds_are_proposed_from_every_recorded_picture";
    for fold in [
        "AllCornersInward",
        "CornersEdgesInward",
        "DoubleStraight",
        "DoubleTriangle",
    ] {
        let Some((pictures, arrows)) = recorded(test, fold) else {
            return;
        };
        let draft = drafted(&pictures).unwrap();
        for (step, right) in draft.steps.iter().zip(&arrows) {
            let off = right.map_or(0.0, |right| off_px(&step.arrow, &right));
            eprintln!(
                "{fold}: {off:.1} px off, overlap {:.3}, sure: {}, {:?}, next {:?}",
                step.overlap,
                step.is_sure(),
                step.fold,
                step.next_best
            );
            // The recorded folds stop short of the center, and some change the outline little.
            assert!(
                off <= 16.0 || !step.is_sure(),
                "{fold}: {off} px off, {step:?}"
            );
        }
        if fold == "DoubleTriangle" {
            let [first, second] = &draft.steps[..] else {
                panic!("{draft:?}");
            };
            let off = off_px(&first.arrow, &arrows[0].unwrap());
            assert!(off <= 2.0, "{off} px off, {first:?}");
            // The second fold was recorded between these two corners.
            let corner = |right, front| ClothPoint::Particle { right, front };
            let second = &second.fold;
            assert_eq!(
                [second.pick, second.place],
                [corner(1.0, 1.0), corner(0.0, 0.0)]
            );
        }
    }
}

#[test]
#[ignore = "long"]
fn a_cloth_that_lies_turned_in_larger_pictures_is_read_as_one_that_lies_straight() {
    let camera = program::Camera {
        image_px: 448,
        height_m: 0.65,
        fov_rad: std::f64::consts::FRAC_PI_4,
        up: program::ImageUp::Y,
    };
    let cloth = Cloth {
        dimx: 49,
        dimy: 41,
        spacing_m: fab_program::RECORDED_SPACING_M,
        start: program::ClothStart::Flat,
        material: None,
    };
    let start = Start::turned_by(&cloth, 20.0_f64.to_radians());
    let mut world = SimulatedWorld::new(&camera, program::Picker::PutDown).unwrap();
    world.reset(&start).unwrap();
    let fold = Fold {
        pick: ClothPoint::Particle {
            right: 1.0,
            front: 0.0,
        },
        place: ClothPoint::Center,
        fraction: 1.0,
    };
    let before = world.observe().unwrap();
    let grip = fab_world::expert::grip(&fold, &start, &world).unwrap();
    let right = [grip.pick, grip.place].map(|at| before.camera.pixel_from_world(at).unwrap());
    world.act(&grip.into(), &Interrupt::default()).unwrap();
    let after = world.observe().unwrap();
    let pictures =
        [("a.png", before.rgb), ("b.png", after.rgb)].map(|(name, picture)| NamedPicture {
            name: name.to_owned(),
            picture,
        });
    let draft = drafted(&pictures).unwrap();
    assert_eq!(draft.camera, camera);
    // Counter-clockwise from above is counter-clockwise in the picture.
    let turned_deg = draft.turned_rad.to_degrees();
    assert!((turned_deg + 20.0).abs() < 1.0, "{turned_deg}");
    let off = [draft.cloth.dimx.abs_diff(49), draft.cloth.dimy.abs_diff(41)];
    assert!(off.iter().all(|off| *off <= 1), "{:?}", draft.cloth);
    let off = off_px(&draft.steps[0].arrow, &right);
    assert!(off <= 6.0, "{off} px off, {:?}", draft.steps[0]);
    assert_eq!(draft.steps[0].fold, fold);
}

/// A table of one colour with a cloth of another, `[left, top, right, bottom]`, pixels.
fn painted(name: &str, side_px: [u32; 2], [left, top, right, bottom]: [u32; 4]) -> NamedPicture {
    let picture = RgbImage::from_fn(side_px[0], side_px[1], |column, row| {
        let is_cloth = (left..right).contains(&column) && (top..bottom).contains(&row);
        image::Rgb(if is_cloth { [200, 60, 20] } else { [230; 3] })
    });
    NamedPicture {
        name: name.to_owned(),
        picture,
    }
}

#[test]
fn pictures_that_show_no_fold_are_refused_with_what_would_be_right() {
    let square = [224; 2];
    let flat = painted("flat.png", square, [40, 40, 184, 184]);
    let half = painted("half.png", square, [40, 40, 184, 112]);
    let table = painted("table.png", square, [0; 4]);
    let speck = painted("speck.png", square, [100, 100, 120, 124]);
    let wide = painted("wide.png", [224, 200], [40, 40, 184, 112]);
    let tiny = painted("tiny.png", [16; 2], [4, 4, 12, 12]);
    let small = painted("small.png", [112; 2], [20, 20, 92, 56]);
    let cut = painted("cut.png", square, [80, 80, 224, 200]);
    // Too few of the cloth's pixels to count as a colour of the table.
    let nearly = painted("nearly.png", [400; 2], [40, 380, 64, 400]);
    let mut carpet = table.clone();
    carpet.name = "carpet.png".to_owned();
    for (column, row, pixel) in carpet.picture.enumerate_pixels_mut() {
        let level = |step: u32| ((column * step + row * 89) % 256) as u8;
        *pixel = image::Rgb([level(53), level(97), level(151)]);
    }
    let cases: [(Vec<&NamedPicture>, &str); 12] = [
        (
            vec![&cut, &cut],
            "no whole cloth is seen on `cut.png`; the picture must show a plain, evenly lit table",
        ),
        (
            vec![&nearly, &nearly],
            "no whole cloth is seen on `nearly.png`",
        ),
        (
            vec![&carpet, &carpet],
            "no whole cloth is seen on `carpet.png`",
        ),
        (vec![], "0 pictures given; there must be 2 to 101"),
        (vec![&flat], "1 picture given; there must be 2 to 101"),
        (
            vec![&flat, &wide],
            "`wide.png` has 224 x 200 px; it must be a square",
        ),
        (
            vec![&tiny, &tiny],
            "`tiny.png` has 16 x 16 px; it must be a square of 32 to 2048",
        ),
        (
            vec![&flat, &small],
            "`small.png` has 112 x 112 px; it must be a square",
        ),
        (vec![&flat, &table], "no whole cloth is seen on `table.png`"),
        (
            vec![&speck, &speck],
            "the cloth must fill at least an eighth",
        ),
        (
            vec![&flat, &flat],
            "`flat.png` shows 100 % of the cloth of `flat.png` (their outlines overlap by 1.000)",
        ),
        (
            vec![&half, &flat],
            "`flat.png` shows 200 % of the cloth of `half.png`",
        ),
    ];
    for (pictures, told) in cases {
        let pictures: Vec<NamedPicture> = pictures.into_iter().cloned().collect();
        let message = drafted(&pictures).unwrap_err().to_string();
        assert!(message.contains(told), "{message}");
    }
}

#[test]
#[ignore = "long"]
fn any_pixels_give_a_draft_or_a_message() {
    let mut chance = fab_base::chance::Chance::seeded(1);
    let mut noise = |coarse: u32| {
        let side = 64 / coarse;
        let tiles: Vec<u8> = (0..side * side * 3)
            .map(|_| (chance.fraction() * 255.0) as u8)
            .collect();
        RgbImage::from_fn(64, 64, |column, row| {
            let tile = ((row / coarse) * side + column / coarse) as usize * 3;
            image::Rgb([tiles[tile], tiles[tile + 1], tiles[tile + 2]])
        })
    };
    for coarse in [1, 4, 16, 32] {
        let pictures = ["a.png", "b.png"].map(|name| NamedPicture {
            name: name.to_owned(),
            picture: noise(coarse),
        });
        if let Err(error) = drafted(&pictures) {
            assert!(!error.to_string().is_empty());
        }
    }
}

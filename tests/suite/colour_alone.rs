//! Keypoints from colour alone, as on the paper's real table: no depth, and no number that depends on the lighting.

use super::support::{self, ProjectFiles, Trial};
use fab_agent::rollout::RunError;
use fab_agent::see::{SeeInput, SeeOutput, see};
use fab_compiler::{LoadError, Loader};
use fab_program::{PixelPoint, Program};
use fab_world::Look;
use image::{Rgb, RgbImage};

/// A uniformly grey table with a square of a colour from 146 to 333 on both axes, and a speck of that colour far away.
fn table(grey: u8, cloth: [u8; 3]) -> RgbImage {
    RgbImage::from_fn(480, 480, |column, row| {
        let is_cloth = (146..334).contains(&column) && (146..334).contains(&row);
        let is_speck = (20..34).contains(&column) && (400..414).contains(&row);
        Rgb(match is_cloth || is_speck {
            true => cloth,
            false => [grey; 3],
        })
    })
}

fn look(program: &Program, rgb: RgbImage) -> Result<SeeOutput, RunError> {
    let (depth_m, last_place) = (None, None);
    let brought = SeeInput {
        rgb,
        depth_m,
        last_place,
    };
    see(program, brought)
}

fn real(task: &str) -> Program {
    let file = format!("tasks/real/{task}.fab");
    let compiled = fab_compiler::compile(&file, &ProjectFiles).unwrap();
    assert!(
        compiled.diagnostics.is_empty(),
        "{:?}",
        compiled.diagnostics
    );
    compiled.programs.into_iter().next().unwrap()
}

fn points<'s>(seen: &'s SeeOutput, name: &str) -> Vec<PixelPoint> {
    let listed: Vec<(&'s str, Vec<PixelPoint>)> = seen.scene.keypoints();
    listed
        .into_iter()
        .find(|(known, _)| *known == name)
        .unwrap()
        .1
}

#[test]
#[ignore = "long"]
fn the_largest_coloured_piece_is_the_cloth_under_any_lamp() {
    let program = real("double_triangle");
    for (grey, cloth) in [
        (240, [250, 110, 20]),
        (60, [70, 40, 90]),
        (128, [20, 120, 40]),
    ] {
        let seen = look(&program, table(grey, cloth)).unwrap();
        let masks = seen.scene.masks();
        let area = |name: &str| {
            let mask = masks.iter().find(|(known, _)| *known == name);
            mask.unwrap().1.area_px()
        };
        assert!(
            area("colored") > area("cloth") + 14 * 14 / 2,
            "the speck is coloured"
        );
        let cloth = seen.scene.cloth().unwrap();
        assert_eq!(cloth.area_px(), area("cloth"));
        assert!((cloth.area_px() as i64 - 188 * 188).abs() < 188 * 4);
        let corners = points(&seen, "corners");
        assert_eq!(corners.len(), 4, "{corners:?}");
        for [u, v] in [[146, 146], [146, 333], [333, 146], [333, 333]] {
            let wanted = PixelPoint::new(u, v);
            let is_near = |corner: &PixelPoint| corner.distance_px(wanted) < 4.0;
            assert!(corners.iter().any(is_near), "{wanted}: {corners:?}");
        }
        assert_eq!(points(&seen, "center"), [PixelPoint::new(239, 239)]);
    }
}

#[test]
fn a_bare_table_shows_no_cloth() {
    for task in ["double_triangle", "smoothing"] {
        let tiles = RgbImage::from_fn(480, 480, |column, row| {
            Rgb([if (column / 160 + row / 160) % 2 == 0 {
                213
            } else {
                243
            }; 3])
        });
        let message = look(&real(task), tiles).err().unwrap().to_string();
        assert!(
            message.starts_with("no pixel of the picture belongs to `colored`")
                && message.contains("all its pixels are alike"),
            "{message}"
        );
        let tinged = table(200, [204, 200, 198]);
        let message = look(&real(task), tinged).err().unwrap().to_string();
        assert!(message.contains("and the mask asks for 0.15"), "{message}");
    }
}

/// A task and the shipped library in a folder beside it.
struct Own(String);

impl Loader for Own {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        match name {
            "tasks/real/own.fab" => Ok(self.0.clone()),
            _ => ProjectFiles.load(name),
        }
    }
}

fn own(keypoints: &str) -> Program {
    let text = format!(
        "use \"../lib/real.fab\"\ntask own extends real_folding {{ cloth grid(50, 50) horizon 1\n\
         without component center_pivoting\n\
         stage describe {{ model vision show scene say \"?\" read instruction from \"I: {{instruction}}\" }}\n\
         verify {{ attempts 1 }}\nkeypoints {{ {keypoints} }} }}"
    );
    let compiled = fab_compiler::compile("tasks/real/own.fab", &Own(text)).unwrap();
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.programs.into_iter().next().unwrap()
}

#[test]
fn new_keypoints_come_before_the_replaced_one_that_they_stand_above() {
    let program = own(
        "plain = mask(split: brightness, keep: low) cloth = largest(plain) rim = contour(cloth, tolerance: 2px)",
    );
    let names: Vec<&str> = program
        .keypoints
        .iter()
        .map(|it| it.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "colored", "pieces", "plain", "cloth", "frame", "corners", "center", "rim"
        ]
    );
}

#[test]
fn corners_are_kept_near_a_box_and_moved_towards_a_point() {
    // Of the cloth's four corners, two lie in the box around its blue half, and two 94 px outside.
    let half = |margin: &str| {
        own(&format!(
            "blue = mask(hue: 200deg to 250deg, saturation: 0.3 to 1, value: 0.2 to 1) \
             left = bounding_box(blue) \
             corners = harris(cloth, of: mask, inside: left{margin}, max: 27, quality: 0.04, spacing: 20px) \
             grips = toward(corners, center, share: 0.25)"
        ))
    };
    let mut rgb = table(230, [250, 110, 20]);
    for (column, _, pixel) in rgb.enumerate_pixels_mut() {
        if pixel.0 == [250, 110, 20] && (146..240).contains(&column) {
            pixel.0 = [30, 60, 220];
        }
    }
    let seen = look(&half(""), rgb.clone()).unwrap();
    let corners = points(&seen, "corners");
    assert_eq!(corners.len(), 2, "{corners:?}");
    assert!(corners.iter().all(|corner| corner.u < 160));
    let center = points(&seen, "center")[0];
    for (grip, corner) in points(&seen, "grips").iter().zip(&corners) {
        let wanted = [(corner.u, center.u), (corner.v, center.v)]
            .map(|(from, to)| f64::from(from) + 0.25 * f64::from(to - from));
        assert!((f64::from(grip.u) - wanted[0]).abs() <= 1.0, "{grip}");
        assert!((f64::from(grip.v) - wanted[1]).abs() <= 1.0, "{grip}");
    }
    let wide = look(&half(", margin: 98px"), rgb).unwrap();
    assert_eq!(points(&wide, "corners").len(), 4);
}

#[test]
#[ignore = "long"]
fn the_simulators_cloth_is_folded_in_half_twice_by_colour_alone() {
    let mut program = real("double_straight");
    program.experts.clear();
    program.goal = None;
    let folder = tempfile::tempdir().unwrap();
    let beside = support::root().join("tasks/real");
    let report =
        Trial::new(&program, &beside, Look::default()).run_stand_in(&folder.path().join("run"));
    assert_eq!((report.steps, report.retries), (3, 0));
    // A quarter, plus a little because the layers lie askew.
    let covered = report.measures.coverage_true.unwrap();
    assert!((0.24..0.32).contains(&covered), "{covered}");
}

/// The result of a step is compared with a subgoal picture, in which the cloth is found by its colour.
#[test]
fn faces_of_shipped_materials_are_not_taken_for_the_table() {
    let compiled = fab_compiler::compile("tasks/lib/materials.fab", &ProjectFiles).unwrap();
    let table = fab_sim::Look::default();
    let table = table.tiles.map(|colour| colour.map(f64::from));
    for material in &compiled.materials {
        for face in [&material.upper, &material.under] {
            let is_table = fab_picture::regions::is_table(face.rgb, &table);
            assert!(!is_table, "{} of {}", face.name, material.name);
        }
    }
}

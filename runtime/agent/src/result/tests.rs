//! Tests of the comparison with a subgoal, on painted silhouettes and on recorded ones.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::recorded::recorded_data;
use fab_picture::{Mask, depth_mask};
use proptest::prelude::*;
use std::path::Path;

type Point = [f64; 2];

/// The pose of a cloth in a picture.
#[derive(Clone, Copy, Debug)]
struct View {
    side_px: u32,
    center: Point,
    /// Width and height of the cloth, pixels.
    cloth_px: Point,
    turn_deg: f64,
}

const VIEW: View = View {
    side_px: 224,
    center: [112.0, 112.0],
    cloth_px: [120.0, 120.0],
    turn_deg: 0.0,
};

impl View {
    /// Paints a polygon; `[right, up]` in shares of the cloth's width and height, from its middle.
    fn paint(&self, outline: &[Point]) -> Mask {
        let (sin, cos) = self.turn_deg.to_radians().sin_cos();
        Mask::from_fn(self.side_px, self.side_px, |column, row| {
            let right = f64::from(column) + 0.5 - self.center[0];
            let up = self.center[1] - f64::from(row) - 0.5;
            let at = [
                (right * cos + up * sin) / self.cloth_px[0],
                (up * cos - right * sin) / self.cloth_px[1],
            ];
            encloses(outline, at)
        })
    }
}

/// Even-odd rule.
fn encloses(outline: &[Point], [x, y]: Point) -> bool {
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    let crossed = edges.filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

const FLAT: [Point; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
/// Its upper left corner is folded to the middle.
const ONE_CORNER: [Point; 5] = [
    [-0.5, -0.5],
    [0.5, -0.5],
    [0.5, 0.5],
    [0.0, 0.5],
    [-0.5, 0.0],
];

fn compared(run: View, shown: View, after: &[Point], goal: &[Point]) -> f64 {
    let alignment = Alignment::of(&run.paint(&FLAT), &shown.paint(&FLAT))
        .unwrap()
        .unwrap();
    overlap(&run.paint(after), &shown.paint(goal), &alignment)
}

/// Half of the cloth is blue and half yellow, and where they meet is a line as grey as the table in shadow.
#[test]
fn a_grey_line_between_two_faces_does_not_cut_a_cloth() {
    let picture = |line: std::ops::Range<u32>| {
        image::RgbImage::from_fn(64, 64, |column, row| {
            image::Rgb(match (column, row) {
                (16..48, row) if line.contains(&row) => [176, 181, 180],
                (16..48, 16..32) => [226, 193, 79],
                (16..48, 32..48) => [127, 168, 217],
                _ => [216, 213, 213],
            })
        })
    };
    for (line, area_px) in [
        (0..0, 32 * 32),
        (31..32, 32 * 32),
        (31..33, 32 * 32),
        (30..33, 14 * 32 + 32),
        (30..34, 14 * 32),
    ] {
        assert_eq!(
            silhouette(&picture(line.clone())).area_px(),
            area_px,
            "{line:?}"
        );
    }
}

/// Specks lie two pixels apart, so that they grow together to a larger patch than the cloth.
#[test]
fn specks_on_the_table_are_no_cloth() {
    let picture = image::RgbImage::from_fn(96, 96, |column, row| {
        image::Rgb(match (column, row) {
            (4..28, 4..28) => [127, 168, 217],
            (32..92, 32..92) if column % 3 == 0 && row % 3 == 0 => [200, 60, 60],
            _ => [216, 213, 213],
        })
    });
    assert_eq!(silhouette(&picture).area_px(), 24 * 24);
}

#[test]
fn any_symmetric_execution_is_right() {
    for quarter in [0.0_f64, 90.0, 180.0, 270.0] {
        let (sin, cos) = quarter.to_radians().sin_cos();
        for mirror in [1.0, -1.0] {
            let moved = ONE_CORNER.map(|[x, y]| [(x * cos - y * sin) * mirror, x * sin + y * cos]);
            let share = compared(VIEW, VIEW, &moved, &ONE_CORNER);
            assert!(share > 0.98, "{quarter} {mirror}: {share}");
        }
    }
}

#[test]
fn a_rectangle_is_not_turned_onto_its_short_side() {
    let wide = View {
        cloth_px: [150.0, 120.0],
        ..VIEW
    };
    let left_half = [[-0.5, -0.5], [0.0, -0.5], [0.0, 0.5], [-0.5, 0.5]];
    let lower_half = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.0], [-0.5, 0.0]];
    assert!(compared(wide, wide, &left_half, &left_half) > 0.98);
    let other = compared(wide, wide, &left_half, &lower_half);
    assert!((other - 1.0 / 3.0).abs() < 0.02, "{other}");
    assert!(compared(VIEW, VIEW, &left_half, &lower_half) > 0.98);
}

#[test]
fn a_step_that_did_nothing_overlaps_by_what_it_left() {
    let share = compared(VIEW, VIEW, &FLAT, &ONE_CORNER);
    assert!((share - 0.875).abs() < 0.01, "{share}");
}

#[test]
fn nothing_overlaps_with_nothing() {
    let empty = VIEW.paint(&[]);
    let flat = VIEW.paint(&FLAT);
    assert_eq!(Alignment::of(&empty, &flat).unwrap(), None);
    assert_eq!(Alignment::of(&flat, &empty).unwrap(), None);
    let alignment = Alignment::of(&flat, &flat).unwrap().unwrap();
    assert_eq!(overlap(&empty, &flat, &alignment), 0.0);
    assert_eq!(overlap(&flat, &empty, &alignment), 0.0);
    assert_eq!(overlap(&empty, &empty, &alignment), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Size, position and rotation of the cloth in the rollout do not matter.
    #[test]
    #[ignore = "long"]
    fn only_the_fold_matters(
        turn_deg in 0.0..360.0_f64, cloth_px in 90.0..140.0_f64, u in 100.0..124.0_f64, v in 100.0..124.0_f64,
    ) {
        let run = View { side_px: 260, center: [u + 18.0, v + 18.0], cloth_px: [cloth_px; 2], turn_deg };
        let share = compared(run, VIEW, &ONE_CORNER, &ONE_CORNER);
        prop_assert!(share > 0.95, "{share}");
        let other = compared(run, VIEW, &FLAT, &ONE_CORNER);
        prop_assert!((other - 0.875).abs() < 0.03, "{other}");
    }

    #[test]
    #[ignore = "long"]
    fn a_share_is_a_share(shape in proptest::collection::vec([-0.9..0.9_f64, -0.9..0.9_f64], 0..7)) {
        let share = compared(VIEW, VIEW, &shape, &ONE_CORNER);
        prop_assert!((0.0..=1.0).contains(&share));
    }
}

/// The cloth of a recorded depth picture: below 0.646 m, 255 levels a metre.
fn recorded_cloth(path: &Path) -> Mask {
    let levels = fab_picture::png::load(path).unwrap();
    let depth = image::ImageBuffer::from_fn(levels.width(), levels.height(), |column, row| {
        image::Luma([f32::from(levels.get_pixel(column, row).0[0]) / 255.0])
    });
    depth_mask(&depth, 0.646)
}

/// The recorded folds and how many steps they have.
const RECORDED: [(&str, usize); 3] = [
    ("AllCornersInward", 4),
    ("CornersEdgesInward", 4),
    ("DoubleStraight", 3),
];

/// The cloth of a recording's depth pictures, one more than there are steps.
fn recorded_cloths(folder: &Path, n_steps: usize) -> Vec<Mask> {
    (0..=n_steps)
        .map(|step| recorded_cloth(&folder.join(format!("depth_{step}.png"))))
        .collect()
}

#[test]
fn recorded_pictures_without_depth_show_the_same_cloth() {
    let Some(data) = recorded_data("recorded_pictures_without_depth_show_the_same_cloth") else {
        return;
    };
    for (task, n_steps) in RECORDED {
        for step in 0..=n_steps {
            let folder = data.join("subgoals").join(task);
            let by_depth = recorded_cloth(&folder.join(format!("depth_{step}.png")));
            let picture = fab_picture::png::load(&folder.join(format!("rgb_{step}.png"))).unwrap();
            let by_colour = silhouette(&picture);
            let alignment = Alignment::of(&by_depth, &by_depth).unwrap().unwrap();
            let share = overlap(&by_colour, &by_depth, &alignment);
            assert!(share > 0.97, "{task} {step}: {share}");
        }
    }
}

/// Steps whose silhouette varies between recordings: the last fold of a half leaves a thick pack.
const LOOSE: (&str, usize) = ("DoubleStraight", 3);

/// The overlap separates a step's result from the cloth before it, over all recorded demonstrations: results overlap
/// their subgoal by 0.910 or more, the cloth before by 0.900 or less; for loose steps 0.737 and 0.455.
#[test]
#[ignore = "long"]
fn recorded_results_share_more_with_their_subgoals_than_what_went_before() {
    let test = "recorded_results_share_more_with_their_subgoals_than_what_went_before";
    let Some(data) = recorded_data(test) else {
        return;
    };
    for (task, n_steps) in RECORDED {
        let shown = data.join("subgoals").join(task);
        let goals = recorded_cloths(&shown, n_steps);
        for id in (0..40).step_by(2) {
            let states = recorded_cloths(
                &data.join(format!("folding120/dev/{task}/{id:02}")),
                n_steps,
            );
            let alignment = Alignment::of(&states[0], &goals[0]).unwrap().unwrap();
            for step in 1..=n_steps {
                let after = overlap(&states[step], &goals[step], &alignment);
                let before = overlap(&states[step - 1], &goals[step], &alignment);
                let limit = if (task, step) == LOOSE { 0.7 } else { 0.905 };
                assert!(
                    before < limit && limit < after,
                    "{task} {id} step {step}: {after} after it, {before} before"
                );
            }
        }
    }
}

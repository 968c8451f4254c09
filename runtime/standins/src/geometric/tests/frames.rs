//! Tests of fitting rectangles to outlines.

use super::super::frame::Frame;
use fab_picture::hull::{self, Point};
use proptest::prelude::*;

fn turned(points: &[Point], degrees: f64) -> Vec<Point> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    points
        .iter()
        .map(|&[x, y]| [x * cos - y * sin, x * sin + y * cos])
        .collect()
}

/// Two rectangles fit a right-angled triangle equally well; a bulge makes the square the tighter one.
#[test]
fn a_right_angled_triangle_lies_along_its_longest_side() {
    for bulge in [0.0, 1.0, 2.0] {
        let triangle = [
            [0.0, 0.0],
            [100.0, 0.0],
            [50.0 + bulge, 50.0 + bulge],
            [0.0, 100.0],
        ];
        for degrees in [0.0, 20.0, 75.0] {
            let frame = Frame::fit(&hull::around(turned(&triangle, degrees))).unwrap();
            assert!(frame.has_long_sides(), "bulge {bulge}, turned by {degrees}");
            let along = (frame.angle().to_degrees() - degrees + 45.0).rem_euclid(180.0);
            assert!(
                along.min(180.0 - along) < 3.0,
                "bulge {bulge}, turned by {degrees}: {along}"
            );
        }
    }
}

#[test]
fn outlines_without_area_have_no_frame() {
    for points in [
        vec![],
        vec![[1.0, 1.0]],
        vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        vec![[f64::NAN, 0.0]; 4],
    ] {
        assert_eq!(Frame::fit(&hull::around(points)), None);
    }
}

proptest! {
    #[test]
    fn a_point_is_found_again_at_its_share(
        degrees in -180.0..180.0_f64,
        eighths in prop::array::uniform2(0..=8_u8),
        turns in 0..4_u32,
    ) {
        let corners = [[-5.0, -4.0], [5.0, -4.0], [5.0, 4.0], [-5.0, 4.0]];
        let frame = Frame::fit(&hull::around(turned(&corners, degrees))).unwrap().turned(turns);
        let back = frame.share_of(frame.point_at(eighths));
        prop_assert!(hull::distance(back, eighths.map(|n| f64::from(n) / 8.0)) < 1e-9);
        for gap in frame.corner_gaps(&turned(&corners, degrees)) {
            prop_assert!(gap < 1e-9, "{}", gap);
        }
    }
}

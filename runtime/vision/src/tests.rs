//! Tests of masks, corners and drawings.
#![allow(clippy::unwrap_used)]

use fab_picture::DepthImage;
use fab_picture::Mask;
use fab_picture::SubpixelPoint;
use fab_picture::centroid;
use fab_picture::depth_mask;
mod arrows;
mod color;
mod layers;
mod numbers;
mod outline;
#[cfg(feature = "opencv")]
mod peer_opencv;
mod recorded;
mod sight;
#[cfg(feature = "tags")]
mod tags;

use super::*;
use fab_program::{PixelPoint, Response, Sight};
use image::{Luma, Rgb, RgbImage};
use proptest::prelude::*;

/// Table at 0.65 m, cloth from column 20 to 39 and row 30 to 59 at 0.645 m.
fn rectangle() -> DepthImage {
    DepthImage::from_fn(100, 80, |column, row| {
        let is_cloth = (20..40).contains(&column) && (30..60).contains(&row);
        Luma([if is_cloth { 0.645 } else { 0.65 }])
    })
}

fn harris() -> CornerSearch {
    CornerSearch {
        of: Sight::Depth,
        image_px: 128,
        max: 27,
        quality: 0.04,
        spacing_px: 10.0,
        block_px: 3,
        response: Response::Harris { k: 0.04 },
    }
}

/// Checks that something is refused with these words.
fn assert_refused<T: std::fmt::Debug>(result: Result<T, VisionError>, words: &str) {
    let why = result.expect_err(words).to_string();
    assert!(why.contains(words), "{why}");
}

/// Finds corners by depth, without colours.
fn corners_by_depth(
    depth: &DepthImage,
    mask: &Mask,
    search: &CornerSearch,
) -> Result<Vec<SubpixelPoint>, VisionError> {
    corners(
        depth,
        &RgbImage::new(depth.width(), depth.height()),
        mask,
        search,
    )
}

#[test]
fn a_mask_holds_the_pixels_above_the_table() {
    let mask = depth_mask(&rectangle(), 0.646);
    assert_eq!(mask.area_px(), 20 * 30);
    assert!(mask.contains(PixelPoint::new(20, 30)) && mask.contains(PixelPoint::new(39, 59)));
    assert!(!mask.contains(PixelPoint::new(19, 30)) && !mask.contains(PixelPoint::new(20, 60)));
    assert!(!mask.contains(PixelPoint::new(-1, 30)) && !mask.contains(PixelPoint::new(100, 30)));
}

#[test]
fn the_depth_limit_itself_is_background() {
    let depth = DepthImage::from_pixel(3, 3, Luma([0.5]));
    assert!(depth_mask(&depth, 0.5).is_empty());
    assert_eq!(depth_mask(&depth, 0.500001).area_px(), 9);
}

#[test]
fn pixels_without_a_reading_are_background() {
    for nothing in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let depth = DepthImage::from_pixel(4, 4, Luma([nothing]));
        assert!(depth_mask(&depth, 0.6).is_empty(), "{nothing}");
    }
}

#[test]
fn the_nearest_pixel_of_an_equal_pair_is_the_upper_then_the_left_one() {
    let square = Mask::from_fn(9, 9, |column, row| {
        [2, 6].contains(&column) && [2, 6].contains(&row)
    });
    assert_eq!(
        square.nearest(PixelPoint::new(4, 4)),
        Some(PixelPoint::new(2, 2))
    );
    assert_eq!(
        square.nearest(PixelPoint::new(4, 8)),
        Some(PixelPoint::new(2, 6))
    );
    assert_eq!(
        square.nearest(PixelPoint::new(2, 4)),
        Some(PixelPoint::new(2, 2))
    );
}

#[test]
fn an_empty_mask_answers_with_nothing() {
    let empty = Mask::from_fn(5, 5, |_, _| false);
    assert_eq!(empty.nearest(PixelPoint::new(2, 2)), None);
    assert_eq!(empty.distance_px(PixelPoint::new(2, 2)), f64::INFINITY);
    assert_eq!(centroid(&empty), None);
    let depth = DepthImage::from_pixel(5, 5, Luma([0.65]));
    assert_eq!(corners_by_depth(&depth, &empty, &harris()).unwrap(), []);
}

#[test]
fn the_centroid_is_cut_off_to_whole_pixels() {
    let found = centroid(&depth_mask(&rectangle(), 0.646)).unwrap();
    assert_eq!(found.pixel, PixelPoint::new(29, 44));
    assert_eq!(found.at, [30.0, 45.0], "the rectangle's true middle");
}

#[test]
fn the_corners_of_a_rectangle_are_its_corners() {
    let depth = rectangle();
    let mask = depth_mask(&depth, 0.646);
    let found = corners_by_depth(&depth, &mask, &harris()).unwrap();
    assert_eq!(found.len(), 4, "{found:?}");
    for expected in [(20, 30), (39, 30), (20, 59), (39, 59)].map(|(u, v)| PixelPoint::new(u, v)) {
        assert!(
            found.iter().any(|c| c.pixel.distance_px(expected) <= 2.0),
            "{expected} in {found:?}"
        );
    }
    assert!(
        found.iter().all(|corner| mask.contains(corner.pixel)),
        "{found:?}"
    );
}

#[test]
fn the_detectors_picture_is_the_cloths_depth_in_centimetres_where_half_a_pixel_is_cloth() {
    // Four pixels become one; the cloth begins a quarter of a pixel before the middle, and three quarters below.
    let depth = DepthImage::from_fn(64, 64, |column, row| {
        Luma([if column >= 31 && row >= 29 { 0.3 } else { 0.65 }])
    });
    let picture = super::sight::detector_picture(
        &depth,
        &RgbImage::new(64, 64),
        &depth_mask(&depth, 0.6),
        Sight::Depth,
        16,
    );
    let first_column = (0..16).find(|&column| picture.get_pixel(column, 12).0[0] > 0);
    let first_row = (0..16).find(|&row| picture.get_pixel(12, row).0[0] > 0);
    assert_eq!((first_column, first_row), (Some(8), Some(7)));
    assert_eq!(picture.get_pixel(12, 12).0, [30]);
    assert_eq!(picture.get_pixel(8, 7).0, [30]);
}

/// OpenCV rounds its rectangles otherwise.
#[test]
#[cfg(not(feature = "opencv"))]
fn a_turned_square_is_found_with_these_bits() {
    let depth = DepthImage::from_fn(224, 224, |column, row| {
        let [x, y] = [column, row].map(|at| f64::from(at) - 111.5);
        let is_cloth = (0.8 * x + 0.6 * y).abs() < 60.0 && (0.8 * y - 0.6 * x).abs() < 45.0;
        Luma([if is_cloth { 0.645 } else { 0.65 }])
    });
    let mask = depth_mask(&depth, 0.646);
    let found = corners_by_depth(&depth, &mask, &harris()).unwrap();
    let at: Vec<[f64; 2]> = found.iter().map(|corner| corner.at).collect();
    let expected = [
        [132.80567932128906, 183.932861328125],
        [37.067047119140625, 111.80559539794922],
        [186.93295288085938, 112.19440460205078],
        [91.19432067871094, 40.067134857177734],
    ];
    assert_eq!(at, expected);
    let rectangle = rectangle_around(&mask).unwrap().unwrap();
    let numbers = [rectangle.center, rectangle.along, rectangle.sides];
    let expected = [
        [112.0, 112.0],
        [0.8, 0.6],
        [120.80000000000001, 90.80000000000001],
    ];
    assert_eq!(numbers, expected);
}

#[test]
fn corners_are_scaled_back_without_a_drift() {
    let depth = DepthImage::from_fn(224, 224, |column, row| {
        let is_cloth = (52..172).contains(&column) && (52..172).contains(&row);
        Luma([if is_cloth { 0.645 } else { 0.65 }])
    });
    let found = corners_by_depth(&depth, &depth_mask(&depth, 0.646), &harris()).unwrap();
    assert_eq!(found.len(), 4, "{found:?}");
    // The cloth's middle is the picture's: 112 as a boundary between pixels, 111.5 as a pixel index.
    for axis in 0..2 {
        let located = found.iter().map(|corner| corner.at[axis]).sum::<f64>() / 4.0;
        assert!((located - 112.0).abs() < 0.3, "{located}: {found:?}");
        let whole = |corner: &SubpixelPoint| f64::from([corner.pixel.u, corner.pixel.v][axis]);
        let rounded = found.iter().map(whole).sum::<f64>() / 4.0;
        assert!((rounded - 111.5).abs() < 0.3, "{rounded}: {found:?}");
    }
}

#[test]
fn missing_readings_and_the_tables_depth_do_not_move_corners() {
    let plain = rectangle();
    let mask = depth_mask(&plain, 0.646);
    let mut patchy = plain.clone();
    for (column, row, pixel) in patchy.enumerate_pixels_mut() {
        if !mask.contains(PixelPoint::new(column as i32, row as i32)) {
            pixel.0[0] = if (column + row) % 3 == 0 {
                f32::NAN
            } else {
                0.9
            };
        }
    }
    let expected = corners_by_depth(&plain, &mask, &harris()).unwrap();
    assert_eq!(
        corners_by_depth(&patchy, &depth_mask(&patchy, 0.646), &harris()).unwrap(),
        expected
    );
}

#[test]
fn settings_and_sizes_out_of_range_are_refused() {
    let depth = rectangle();
    let mask = depth_mask(&depth, 0.646);
    let faulty = [
        ("max", CornerSearch { max: 0, ..harris() }),
        (
            "image",
            CornerSearch {
                image_px: 0,
                ..harris()
            },
        ),
        (
            "image",
            CornerSearch {
                image_px: MAX_SIDE_PX + 1,
                ..harris()
            },
        ),
        (
            "quality",
            CornerSearch {
                quality: f64::NAN,
                ..harris()
            },
        ),
        (
            "quality",
            CornerSearch {
                quality: 0.0,
                ..harris()
            },
        ),
        (
            "spacing",
            CornerSearch {
                spacing_px: -1.0,
                ..harris()
            },
        ),
        (
            "k",
            CornerSearch {
                response: Response::Harris { k: f64::NAN },
                ..harris()
            },
        ),
    ];
    for (setting, search) in faulty {
        assert_refused(
            corners_by_depth(&depth, &mask, &search),
            &format!("`{}` is", setting),
        );
    }
    let other_mask = Mask::from_fn(99, 80, |_, _| true);
    assert_refused(
        corners_by_depth(&depth, &other_mask, &harris()),
        "the depth image",
    );
    let nothing = DepthImage::new(0, 0);
    let no_mask = depth_mask(&nothing, 1.0);
    assert_refused(
        corners_by_depth(&nothing, &no_mask, &harris()),
        "cannot be used",
    );
    assert_refused(
        draw_arrow(&mut RgbImage::new(0, 4), [0.0; 2], [1.0; 2]),
        "cannot be used",
    );
}

fn dots(at: Vec<PixelPoint>, rgb: [u8; 3], radius_px: u32) -> DrawnLayer {
    let shape = DrawnShape::Dots { at, radius_px };
    DrawnLayer { rgb, shape }
}

#[test]
fn arrows_that_are_not_finite_are_left_out_and_far_ones_cut_off() {
    let mut picture = RgbImage::from_pixel(64, 64, Rgb([200; 3]));
    draw_arrow(&mut picture, [f64::NAN, 3.0], [40.0, 40.0]).unwrap();
    assert!(picture.pixels().all(|pixel| pixel.0 == [200; 3]));
    draw_arrow(&mut picture, [32.0, 32.0], [f64::INFINITY, 32.0]).unwrap();
    assert!(picture.pixels().all(|pixel| pixel.0 == [200; 3]));
    draw_arrow(&mut picture, [32.0, 32.0], [1e9, 32.0]).unwrap();
    assert_eq!(picture.get_pixel(63, 32).0, [0; 3]);
    let far = PixelPoint::new(i32::MIN, i32::MAX);
    draw_action(&mut picture, far, PixelPoint::new(10, 10)).unwrap();
    draw_layers(&picture, &[dots(vec![far], [255, 0, 0], u32::MAX)]).unwrap();
}

#[test]
fn an_action_has_a_green_pick_and_a_purple_place() {
    let mut picture = RgbImage::from_pixel(100, 100, Rgb([255; 3]));
    draw_action(
        &mut picture,
        PixelPoint::new(20, 50),
        PixelPoint::new(80, 50),
    )
    .unwrap();
    assert_eq!(picture.get_pixel(15, 50).0, [0, 255, 0]);
    assert_eq!(picture.get_pixel(50, 50).0, [0, 255, 0]);
    assert_eq!(picture.get_pixel(85, 50).0, [128, 0, 128]);
}

#[test]
fn marks_leave_the_corner_in_their_rings_visible() {
    let white = RgbImage::from_pixel(224, 224, Rgb([255; 3]));
    let untouched = |picture: &RgbImage, u: u32, v: u32| {
        let mut inside = (u - 1..=u + 1).flat_map(|u| (v - 1..=v + 1).map(move |v| (u, v)));
        inside.all(|(u, v)| picture.get_pixel(u, v).0 == [255; 3])
    };
    let (pick, place) = (PixelPoint::new(40, 50), PixelPoint::new(150, 90));
    let (mut subgoal, mut action) = (white.clone(), white);
    draw_arrow(&mut subgoal, [40.0, 50.0], [150.0, 90.0]).unwrap();
    draw_action(&mut action, pick, place).unwrap();
    assert!(untouched(&subgoal, 40, 50));
    assert!(untouched(&action, 40, 50) && untouched(&action, 150, 90));
}

#[test]
fn edges_are_smooth_and_the_middle_of_a_stroke_is_full() {
    let mut picture = RgbImage::from_pixel(64, 64, Rgb([200; 3]));
    draw_arrow(&mut picture, [10.0, 20.0], [50.0, 33.0]).unwrap();
    let column = (10..44).map(|row| picture.get_pixel(40, row).0[0]);
    let inked: Vec<u8> = column.filter(|&level| level != 200).collect();
    // The line is at row 29.75 here: one row is covered, and a part of each of its neighbours.
    let [above, middle, below] = inked[..] else {
        panic!("{inked:?}");
    };
    assert!(
        middle == 0 && (40..100).contains(&above) && (140..190).contains(&below),
        "{inked:?}"
    );
}

#[test]
fn points_and_labels_appear_in_their_colour() {
    let mut picture = RgbImage::new(200, 40);
    let dot = dots(vec![PixelPoint::new(5, 6)], [10, 20, 30], 0);
    picture = draw_layers(&picture, &[dot]).unwrap();
    assert_eq!(
        picture
            .pixels()
            .filter(|pixel| pixel.0 == [10, 20, 30])
            .count(),
        1
    );
    assert_eq!(picture.get_pixel(5, 6).0, [10, 20, 30]);
    draw_label(
        &mut picture,
        "pick é 1",
        PixelPoint::new(10, 30),
        [250, 0, 0],
        14,
    )
    .unwrap();
    let written = picture
        .enumerate_pixels()
        .filter(|(_, _, pixel)| pixel.0[0] > 100);
    let (top, bottom) = written.fold((40, 0), |(top, bottom), (_, row, _)| {
        (row.min(top), row.max(bottom))
    });
    assert!(
        (14..=18).contains(&top) && (28..=36).contains(&bottom),
        "rows {top} to {bottom}"
    );
}

#[test]
fn residuals_have_a_ring_and_an_arrow_many_times_as_long() {
    let table = RgbImage::from_pixel(640, 480, Rgb([120; 3]));
    let mut picture = table.clone();
    let nowhere = [f64::NAN, f64::INFINITY];
    let lost = [(nowhere, Some([9.0; 2])), (nowhere, None)];
    draw_residuals(&mut picture, &lost, 10.0).unwrap();
    assert_eq!(picture, table);
    let places = [
        ([100.2, 90.9], Some([102.2, 90.9])),
        ([300.0, 90.0], Some(nowhere)),
    ];
    draw_residuals(&mut picture, &places, 10.0).unwrap();
    for ring in [94, 294] {
        assert_eq!(picture.get_pixel(ring, 90).0, [255, 220, 0]);
    }
    assert_eq!(picture.get_pixel(119, 90).0, [255, 60, 60]);
    // The black stroke below is wider.
    assert!(picture.get_pixel(110, 88).0[0] < 100);
    assert_eq!(picture.get_pixel(124, 90).0, [120; 3]);
    assert_eq!(picture.get_pixel(310, 90).0, [120; 3]);
}

/// Returns where the marks of one colour lie in only one of two drawings on the same ground, more than 2 px from the
/// other's.
fn apart(ground: &RgbImage, drawings: [&RgbImage; 2], rgb: [u8; 3]) -> Vec<PixelPoint> {
    let marks = drawings.map(|drawing| {
        Mask::from_fn(ground.width(), ground.height(), |column, row| {
            let pixel = drawing.get_pixel(column, row);
            let mut off = pixel.0.iter().zip(rgb).map(|(&a, b)| a.abs_diff(b));
            pixel != ground.get_pixel(column, row) && off.all(|off| off <= 24)
        })
    });
    assert!(marks.iter().all(|mark| !mark.is_empty()), "{rgb:?}");
    let lone = [(0, 1), (1, 0)].map(|(own, other)| {
        let pixels = marks[own].pixels();
        pixels
            .filter(|at| !marks[other].is_within(2, at.u as u32, at.v as u32))
            .collect()
    });
    lone.into_iter().flat_map(|pixels: Vec<_>| pixels).collect()
}

proptest! {
    #[test]
    fn the_nearest_pixel_is_never_beaten(
        pixels in prop::collection::btree_set((0..30_i32, 0..20_i32), 1..40),
        u in -10..40_i32,
        v in -10..30_i32,
    ) {
        let mask = Mask::from_fn(30, 20, |column, row| pixels.contains(&(column as i32, row as i32)));
        let point = PixelPoint::new(u, v);
        let nearest = mask.nearest(point).unwrap();
        prop_assert!(mask.contains(nearest));
        let least = pixels.iter().map(|&(u, v)| point.distance_px(PixelPoint::new(u, v)));
        prop_assert_eq!(point.distance_px(nearest), least.fold(f64::INFINITY, f64::min));
    }
}

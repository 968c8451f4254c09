//! Tests of boxes and outlines.

use super::super::*;
use super::assert_refused;
use fab_picture::Mask;
use fab_picture::SubpixelPoint;
use fab_program::PixelPoint;
use proptest::prelude::*;

fn points<const N: usize>(list: [(i32, i32); N]) -> Vec<PixelPoint> {
    list.map(|(u, v)| PixelPoint::new(u, v)).to_vec()
}

/// The pixels of the middles; their exact positions are tested separately.
fn edge_middles(outline: &[PixelPoint]) -> Vec<PixelPoint> {
    let middles = super::super::edge_middles(outline);
    middles.into_iter().map(|middle| middle.pixel).collect()
}

fn along(outline: &[PixelPoint], count: u32) -> Vec<PixelPoint> {
    let points = super::super::along(outline, count);
    points.into_iter().map(|point| point.pixel).collect()
}

#[test]
fn points_of_an_outline_are_located_between_pixels() {
    let outline = points([(20, 30), (39, 30), (39, 60), (20, 60)]);
    let located =
        |points: Vec<SubpixelPoint>| points.into_iter().map(|point| point.at).collect::<Vec<_>>();
    let middles = [[30.0, 30.5], [39.5, 45.5], [30.0, 60.5], [20.5, 45.5]];
    assert_eq!(located(super::super::edge_middles(&outline)), middles);
    let quarters = located(super::super::along(&outline, 4));
    assert_eq!(quarters[..2], [[20.5, 30.5], [39.5, 36.0]]);
}

/// Columns 20 to 39 and rows 30 to 60 of 100 x 80.
fn rectangle() -> Mask {
    Mask::from_fn(100, 80, |column, row| {
        (20..40).contains(&column) && (30..61).contains(&row)
    })
}

/// Reads a mask from text, `#` inside.
fn drawn(rows: &[&str]) -> Mask {
    Mask::from_fn(rows[0].len() as u32, rows.len() as u32, |column, row| {
        rows[row as usize].as_bytes()[column as usize] == b'#'
    })
}

#[test]
fn a_rectangle_has_its_corners_middles_and_box() {
    let outline = contour(&rectangle(), 1.0).unwrap();
    assert_eq!(outline, points([(20, 30), (39, 30), (39, 60), (20, 60)]));
    // 29.5 is rounded up.
    let middles = points([(30, 30), (39, 45), (30, 60), (20, 45)]);
    assert_eq!(edge_middles(&outline), middles);
    let corners = bounding_box(&rectangle()).unwrap();
    assert_eq!(corners.to_vec(), points([(20, 30), (39, 60)]));
    assert_eq!(box_center(corners), PixelPoint::new(29, 45));
}

#[test]
fn points_along_a_rectangle_are_equally_far_apart() {
    let outline = contour(&rectangle(), 1.0).unwrap();
    // The perimeter is 98.
    let expected = points([
        (20, 30),
        (34, 30),
        (39, 39),
        (39, 53),
        (32, 60),
        (20, 58),
        (20, 44),
    ]);
    assert_eq!(along(&outline, 7), expected);
    assert_eq!(along(&outline, 1), points([(20, 30)]));
    assert_eq!(along(&outline, 0), []);
    assert_eq!(along(&outline, u32::MAX).len(), 98);
}

#[test]
fn without_a_tolerance_every_pixel_of_the_outline_is_kept_in_clockwise_order() {
    let outline = contour(&rectangle(), 0.0).unwrap();
    assert_eq!(outline.len(), 98);
    assert_eq!(outline[..2], points([(20, 30), (21, 30)]));
    assert_eq!(outline[97], PixelPoint::new(20, 31));
    let next = outline.iter().cycle().skip(1);
    assert!(
        outline
            .iter()
            .zip(next)
            .all(|(a, b)| a.distance_px(*b) == 1.0)
    );
    assert_eq!(along(&outline, 98), outline);
}

#[test]
fn the_largest_piece_counts_even_where_it_lies_in_a_hole() {
    let ring_around_a_block = drawn(&[
        "#########",
        "#.......#",
        "#.#####.#",
        "#.#####.#",
        "#.#####.#",
        "#.#####.#",
        "#.#####.#",
        "#.#####.#",
        "#.......#",
        "#########",
    ]);
    let ring = points([(0, 0), (8, 0), (8, 9), (0, 9)]);
    assert_eq!(contour(&ring_around_a_block, 1.0).unwrap(), ring);
    // 44 pixels around 64.
    let block_in_a_thin_ring = Mask::from_fn(12, 12, |column, row| {
        let (near, far) = (column.min(row), column.max(row));
        near == 0 || far == 11 || (near >= 2 && far <= 9)
    });
    let block = points([(2, 2), (9, 2), (9, 9), (2, 9)]);
    assert_eq!(contour(&block_in_a_thin_ring, 1.0).unwrap(), block);
}

#[test]
fn of_equally_large_pieces_the_upper_one_is_taken_and_corners_join_pixels() {
    let mask = drawn(&["....##", "##....", "##..##"]);
    assert_eq!(
        contour(&mask, 0.0).unwrap(),
        points([(0, 1), (1, 1), (1, 2), (0, 2)])
    );
    let staircase = drawn(&["..#", ".#.", "#.."]);
    assert_eq!(
        contour(&staircase, 0.0).unwrap().first(),
        Some(&PixelPoint::new(2, 0))
    );
    assert_eq!(contour(&staircase, 0.0).unwrap().len(), 4);
}

#[test]
fn degenerate_outlines_have_few_sides() {
    let dot = contour(&drawn(&["...", ".#.", "..."]), 0.0).unwrap();
    assert_eq!(dot, points([(1, 1)]));
    assert_eq!(edge_middles(&dot), []);
    assert_eq!(along(&dot, 5), dot);
    let line = contour(&drawn(&["....", "####"]), 1.0).unwrap();
    assert_eq!(line, points([(0, 1), (3, 1)]));
    assert_eq!(edge_middles(&line), points([(2, 1)]));
    let far = points([(i32::MIN, i32::MIN), (i32::MAX, i32::MAX)]);
    assert_eq!(edge_middles(&far), points([(0, 0)]));
    assert_eq!(along(&far, 2).len(), 2);
}

#[test]
fn empty_masks_and_lists_give_nothing() {
    for (width, height) in [(0, 0), (5, 4)] {
        let empty = Mask::from_fn(width, height, |_, _| false);
        assert_eq!(contour(&empty, 0.0).unwrap(), []);
        assert_eq!(bounding_box(&empty), None);
    }
    assert_eq!(edge_middles(&[]), []);
    assert_eq!(along(&[], 4), []);
}

#[test]
fn a_tolerance_out_of_range_is_refused() {
    for tolerance_px in [-1.0, f64::NAN, f64::INFINITY] {
        assert_refused(
            contour(&rectangle(), tolerance_px),
            &format!("`{}` is", "tolerance"),
        );
    }
}

#[test]
fn distances_to_a_box_are_zero_inside_whichever_corners_name_it() {
    let corners = [PixelPoint::new(20, 60), PixelPoint::new(39, 30)];
    for (point, expected_px) in [
        ((20, 30), 0.0),
        ((30, 45), 0.0),
        ((42, 64), 5.0),
        ((30, 28), 2.0),
    ] {
        let point = PixelPoint::new(point.0, point.1);
        assert_eq!(box_distance_px(point, corners), expected_px, "{point}");
    }
    assert_eq!(box_center(corners), PixelPoint::new(29, 45));
    let everything = [
        PixelPoint::new(i32::MAX, i32::MIN),
        PixelPoint::new(i32::MIN, i32::MAX),
    ];
    assert_eq!(box_center(everything), PixelPoint::new(-1, -1));
}

/// Any mask, as the picture's width and one flag per pixel.
fn any_mask() -> impl Strategy<Value = Mask> {
    (1..24_usize, 1..24_usize, 0.0..1.0_f64).prop_flat_map(|(width, height, share)| {
        prop::collection::vec(prop::bool::weighted(share), width * height).prop_map(move |inside| {
            Mask::from_fn(width as u32, height as u32, |column, row| {
                inside[row as usize * width + column as usize]
            })
        })
    })
}

proptest! {
    #[test]
    fn outlines_of_any_mask_lie_on_it_and_points_along_them_near_it(
        mask in any_mask(),
        tolerance_px in 0.0..4.0_f64,
        count in 0..40_u32,
    ) {
        let exact = contour(&mask, 0.0).unwrap();
        prop_assert_eq!(exact.is_empty(), mask.is_empty());
        prop_assert!(exact.iter().all(|&point| mask.contains(point)));
        prop_assert_eq!(exact.iter().map(|p| (p.v, p.u)).min(), exact.first().map(|p| (p.v, p.u)));
        let polygon = contour(&mask, tolerance_px).unwrap();
        prop_assert_eq!(polygon.is_empty(), mask.is_empty());
        prop_assert!(polygon.iter().all(|point| exact.contains(point)));
        let points = along(&polygon, count);
        prop_assert!(points.len() <= count as usize);
        for point in points.iter().chain(&edge_middles(&polygon)) {
            let off_px = exact.iter().map(|p| p.distance_px(*point)).fold(f64::INFINITY, f64::min);
            // Twice the tolerance, because OpenCV drops nearly straight vertices once more at the end.
            prop_assert!(off_px <= 2.0 * tolerance_px + 1.0, "{}: {} px off", point, off_px);
        }
    }

    #[test]
    fn boxes_are_tight(mask in any_mask()) {
        let Some(corners @ [low, high]) = bounding_box(&mask) else {
            prop_assert!(mask.is_empty());
            return Ok(());
        };
        prop_assert!(mask.pixels().all(|pixel| box_distance_px(pixel, corners) == 0.0));
        prop_assert!(mask.pixels().any(|p| p.u == low.u) && mask.pixels().any(|p| p.u == high.u));
        prop_assert!(mask.pixels().any(|p| p.v == low.v) && mask.pixels().any(|p| p.v == high.v));
    }

    #[test]
    fn points_along_an_outline_turn_and_move_with_it(
        vertices in prop::collection::vec((-200..200_i32, -200..200_i32), 3..9),
        count in 1..20_u32,
        moved in (-500..500_i32, -500..500_i32),
    ) {
        // After a quarter turn distances are the same numbers; only the rounding of halves may differ.
        let outline: Vec<_> = vertices.iter().map(|&(u, v)| PixelPoint::new(u, v)).collect();
        let turned: Vec<_> = vertices.iter().map(|&(u, v)| PixelPoint::new(-v, u)).collect();
        let shifted: Vec<_> =
            vertices.iter().map(|&(u, v)| PixelPoint::new(u + moved.0, v + moved.1)).collect();
        let expected = along(&outline, count);
        let close = |from: &[PixelPoint], to: &[PixelPoint], map: &dyn Fn(PixelPoint) -> PixelPoint| {
            from.iter().all(|&a| to.iter().any(|&b| map(a).distance_px(b) < 1.5))
        };
        let turn = |p: PixelPoint| PixelPoint::new(-p.v, p.u);
        let shift = |p: PixelPoint| PixelPoint::new(p.u + moved.0, p.v + moved.1);
        prop_assert!(close(&expected, &along(&turned, count), &turn));
        prop_assert!(close(&expected, &along(&shifted, count), &shift));
    }

    #[test]
    fn points_along_a_square_do_not_depend_on_the_corner_that_comes_first(
        side_px in 1..60_i32,
        first in 0..4_usize,
        per_side in 1..6_u32,
    ) {
        let corners = points([(0, 0), (60, 0), (60, 60), (0, 60)]).into_iter();
        let outline: Vec<_> =
            corners.map(|p| PixelPoint::new(p.u * side_px, p.v * side_px)).collect();
        let mut turned = outline.clone();
        turned.rotate_left(first);
        let mut expected = along(&outline, 4 * per_side);
        expected.rotate_left(first * per_side as usize);
        prop_assert_eq!(along(&turned, 4 * per_side), expected);
    }
}

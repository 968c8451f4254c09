//! Tests of holes in depth pictures.

#![allow(clippy::unwrap_used)]

use super::*;
use image::Luma;

/// Cloth at 0.61 m on a table at 0.65 m, without readings where `is_missing` says so.
fn picture(is_missing: impl Fn(u32, u32) -> bool) -> DepthImage {
    DepthImage::from_fn(224, 224, |column, row| {
        let is_cloth = (40..184).contains(&column) && (40..184).contains(&row);
        Luma([match is_missing(column, row) {
            true => 0.0,
            false if is_cloth => 0.61,
            false => 0.65,
        }])
    })
}

#[test]
fn salt_is_closed_and_counted() {
    let whole = picture(|_, _| false);
    // Inside the cloth, so that every median is the cloth's.
    for every in [3_u32, 7, 10] {
        let is_missing = |column: u32, row: u32| {
            (60..160).contains(&column)
                && (60..160).contains(&row)
                && (column * 31 + row * 17).is_multiple_of(every)
        };
        let (closed, note) = closed(&picture(is_missing));
        let count = (0..224 * 224)
            .filter(|at| is_missing(at % 224, at / 224))
            .count();
        assert!(closed == whole, "every {every}th");
        let note = note.unwrap();
        let begins = format!(
            "{count} of 50176 pixels of the depth picture have no reading; {count} of them"
        );
        assert!(
            note.starts_with(&begins) && note.ends_with("around them"),
            "{note}"
        );
    }
}

#[test]
fn small_holes_are_closed_and_large_ones_stay() {
    let square = |left: u32, side: u32| {
        move |column: u32, row: u32| {
            (left..left + side).contains(&column) && (80..80 + side).contains(&row)
        }
    };
    let (closed_small, _) = closed(&picture(square(80, 7)));
    assert!(closed_small == picture(|_, _| false));
    // A hole at the cloth's edge is closed by readings of cloth and of table, and by nothing in between.
    let (at_edge, _) = closed(&picture(square(37, 7)));
    assert!(
        at_edge
            .pixels()
            .all(|pixel| [0.61, 0.65].contains(&pixel.0[0]))
    );
    let large = picture(square(80, 8));
    let (closed_large, note) = closed(&large);
    assert!(closed_large == large);
    let told = "64 of 50176 pixels of the depth picture have no reading; 0 of them";
    let note = note.unwrap();
    assert!(
        note.starts_with(told) && note.contains("and 64 are left, near which corners may be false"),
        "{note}"
    );
}

#[test]
fn a_picture_without_holes_or_without_readings_stays() {
    for depth_m in [
        picture(|_, _| false),
        DepthImage::new(5, 3),
        DepthImage::new(0, 0),
    ] {
        assert!(closed(&depth_m) == (depth_m, None));
    }
    let odd = DepthImage::from_fn(2, 1, |column, _| Luma([[f32::NAN, -1.0][column as usize]]));
    assert!(closed(&odd).1.is_none());
    let tiny = DepthImage::from_fn(2, 1, |column, _| Luma([[f32::NAN, 0.5][column as usize]]));
    assert!(closed(&tiny).0.pixels().all(|pixel| pixel.0 == [0.5]));
}

//! Tests of printed tags. `tags.png` was drawn by OpenCV 5.0 (`cv2.aruco.generateImageMarker`), in perspective.

use super::*;

#[test]
fn tags_are_found_at_the_crossing_of_their_diagonals() {
    let picture = image::load_from_memory(include_bytes!("tags.png")).unwrap();
    let found = tags(&picture.into_rgb8()).unwrap();
    let drawn = [
        (3, [50.25, 60.75]),
        (97, [130.5, 100.0]),
        (586, [195.0, 50.0]),
    ];
    let ids: Vec<usize> = found.iter().map(|tag| tag.id).collect();
    assert_eq!(ids, drawn.map(|(id, _)| id));
    for (tag, (id, [u, v])) in found.iter().zip(drawn) {
        let [column, row] = tag.middle_px;
        let off_px = (column - u).hypot(row - v);
        assert!(off_px < 0.1, "{id}: {column}, {row}, {off_px} px off");
    }
}

/// The detector is in C, and reads outside of tiny pictures if it is given them.
#[test]
fn no_picture_brings_the_detector_down() {
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    for (width, height) in [
        (1, 1),
        (100, 1),
        (8, 2),
        (2, 2),
        (15, 400),
        (16, 16),
        (17, 31),
        (200, 16),
        (97, 61),
    ] {
        let plain = RgbImage::new(width, height);
        let noisy = RgbImage::from_fn(width, height, |_, _| Rgb([noise(); 3]));
        for picture in [plain, noisy] {
            assert_eq!(tags(&picture), Ok(Vec::new()), "{width} x {height}");
        }
    }
    assert_refused(tags(&RgbImage::new(0, 0)), "cannot be used");
}

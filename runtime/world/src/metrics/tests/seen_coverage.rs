//! Unit tests of `metrics::seen_coverage`.

use super::*;

fn square(size_px: u32, side_px: u32) -> Mask {
    Mask::from_fn(size_px, size_px, |column, row| {
        column < side_px && row < side_px
    })
}

#[test]
fn the_share_is_that_of_the_areas() {
    assert_eq!(seen_coverage(&square(64, 10), &square(64, 20)), Some(0.25));
    assert_eq!(seen_coverage(&square(64, 20), &square(64, 20)), Some(1.0));
    assert_eq!(seen_coverage(&square(64, 0), &square(64, 20)), Some(0.0));
    assert_eq!(seen_coverage(&square(64, 20), &square(64, 10)), Some(4.0));
}

#[test]
fn pictures_that_cannot_be_compared_have_no_coverage() {
    assert_eq!(seen_coverage(&square(64, 10), &square(64, 0)), None);
    assert_eq!(seen_coverage(&square(64, 10), &square(65, 20)), None);
}

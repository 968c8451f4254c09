//! Coverage as a camera sees it, for a cloth whose particles are not known.
//!
//! In: the cloth's pixels now, and those of the same cloth lying flat under the same camera. Out: the ratio of the two
//! areas, as the paper measures on the real table. Cloth hidden under other cloth does not count, and parts closer to
//! the camera count as larger, so this number must never be shown beside the simulator's measures without saying which
//! is which.

use fab_picture::Mask;

/// Returns the covered share of the flat cloth's area, by pixels of one camera.
///
/// - `now`, `flat`: the cloth's pixels, from pictures of one size.
///
/// Above 1 if the cloth looks larger than it was flat. `None` if the sizes differ or the flat cloth has no pixels.
pub fn seen_coverage(now: &Mask, flat: &Mask) -> Option<f64> {
    let size = |mask: &Mask| (mask.width(), mask.height());
    let is_comparable = size(now) == size(flat) && !flat.is_empty();
    is_comparable.then(|| now.area_px() as f64 / flat.area_px() as f64)
}

#[cfg(test)]
mod tests {
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
}

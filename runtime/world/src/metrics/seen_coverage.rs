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
#[path = "tests/seen_coverage.rs"]
mod tests;

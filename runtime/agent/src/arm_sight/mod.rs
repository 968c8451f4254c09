//! An arm's eyes: detectors of [`fab_vision`], and pictures of its plans and calibrations.

mod errors;
mod plan;

pub use errors::draw_errors;

use fab_arm::sight::Sight;

/// Finds marks again, and draws plans.
pub const SIGHT: Sight = Sight {
    marks: |picture| fab_vision::marks(picture).map_err(|error| error.to_string()),
    find_again: |first, marks, second| {
        fab_vision::find_again(first, marks, second).map_err(|error| error.to_string())
    },
    draw_plan: |plan, picture, calibration, settings, reach| {
        plan::draw(plan, picture, calibration, settings, reach).map_err(|error| error.to_string())
    },
};

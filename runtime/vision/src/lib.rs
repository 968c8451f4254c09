//! Pictures in, points out; and points drawn back into pictures.
//!
//! In: depth images and RGB pictures. Out: [`fab_picture::Mask`]s, corners, boxes, rectangles, outlines, places
//! found again in another picture, printed tags, drawings.
//! Everything is a pure function of its input, and the same bits on every machine. Only this crate names OpenCV, whose
//! corners the paper used: the feature `opencv` calls it in place of our own detectors, which find the same. Which
//! detector a task uses, and what its points are called, is decided elsewhere.

mod boxes;
mod color;
mod corners;
mod draw;
mod layers;
mod marks;
mod numbers;
mod outline;
#[cfg(not(feature = "opencv"))]
mod primitives;
#[cfg(feature = "opencv")]
#[doc(hidden)]
pub mod primitives; // both implementations, for the tests and the benchmark that compare them
mod raster;
#[cfg(test)]
#[path = "../../../tests/recorded_data.rs"]
mod recorded;
mod rectangle;
mod residuals;
mod sight;
mod split;
mod tags;
#[cfg(test)]
mod tests;

pub use boxes::{bounding_box, box_center, box_distance_px};
pub use color::{color_mask, painted_white};
pub use corners::{CornerSearch, corners, corners_of_gray};
pub use draw::{draw_action, draw_arrow, draw_label};
pub use layers::{DrawnLayer, DrawnShape, draw_layers};
pub use marks::{find_again, marks};
pub use numbers::draw_numbers;
pub use outline::{MAX_ALONG, along, contour, edge_middles, largest};
pub use rectangle::{Rectangle, rectangle_around};
pub use residuals::draw_residuals;
pub use split::{closed, contrast_of, split_mask};
pub use tags::tags;

/// Returns what finds keypoints in this build: `fabc itself`, or OpenCV with its version.
pub fn detectors() -> Result<String, VisionError> {
    primitives::chosen::version()
}

/// The longest side of a picture accepted by this crate, pixels.
pub const MAX_SIDE_PX: u32 = 8192;

/// Why a picture could not be processed: its size, a setting outside of its range, or a detector's own reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct VisionError(String);

/// Rejects pictures that are empty or larger than [`MAX_SIDE_PX`].
fn check_size(width: u32, height: u32) -> Result<(), VisionError> {
    let fits = |side: u32| (1..=MAX_SIDE_PX).contains(&side);
    if fits(width) && fits(height) {
        Ok(())
    } else {
        Err(VisionError(format!(
            "a picture of {width} x {height} px cannot be used: each side has 1 to {MAX_SIDE_PX} px"
        )))
    }
}

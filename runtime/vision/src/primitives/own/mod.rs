//! The detectors in plain Rust, written from the papers and from OpenCV's documented behaviour.

pub mod corners;
mod outline;
mod rectangle;
mod refine;

pub use corners::strong_corners;
pub use outline::{outer_outline, simplified};
pub use rectangle::smallest_rectangle;
pub use refine::refine_corners;

/// Names these detectors.
pub fn version() -> Result<String, crate::VisionError> {
    Ok("fabc itself".to_owned())
}

//! Pictures and the cameras that take them: colour, depth, sets of pixels, PNG and JPEG files, animated GIF files.
//!
//! In: files, camera readings, world points. Out: pictures, [`Mask`]s and coordinates. World points are metres,
//! right-handed, z up; pixels are `[column, row]` from the top left corner. What can be found
//! in a picture without knowing what is cloth is here too: regions, convex outlines, the arrow of a subgoal picture. `fab-vision` finds
//! the rest.
//!
//! ```
//! use fab_picture::camera::Camera;
//! use fab_picture::{DepthImage, centroid, depth_mask};
//! use fab_program::ImageUp;
//! use image::Luma;
//!
//! // A camera 650 mm above the table, which sees 40 mm of cloth in the right half of its picture.
//! let depth_m = DepthImage::from_fn(224, 224, |column, _| Luma([if column < 112 { 0.65 } else { 0.61 }]));
//! let cloth = depth_mask(&depth_m, 0.646);
//! assert_eq!(cloth.area_px(), 112 * 224);
//!
//! let camera = Camera::top_down(0.65, std::f64::consts::FRAC_PI_4, 224, ImageUp::Y);
//! let middle = centroid(&cloth).ok_or("no pixel shows cloth")?;
//! let point = camera.world_from_pixel(middle.at, 0.61).ok_or("the pixel looks past the table")?;
//! assert!((point.z - 0.04).abs() < 1e-6 && point.x > 0.1 && point.y.abs() < 1e-6, "{point}");
//! # Ok::<(), &str>(())
//! ```

pub mod animation;
pub mod arrow;
pub mod camera;
pub mod dropouts;
pub mod hull;
pub mod observation;
pub mod png;
pub mod regions;

mod mask;
#[cfg(test)]
#[path = "../../../tests/recorded_data.rs"]
mod recorded;
mod subpixel_point;

pub use mask::{Mask, centroid, depth_mask, has_reading, mask_picture, overlap};
pub use subpixel_point::SubpixelPoint;

/// Distances to the nearest surface, metres along the optical axis, `[width, height]`.
///
/// A value that is not a positive finite number means "no reading".
pub type DepthImage = image::ImageBuffer<image::Luma<f32>, Vec<f32>>;

/// The position of a mark in another picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedMark {
    /// The mark, `[column, row]`, the middle of its pixel.
    pub at_px: [f64; 2],
    /// Its offset from there, `[right, down]`, pixels.
    pub moved_px: [f64; 2],
}

/// A printed tag of the family 36h11 that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tag {
    /// Its number.
    pub id: usize,
    /// Where its diagonals cross, `[column, row]`; the middle of the pixel in column 3 is at 3.5.
    pub middle_px: [f64; 2],
}

//! What a world's camera gives.

use crate::camera::Camera;
use crate::vision::DepthImage;
use image::RgbImage;

/// One RGB-D picture and the camera that took it.
#[derive(Clone, Debug)]
pub struct Observation {
    /// Colour, `[image_px, image_px]`.
    pub rgb: RgbImage,
    /// Depth along the optical axis, metres, registered to the colour picture; 0 means no reading.
    pub depth_m: DepthImage,
    /// Geometry of the camera.
    pub camera: Camera,
    /// Time in the world, seconds since its reset.
    pub time_s: f64,
}

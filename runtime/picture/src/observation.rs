//! What a camera delivers: a world's camera, or the user's own with pictures from files.

use crate::DepthImage;
use crate::camera::Camera;
use fab_program as program;
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

/// A picture whose size differs from the task's camera.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the {what} has {} x {} px, and the task's camera takes {camera_px} x {camera_px} px: scale it to that, or \
     state its side as `image` in the task's `camera`", size_px[0], size_px[1]
)]
pub struct WrongSize {
    /// `picture` or `depth picture`.
    pub what: &'static str,
    /// Its width and height, pixels.
    pub size_px: [u32; 2],
    /// The side of the camera's square image, pixels.
    pub camera_px: u32,
}

impl Observation {
    /// Makes an observation by the task's camera from a picture; without depth, no pixel has a reading.
    pub fn of_picture(
        camera: &program::Camera,
        rgb: RgbImage,
        depth_m: Option<DepthImage>,
    ) -> Result<Observation, WrongSize> {
        let side_px = camera.image_px;
        let fits = |what, (width, height)| {
            let wrong = WrongSize {
                what,
                size_px: [width, height],
                camera_px: side_px,
            };
            (wrong.size_px == [side_px; 2]).then_some(()).ok_or(wrong)
        };
        fits("picture", rgb.dimensions())?;
        let depth_m = depth_m.unwrap_or_else(|| DepthImage::new(side_px, side_px));
        fits("depth picture", depth_m.dimensions())?;
        Ok(Observation {
            rgb,
            depth_m,
            camera: Camera::top_down(camera.height_m, camera.fov_rad, side_px, camera.up),
            time_s: 0.0,
        })
    }
}

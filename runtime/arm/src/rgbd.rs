//! The interface of cameras that deliver colour with depth: from ROS topics, a folder, or the simulator.
//!
//! Out: a [`Shot`] at the camera's full resolution; the world crops the task's square picture from it.

mod picture;
pub mod topics;

use crate::settings::declare::{MAX_SIDE_PX, from, section};
use fab_picture::DepthImage;
use image::RgbImage;
use serde::Serialize;

/// One picture with depth.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Colour, `[height, width]`.
    pub rgb: RgbImage,
    /// Depth along the optical axis, metres, of the same size and aligned with the colour; 0 means no reading.
    pub depth_m: DepthImage,
    /// The camera's projection, if it reports it.
    pub intrinsics: Option<Intrinsics>,
}

impl Shot {
    /// Joins colour with its depth, without which there is no reading; fails if their sizes differ.
    pub(crate) fn aligned(
        rgb: RgbImage,
        depth_m: Option<DepthImage>,
        intrinsics: Option<Intrinsics>,
    ) -> Result<Shot, String> {
        let (width, height) = rgb.dimensions();
        let depth_m = depth_m.unwrap_or_else(|| DepthImage::new(width, height));
        let (deep_width, deep_height) = depth_m.dimensions();
        if (width, height) != (deep_width, deep_height) {
            return Err(format!(
                "the picture has {width} x {height} px and its depth {deep_width} x {deep_height}: use the depth that is \
                 aligned with the colour"
            ));
        }
        Ok(Shot {
            rgb,
            depth_m,
            intrinsics,
        })
    }
}

section! {
    /// A camera's projection, in the terms of `sensor_msgs/CameraInfo`.
    #[derive(Serialize)]
    pub struct Intrinsics {
        /// Width and height of its picture; the window lies inside.
        size_px: [u32; 2], from(1.0, MAX_SIDE_PX);
        /// Focal lengths along columns and rows.
        focal_px: [f64; 2], from(1.0, 1e6);
        /// Where the optical axis meets the picture; the middle of the pixel in column 3 is at 3.5.
        middle_px: [f64; 2], from(0.0, MAX_SIDE_PX);
        /// Coefficients of the model `plumb_bob`: k1, k2, t1, t2, k3.
        distortion: Vec<f64> = [], from(-1e6, 1e6);
    }
}

/// A camera that delivers colour with depth.
pub trait RgbdSource {
    /// Returns its name, e.g. its topic.
    fn name(&self) -> String;

    /// Takes a picture after the call; never returns an older, buffered one. Fails with the reason.
    fn shoot(&mut self) -> Result<Shot, String>;
}

//! What a camera delivers: a world's camera, or the user's own with pictures from files.
//!
//! The square picture of a task's camera, `[left, top, side]` in another picture's pixels, is cut out of that and scaled.
//! Colour and depth are cut alike, so aligned pictures stay aligned.

use crate::camera::Camera;
use crate::{DepthImage, dropouts};
use fab_program as program;
use image::RgbImage;
use image::imageops::{self, FilterType};

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
    /// What the pictures lacked, and what was done about it, for people.
    pub notes: Vec<String>,
}

impl Observation {
    /// Makes an observation by the task's camera from a picture of any size; without depth, no pixel has a reading.
    ///
    /// The middle square of the picture is scaled to the camera's, and small holes of the depth are closed. Fails with the
    /// reason if the depth picture has another shape.
    pub fn of_picture(
        camera: &program::Camera,
        rgb: RgbImage,
        depth_m: Option<DepthImage>,
    ) -> Result<Observation, String> {
        let side_px = camera.image_px;
        let mut notes = Vec::new();
        let (rgb_px, square) = (rgb.dimensions(), middle_square(rgb.dimensions()));
        if rgb_px != (side_px, side_px) {
            notes.push(format!(
                "the picture has {} x {} px: its middle square of {} px is taken, scaled to the camera's {side_px} px",
                rgb_px.0, rgb_px.1, square[2]
            ));
        }
        let depth_m = match depth_m {
            None => DepthImage::new(side_px, side_px),
            Some(depth_m) => {
                let depth_px = depth_m.dimensions();
                let shape = |across: u32, down: u32| u64::from(across) * u64::from(down);
                if shape(rgb_px.0, depth_px.1) != shape(depth_px.0, rgb_px.1) {
                    return Err(format!(
                        "the picture has {} x {} px and the depth picture {} x {}: they must show the same from one \
                         place, in one shape",
                        rgb_px.0, rgb_px.1, depth_px.0, depth_px.1
                    ));
                }
                let (closed, note) = dropouts::closed(&depth_m);
                notes.extend(note);
                cut_depth(&closed, middle_square(depth_px), side_px)
            }
        };
        Ok(Observation {
            rgb: cut_colours(&rgb, square, side_px),
            depth_m,
            camera: Camera::top_down(camera.height_m, camera.fov_rad, side_px, camera.up),
            time_s: 0.0,
            notes,
        })
    }
}

/// Returns the largest square in the middle of a picture.
pub fn middle_square((width, height): (u32, u32)) -> [u32; 3] {
    let side = width.min(height);
    [(width - side) / 2, (height - side) / 2, side]
}

/// Cuts and scales colours, which are averaged.
///
/// The square lies in the picture.
pub fn cut_colours(rgb: &RgbImage, [left, top, side]: [u32; 3], image_px: u32) -> RgbImage {
    let rgb = imageops::crop_imm(rgb, left, top, side, side).to_image();
    if side == image_px {
        return rgb;
    }
    imageops::resize(&rgb, image_px, image_px, FilterType::Triangle)
}

/// Cuts and scales readings. The mean of a near and a far one is a point on neither surface, so each is one pixel's.
///
/// The square lies in the picture.
pub fn cut_depth(depth_m: &DepthImage, [left, top, side]: [u32; 3], image_px: u32) -> DepthImage {
    DepthImage::from_fn(image_px, image_px, |column, row| {
        let raw = |at: u32| (2 * u64::from(at) + 1) * u64::from(side) / (2 * u64::from(image_px));
        *depth_m.get_pixel(left + raw(column) as u32, top + raw(row) as u32)
    })
}

//! What a camera delivers: a world's camera, or the user's own with pictures from files.

use crate::camera::Camera;
use crate::{DepthImage, cut, dropouts};
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
    /// What the pictures lacked, and what was done about it, for people.
    pub notes: Vec<String>,
}

/// A depth picture that does not show the same as the colour picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the picture has {} x {} px and the depth picture {} x {}: they must show the same from one place, in one shape",
    rgb_px.0, rgb_px.1, depth_px.0, depth_px.1
)]
pub struct NotAligned {
    /// The picture's width and height, pixels.
    pub rgb_px: (u32, u32),
    /// The depth picture's width and height, pixels.
    pub depth_px: (u32, u32),
}

impl Observation {
    /// Makes an observation by the task's camera from a picture of any size; without depth, no pixel has a reading.
    ///
    /// The middle square of the picture is scaled to the camera's, and small holes of the depth are closed.
    pub fn of_picture(
        camera: &program::Camera,
        rgb: RgbImage,
        depth_m: Option<DepthImage>,
    ) -> Result<Observation, NotAligned> {
        let side_px = camera.image_px;
        let mut notes = Vec::new();
        let (rgb_px, square) = (rgb.dimensions(), cut::middle(rgb.dimensions()));
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
                    return Err(NotAligned { rgb_px, depth_px });
                }
                let (closed, note) = dropouts::closed(&depth_m);
                notes.extend(note);
                cut::depth(&closed, cut::middle(depth_px), side_px)
            }
        };
        Ok(Observation {
            rgb: cut::colours(&rgb, square, side_px),
            depth_m,
            camera: Camera::top_down(camera.height_m, camera.fov_rad, side_px, camera.up),
            time_s: 0.0,
            notes,
        })
    }
}

//! The vision functions that an arm needs, as function pointers, so that this crate does not depend on `fab-vision`.

use crate::calibration::Calibration;
use crate::kinematics::reach::Reach;
use crate::plan::Plan;
use crate::settings::Settings;
use fab_picture::MovedMark;
use image::{GrayImage, RgbImage};

/// Finds places of the first picture in the second; omits hidden ones and those outside it.
pub type FindAgain = fn(&GrayImage, &[[u32; 2]], &GrayImage) -> Result<Vec<MovedMark>, String>;

/// The vision functions of an arm, provided by the caller; errors are worded for people.
#[derive(Clone, Copy)]
pub struct Sight {
    /// Finds places that can be recognised again, `[column, row]`; none in a picture without texture.
    pub marks: fn(&GrayImage) -> Result<Vec<[u32; 2]>, String>,
    /// Finds such places in another picture.
    pub find_again: FindAgain,
    /// Draws a plan on the camera's own picture, which has the calibration's size.
    pub draw_plan:
        fn(&Plan, &RgbImage, &Calibration, &Settings, &Reach) -> Result<RgbImage, String>,
}

//! Detects whether the camera was moved since its calibration.
//!
//! In: a calibration with its reference picture, and a new picture. Out: why the calibration no longer holds, if it does
//! not. Marks of the reference are found again in the new picture. Cloth and arm hide or move some of them, so what
//! half of those that are found say decides.

use super::Calibration;
use crate::sight::Sight;
use image::imageops::{self, FilterType};
use image::{GrayImage, RgbImage};

/// How far half of the marks may seem to have moved, pixels of a picture 640 px wide: about 1.5 mm at a metre.
const STILL_PX: f64 = 1.0;
/// Width at which pictures are compared.
const COMPARED_PX: u32 = 640;
/// The fewest marks that must be found again, and their smallest share of all.
const FEWEST: usize = 8;
/// See [`FEWEST`].
const SHARE: f64 = 0.2;

impl Calibration {
    /// Compares a picture with the one that the calibration was made with.
    ///
    /// Fails if the camera was moved, if its pictures have another size, or if too little is seen to tell.
    pub fn check_camera(&self, picture: &RgbImage, sight: &Sight) -> Result<(), String> {
        let ([width, height], (found_width, found_height)) =
            (self.terms.size_px, picture.dimensions());
        if [found_width, found_height] != [width, height] {
            return Err(format!(
                "its pictures have {found_width} x {found_height} px, and had {width} x {height} when it was calibrated"
            ));
        }
        let reference = self.reference.as_ref().ok_or(
            "whether it was moved since it was calibrated cannot be said: the calibration has no picture to compare with; \
             calibrate with `--image PNG`",
        )?;
        let scale = f64::from(width.max(COMPARED_PX)) / f64::from(COMPARED_PX);
        let (reference, now) = (
            reduced(reference, scale),
            reduced(&imageops::grayscale(picture), scale),
        );
        let marks = (sight.marks)(&reference)?;
        let again = (sight.find_again)(&reference, &marks, &now)?;
        if again.len() < FEWEST || (again.len() as f64) < SHARE * marks.len() as f64 {
            return Err(format!(
                "whether it was moved since it was calibrated cannot be said: of {} places of the calibration's picture {} \
                 are found again, and at least {FEWEST} are needed: the camera was moved far, or too much of the table is \
                 covered or lit otherwise; if nothing was, stick a few pieces of printed paper beside the cloth's place and \
                 calibrate anew",
                marks.len(),
                again.len()
            ));
        }
        let ways_px = again
            .iter()
            .map(|mark| mark.moved_px[0].hypot(mark.moved_px[1]));
        let mut ways_px: Vec<f64> = ways_px.collect();
        ways_px.sort_by(f64::total_cmp);
        let by_px = ways_px[ways_px.len() / 2];
        if by_px > STILL_PX {
            return Err(format!(
                "it was moved since it was calibrated, by {:.1} px; calibrate anew",
                by_px * scale
            ));
        }
        Ok(())
    }
}

fn reduced(picture: &GrayImage, scale: f64) -> GrayImage {
    let side = |px: u32| ((f64::from(px) / scale) as u32).max(1);
    let (width, height) = (side(picture.width()), side(picture.height()));
    imageops::resize(picture, width, height, FilterType::Triangle)
}

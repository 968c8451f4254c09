//! The contact sheet: a rollout on one picture.
//!
//! One row per executed step: the subgoal with its arrow, the cloth with the chosen action, the cloth after it. The
//! headline names the task, the policy with its caveats, and the result.

use crate::record::{Header, Report};
use fab_program::PixelPoint;
use fab_vision::VisionError;
use image::{Rgb, RgbImage, imageops};

const MARGIN_PX: u32 = 12;
const HEADLINE_PX: u32 = 54;
const CAPTION_PX: u32 = 22;
/// The largest picture in the sheet, and the smallest in a long one.
const MAX_CELL_PX: u32 = 224;
const MIN_CELL_PX: u32 = 32;
/// The sheet's greatest height, pixels; just below the largest picture that can be drawn on.
const MAX_HEIGHT_PX: u32 = 8000;
const PAPER: Rgb<u8> = Rgb([255, 255, 255]);
const INK: [u8; 3] = [30, 30, 30];
const CAPTIONS: [&str; 3] = ["to be done", "chosen pick and place", "after the step"];

/// Name of the contact sheet in a run folder.
pub const SHEET_FILE: &str = "sheet.png";

/// The rows of a contact sheet.
#[derive(Debug, Default)]
pub struct Sheet {
    /// Each with its step's number, from 1.
    rows: Vec<(u32, [RgbImage; 3])>,
}

impl Sheet {
    /// Adds an executed step, numbered from 1.
    ///
    /// The first picture is the subgoal with its arrow; if there is none, the scene with the task's layers.
    pub fn row(&mut self, step: u32, shown: &RgbImage, action: RgbImage, after: RgbImage) {
        // Shrink at once: the pictures of a long rollout with a large camera would fill the memory.
        let row = [shown, &action, &after].map(|picture| fit(picture, MAX_CELL_PX));
        self.rows.push((step, row));
    }

    /// Draws the sheet; `None` if no step was executed. Fails if text cannot be drawn.
    pub fn picture(
        &self,
        header: &Header,
        report: &Report,
    ) -> Result<Option<RgbImage>, VisionError> {
        if self.rows.is_empty() {
            return Ok(None);
        }
        let rows = self.rows.len() as u32;
        let room_px = (MAX_HEIGHT_PX - HEADLINE_PX) / rows;
        let cell = MAX_CELL_PX
            .min(room_px.saturating_sub(CAPTION_PX + MARGIN_PX))
            .max(MIN_CELL_PX);
        let width = 3 * cell + 4 * MARGIN_PX;
        let height = HEADLINE_PX + rows * (CAPTION_PX + cell + MARGIN_PX);
        let mut sheet = RgbImage::from_pixel(width, height, PAPER);
        let title = format!("{}   policy: {}", header.task, header.policy.title());
        label(&mut sheet, &title, [MARGIN_PX, 22], 10)?;
        let distance = match (report.mean_particle_distance_mm, report.measures.coverage) {
            (Some(mm), _) => format!("   {mm:.1} mm from the nearest expert result"),
            (None, Some(coverage)) => format!("   coverage {coverage:.3}"),
            (None, None) => String::new(),
        };
        let result = format!("{}{distance}", report.outcome.name());
        label(&mut sheet, &result, [MARGIN_PX, 44], 10)?;
        let mut top = HEADLINE_PX + CAPTION_PX;
        for (step, row) in &self.rows {
            let mut left = MARGIN_PX;
            for (caption, picture) in CAPTIONS.iter().zip(row) {
                let caption = format!("{step}. {caption}");
                label(&mut sheet, &caption, [left, top - 7], 8)?;
                imageops::replace(&mut sheet, &fit(picture, cell), left.into(), top.into());
                left += cell + MARGIN_PX;
            }
            top += CAPTION_PX + cell + MARGIN_PX;
        }
        Ok(Some(sheet))
    }
}

/// Writes a line of text that begins here.
fn label(
    sheet: &mut RgbImage,
    text: &str,
    [left, base]: [u32; 2],
    height_px: u32,
) -> Result<(), VisionError> {
    let at = PixelPoint::new(left as i32, base as i32);
    fab_vision::draw_label(sheet, text, at, INK, height_px)
}

/// Scales a picture to a square of the given side.
fn fit(picture: &RgbImage, side_px: u32) -> RgbImage {
    if picture.dimensions() == (side_px, side_px) {
        return picture.clone();
    }
    imageops::resize(picture, side_px, side_px, imageops::FilterType::Triangle)
}

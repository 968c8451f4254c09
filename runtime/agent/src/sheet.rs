//! The contact sheet: a rollout on one picture.
//!
//! One row per executed step: the subgoal with its arrow, the cloth with the chosen action, the cloth after it. The
//! headline names the task, the policy with its caveats, and the result.

use crate::record::Report;
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
    /// Makes a sheet without rows.
    pub fn new() -> Sheet {
        Sheet::default()
    }

    /// Adds an executed step, numbered from 1.
    ///
    /// The first picture is the subgoal with its arrow; if there is none, the scene with the task's layers.
    pub fn row(&mut self, step: u32, shown: &RgbImage, action: RgbImage, after: RgbImage) {
        // Shrink at once: the pictures of a long rollout with a large camera would fill the memory.
        let row = [shown, &action, &after].map(|picture| fit(picture, MAX_CELL_PX));
        self.rows.push((step, row));
    }

    /// Draws the sheet; `None` if no step was executed. Fails if text cannot be drawn.
    pub fn picture(&self, report: &Report) -> Result<Option<RgbImage>, VisionError> {
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
        fab_vision::draw_label(
            &mut sheet,
            &format!("{}   policy: {}", report.task, report.policy),
            PixelPoint::new(MARGIN_PX as i32, 22),
            INK,
            10,
        )?;
        let distance = match (report.mean_particle_distance_mm, report.coverage) {
            (Some(mm), _) => format!("   {mm:.1} mm from the nearest expert result"),
            (None, Some(coverage)) => format!("   coverage {coverage:.3}"),
            (None, None) => String::new(),
        };
        fab_vision::draw_label(
            &mut sheet,
            &format!("{}{distance}", report.outcome.name()),
            PixelPoint::new(MARGIN_PX as i32, 44),
            INK,
            10,
        )?;
        for (number, (step, row)) in self.rows.iter().enumerate() {
            let top = HEADLINE_PX + number as u32 * (CAPTION_PX + cell + MARGIN_PX);
            for (column, picture) in row.iter().enumerate() {
                let left = MARGIN_PX + column as u32 * (cell + MARGIN_PX);
                let caption = format!("{step}. {}", CAPTIONS[column]);
                fab_vision::draw_label(
                    &mut sheet,
                    &caption,
                    PixelPoint::new(left as i32, (top + CAPTION_PX - 7) as i32),
                    INK,
                    8,
                )?;
                let fitted = fit(picture, cell);
                imageops::replace(
                    &mut sheet,
                    &fitted,
                    i64::from(left),
                    i64::from(top + CAPTION_PX),
                );
            }
        }
        Ok(Some(sheet))
    }
}

/// Scales a picture to a square of the given side.
fn fit(picture: &RgbImage, side_px: u32) -> RgbImage {
    if picture.dimensions() == (side_px, side_px) {
        return picture.clone();
    }
    imageops::resize(picture, side_px, side_px, imageops::FilterType::Triangle)
}

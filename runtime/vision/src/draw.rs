//! Marks in pictures: subgoal arrows, proposed actions, detected points, labels.
//!
//! In: a picture and where to draw. Out: the same picture, changed. Marks are clipped at the picture's edge; a mark at
//! a non-finite position is omitted.

use super::raster::{Font, Pen, Place};
use super::{VisionError, check_size};
use fab_program::PixelPoint;
use image::RgbImage;

const BLACK: [u8; 3] = [0, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const PURPLE: [u8; 3] = [128, 0, 128];

/// Picture side at which the arrow's ring has the paper's radius of 3, pixels.
const ARROW_DRAWN_AT_PX: f64 = 224.0;

/// Radius of a subgoal arrow's ring and width of its strokes at that side, pixels. Narrower strokes would be too pale
/// between two rows of pixels to be told from a crease.
const RING_PX: f64 = 3.0;
const STROKE_PX: f64 = 1.75;

/// Radius of a proposed action's rings and width of its strokes, pixels.
const ACTION_RING_PX: f64 = 5.0;
const ACTION_STROKE_PX: f64 = 2.0;

/// The shortest arrowhead's strokes, pixels.
const HEAD_PX: f64 = 5.0;

/// The longest label, characters.
const MAX_LABEL: usize = 200;

/// Draws the black arrow of a subgoal picture: a ring at the tail, a line from there, a head at the tip.
///
/// `tail` and `tip` are `[column, row]`, truncated to whole pixels. At 224 px the ring has radius 3 (protocol, section
/// 6) and is open: the corner inside stays visible. In larger pictures ring and strokes grow with the longer side; in
/// smaller ones they stay, or the ring would close up.
pub fn draw_arrow(
    picture: &mut RgbImage,
    tail: [f64; 2],
    tip: [f64; 2],
) -> Result<(), VisionError> {
    check_size(picture.width(), picture.height())?;
    let side_px = f64::from(picture.width().max(picture.height()));
    let scale = (side_px / ARROW_DRAWN_AT_PX).max(1.0);
    let radius_px = (RING_PX * scale).round();
    let [tail, tip] = [tail, tip].map(|at| at.map(f64::trunc));
    if !tail.iter().chain(&tip).all(|value| value.is_finite()) {
        return Ok(());
    }
    let pen = Pen {
        rgb: BLACK,
        width_px: STROKE_PX * scale,
    };
    pen.ring(picture, tail, radius_px);
    pen.arrow(picture, [tail, tip], [radius_px, 0.0], HEAD_PX * scale);
    Ok(())
}

/// Draws a proposed action: a green ring at the pick, a green arrow, a purple ring at the place.
///
/// The arrow leads from ring to ring, so both points stay visible. Sizes do not grow with the picture (protocol,
/// section 4, item 4).
pub fn draw_action(
    picture: &mut RgbImage,
    pick: PixelPoint,
    place: PixelPoint,
) -> Result<(), VisionError> {
    check_size(picture.width(), picture.height())?;
    let [green, purple] = [GREEN, PURPLE].map(|rgb| Pen {
        rgb,
        width_px: ACTION_STROKE_PX,
    });
    let [pick, place] = [pick, place].map(middle);
    green.ring(picture, pick, ACTION_RING_PX);
    green.arrow(picture, [pick, place], [ACTION_RING_PX; 2], HEAD_PX);
    purple.ring(picture, place, ACTION_RING_PX);
    Ok(())
}

/// Writes one line of text whose baseline starts at `at`.
///
/// `height_px` is the height of a capital letter; the font has 9, 13 and 17 px, and the largest that is not higher is
/// used, at least 9. Characters outside ASCII appear as question marks; text after 200 characters is omitted.
pub fn draw_label(
    picture: &mut RgbImage,
    text: &str,
    at: PixelPoint,
    rgb: [u8; 3],
    height_px: u32,
) -> Result<(), VisionError> {
    check_size(picture.width(), picture.height())?;
    let text: String = text.chars().take(MAX_LABEL).collect();
    let at = [at.u, at.v].map(i64::from);
    Font::of(height_px).write(picture, &text, at, rgb);
    Ok(())
}

/// The largest radius and width of a mark, pixels.
const MAX_MARK_PX: u32 = 100;

pub(super) fn mark(size_px: u32) -> f64 {
    f64::from(size_px.min(MAX_MARK_PX))
}

pub(super) fn middle(point: PixelPoint) -> Place {
    [f64::from(point.u), f64::from(point.v)]
}

pub(super) fn dot(picture: &mut RgbImage, at: PixelPoint, rgb: [u8; 3], radius_px: u32) {
    let width_px = 2.0 * mark(radius_px) + 1.0;
    Pen { rgb, width_px }.line(picture, middle(at), middle(at));
}

//! Marks in pictures: subgoal arrows, proposed actions, detected points, labels.
//!
//! In: a picture and where to draw. Out: the same picture, changed. Marks are clipped at the picture's edge; a mark at
//! a non-finite position is omitted.

use super::{VisionError, check_size};
use fab_program::PixelPoint;
use image::RgbImage;
use opencv::core::{Mat, Point, Scalar, ToInputOutputArray, Vec3b};
use opencv::imgproc;

/// A colour as red, green, blue.
type Rgb = [u8; 3];

const BLACK: Rgb = [0, 0, 0];
const GREEN: Rgb = [0, 255, 0];
const PURPLE: Rgb = [128, 0, 128];

/// Picture side at which the paper's arrow has a ring of radius 3 and lines 2 px wide, pixels.
const ARROW_DRAWN_AT_PX: f64 = 224.0;

/// Length of an arrowhead's strokes as a fraction of the arrow; OpenCV's default.
const HEAD_FRACTION: f64 = 0.1;

/// The longest label, characters.
const MAX_LABEL: usize = 200;

/// Draws the black arrow of a subgoal picture: a ring at the tail, a line, a head at the tip.
///
/// `tail` and `tip` are `[column, row]`, truncated to whole pixels. At 224 px the ring has radius 3 and all strokes are
/// 2 px wide (protocol, section 6). In larger pictures both grow with the longer side; in smaller ones they stay, or
/// the ring would close up.
pub fn draw_arrow(
    picture: &mut RgbImage,
    tail: [f64; 2],
    tip: [f64; 2],
) -> Result<(), VisionError> {
    let side_px = f64::from(picture.width().max(picture.height()));
    let scale = (side_px / ARROW_DRAWN_AT_PX).max(1.0);
    // Widths are truncated, not rounded, so the inside of the ring stays open.
    let (radius_px, stroke_px) = ((3.0 * scale).round() as i32, (2.0 * scale) as i32);
    let (Some(tail), Some(tip)) = (whole(tail), whole(tip)) else {
        return Ok(());
    };
    let mut canvas = canvas(picture)?;
    ring(&mut canvas, tail, radius_px, stroke_px, BLACK)?;
    arrow(&mut canvas, tail, tip, stroke_px, BLACK)
}

/// Draws a proposed action: a green ring at the pick, a green arrow, a purple ring at the place.
///
/// Sizes do not grow with the picture (protocol, section 4, item 4).
pub fn draw_action(
    picture: &mut RgbImage,
    pick: PixelPoint,
    place: PixelPoint,
) -> Result<(), VisionError> {
    let mut canvas = canvas(picture)?;
    let [pick, place] = [pick, place].map(bounded);
    ring(&mut canvas, pick, 5, 2, GREEN)?;
    arrow(&mut canvas, pick, place, 2, GREEN)?;
    ring(&mut canvas, place, 5, 2, PURPLE)
}

/// Draws a filled dot at each point; `radius_px` 0 is a single pixel, 100 the maximum.
pub fn draw_points(
    picture: &mut RgbImage,
    points: &[PixelPoint],
    rgb: [u8; 3],
    radius_px: u32,
) -> Result<(), VisionError> {
    let mut canvas = canvas(picture)?;
    let radius_px = radius_px.min(100) as i32;
    for &point in points {
        ring(&mut canvas, bounded(point), radius_px, imgproc::FILLED, rgb)?;
    }
    Ok(())
}

/// Writes one line of text whose baseline starts at `at`.
///
/// `height_px` is the height of a capital letter, 4 to 100. Characters outside ASCII appear as question marks; text
/// after 200 characters is omitted.
pub fn draw_label(
    picture: &mut RgbImage,
    text: &str,
    at: PixelPoint,
    rgb: [u8; 3],
    height_px: u32,
) -> Result<(), VisionError> {
    // Capitals of this font are 21 px high at scale 1.
    let scale = f64::from(height_px.clamp(4, 100)) / 21.0;
    let printable = |c: char| {
        if c.is_ascii() && !c.is_ascii_control() {
            c
        } else {
            '?'
        }
    };
    let text: String = text.chars().take(MAX_LABEL).map(printable).collect();
    let thickness = scale.round().max(1.0) as i32;
    imgproc::put_text(
        &mut canvas(picture)?,
        &text,
        bounded(at),
        imgproc::FONT_HERSHEY_SIMPLEX,
        scale,
        scalar(rgb),
        thickness,
        imgproc::LINE_AA,
        false,
    )?;
    Ok(())
}

/// Lends the picture's pixels to OpenCV. Its channels stay in the order red, green, blue.
pub(super) fn canvas(
    picture: &mut RgbImage,
) -> Result<opencv::boxed_ref::BoxedRefMut<'_, Mat>, VisionError> {
    let (width, height) = picture.dimensions();
    check_size(width, height)?;
    Ok(Mat::new_rows_cols_with_bytes_mut::<Vec3b>(
        height as i32,
        width as i32,
        picture,
    )?)
}

pub(super) fn ring(
    canvas: &mut impl ToInputOutputArray,
    center: Point,
    radius_px: i32,
    thickness_px: i32,
    rgb: Rgb,
) -> Result<(), VisionError> {
    let color = scalar(rgb);
    imgproc::circle(
        canvas,
        center,
        radius_px,
        color,
        thickness_px,
        imgproc::LINE_8,
        0,
    )?;
    Ok(())
}

pub(super) fn arrow(
    canvas: &mut impl ToInputOutputArray,
    tail: Point,
    tip: Point,
    thickness_px: i32,
    rgb: Rgb,
) -> Result<(), VisionError> {
    let color = scalar(rgb);
    let style = imgproc::LINE_8;
    imgproc::arrowed_line(
        canvas,
        tail,
        tip,
        color,
        thickness_px,
        style,
        0,
        HEAD_FRACTION,
    )?;
    Ok(())
}

pub(super) fn scalar(rgb: Rgb) -> Scalar {
    let [red, green, blue] = rgb.map(f64::from);
    Scalar::new(red, green, blue, 0.0)
}

/// Coordinates of marks are clamped to this, pixels; OpenCV's fixed-point lines overflow far beyond it.
const FAR_PX: i32 = 16_384;

fn whole(at: [f64; 2]) -> Option<Point> {
    let far = f64::from(FAR_PX);
    let [x, y] = at.map(|value| value.clamp(-far, far).trunc());
    (x.is_finite() && y.is_finite()).then(|| Point::new(x as i32, y as i32))
}

pub(super) fn bounded(point: PixelPoint) -> Point {
    Point::new(
        point.u.clamp(-FAR_PX, FAR_PX),
        point.v.clamp(-FAR_PX, FAR_PX),
    )
}

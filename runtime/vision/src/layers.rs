//! The layers of marks on the picture that a model sees.
//!
//! In: the camera's picture and [`DrawnLayer`]s with resolved points. Out: a new picture. Later layers cover earlier
//! ones; marks are clipped at the picture's edge. OpenCV draws the marks, so the paper's annotated pictures are
//! reproduced pixel for pixel (protocol, section 4, item 4).

use super::VisionError;
use super::boxes::sorted;
use super::color::gray_level;
use super::draw::{arrow, bounded, canvas, ring, scalar};
use fab_program::PixelPoint;
use image::RgbImage;
use opencv::core::{Point, ToInputOutputArray, Vector};
use opencv::imgproc;

/// One layer: marks of one kind and colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnLayer {
    /// The colour as red, green, blue.
    pub rgb: [u8; 3],
    /// What is drawn, and where.
    pub shape: DrawnShape,
}

/// Marks at given pixels; sizes above 100 px count as 100, widths of 0 as 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DrawnShape {
    /// Filled circles.
    Dots {
        /// Their centres.
        at: Vec<PixelPoint>,
        /// Pixels; 0 is a single pixel.
        radius_px: u32,
    },
    /// Circles.
    Rings {
        /// Their centres.
        at: Vec<PixelPoint>,
        /// Radius to the middle of the line, pixels.
        radius_px: u32,
        /// Width of the line, pixels.
        width_px: u32,
    },
    /// Upright crosses.
    Crosses {
        /// Their middles.
        at: Vec<PixelPoint>,
        /// Length of each arm, pixels.
        radius_px: u32,
        /// Width of the lines, pixels.
        width_px: u32,
    },
    /// The index of each point, from 1, beside it and inside the picture.
    ///
    /// Points outside the picture are counted, but their numbers are not drawn.
    Numbers {
        /// The points.
        at: Vec<PixelPoint>,
    },
    /// An arrow; its head is a tenth of its length.
    Arrow {
        /// Its tail.
        from: PixelPoint,
        /// Its tip.
        to: PixelPoint,
        /// Width of the line, pixels.
        width_px: u32,
    },
    /// The sides of an upright box, as single pixels.
    Box {
        /// Two opposite corners, both part of the box.
        corners: [PixelPoint; 2],
        /// Every how many pixels a dot is drawn, counted on each side from the left or the top; 0 and 1 make solid
        /// lines.
        spacing_px: u32,
    },
    /// The sides of a closed polygon.
    Outline {
        /// Its vertices in order.
        points: Vec<PixelPoint>,
        /// Width of the line, pixels.
        width_px: u32,
    },
}

/// The largest radius and width of a mark, pixels.
const MAX_MARK_PX: u32 = 100;

/// Height of a digit, pixels: legible in a picture of 224 px, and small beside a cloth of 100.
const DIGIT_PX: f64 = 9.0;

/// Height of a capital letter or digit of OpenCV's plain font at scale 1, pixels.
const FONT_PX: f64 = 21.0;

/// Gap between a point and its number, pixels; enough to clear a dot or ring of the usual radius of 3.
const GAP_PX: i32 = 5;

/// How far a digit's rim reaches beyond it, pixels.
const RIM_PX: i32 = 3;

/// Draws layers onto a copy of a picture, in order.
///
/// Fails if the picture is empty or larger than [`super::MAX_SIDE_PX`], or OpenCV fails.
pub fn draw_layers(rgb: &RgbImage, layers: &[DrawnLayer]) -> Result<RgbImage, VisionError> {
    let mut picture = rgb.clone();
    let size = [picture.width() as i32, picture.height() as i32];
    let mut canvas = canvas(&mut picture)?;
    for layer in layers {
        draw(&mut canvas, size, layer)?;
    }
    drop(canvas);
    Ok(picture)
}

fn draw(
    canvas: &mut impl ToInputOutputArray,
    size: [i32; 2],
    DrawnLayer { rgb, shape }: &DrawnLayer,
) -> Result<(), VisionError> {
    match shape {
        DrawnShape::Dots { at, radius_px } => at.iter().try_for_each(|&point| {
            ring(
                canvas,
                bounded(point),
                mark(*radius_px),
                imgproc::FILLED,
                *rgb,
            )
        }),
        DrawnShape::Rings {
            at,
            radius_px,
            width_px,
        } => at.iter().try_for_each(|&point| {
            let (radius, width) = (mark(*radius_px), line_width(*width_px));
            ring(canvas, bounded(point), radius, width, *rgb)
        }),
        DrawnShape::Crosses {
            at,
            radius_px,
            width_px,
        } => at.iter().try_for_each(|&point| {
            let (point, arm, width) = (bounded(point), mark(*radius_px), line_width(*width_px));
            [Point::new(arm, 0), Point::new(0, arm)]
                .into_iter()
                .try_for_each(|arm| line(canvas, point - arm, point + arm, width, *rgb))
        }),
        DrawnShape::Numbers { at } => (1_usize..)
            .zip(at)
            .try_for_each(|(index, &point)| number(canvas, size, &index.to_string(), point, *rgb)),
        DrawnShape::Arrow { from, to, width_px } => {
            let width = line_width(*width_px);
            arrow(canvas, bounded(*from), bounded(*to), width, *rgb)
        }
        DrawnShape::Box {
            corners,
            spacing_px,
        } => dotted_box(canvas, *corners, *spacing_px, *rgb),
        DrawnShape::Outline { points, width_px } => {
            let points: Vector<Point> = points.iter().map(|&point| bounded(point)).collect();
            if points.is_empty() {
                return Ok(());
            }
            let (width, style) = (line_width(*width_px), imgproc::LINE_8);
            Ok(imgproc::polylines(
                canvas,
                &points,
                true,
                scalar(*rgb),
                width,
                style,
                0,
            )?)
        }
    }
}

fn mark(size_px: u32) -> i32 {
    size_px.min(MAX_MARK_PX) as i32
}

fn line_width(width_px: u32) -> i32 {
    width_px.clamp(1, MAX_MARK_PX) as i32
}

fn line(
    canvas: &mut impl ToInputOutputArray,
    from: Point,
    to: Point,
    width_px: i32,
    rgb: [u8; 3],
) -> Result<(), VisionError> {
    let style = imgproc::LINE_8;
    Ok(imgproc::line(
        canvas,
        from,
        to,
        scalar(rgb),
        width_px,
        style,
        0,
    )?)
}

/// Draws single pixels on a box's sides.
///
/// A dotted side ends before its last pixel, as in the paper's pictures; a solid box is closed.
fn dotted_box(
    canvas: &mut impl ToInputOutputArray,
    corners: [PixelPoint; 2],
    spacing_px: u32,
    rgb: [u8; 3],
) -> Result<(), VisionError> {
    let [low, high] = sorted(corners).map(bounded);
    let opposite = Point::new(high.x, low.y);
    let other = Point::new(low.x, high.y);
    if spacing_px <= 1 {
        let turns = [low, opposite, high, other, low];
        return turns
            .windows(2)
            .try_for_each(|side| line(canvas, side[0], side[1], 1, rgb));
    }
    let step = usize::try_from(spacing_px).unwrap_or(usize::MAX);
    let across = (low.x..high.x)
        .step_by(step)
        .flat_map(|x| [Point::new(x, low.y), Point::new(x, high.y)]);
    let down = (low.y..high.y)
        .step_by(step)
        .flat_map(|y| [Point::new(low.x, y), Point::new(high.x, y)]);
    across
        .chain(down)
        .try_for_each(|pixel| line(canvas, pixel, pixel, 1, rgb))
}

/// Writes a number right above a point, or on another side if the picture ends there.
fn number(
    canvas: &mut impl ToInputOutputArray,
    [width, height]: [i32; 2],
    text: &str,
    point: PixelPoint,
    rgb: [u8; 3],
) -> Result<(), VisionError> {
    if !(0..width).contains(&point.u) || !(0..height).contains(&point.v) {
        return Ok(());
    }
    let (font, scale) = (imgproc::FONT_HERSHEY_SIMPLEX, DIGIT_PX / FONT_PX);
    let size = imgproc::get_text_size(text, font, scale, 1, &mut 0)?;
    let (right, above) = (point.u + GAP_PX, point.v - GAP_PX);
    let left = if right + size.width + RIM_PX < width {
        right
    } else {
        (point.u - GAP_PX - size.width).max(RIM_PX)
    };
    let baseline = if above - size.height - RIM_PX >= 0 {
        above
    } else {
        (point.v + GAP_PX + size.height).min(height - RIM_PX)
    };
    // A rim of the opposite brightness keeps a digit legible on any cloth.
    let rim = if gray_level(rgb) < 128 {
        [255; 3]
    } else {
        [0; 3]
    };
    for (color, stroke_px) in [(rim, 3), (rgb, 1)] {
        let (origin, style) = (Point::new(left, baseline), imgproc::LINE_AA);
        imgproc::put_text(
            canvas,
            text,
            origin,
            font,
            scale,
            scalar(color),
            stroke_px,
            style,
            false,
        )?;
    }
    Ok(())
}

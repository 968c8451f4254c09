//! The layers of marks on the picture that a model sees.
//!
//! In: the camera's picture and [`DrawnLayer`]s with resolved points. Out: a new picture. Later layers cover earlier
//! ones; marks are clipped at the picture's edge. They are where the paper's annotated pictures have them (protocol,
//! section 4, item 4), with smooth edges.

use super::boxes::sorted;
use super::draw::{dot, mark, middle};
use super::numbers::write_numbers;
use super::raster::Pen;
use super::{VisionError, check_size};
use fab_program::PixelPoint;
use image::RgbImage;

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
    /// The index of each point, from 1, beside it and inside the picture, with a rim of the opposite brightness.
    ///
    /// Points outside the picture are counted, but their numbers are not drawn.
    Numbers {
        /// The points.
        at: Vec<PixelPoint>,
    },
    /// An arrow; its head is a tenth of its length, and at least three line widths.
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

/// Draws layers onto a copy of a picture, in order.
///
/// Fails if the picture is empty or larger than [`super::MAX_SIDE_PX`].
pub fn draw_layers(rgb: &RgbImage, layers: &[DrawnLayer]) -> Result<RgbImage, VisionError> {
    check_size(rgb.width(), rgb.height())?;
    let mut picture = rgb.clone();
    for layer in layers {
        draw(&mut picture, layer);
    }
    Ok(picture)
}

fn draw(picture: &mut RgbImage, DrawnLayer { rgb, shape }: &DrawnLayer) {
    let pen = |width_px: u32| Pen {
        rgb: *rgb,
        width_px: mark(width_px).max(1.0),
    };
    match shape {
        DrawnShape::Dots { at, radius_px } => {
            for &point in at {
                dot(picture, point, *rgb, *radius_px);
            }
        }
        DrawnShape::Rings {
            at,
            radius_px,
            width_px,
        } => {
            for &point in at {
                pen(*width_px).ring(picture, middle(point), mark(*radius_px));
            }
        }
        DrawnShape::Crosses {
            at,
            radius_px,
            width_px,
        } => {
            let arm = mark(*radius_px);
            for [u, v] in at.iter().map(|&point| middle(point)) {
                pen(*width_px).line(picture, [u - arm, v], [u + arm, v]);
                pen(*width_px).line(picture, [u, v - arm], [u, v + arm]);
            }
        }
        DrawnShape::Numbers { at } => {
            let places: Vec<_> = at.iter().map(|&point| middle(point)).collect();
            write_numbers(picture, &places, *rgb);
        }
        DrawnShape::Arrow { from, to, width_px } => {
            let (pen, ends) = (pen(*width_px), [*from, *to].map(middle));
            pen.arrow(picture, ends, [0.0; 2], 3.0 * pen.width_px);
        }
        DrawnShape::Box {
            corners,
            spacing_px,
        } => dotted_box(picture, *corners, *spacing_px, *rgb),
        DrawnShape::Outline { points, width_px } => {
            for (&from, &to) in points.iter().zip(points.iter().cycle().skip(1)) {
                pen(*width_px).line(picture, middle(from), middle(to));
            }
        }
    }
}

/// Draws single pixels on a box's sides.
///
/// A dotted side ends before its last pixel, as in the paper's pictures; a solid box is closed.
fn dotted_box(picture: &mut RgbImage, corners: [PixelPoint; 2], spacing_px: u32, rgb: [u8; 3]) {
    let [low, high] = sorted(corners).map(|corner| [corner.u, corner.v].map(i64::from));
    let (step, past) = match spacing_px {
        0 | 1 => (1, 1),
        _ => (i64::from(spacing_px), 0),
    };
    let size = [picture.width(), picture.height()];
    for axis in [0, 1] {
        let is_dot = |&at: &u32| {
            let along = i64::from(at) - low[axis];
            (0..high[axis] - low[axis] + past).contains(&along) && along % step == 0
        };
        for along in (0..size[axis]).filter(is_dot) {
            for across in [low[1 - axis], high[1 - axis]] {
                let Ok(across) = u32::try_from(across) else {
                    continue;
                };
                let [column, row] = [[along, across], [across, along]][axis];
                if let Some(pixel) = picture.get_pixel_mut_checked(column, row) {
                    pixel.0 = rgb;
                }
            }
        }
    }
}

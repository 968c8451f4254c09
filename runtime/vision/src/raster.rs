//! Anti-aliased strokes and text.
//!
//! In: places `[column, row]`, with pixel centres at whole numbers, and a pen. Out: the same picture, changed. A pixel
//! takes on the pen's colour as far as the stroke covers it. Everything is clipped at the picture's edge, and work is
//! bounded by its area wherever a mark lies. Only sums, products and square roots are used, so that every machine draws
//! the same bits.

use fab_picture::hull::{dot, minus};
use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// A place, `[column, row]`, pixels.
pub(super) type Place = [f64; 2];

/// A round pen.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// Width of its strokes, pixels.
    pub width_px: f64,
}

/// Length of an arrowhead's strokes as a fraction of the arrow, as in the paper's pictures.
const HEAD_FRACTION: f64 = 0.1;

impl Pen {
    /// Draws a straight line with round ends; a dot if both ends are the same.
    pub fn line(self, picture: &mut RgbImage, from: Place, to: Place) {
        let along = minus(to, from);
        let reach = self.reach();
        let columns = |row: f64| {
            let near = [-reach, reach]
                .map(|off| from[0] + along[0] * share((row + off - from[1]) / along[1]));
            [near[0].min(near[1]) - reach, near[0].max(near[1]) + reach]
        };
        let rows = [from[1].min(to[1]) - reach, from[1].max(to[1]) + reach];
        self.cover(picture, rows, columns, |at| {
            let off = minus(at, from);
            let share = share(dot(off, along) / dot(along, along));
            length(minus(off, along.map(|part| part * share)))
        });
    }

    /// Draws a circle; the radius reaches to the middle of the line.
    pub fn ring(self, picture: &mut RgbImage, center: Place, radius_px: f64) {
        let outer = radius_px + self.reach();
        let [columns, rows] = center.map(|middle| [middle - outer, middle + outer]);
        let off_px = |at| (length(minus(at, center)) - radius_px).abs();
        self.cover(picture, rows, |_| columns, off_px);
    }

    /// Draws an arrow that keeps `clear_px` from its tail and from its tip; nothing if no length is left.
    ///
    /// - `head_px`: the least length of the head's strokes, because a tenth of a short arrow could not be seen.
    pub fn arrow(
        self,
        picture: &mut RgbImage,
        [tail, tip]: [Place; 2],
        clear_px: [f64; 2],
        head_px: f64,
    ) {
        let back = minus(tail, tip);
        let (whole_px, length_px) = (length(back), length(back) - clear_px[0] - clear_px[1]);
        if length_px <= 0.0 {
            return;
        }
        let [x, y] = back.map(|part| part / whole_px);
        let behind =
            |from: Place, step: Place, px: f64| [0, 1].map(|axis| from[axis] + px * step[axis]);
        let tip = behind(tip, [x, y], clear_px[1]);
        self.line(picture, behind(tip, [x, y], length_px), tip);
        let head_px = (HEAD_FRACTION * whole_px).max(head_px).min(length_px / 2.0);
        // Half a right angle to each side.
        for side in [[x - y, y + x], [x + y, y - x]] {
            self.line(
                picture,
                tip,
                behind(tip, side, head_px * std::f64::consts::FRAC_1_SQRT_2),
            );
        }
    }

    /// Returns how far from its middle a stroke may colour a pixel.
    fn reach(self) -> f64 {
        self.width_px / 2.0 + 0.5
    }

    fn cover(
        self,
        picture: &mut RgbImage,
        rows: [f64; 2],
        columns: impl Fn(f64) -> [f64; 2],
        off_px: impl Fn(Place) -> f64,
    ) {
        let (width, height) = picture.dimensions();
        // Casts clamp to what fits.
        let within = |[from, to]: [f64; 2], size: u32| {
            from.ceil() as u32..((to.floor() + 1.0) as u32).min(size)
        };
        for row in within(rows, height) {
            for column in within(columns(f64::from(row)), width) {
                let off_px = off_px([f64::from(column), f64::from(row)]);
                blend(
                    picture.get_pixel_mut(column, row),
                    self.rgb,
                    self.reach() - off_px,
                );
            }
        }
    }
}

/// Returns a vector's length. Square roots are exact on every machine, `hypot` is not.
fn length(vector: Place) -> f64 {
    dot(vector, vector).sqrt()
}

/// Clamps to 0 to 1, and takes what is not a number, such as 0 / 0 for a dot, as 0.
fn share(value: f64) -> f64 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

fn blend(pixel: &mut Rgb<u8>, rgb: [u8; 3], coverage: f64) {
    for (level, ink) in pixel.0.iter_mut().zip(rgb) {
        let from = f64::from(*level);
        *level = (from + share(coverage) * (f64::from(ink) - from)).round() as u8;
    }
}

const WEIGHT: FontWeight = FontWeight::Regular;

/// A size of the font, in which letters and digits are equally wide.
#[derive(Clone, Copy)]
pub(super) struct Font(RasterHeight);

impl Font {
    /// Returns the largest size whose capitals are not higher than this, or the smallest: 9, 13 or 17 px.
    pub fn of(capital_px: u32) -> Font {
        Font(match capital_px {
            ..13 => RasterHeight::Size16,
            13..17 => RasterHeight::Size24,
            17.. => RasterHeight::Size32,
        })
    }

    /// Returns the height of a capital letter or digit, pixels.
    pub fn capital_px(self) -> i64 {
        self.0.val() as i64 / 2 + 1
    }

    /// Returns the width of a line of text, pixels.
    pub fn width_px(self, text: &str) -> i64 {
        (get_raster_width(WEIGHT, self.0) * text.chars().count()) as i64
    }

    /// Writes a line whose first capital has its lowest left pixel at `[column, row]`.
    ///
    /// Characters outside ASCII appear as question marks.
    pub fn write(self, picture: &mut RgbImage, text: &str, at: [i64; 2], rgb: [u8; 3]) {
        let glyph = |letter| get_raster(letter, WEIGHT, self.0);
        let glyphs = text
            .chars()
            .filter_map(|letter| glyph(letter).or_else(|| glyph('?')));
        for (glyph, number) in glyphs.zip(0_i64..) {
            let left = at[0] + number * glyph.width() as i64;
            // A quarter of the raster lies below the baseline.
            let top = at[1] - 3 * glyph.height() as i64 / 4;
            for (line, row) in glyph.rows().zip(top..) {
                for (&ink, column) in line.iter().zip(left..) {
                    let (Ok(column), Ok(row)) = (u32::try_from(column), u32::try_from(row)) else {
                        continue;
                    };
                    if let Some(pixel) = picture.get_pixel_mut_checked(column, row) {
                        blend(pixel, rgb, f64::from(ink) / 255.0);
                    }
                }
            }
        }
    }
}

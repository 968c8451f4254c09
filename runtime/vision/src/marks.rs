//! Marks: places in a picture that can be found again in another picture of the same view.
//!
//! In: grey pictures. Out: marks, which are corners whose surroundings look like nothing else nearby, and where each is
//! in the other picture, to a fraction of a pixel. Brightness and contrast do not matter: patches are compared by
//! normalised correlation. The caller interprets their common motion.

use super::{VisionError, check_size};
use fab_picture::MovedMark;
use image::GrayImage;
use opencv::boxed_ref::BoxedRef;
use opencv::core::{Mat, Rect};
use opencv::imgproc;
use opencv::prelude::{MatTraitConst, MatTraitConstManual};

/// Half the side of a patch, pixels, without its middle: 21 x 21 in all, which still looks the same turned by 3
/// degrees.
const HALF: i32 = 10;
/// How far a patch is searched for, pixels in each direction.
const REACH: i32 = 32;
/// Side of a cell, pixels; each gives at most `PER_CELL` marks, so one textured corner cannot take them all.
const CELL_PX: i32 = 64;
/// The most marks of a cell.
const PER_CELL: usize = 3;
/// The least strength of a mark: the squared change of grey levels in the weaker direction, mean over its pixels.
/// Camera noise of 2 levels gives 2.
const LEAST_STRENGTH: f64 = 4.0;
/// A patch that correlates this well with another place nearby is not a mark.
const ALIKE: f64 = 0.75;
/// A patch whose best correlation is below this is not found.
const FOUND: f64 = 0.75;

/// Finds marks, the strongest of each part of the picture; none in a picture without texture.
pub fn marks(picture: &GrayImage) -> Result<Vec<[u32; 2]>, VisionError> {
    let grey = Grey::of(picture)?;
    let mut found = Vec::new();
    for top in (0..grey.height).step_by(CELL_PX as usize) {
        for left in (0..grey.width).step_by(CELL_PX as usize) {
            let mut kept: Vec<[i32; 2]> = Vec::new();
            // Rejected candidates, such as those on a checkered cloth, cost a search each.
            for at in grey.strongest([left, top]).into_iter().take(20) {
                let is_apart = |other: &[i32; 2]| {
                    (other[0] - at[0]).abs().max((other[1] - at[1]).abs()) > HALF
                };
                if kept.len() < PER_CELL && kept.iter().all(is_apart) && grey.is_alone(at)? {
                    kept.push(at);
                }
            }
            found.extend(kept.into_iter().map(|[u, v]| [u as u32, v as u32]));
        }
    }
    Ok(found)
}

/// Searches for each mark of one picture in another of the same size; omits those not found.
///
/// `marks` are the result of [`marks`] on `reference`. A mark is searched for up to 32 pixels from its old place.
pub fn find_again(
    reference: &GrayImage,
    marks: &[[u32; 2]],
    other: &GrayImage,
) -> Result<Vec<MovedMark>, VisionError> {
    if reference.dimensions() != other.dimensions() {
        return Ok(Vec::new());
    }
    let (reference, other) = (Grey::of(reference)?, Grey::of(other)?);
    let mut found = Vec::new();
    for mark in marks {
        let at = mark.map(|coordinate| i32::try_from(coordinate).unwrap_or(-1));
        if reference.holds(at)
            && let Some(moved_px) = other.likenesses(&reference, at)?.best()
        {
            found.push(MovedMark {
                at_px: at.map(|coordinate| f64::from(coordinate) + 0.5),
                moved_px,
            });
        }
    }
    Ok(found)
}

/// A picture, as plain levels and as an OpenCV matrix.
struct Grey<'p> {
    width: i32,
    height: i32,
    picture: &'p GrayImage,
    pixels: BoxedRef<'p, Mat>,
}

const SIDE: i32 = 2 * HALF + 1;

impl<'p> Grey<'p> {
    fn of(picture: &'p GrayImage) -> Result<Grey<'p>, VisionError> {
        let (width, height) = picture.dimensions();
        check_size(width, height)?;
        let (width, height) = (width as i32, height as i32);
        Ok(Grey {
            width,
            height,
            picture,
            pixels: Mat::new_rows_cols_with_bytes::<u8>(height, width, picture)?,
        })
    }

    /// Returns whether the patch around a pixel lies in the picture.
    fn holds(&self, [u, v]: [i32; 2]) -> bool {
        u >= HALF && v >= HALF && u + HALF < self.width && v + HALF < self.height
    }

    fn level(&self, u: i32, v: i32) -> f64 {
        f64::from(self.picture.get_pixel(u as u32, v as u32).0[0])
    }

    /// Returns the pixels of a cell with strong enough surroundings, strongest first.
    fn strongest(&self, [left, top]: [i32; 2]) -> Vec<[i32; 2]> {
        let mut strong: Vec<(f64, [i32; 2])> = Vec::new();
        // Every third pixel: a corner is wider than that, and the search does not need its exact middle.
        for v in (top..(top + CELL_PX).min(self.height)).step_by(3) {
            for u in (left..(left + CELL_PX).min(self.width)).step_by(3) {
                if self.holds([u, v]) {
                    let strength = self.strength([u, v]);
                    if strength >= LEAST_STRENGTH {
                        strong.push((strength, [u, v]));
                    }
                }
            }
        }
        strong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        strong.into_iter().map(|(_, at)| at).collect()
    }

    /// Returns the smaller eigenvalue of the patch's structure tensor, per pixel (Shi, Tomasi 1994).
    fn strength(&self, [u, v]: [i32; 2]) -> f64 {
        let (mut xx, mut xy, mut yy) = (0.0_f64, 0.0, 0.0);
        // Every second pixel is enough.
        for row in (v - HALF + 1..v + HALF).step_by(2) {
            for column in (u - HALF + 1..u + HALF).step_by(2) {
                let x = (self.level(column + 1, row) - self.level(column - 1, row)) / 2.0;
                let y = (self.level(column, row + 1) - self.level(column, row - 1)) / 2.0;
                (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            }
        }
        let n = f64::from(HALF * HALF);
        let (mean, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        (mean - half.hypot(xy)) / n
    }

    /// Returns whether no other place in the search range looks like the patch around a pixel.
    fn is_alone(&self, at: [i32; 2]) -> Result<bool, VisionError> {
        let likenesses = self.likenesses(self, at)?;
        let is_itself = |[right, down]: [i32; 2]| right.abs().max(down.abs()) < HALF / 2 + 2;
        let mut others = likenesses.all().filter(|(offset, _)| !is_itself(*offset));
        Ok(others.all(|(_, like)| like < ALIKE))
    }

    /// Compares a patch of another picture with all patches of this one around the same place, within the search range.
    fn likenesses(&self, of: &Grey<'_>, at: [i32; 2]) -> Result<Correlations, VisionError> {
        let [u, v] = at;
        let patch = Mat::roi(&of.pixels, Rect::new(u - HALF, v - HALF, SIDE, SIDE))?;
        let least = at.map(|coordinate| (coordinate - REACH - HALF).max(0));
        let most = |axis: usize, side: i32| (at[axis] + REACH + HALF + 1).min(side);
        let size = [
            most(0, self.width) - least[0],
            most(1, self.height) - least[1],
        ];
        let searched = Mat::roi(
            &self.pixels,
            Rect::new(least[0], least[1], size[0], size[1]),
        )?;
        let mut likeness = Mat::default();
        imgproc::match_template_def(&searched, &patch, &mut likeness, imgproc::TM_CCOEFF_NORMED)?;
        Ok(Correlations {
            first: [least[0] + HALF - u, least[1] + HALF - v],
            columns: likeness.cols(),
            values: likeness.data_typed::<f32>()?.to_vec(),
        })
    }
}

/// The normalised correlation of a patch with each patch around a place, -1 to 1.
struct Correlations {
    /// Offset of the first value from the place, `[right, down]`.
    first: [i32; 2],
    columns: i32,
    /// Row by row.
    values: Vec<f32>,
}

impl Correlations {
    fn all(&self) -> impl Iterator<Item = ([i32; 2], f64)> {
        let offset = |index: i32| {
            let (row, column) = (index / self.columns, index % self.columns);
            [self.first[0] + column, self.first[1] + row]
        };
        (0..)
            .zip(&self.values)
            .map(move |(index, like)| (offset(index), f64::from(*like)))
    }

    fn at(&self, [right, down]: [i32; 2]) -> Option<f64> {
        let (column, row) = (right - self.first[0], down - self.first[1]);
        let index = usize::try_from(row * self.columns + column).ok()?;
        let is_inside = (0..self.columns).contains(&column) && row >= 0;
        is_inside.then(|| self.values.get(index).map(|like| f64::from(*like)))?
    }

    /// Returns the best offset to a fraction of a pixel; `None` if it is poor, or at the border of the search range.
    fn best(&self) -> Option<[f64; 2]> {
        let best = self.all().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let ([right, down], like) = best;
        if !(FOUND..=1.01).contains(&like) {
            return None;
        }
        // The parabola through three values peaks near the middle one.
        let top = |before: f64, after: f64| {
            let bend = before - 2.0 * like + after;
            if bend < 0.0 {
                (before - after) / (2.0 * bend)
            } else {
                0.0
            }
        };
        Some([
            f64::from(right) + top(self.at([right - 1, down])?, self.at([right + 1, down])?),
            f64::from(down) + top(self.at([right, down - 1])?, self.at([right, down + 1])?),
        ])
    }
}

//! Marks: places in a picture that can be found again in another picture of the same view.
//!
//! In: grey pictures. Out: marks, which are corners whose surroundings look like nothing else nearby, and where each is
//! in the other picture, to a fraction of a pixel. Brightness and contrast do not matter: patches are compared by
//! normalised correlation. The caller interprets their common motion.

use super::{VisionError, check_size};
use fab_picture::MovedMark;
use image::GrayImage;

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
                if kept.len() < PER_CELL && kept.iter().all(is_apart) && grey.is_alone(at) {
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
    let found = marks.iter().filter_map(|mark| {
        let at = mark.map(|coordinate| i32::try_from(coordinate).unwrap_or(-1));
        let likenesses = reference
            .holds(at)
            .then(|| other.likenesses(&reference, at))?;
        Some(MovedMark {
            at_px: at.map(|coordinate| f64::from(coordinate) + 0.5),
            moved_px: best(&likenesses)?,
        })
    });
    Ok(found.collect())
}

/// A picture.
struct Grey {
    width: i32,
    height: i32,
    /// Levels from their middle, row by row: sums of products stay small enough for `f32` to hold them exactly.
    levels: Vec<f32>,
}

impl Grey {
    fn of(picture: &GrayImage) -> Result<Grey, VisionError> {
        let (width, height) = picture.dimensions();
        check_size(width, height)?;
        let levels = picture.as_raw().iter();
        Ok(Grey {
            width: width as i32,
            height: height as i32,
            levels: levels.map(|level| f32::from(*level) - 128.0).collect(),
        })
    }

    /// Returns whether the patch around a pixel lies in the picture.
    fn holds(&self, [u, v]: [i32; 2]) -> bool {
        u >= HALF && v >= HALF && u + HALF < self.width && v + HALF < self.height
    }

    /// Returns the levels of a row from a pixel on.
    fn line(&self, u: i32, v: i32, n: usize) -> &[f32] {
        let first = v as usize * self.width as usize + u as usize;
        &self.levels[first..first + n]
    }

    fn level(&self, u: i32, v: i32) -> f64 {
        f64::from(self.line(u, v, 1)[0])
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
        (mean - (half * half + xy * xy).sqrt()) / n
    }

    /// Returns whether no other place in the search range looks like the patch around a pixel.
    fn is_alone(&self, at: [i32; 2]) -> bool {
        let is_itself = |[right, down]: [i32; 2]| right.abs().max(down.abs()) < HALF / 2 + 2;
        let likenesses = self.likenesses(self, at);
        let mut others = likenesses.iter().filter(|(offset, _)| !is_itself(*offset));
        others.all(|(_, like)| *like < ALIKE)
    }

    /// Compares a patch of another picture with all patches of this one around the same place, within the search range.
    ///
    /// Returns offsets `[right, down]`, row by row, and the normalised correlation, -1 to 1; 0 for a patch without contrast.
    fn likenesses(&self, of: &Grey, at: [i32; 2]) -> Vec<([i32; 2], f64)> {
        const SIDE: usize = 2 * HALF as usize + 1;
        let n = (SIDE * SIDE) as f64;
        let [rights, downs] = [0, 1].map(|axis| {
            let last = [self.width, self.height][axis] - 1 - HALF - at[axis];
            (HALF - at[axis]).max(-REACH)..=last.min(REACH)
        });
        let [u, v] = at;
        let patch: Vec<&[f32]> = (-HALF..=HALF)
            .map(|row| of.line(u - HALF, v + row, SIDE))
            .collect();
        let sum = |value: fn(f32) -> f32| -> f64 {
            let levels = patch.iter().copied().flatten();
            levels.map(|level| f64::from(value(*level))).sum()
        };
        let (sum_of, squares_of) = (sum(|level| level), sum(|level| level * level));
        let mut likenesses = Vec::new();
        for down in downs {
            let n_places = rights.clone().count();
            // Of each place: the sum of products with the patch, of levels, and of their squares.
            let [mut products, mut sums, mut squares] = [(); 3].map(|()| vec![0.0_f32; n_places]);
            for (row, weights) in (v + down - HALF..).zip(&patch) {
                let line = self.line(u + rights.start() - HALF, row, n_places + SIDE - 1);
                for (first, weight) in weights.iter().enumerate() {
                    for (product, level) in products.iter_mut().zip(&line[first..]) {
                        *product += weight * level;
                    }
                }
                for ((sum, square), levels) in
                    sums.iter_mut().zip(&mut squares).zip(line.windows(SIDE))
                {
                    *sum += levels.iter().sum::<f32>();
                    *square += levels.iter().map(|level| level * level).sum::<f32>();
                }
            }
            for ((right, product), (sum, square)) in
                rights.clone().zip(&products).zip(sums.iter().zip(&squares))
            {
                let [product, sum, square] = [product, sum, square].map(|sum| f64::from(*sum));
                let spread = (n * square - sum * sum) * (n * squares_of - sum_of * sum_of);
                let like = (n * product - sum_of * sum) / spread.sqrt();
                likenesses.push(([right, down], if like.is_finite() { like } else { 0.0 }));
            }
        }
        likenesses
    }
}

/// Returns the best offset to a fraction of a pixel; `None` if it is poor, or at the border of the search range.
fn best(likenesses: &[([i32; 2], f64)]) -> Option<[f64; 2]> {
    let best = likenesses.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let ([right, down], like) = *best;
    if like < FOUND {
        return None;
    }
    let at = |offset: [i32; 2]| likenesses.iter().find(|(at, _)| *at == offset);
    // The parabola through three values peaks near the middle one.
    let top = |before: [i32; 2], after: [i32; 2]| {
        let (before, after) = (at(before)?.1, at(after)?.1);
        let bend = before - 2.0 * like + after;
        Some(if bend < 0.0 {
            (before - after) / (2.0 * bend)
        } else {
            0.0
        })
    };
    Some([
        f64::from(right) + top([right - 1, down], [right + 1, down])?,
        f64::from(down) + top([right, down - 1], [right, down + 1])?,
    ])
}

//! Corners between pixels: where the edges around a corner meet (Förstner and Gülch 1987).
//!
//! In: a grey picture, corners to a pixel. Out: the same corners to a fraction of a pixel. At the point sought, the
//! gradient of each pixel nearby is perpendicular to the line from there. Its least squares solution is found again
//! around each result, as in OpenCV's `cornerSubPix`.

use crate::VisionError;
use image::GrayImage;

/// The most repetitions.
const MOST: usize = 30;
/// A move of no more than this ends the search, pixels.
const ENOUGH_PX: f64 = 0.01;

/// Moves corners `[x, y]` to where the edges around them meet.
///
/// - `half_px`: half the side of the square searched around each corner, without its middle.
///
/// A corner that would leave this square, or whose surroundings determine no point, stays where it was.
pub fn refine_corners(
    picture: &GrayImage,
    corners: &[[f32; 2]],
    half_px: u32,
) -> Result<Vec<[f32; 2]>, VisionError> {
    let weights = weights(half_px as i32);
    let mut patch = Patch::new(half_px as usize);
    Ok(corners
        .iter()
        .map(|&start| refined(picture, start, half_px as i32, &weights, &mut patch))
        .collect())
}

fn refined(
    picture: &GrayImage,
    start: [f32; 2],
    half: i32,
    weights: &[f32],
    patch: &mut Patch,
) -> [f32; 2] {
    let mut at = start;
    for _ in 0..MOST {
        patch.read(picture, at);
        let Some([right, down]) = offset(patch, half, weights) else {
            break;
        };
        let next = [
            (f64::from(at[0]) + right) as f32,
            (f64::from(at[1]) + down) as f32,
        ];
        let moved = [0, 1].map(|axis| f64::from(next[axis] - at[axis]));
        at = next;
        let is_outside = |value: f32, side: u32| !(0.0..side as f32).contains(&value);
        if is_outside(at[0], picture.width())
            || is_outside(at[1], picture.height())
            || moved[0] * moved[0] + moved[1] * moved[1] <= ENOUGH_PX * ENOUGH_PX
        {
            break;
        }
    }
    let is_near = |axis: usize| (at[axis] - start[axis]).abs() <= half as f32;
    if is_near(0) && is_near(1) { at } else { start }
}

/// Returns how far the point that fits best lies from the patch's middle; `None` if all gradients are parallel.
fn offset(patch: &Patch, half: i32, weights: &[f32]) -> Option<[f64; 2]> {
    let (mut xx, mut xy, mut yy) = (0.0_f64, 0.0, 0.0);
    let (mut along_x, mut along_y) = (0.0_f64, 0.0);
    let mut weights = weights.iter();
    for (row, y) in (1..).zip(-half..=half) {
        for (column, x) in (1..).zip(-half..=half) {
            let weight = f64::from(*weights.next()?);
            let level = |column: usize, row: usize| patch.levels[row * patch.side + column];
            let right = f64::from(level(column + 1, row) - level(column - 1, row));
            let down = f64::from(level(column, row + 1) - level(column, row - 1));
            let (gxx, gxy, gyy) = (
                right * right * weight,
                right * down * weight,
                down * down * weight,
            );
            (xx, xy, yy) = (xx + gxx, xy + gxy, yy + gyy);
            let (x, y) = (f64::from(x), f64::from(y));
            along_x += gxx * x + gxy * y;
            along_y += gxy * x + gyy * y;
        }
    }
    let determinant = xx * yy - xy * xy;
    if determinant.abs() <= f64::EPSILON * f64::EPSILON {
        return None;
    }
    let scale = 1.0 / determinant;
    Some([
        yy * scale * along_x - xy * scale * along_y,
        xx * scale * along_y - xy * scale * along_x,
    ])
}

/// The levels around a point, between pixels; the picture's outermost pixels continue beyond its edge.
struct Patch {
    /// Pixels, one more on each side than the square searched, for its gradients.
    side: usize,
    /// Row by row.
    levels: Vec<f32>,
}

impl Patch {
    fn new(half: usize) -> Patch {
        let side = 2 * half + 3;
        Patch {
            side,
            levels: vec![0.0; side * side],
        }
    }

    fn read(&mut self, picture: &GrayImage, [x, y]: [f32; 2]) {
        let half = (self.side - 1) as f32 * 0.5;
        let (left, top) = (x - half, y - half);
        let first = [left.floor() as i64, top.floor() as i64];
        let share = [left - left.floor(), top - top.floor()];
        let size = [picture.width(), picture.height()].map(i64::from);
        if (0..2).all(|axis| first[axis] >= 0 && first[axis] + (self.side as i64) < size[axis]) {
            self.read_inside(picture, first.map(|at| at as usize), share);
        } else {
            self.read_at_edge(picture, first, share);
        }
    }

    /// Goes along each row with one product for two pixels: what a column adds to the pixel on its left, it adds to the
    /// next one in a constant ratio. The rounding differs from that at the edge, and is OpenCV's.
    fn read_inside(&mut self, picture: &GrayImage, first: [usize; 2], [right, down]: [f32; 2]) {
        // The ratio must be finite.
        let right = right.max(0.0001);
        let (upper, lower) = (right * (1.0 - down), right * down);
        let ratio = (1.0 - f64::from(right)) / f64::from(right);
        let width = picture.width() as usize;
        let levels = picture.as_raw();
        let side = self.side;
        for (row, cells) in (first[1]..).zip(self.levels.chunks_exact_mut(side)) {
            let begin = row * width + first[0];
            let above = &levels[begin..=begin + side];
            let below = &levels[begin + width..=begin + width + side];
            let column = |at: usize| (f32::from(above[at]), f32::from(below[at]));
            let (a, b) = column(0);
            let mut from_left = (1.0 - right) * ((1.0 - down) * a + down * b);
            for (at, cell) in (1..).zip(cells) {
                let (a, b) = column(at);
                let from_right = upper * a + lower * b;
                *cell = from_left + from_right;
                from_left = (f64::from(from_right) * ratio) as f32;
            }
        }
    }

    /// Repeats the picture's outermost pixels beyond its edge.
    fn read_at_edge(&mut self, picture: &GrayImage, first: [i64; 2], [right, down]: [f32; 2]) {
        let last = [picture.width(), picture.height()].map(|side| i64::from(side) - 1);
        let level = |column: i64, row: i64| {
            let (column, row) = (column.clamp(0, last[0]), row.clamp(0, last[1]));
            f32::from(picture.get_pixel(column as u32, row as u32).0[0])
        };
        let shares = [
            (1.0 - right) * (1.0 - down),
            right * (1.0 - down),
            (1.0 - right) * down,
            right * down,
        ];
        for (row, cells) in (first[1]..).zip(self.levels.chunks_exact_mut(self.side)) {
            for (column, cell) in (first[0]..).zip(cells) {
                *cell = if (0..last[0]).contains(&column) {
                    level(column, row) * shares[0]
                        + level(column + 1, row) * shares[1]
                        + level(column, row + 1) * shares[2]
                        + level(column + 1, row + 1) * shares[3]
                } else {
                    level(column, row) * (1.0 - down) + level(column, row + 1) * down
                };
            }
        }
    }
}

/// Returns the weights of a square's pixels, row by row: a bell that falls to 1/e at the middle of each side.
fn weights(half: i32) -> Vec<f32> {
    let bell: Vec<f32> = (-half..=half)
        .map(|at| {
            let share = at as f32 / half.max(1) as f32;
            exp_of_minus(share * share)
        })
        .collect();
    let rows = bell.iter();
    rows.flat_map(|down| bell.iter().map(move |across| down * across))
        .collect()
}

/// Returns e to the power of `-x` for `0 <= x <= 1`, with the same bits everywhere, which the system's function has not.
fn exp_of_minus(x: f32) -> f32 {
    let x = f64::from(x);
    // Horner's form of the series; the next term is below 1e-17.
    (1..=18)
        .rev()
        .fold(1.0_f64, |sum, n| 1.0 - x / f64::from(n) * sum) as f32
}

//! Places of a picture that can be found again in another of the same view.
//!
//! In: grey pictures. Out: marks, which are corners whose surroundings look like nothing else nearby, and where each is
//! in the other picture, to a fraction of a pixel. Brightness and contrast do not matter: patches are compared by their
//! normalised correlation. What a common motion of them means is left to the caller.

use image::GrayImage;

/// Half the side of a patch, pixels, without its middle: 21 x 21 in all, which still looks the same turned by 3 degrees.
const HALF: i64 = 10;
/// How far a patch is sought, pixels in each direction.
pub(crate) const REACH: i64 = 32;
/// A part of the picture this large gives at most `PER_CELL` marks, so that one textured corner does not hold all.
const CELL_PX: i64 = 64;
/// The most marks of a cell.
const PER_CELL: usize = 3;
/// The least strength of a mark: the square of what grey levels change by in the weaker direction, mean over its pixels.
/// Noise of 2 levels, as cameras have, comes to 2.
const LEAST_STRENGTH: f64 = 4.0;
/// A patch that correlates so well with another place nearby is no mark.
const ALIKE: f64 = 0.75;
/// A patch that correlates less with its best place is not found.
const FOUND: f64 = 0.75;

/// Where a mark is in another picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The mark, `[column, row]`, middle of its pixel.
    pub at_px: [f64; 2],
    /// How far from there it was found, `[right, down]`, pixels.
    pub moved_px: [f64; 2],
}

/// Finds marks, the strongest of each part of the picture; none in a picture without texture.
pub fn marks(picture: &GrayImage) -> Vec<[u32; 2]> {
    let grey = Grey::of(picture);
    let (width, height) = (grey.width, grey.height);
    let mut found = Vec::new();
    for top in (0..height).step_by(CELL_PX as usize) {
        for left in (0..width).step_by(CELL_PX as usize) {
            let mut strong: Vec<(f64, [i64; 2])> = Vec::new();
            // Every third pixel: a corner is wider than that, and the search does not need its very middle.
            for v in (top..(top + CELL_PX).min(height)).step_by(3) {
                for u in (left..(left + CELL_PX).min(width)).step_by(3) {
                    if grey.holds([u, v]) {
                        let strength = grey.strength([u, v]);
                        if strength >= LEAST_STRENGTH {
                            strong.push((strength, [u, v]));
                        }
                    }
                }
            }
            strong.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut kept: Vec<[i64; 2]> = Vec::new();
            // Candidates that are no marks, such as those of a checkered cloth, cost a search each.
            for (_, at) in strong.into_iter().take(20) {
                let is_apart = |other: &[i64; 2]| {
                    (other[0] - at[0]).abs().max((other[1] - at[1]).abs()) > HALF
                };
                if kept.len() < PER_CELL && kept.iter().all(is_apart) && grey.is_alone(at) {
                    kept.push(at);
                }
            }
            found.extend(kept.into_iter().map(|[u, v]| [u as u32, v as u32]));
        }
    }
    found
}

/// Seeks each mark of one picture in another of the same size; leaves out those that are not found.
///
/// `marks` are those that [`marks`] found in `reference`. A mark is sought up to 32 pixels from where it was.
pub fn find_again(reference: &GrayImage, marks: &[[u32; 2]], other: &GrayImage) -> Vec<Found> {
    if reference.dimensions() != other.dimensions() {
        return Vec::new();
    }
    let (reference, other) = (Grey::of(reference), Grey::of(other));
    let mut found = Vec::new();
    for &[u, v] in marks {
        let at = [i64::from(u), i64::from(v)];
        let patch = reference.holds(at).then(|| reference.patch(at)).flatten();
        if let Some(moved_px) = patch.and_then(|patch| other.seek(&patch, at)) {
            found.push(Found {
                at_px: at.map(|coordinate| coordinate as f64 + 0.5),
                moved_px,
            });
        }
    }
    found
}

/// A picture as numbers, with running sums of them and of their squares.
struct Grey {
    width: i64,
    height: i64,
    levels: Vec<f32>,
    sums: Vec<[f64; 2]>,
}

/// A patch less its mean, and the root of the sum of its squares.
struct Patch {
    levels: Vec<f32>,
    norm: f64,
}

const SIDE: i64 = 2 * HALF + 1;

impl Grey {
    fn of(picture: &GrayImage) -> Grey {
        let (width, height) = (i64::from(picture.width()), i64::from(picture.height()));
        let levels: Vec<f32> = picture
            .pixels()
            .map(|pixel| f32::from(pixel.0[0]))
            .collect();
        let row = (width + 1) as usize;
        let mut sums = vec![[0.0; 2]; row * (height + 1) as usize];
        for v in 0..height as usize {
            let mut along = [0.0; 2];
            for u in 0..width as usize {
                let level = f64::from(levels[v * width as usize + u]);
                along = [along[0] + level, along[1] + level * level];
                let above = sums[v * row + u + 1];
                sums[(v + 1) * row + u + 1] = [above[0] + along[0], above[1] + along[1]];
            }
        }
        Grey {
            width,
            height,
            levels,
            sums,
        }
    }

    /// Returns whether the patch about a pixel lies in the picture.
    fn holds(&self, [u, v]: [i64; 2]) -> bool {
        u >= HALF && v >= HALF && u + HALF < self.width && v + HALF < self.height
    }

    fn level(&self, u: i64, v: i64) -> f32 {
        self.levels[(v * self.width + u) as usize]
    }

    /// Returns the smaller eigenvalue of the patch's structure tensor, per pixel (Shi, Tomasi 1994).
    fn strength(&self, [u, v]: [i64; 2]) -> f64 {
        let (mut xx, mut xy, mut yy) = (0.0_f64, 0.0, 0.0);
        for row in v - HALF + 1..v + HALF {
            for column in u - HALF + 1..u + HALF {
                let x = f64::from(self.level(column + 1, row) - self.level(column - 1, row)) / 2.0;
                let y = f64::from(self.level(column, row + 1) - self.level(column, row - 1)) / 2.0;
                (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            }
        }
        let n = ((SIDE - 2) * (SIDE - 2)) as f64;
        let (mean, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        (mean - half.hypot(xy)) / n
    }

    /// Returns a patch; `None` where it has but one level.
    fn patch(&self, [u, v]: [i64; 2]) -> Option<Patch> {
        let rows = v - HALF..=v + HALF;
        let levels: Vec<f32> = rows
            .flat_map(|row| (u - HALF..=u + HALF).map(move |column| (column, row)))
            .map(|(column, row)| self.level(column, row))
            .collect();
        let mean = levels.iter().sum::<f32>() / levels.len() as f32;
        let levels: Vec<f32> = levels.into_iter().map(|level| level - mean).collect();
        let norm = levels
            .iter()
            .map(|level| f64::from(level * level))
            .sum::<f64>()
            .sqrt();
        (norm > 1.0).then_some(Patch { levels, norm })
    }

    /// Returns the normalised correlation of a patch with the one about a pixel, -1 to 1.
    fn likeness(&self, patch: &Patch, [u, v]: [i64; 2]) -> f64 {
        let mut product = 0.0_f64;
        for (line, row) in patch.levels.chunks_exact(SIDE as usize).zip(v - HALF..) {
            let start = (row * self.width + u - HALF) as usize;
            let theirs = &self.levels[start..start + SIDE as usize];
            let along: f32 = line.iter().zip(theirs).map(|(a, b)| a * b).sum();
            product += f64::from(along);
        }
        let row = self.width + 1;
        let sum = |u: i64, v: i64| self.sums[(v * row + u) as usize];
        let [left, top, right, bottom] = [u - HALF, v - HALF, u + HALF + 1, v + HALF + 1];
        let of = |which: usize| {
            sum(right, bottom)[which] - sum(left, bottom)[which] - sum(right, top)[which]
                + sum(left, top)[which]
        };
        let n = (SIDE * SIDE) as f64;
        let norm = (of(1) - of(0) * of(0) / n).max(0.0).sqrt();
        match norm > 1.0 {
            true => product / (patch.norm * norm),
            false => 0.0,
        }
    }

    /// Returns whether the patch about a pixel looks like none that is sought together with it.
    fn is_alone(&self, at: [i64; 2]) -> bool {
        let Some(patch) = self.patch(at) else {
            return false;
        };
        let offsets = || (-REACH..=REACH).step_by(2);
        let mut others = offsets().flat_map(|down| offsets().map(move |right| [right, down]));
        others.all(|[right, down]| {
            let there = [at[0] + right, at[1] + down];
            let is_itself = right.abs().max(down.abs()) < HALF / 2 + 2;
            is_itself || !self.holds(there) || self.likeness(&patch, there) < ALIKE
        })
    }

    /// Returns how far from a pixel a patch is found; `None` where it is not, or at the rim of what is searched.
    fn seek(&self, patch: &Patch, at: [i64; 2]) -> Option<[f64; 2]> {
        let likeness = |right: i64, down: i64| {
            let there = [at[0] + right, at[1] + down];
            self.holds(there).then(|| self.likeness(patch, there))
        };
        let mut best = (f64::NEG_INFINITY, [0, 0]);
        for down in -REACH..=REACH {
            for right in -REACH..=REACH {
                if let Some(like) = likeness(right, down)
                    && like > best.0
                {
                    best = (like, [right, down]);
                }
            }
        }
        let (like, [right, down]) = best;
        if like < FOUND {
            return None;
        }
        // The parabola through three values has its top beside the middle one.
        let top = |before: f64, after: f64| {
            let bend = before - 2.0 * like + after;
            if bend < 0.0 {
                (before - after) / (2.0 * bend)
            } else {
                0.0
            }
        };
        Some([
            right as f64 + top(likeness(right - 1, down)?, likeness(right + 1, down)?),
            down as f64 + top(likeness(right, down - 1)?, likeness(right, down + 1)?),
        ])
    }
}

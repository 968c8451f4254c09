//! Analyses single pictures: the cloth's outline, and the pose of the flat cloth.
//!
//! In: pictures. Out: [`Outline`]s, normalised: the cloth's sides along the picture's, its middle in the middle, and
//! the picture as large as those of worlds here.

use super::{COMPARED_PX, NamedPicture};
use crate::error::RunError;
use crate::result::silhouette;
use crate::subgoals::ArrowPx;
use fab_picture::{Mask, SubpixelPoint};

/// Least area of the cloth, as a share of the picture.
const LEAST_CLOTH: f64 = 0.003;

/// Least side of the flat cloth, as a share of the picture's.
const LEAST_SIDE: f64 = 0.125;

fn no_cloth(name: &str) -> RunError {
    RunError::Failed(format!(
        "no whole cloth is seen on `{name}`; the picture must show a plain, evenly lit table all round the cloth, in a colour \
         unlike the cloth's, and the cloth must fill at least an eighth of its side"
    ))
}

/// Finds the cloth in a square picture, in its own pixels; fails if there is none.
pub fn cloth_of(NamedPicture { name, picture }: &NamedPicture) -> Result<Mask, RunError> {
    let cloth = silhouette(picture);
    let all_px = f64::from(picture.width()) * f64::from(picture.height());
    if (cloth.area_px() as f64) < LEAST_CLOTH * all_px {
        return Err(no_cloth(name));
    }
    Ok(cloth)
}

/// The pose of the flat cloth.
pub struct Pose {
    center: [f64; 2],
    /// Unit vector along the side closest to the picture's right, `[column, row]`.
    right: [f64; 2],
    /// The angle of that vector, clockwise as seen in the picture, radians.
    pub turned_rad: f64,
    /// Lengths of the sides along that vector and across it, pixels.
    pub sides_px: [f64; 2],
    /// Picture pixels per compared pixel.
    scale: f64,
}

impl Pose {
    /// Measures the flat cloth by its bounding rectangle.
    pub fn of(flat: &Mask, name: &str) -> Result<Pose, RunError> {
        let side_px = f64::from(flat.width());
        let rectangle = fab_vision::rectangle_around(flat)?;
        let rectangle = rectangle.ok_or_else(|| no_cloth(name))?;
        let [x, y] = rectangle.along;
        let [long, short] = rectangle.sides;
        // Of the four directions along a side, the one closest to the picture's right.
        let (right, sides_px) = if x.abs() >= y.abs() {
            ([x, y].map(|part| part * x.signum()), [long, short])
        } else {
            ([-y, x].map(|part| part * -y.signum()), [short, long])
        };
        let is_small = sides_px.iter().any(|side| *side < LEAST_SIDE * side_px);
        if is_small || !flat.reached_borders().is_empty() {
            return Err(no_cloth(name));
        }
        Ok(Pose {
            center: rectangle.center,
            right,
            turned_rad: right[1].atan2(right[0]),
            sides_px,
            scale: side_px / f64::from(COMPARED_PX),
        })
    }

    /// Maps a point of the straightened picture to the original pictures.
    pub fn as_shown(&self, at: [f64; 2]) -> [f64; 2] {
        let middle = f64::from(COMPARED_PX) / 2.0;
        let [along, across] = at.map(|at| (at - middle) * self.scale);
        let [x, y] = self.right;
        [
            self.center[0] + along * x - across * y,
            self.center[1] + along * y + across * x,
        ]
    }

    /// Returns a picture's outline with the flat cloth straightened and centred.
    pub fn straight(&self, shown: &Mask) -> Outline {
        Outline::of(|at| shown.contains(SubpixelPoint::at(self.as_shown(at)).pixel))
    }
}

/// The cloth's outline in a straightened picture, `COMPARED_PX` a side.
pub struct Outline(pub Mask);

impl Outline {
    /// Collects the pixels whose middles, `[column, row]`, are cloth.
    fn of(is_cloth: impl Fn([f64; 2]) -> bool) -> Outline {
        Outline(Mask::from_fn(COMPARED_PX, COMPARED_PX, |column, row| {
            is_cloth([column, row].map(|at| f64::from(at) + 0.5))
        }))
    }

    fn contains(&self, at: [f64; 2]) -> bool {
        self.0.contains(SubpixelPoint::at(at).pixel)
    }

    /// Returns intersection over union; 0 if either is empty.
    pub fn overlap(&self, other: &Outline) -> f64 {
        let here = self.0.pixels().map(|at| (true, other.0.contains(at)));
        let only_there = other.0.pixels().filter(|at| !self.0.contains(*at));
        fab_picture::overlap(here.chain(only_there.map(|_| (false, true))))
    }

    /// Returns the pixels that are cloth here but not in `other`.
    pub fn without(&self, other: &Outline) -> Outline {
        Outline::of(|at| self.contains(at) && !other.contains(at))
    }

    /// Returns the outline of stiff paper folded so that the arrow's tail lands on its tip.
    pub fn folded(&self, [tail, tip]: ArrowPx) -> Outline {
        let way = [tip[0] - tail[0], tip[1] - tail[1]];
        let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
        let way = way.map(|part| part / length);
        Outline::of(|at| {
            let beyond = (0..2)
                .map(|axis| (at[axis] - (tail[axis] + tip[axis]) / 2.0) * way[axis])
                .sum::<f64>();
            let mirrored = [0, 1].map(|axis| at[axis] - 2.0 * beyond * way[axis]);
            beyond >= 0.0 && (self.contains(at) || self.contains(mirrored))
        })
    }

    /// Returns the distance from a point to the cloth, pixels.
    pub fn distance_px(&self, at: [f64; 2]) -> f64 {
        self.0.distance_px(SubpixelPoint::at(at).pixel)
    }
}

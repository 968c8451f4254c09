//! Analyses single pictures: the cloth's outline and an arrow; and the pose of the flat cloth.
//!
//! In: pictures. Out: [`Outline`]s, normalised: the cloth's sides along the picture's, its middle in the middle, and
//! the picture as large as those of worlds here.

use super::{COMPARED_PX, DraftError, NamedPicture};
use crate::result::silhouette;
use crate::subgoals::ArrowPx;
use fab_picture::arrow;
use fab_picture::camera::center_of;
use fab_picture::hull;
use fab_picture::{Mask, SubpixelPoint};
use fab_program::PixelPoint;

/// Least area of the cloth, as a share of the picture.
const LEAST_CLOTH: f64 = 0.003;

/// Least side of the flat cloth, as a share of the picture's.
const LEAST_SIDE: f64 = 0.125;

/// How far an arrow's end on the cloth may lie outside the visible cloth, pixels of a compared picture.
const ARROW_END_PX: f64 = 6.0;

/// What a picture shows, in its own pixels.
pub struct PictureParts {
    /// The cloth, without parts hidden by an arrow.
    cloth: Mask,
    /// An arrow and the pixels beside it, which may be cloth or table.
    hidden: Mask,
    /// The only arrow's tail and tip.
    pub arrow: Option<ArrowPx>,
    /// Whether the cloth reaches the picture's border.
    reaches_border: bool,
}

fn no_cloth(name: &str) -> DraftError {
    DraftError::Unfit(format!(
        "no cloth is seen on `{name}`; the picture must show a plain table all round the whole cloth, in a colour unlike \
         the cloth's"
    ))
}

impl PictureParts {
    /// Analyses a square picture.
    ///
    /// Fails if there is no cloth on it.
    pub fn of(NamedPicture { name, picture }: &NamedPicture) -> Result<PictureParts, DraftError> {
        let (width, height) = picture.dimensions();
        let scale = (f64::from(width) / 224.0).max(1.0);
        let found = arrow::find(&arrow::near_black(picture), scale).ok();
        let hidden = Mask::from_fn(width, height, |column, row| {
            let arrow = found.as_ref();
            arrow.is_some_and(|arrow| arrow.stroke.is_within(1, column, row))
        });
        let patch = silhouette(picture);
        let cloth = Mask::from_fn(width, height, |column, row| {
            patch.contains_at(column, row) && !hidden.contains_at(column, row)
        });
        let all_px = f64::from(width) * f64::from(height);
        if (cloth.area_px() as f64) < LEAST_CLOTH * all_px {
            return Err(no_cloth(name));
        }
        Ok(PictureParts {
            cloth,
            hidden,
            arrow: found.map(|arrow| [arrow.tail, arrow.tip]),
            reaches_border: !patch.reached_borders().is_empty(),
        })
    }

    /// Returns a convex cloth with the parts hidden by an arrow filled in; a ring at a corner reaches beyond it.
    ///
    /// An arrow along an edge hides all of it, and its ends tell where the edge is.
    fn without_gaps(&self) -> Mask {
        let scale = f64::from(self.cloth.width()) / f64::from(COMPARED_PX);
        let ends = self.arrow.into_iter().flatten().filter(|at| {
            self.cloth.distance_px(SubpixelPoint::at(*at).pixel) <= ARROW_END_PX * scale
        });
        let pixels: Vec<PixelPoint> = self.cloth.pixels().collect();
        let rows = pixels.chunk_by(|a, b| a.v == b.v);
        let rims = rows.flat_map(|row| [row[0], row[row.len() - 1]].map(center_of));
        let corners = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]];
        let square = |[u, v]: [f64; 2]| corners.map(|[right, down]| [u + right, v + down]);
        let hull = hull::around(rims.chain(ends).flat_map(square));
        Mask::from_fn(self.cloth.width(), self.cloth.height(), |column, row| {
            let pixel = PixelPoint::new(column as i32, row as i32);
            let is_gap = || self.hidden.contains(pixel) && hull::is_inside(&hull, center_of(pixel));
            self.cloth.contains(pixel) || is_gap()
        })
    }
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
    pub fn of(flat: &PictureParts, name: &str) -> Result<Pose, DraftError> {
        let side_px = f64::from(flat.cloth.width());
        let rectangle = fab_vision::rectangle_around(&flat.without_gaps())?;
        let rectangle = rectangle.ok_or_else(|| no_cloth(name))?;
        let [x, y] = rectangle.along;
        let [long, short] = rectangle.sides;
        // Of the four directions along a side, the one closest to the picture's right.
        let (right, sides_px) = if x.abs() >= y.abs() {
            ([x, y].map(|part| part * x.signum()), [long, short])
        } else {
            ([-y, x].map(|part| part * -y.signum()), [short, long])
        };
        if flat.reaches_border {
            return Err(DraftError::Unfit(format!(
                "the cloth on `{name}` reaches the picture's border, or its table is not plain; the table must have one \
                 colour, be evenly lit, and be visible all round the cloth"
            )));
        }
        if sides_px.iter().any(|side| *side < LEAST_SIDE * side_px) {
            let [width, height] = sides_px;
            return Err(DraftError::Unfit(format!(
                "the cloth on `{name}` measures {width:.0} x {height:.0} of {side_px} px; it must fill at least an eighth \
                 of the picture's side"
            )));
        }
        Ok(Pose {
            center: rectangle.center,
            right,
            turned_rad: right[1].atan2(right[0]),
            sides_px,
            scale: side_px / f64::from(COMPARED_PX),
        })
    }

    /// Maps a point of a picture to the straightened picture, both `[column, row]`, pixels.
    pub fn straighten(&self, at: [f64; 2]) -> [f64; 2] {
        let off = [at[0] - self.center[0], at[1] - self.center[1]];
        let [x, y] = self.right;
        let middle = f64::from(COMPARED_PX) / 2.0;
        [
            middle + (off[0] * x + off[1] * y) / self.scale,
            middle + (off[1] * x - off[0] * y) / self.scale,
        ]
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
    pub fn straight(&self, shown: &PictureParts) -> Outline {
        let straight = |mask: &Mask| {
            Mask::from_fn(COMPARED_PX, COMPARED_PX, |column, row| {
                let at = [column, row].map(|at| f64::from(at) + 0.5);
                mask.contains(SubpixelPoint::at(self.as_shown(at)).pixel)
            })
        };
        Outline {
            cloth: straight(&shown.cloth),
            hidden: straight(&shown.hidden),
        }
    }
}

/// The cloth's outline in a straightened picture, `COMPARED_PX` a side.
pub struct Outline {
    cloth: Mask,
    /// Pixels that may or may not be cloth.
    hidden: Mask,
}

impl Outline {
    /// Makes an outline without hidden parts.
    pub fn whole(cloth: Mask) -> Outline {
        let hidden = Mask::from_fn(cloth.width(), cloth.height(), |_, _| false);
        Outline { cloth, hidden }
    }

    /// Returns the number of cloth pixels, counting half of the hidden ones beside it.
    pub fn area(&self) -> usize {
        self.cloth.area_px() + self.hidden.area_px() / 2
    }

    /// Returns intersection over union, of the pixels visible in both; 0 if either is empty.
    pub fn overlap(&self, other: &Outline) -> f64 {
        let visible = Mask::from_fn(COMPARED_PX, COMPARED_PX, |column, row| {
            !self.hidden.contains_at(column, row) && !other.hidden.contains_at(column, row)
        });
        fab_picture::overlap(
            visible
                .pixels()
                .map(|at| (self.cloth.contains(at), other.cloth.contains(at))),
        )
    }

    /// Returns the pixels that are cloth here but not in `other`.
    pub fn without(&self, other: &Outline) -> Mask {
        Mask::from_fn(COMPARED_PX, COMPARED_PX, |column, row| {
            let here = self.cloth.contains_at(column, row) || self.hidden.contains_at(column, row);
            here && !other.cloth.contains_at(column, row) && !other.hidden.contains_at(column, row)
        })
    }

    /// Returns the outline of stiff paper folded so that the arrow's tail lands on its tip.
    pub fn folded(&self, [tail, tip]: [[f64; 2]; 2]) -> Outline {
        let way = [tip[0] - tail[0], tip[1] - tail[1]];
        let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
        let way = way.map(|part| part / length);
        let is_cloth = |at: [f64; 2]| {
            let pixel = SubpixelPoint::at(at).pixel;
            self.cloth.contains(pixel) || self.hidden.contains(pixel)
        };
        Outline::whole(Mask::from_fn(COMPARED_PX, COMPARED_PX, |column, row| {
            let at = [column, row].map(|at| f64::from(at) + 0.5);
            let beyond = (0..2)
                .map(|axis| (at[axis] - (tail[axis] + tip[axis]) / 2.0) * way[axis])
                .sum::<f64>();
            let mirrored = [0, 1].map(|axis| at[axis] - 2.0 * beyond * way[axis]);
            beyond >= 0.0 && (is_cloth(at) || is_cloth(mirrored))
        }))
    }

    /// Returns the distance from a point to the cloth, pixels.
    pub fn distance_px(&self, at: [f64; 2]) -> f64 {
        self.cloth.distance_px(SubpixelPoint::at(at).pixel)
    }
}

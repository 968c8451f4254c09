//! The features of a pull, from which its gain is estimated.
//!
//! In: a [`View`], and a corner with a direction to pull it in. Out: one number for each of [`NAMES`]. All are lengths
//! relative to the cloth's side, areas relative to the flat cloth, or shares, so neither the picture's size nor the
//! cloth's matters. All are invariant under mirroring the picture and quarter turns. A pull also carries the
//! [`window`] around its pick.

use super::view::{Counts, Face, Patches, View};
use super::window::{self, Window};
use fab_picture::hull::{self, Point};
use std::rc::Rc;

/// The names of the features, in order: of the whole cloth, the corner, the direction, the distance.
pub const NAMES: [&str; 22] = [
    "covered",             // area that shows cloth
    "hull",                // area of the convex outline
    "filled",              // share of it that shows cloth
    "lesser_face",         // area that shows the face that shows less
    "dark",                // how much light steep places lose, on average
    "rough",               // how much brightness differs between near places, on average
    "cloth_near",          // share of small circles around the corner that is cloth
    "one_sided",           // 0 where that is on all sides, up to 1
    "cloth_around",        // the same share of a large circle
    "from_center",         // from the middle of the upright box
    "from_middle",         // from the mean of the cloth's pixels
    "farthest_from_pick",  // point of the outline
    "patch",               // area of one face that hangs together with what is taken
    "own_near",            // share of the small circles that shows that face
    "own_behind",          // how far back it is seen
    "other_behind",        // share of what is behind that shows the other face
    "beyond",              // area of cloth farther on than the corner
    "ahead",               // how far there is cloth in the direction of the pull
    "beside",              // on the farther side of the two beside the pull
    "farthest_from_place", // point of the outline
    "widened",             // area by which the place widens the outline
    "length",              // of the pull
];

/// Radii of the small circles around a corner, and of the large one, in sides.
const NEAR: [f64; 3] = [0.045, 0.07, 0.1];
const AROUND: f64 = 0.18;

/// Number of points on each circle.
const N_DIRECTIONS: u32 = 64;

/// How far behind a pick to look for the cloth that it grasps, in sides.
const HOLD: [f64; 5] = [0.015, 0.025, 0.035, 0.05, 0.07];

/// How far behind a pick the cloth's width is measured, in sides.
const HELD_BACK: f64 = 0.06;

/// How far behind a pick another face may cover the grasped cloth, in sides.
const COVERING: f64 = 0.4;

/// Start, step and end of a line scan, in sides.
const FIRST: f64 = 0.04;
const STEP: f64 = 0.01;
const END: f64 = 1.5;

/// Distance from the rim, and between points, for comparing brightness, in sides.
const INNER: f64 = 0.025;
const APART: f64 = 0.014;

/// The features of the whole cloth.
pub struct Cloth<'a> {
    view: &'a View,
    patches: Patches,
    counts: Counts,
    /// Convex, pixels.
    hull: Vec<Point>,
    /// Of the hull, square pixels.
    hull_px: f64,
    /// Of the cloth's pixels.
    middle: Point,
    /// Of the box around it.
    pub center: Point,
    /// Of the flat cloth, pixels.
    side: f64,
    covered: f64,
    lesser_face: f64,
    dark: f64,
    rough: f64,
}

/// The features of a corner that do not depend on the direction.
pub struct Corner {
    at: Point,
    /// The share of the small circles around it that is cloth: a quarter at a corner of a flat square.
    pub cloth_near: f64,
    one_sided: f64,
    cloth_around: f64,
    /// The face that most of it shows.
    face: Face,
}

/// A corner with a direction to pull it in.
pub struct Pull<'c> {
    cloth: &'c Cloth<'c>,
    corner: &'c Corner,
    /// The picture around the pick, turned to the pull.
    pub window: Rc<Window>,
    /// The features that do not depend on the distance.
    fixed: [f64; NAMES.len() - 3],
}

impl<'a> Cloth<'a> {
    /// Measures the cloth; `center` in pixels, `side` of the flat cloth in pixels.
    pub fn new(view: &'a View, center: Point, side: f64) -> Cloth<'a> {
        let hull = hull::around(view.rim());
        let (middle, n_pixels) = view.middle();
        let n_under = view.cloth().filter(|(_, face)| *face == Face::Under);
        let n_under = n_under.count() as f64;
        let [dark, rough] = shading(view, side);
        Cloth {
            view,
            patches: view.patches(),
            counts: view.counts(),
            hull_px: area(&hull),
            hull,
            middle,
            center,
            side,
            covered: n_pixels / (side * side),
            lesser_face: n_under.min(n_pixels - n_under) / (side * side),
            dark,
            rough,
        }
    }

    /// Measures the surroundings of a corner, pixels.
    pub fn corner(&self, at: Point) -> Corner {
        let faces = [Face::Top, Face::Under];
        let [top, under] = faces.map(|face| self.around(at, &NEAR, |other| other == face));
        let near = self.around(at, &NEAR, |face| face != Face::Table);
        Corner {
            at,
            cloth_near: near.share,
            one_sided: near.one_sided,
            cloth_around: self.around(at, &[AROUND], |face| face != Face::Table).share,
            face: match top.share >= under.share {
                true => Face::Top,
                false => Face::Under,
            },
        }
    }

    /// Measures how much of the circles around a point satisfies a condition; radii in sides.
    fn around(&self, at: Point, radii: &[f64], is_it: impl Fn(Face) -> bool) -> Distribution {
        let (mut seen, mut sum) = (0.0_f64, [0.0_f64; 2]);
        for (angle, radius) in circles(radii) {
            if is_it(self.view.at(self.beside(at, angle, radius))) {
                seen += 1.0;
                sum = [sum[0] + angle.cos(), sum[1] + angle.sin()];
            }
        }
        Distribution {
            share: seen / f64::from(N_DIRECTIONS) / radii.len() as f64,
            one_sided: sum[0].hypot(sum[1]) / seen.max(1.0),
        }
    }

    /// Returns by how much a point outside the outline enlarges it, as a share of the flat cloth.
    fn widened(&self, to: Point) -> f64 {
        let with = hull::around(self.hull.iter().copied().chain([to]));
        (area(&with) - self.hull_px) / (self.side * self.side)
    }

    /// Measures a corner with a direction; `angle` in radians, clockwise from the picture's right.
    pub fn measure<'c>(&'c self, corner: &'c Corner, angle: f64) -> Pull<'c> {
        let from = corner.at;
        let square = self.side * self.side;
        let back = self.beside(from, angle, -HELD_BACK);
        let quarter = std::f64::consts::FRAC_PI_2;
        let [left, right] =
            [angle - quarter, angle + quarter].map(|angle| self.cloth_along(back, angle));
        let (hold, own) = self.held(corner, angle);
        let [own_behind, other_behind] = self.behind(from, angle, own);
        let fixed = [
            self.covered,
            self.hull_px / square,
            self.covered * square / self.hull_px.max(1.0),
            self.lesser_face,
            self.dark,
            self.rough,
            corner.cloth_near,
            corner.one_sided,
            corner.cloth_around,
            hull::distance(from, self.center) / self.side,
            hull::distance(from, self.middle) / self.side,
            self.farthest(from),
            f64::from(self.view.patch_px(&self.patches, hold)) / square,
            self.around(from, &NEAR, |face| face == own).share,
            own_behind,
            other_behind,
            self.counts.beyond_px(from, angle) / square,
            self.cloth_along(from, angle),
            left.max(right),
        ];
        Pull {
            cloth: self,
            corner,
            window: Rc::new(window::around(self.view, from, angle, self.side, own)),
            fixed,
        }
    }

    /// Returns the distance of the outline's farthest point, in sides.
    fn farthest(&self, from: Point) -> f64 {
        let distances = self.hull.iter().map(|&point| hull::distance(point, from));
        distances.fold(0.0, f64::max) / self.side
    }

    /// Returns a visible point of the grasped cloth, and its face; little of it is visible if the layer only peeks out.
    fn held(&self, corner: &Corner, angle: f64) -> (Point, Face) {
        let behind = HOLD.map(|distance| self.beside(corner.at, angle, -distance));
        let seen = behind.into_iter().map(|point| (point, self.view.at(point)));
        let mut cloth = seen.filter(|(_, face)| *face != Face::Table);
        cloth.next().unwrap_or((corner.at, corner.face))
    }

    /// Returns how far back the grasped cloth shows its face, in sides, at least [`FIRST`], and how much of the area
    /// behind shows the other face.
    fn behind(&self, from: Point, angle: f64, own: Face) -> [f64; 2] {
        let at = |distance: f64| self.view.at(self.beside(from, angle, -distance));
        let mut distance = FIRST;
        while distance < END && at(distance) == own {
            distance += STEP;
        }
        let steps = (COVERING / STEP) as u32;
        let seen = (1..=steps).map(|step| at(f64::from(step) * STEP));
        let other = seen.filter(|&face| face != own && face != Face::Table);
        [distance, other.count() as f64 / f64::from(steps)]
    }

    /// Returns how far there is cloth along a line, in sides; [`FIRST`] if there is none.
    fn cloth_along(&self, from: Point, angle: f64) -> f64 {
        let mut distance = FIRST;
        while distance < END && self.view.at(self.beside(from, angle, distance)) != Face::Table {
            distance += STEP;
        }
        distance
    }

    /// Returns a point at a distance, in sides.
    fn beside(&self, from: Point, angle: f64, distance: f64) -> Point {
        let (sin, cos) = angle.sin_cos();
        [
            from[0] + distance * self.side * cos,
            from[1] + distance * self.side * sin,
        ]
    }
}

impl Pull<'_> {
    /// Returns the features of a pull to a place, in the order of [`NAMES`].
    pub fn features(&self, to: Point) -> [f64; NAMES.len()] {
        let length = hull::distance(self.corner.at, to) / self.cloth.side;
        let of_place = [self.cloth.farthest(to), self.cloth.widened(to), length];
        let mut fixed = self.fixed.iter().chain(&of_place);
        std::array::from_fn(|_| *fixed.next().expect("there are as many numbers as names"))
    }
}

/// How a property is distributed around a point.
struct Distribution {
    /// Its share of the circles.
    share: f64,
    /// 0 if it is on all sides, up to 1.
    one_sided: f64,
}

/// Returns the cloth's mean darkness and mean variation of brightness over its inner pixels; 0 if none are visible.
fn shading(view: &View, side: f64) -> [f64; 2] {
    const DIRECTIONS: [Point; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let (mut sums, mut count) = ([0.0; 2], 0.0_f64);
    for (at, _) in view.cloth() {
        let beside = |[right, down]: Point, distance: f64| {
            view.light([
                at[0] + right * distance * side,
                at[1] + down * distance * side,
            ])
        };
        let is_inner = DIRECTIONS
            .into_iter()
            .all(|direction| beside(direction, INNER).is_some());
        let near = DIRECTIONS.map(|direction| beside(direction, APART));
        if let (true, Some(here), [Some(a), Some(b), Some(c), Some(d)]) =
            (is_inner, view.light(at), near)
        {
            sums[0] += 1.0 - here;
            sums[1] += ((a - c).abs() + (b - d).abs()) / 2.0;
            count += 1.0;
        }
    }
    sums.map(|sum| sum / count.max(1.0))
}

/// Returns angles and radii of the circles' points.
fn circles(radii: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    (0..N_DIRECTIONS).flat_map(move |step| {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(N_DIRECTIONS);
        radii.iter().map(move |&radius| (angle, radius))
    })
}

fn area(hull: &[Point]) -> f64 {
    let next = hull.iter().cycle().skip(1);
    let twice: f64 = hull
        .iter()
        .zip(next)
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum();
    twice.abs() / 2.0
}

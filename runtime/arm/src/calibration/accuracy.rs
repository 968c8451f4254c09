//! The accuracy of a fit, and its comparison with what is stated of table and camera.
//!
//! In: a fit, its points, the terms. Out: the error of each point, and one [`Check`] per measured value. Their bounds
//! stand here, each with its reason.

use super::fault::Fault;
use super::fit::{Sighting, error, fit, height_at};
use super::{Terms, implied, plane};
use fab_picture::camera::{Lens, Plane};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

/// Factor by which left-out errors may be larger: they measure the uncertainty at places without a touched point.
const LEFT_OUT_SHARE: f64 = 5.0 / 3.0;
/// How much 1 mm of error in the points may become at a corner of what tasks see and the arm reaches, millimetres. A
/// grid of 4 x 4 over the middle 60 % of a window gives 1.5, over its middle half 2.2, and two rows 25 mm apart 15
/// (`tests/errors.rs`).
const MAX_GAIN: f64 = 2.0;
/// A hundred careful calibrations stay within 0.6 degrees and 1 % (`tests/refusals.rs`); stated focal lengths are
/// within about 1 %.
const MAX_SHEAR_DEG: f64 = 2.0;
/// See [`MAX_SHEAR_DEG`].
const MAX_STRETCH_PERCENT: f64 = 3.0;
/// A tape measures a metre to within 1 %, and a stated focal length is within 2 %.
const MAX_CAMERA_HEIGHT_PERCENT: f64 = 5.0;
/// A direction is stated with a ruler and a protractor on the table.
const MAX_UP_DEG: f64 = 5.0;
/// How far the window's middle may lie from the table's, millimetres: a window is placed to within a few pixels.
const MAX_MIDDLE_MM: f64 = 50.0;
/// How far the touched table may be from `table.center_m`, millimetres: 3 for the driver, and what careful touches
/// scatter by.
const MAX_HEIGHT_MM: f64 = 5.0;
/// How far a corner may be from the height of the table's middle, millimetres: fingers that close so far above a cloth
/// miss it.
const MAX_CORNER_MM: f64 = 10.0;

/// A measured value and its bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Its name in files and JSON.
    pub name: &'static str,
    /// The value, never negative.
    pub value: f64,
    /// The largest value accepted.
    pub bound: f64,
    /// What was measured, with the value.
    #[serde(skip)]
    pub text: String,
    /// What to do if it is too large.
    #[serde(skip)]
    pub next: String,
}

impl Check {
    /// Returns whether it compares the points with the settings, rather than with each other.
    pub fn is_comparison(&self) -> bool {
        !matches!(
            self.name,
            "rms_mm" | "left_out_mm" | "plane_gain" | "height_gain"
        )
    }

    /// Returns whether the value is within its bound; a value that is not a number is not.
    pub fn holds(&self) -> bool {
        self.value <= self.bound
    }
}

/// The area covered by points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Their extent along the narrowest strip of the table that contains them, metres.
    pub length_m: f64,
    /// Their extent across that strip, metres.
    pub width_m: f64,
    /// Error amplification in the plane, at the worst corner of what the window shows and the arm reaches; ratio of
    /// standard deviations.
    pub plane_gain: f64,
    /// Error amplification in height, at the worst such corner.
    pub height_gain: f64,
}

/// A corner of the part of the table that tasks see and the arm reaches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Corner {
    /// Its place by the fit, metres, base frame.
    pub at_m: [f64; 3],
    /// Its height above that of the table's stated middle, millimetres.
    pub above_mm: f64,
    /// The standard error of the fit there, in the plane, if points scatter by 1 mm or by `rms_mm`, whichever is more;
    /// millimetres.
    pub error_mm: f64,
}

/// The accuracy of a fit. Errors are distances in space between the tool and the fit's position for the pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// The error of each point, millimetres, in the order of the points.
    pub residual_mm: Vec<f64>,
    /// The error of each point under the fit of the others, millimetres.
    pub left_out_mm: Vec<f64>,
    /// Root mean square of the errors, millimetres.
    pub rms_mm: f64,
    /// Root mean square of the left-out errors, millimetres.
    pub left_out_rms_mm: f64,
    /// The area covered by the points, and how their errors propagate beyond it.
    pub spread: Spread,
    /// The residual at the table's corners, from the window's top left clockwise.
    pub corners: Vec<Corner>,
    /// Every value that has a bound.
    pub checks: Vec<Check>,
}

impl Accuracy {
    /// Returns the points, numbered from 1, that contradict the others although all together are accepted.
    ///
    /// The error of such a point exceeds `limit_mm` and three times that of the others.
    pub fn outliers(&self, limit_mm: f64) -> Vec<usize> {
        let others_rms = |out: usize| {
            let kept = self.left_out_mm.iter().enumerate();
            let kept: Vec<f64> = kept.filter(|it| it.0 != out).map(|it| *it.1).collect();
            root_mean_square(&kept)
        };
        let stands_out = |(index, error): &(usize, &f64)| {
            **error > limit_mm && **error > 3.0 * others_rms(*index)
        };
        let found = self.left_out_mm.iter().enumerate().filter(stands_out);
        found.map(|(index, _)| index + 1).collect()
    }
}

/// Measures a fit and compares it with the terms; fails if it depends on a single point, or shows no table.
pub(super) fn measure(
    terms: &Terms,
    lens: &Lens,
    made: &Plane,
    points: &[Sighting],
) -> Result<Accuracy, Fault> {
    let residual_mm = errors_mm(made, points).ok_or(Fault::Undetermined)?;
    let left_out_mm = left_out(lens, points)?;
    let (rms_mm, left_out_rms_mm) = (
        root_mean_square(&residual_mm),
        root_mean_square(&left_out_mm),
    );
    let corners = corners(terms, lens, made, points, rms_mm.max(1.0))?;
    let [length_m, width_m] = extent_m(points);
    let worst = |of: fn(&Gains) -> f64| {
        corners
            .iter()
            .map(|(_, gains)| of(gains))
            .fold(0.0, f64::max)
    };
    let spread = Spread {
        length_m,
        width_m,
        plane_gain: worst(|gains| gains.plane),
        height_gain: worst(|gains| gains.height),
    };
    let corners: Vec<Corner> = corners.into_iter().map(|(corner, _)| corner).collect();
    let mut accuracy = Accuracy {
        residual_mm,
        left_out_mm,
        rms_mm,
        left_out_rms_mm,
        spread,
        corners,
        checks: Vec::new(),
    };
    accuracy.checks = scatter(terms, &accuracy);
    accuracy
        .checks
        .extend(comparison(terms, lens, made, &accuracy)?);
    Ok(accuracy)
}

/// How well the points agree with each other and cover the table.
fn scatter(terms: &Terms, accuracy: &Accuracy) -> Vec<Check> {
    let Accuracy {
        rms_mm,
        left_out_rms_mm,
        spread,
        ..
    } = accuracy;
    let numbered = accuracy.left_out_mm.iter().copied().zip(1..);
    let worst = numbered.max_by(|a, b| a.0.total_cmp(&b.0));
    let (worst_mm, worst) = worst.unwrap_or_default();
    let anew = format!(
        "point {worst} is the worst, {worst_mm:.1} mm from where the others put it; touch it anew, or all with more care"
    );
    let covered = format!(
        "the points cover {:.0} x {:.0} mm",
        spread.length_m * 1000.0,
        spread.width_m * 1000.0
    );
    let wider = "touch a grid of 4 x 4 over all that tasks see, as `--grid 4x4` shows it";
    vec![
        Check {
            name: "rms_mm",
            value: *rms_mm,
            bound: terms.limit_mm,
            text: format!("the points fit to {rms_mm:.1} mm (root mean square)"),
            next: anew.clone(),
        },
        Check {
            name: "left_out_mm",
            value: *left_out_rms_mm,
            bound: terms.limit_mm * LEFT_OUT_SHARE,
            text: format!(
                "the points are {left_out_rms_mm:.1} mm from where the others put them (root mean square)"
            ),
            next: anew,
        },
        Check {
            name: "plane_gain",
            value: spread.plane_gain,
            bound: MAX_GAIN,
            text: format!(
                "{covered}, and 1 mm of error in them becomes {:.1} mm in the plane at a corner of the table",
                spread.plane_gain
            ),
            next: wider.to_owned(),
        },
        Check {
            name: "height_gain",
            value: spread.height_gain,
            bound: MAX_GAIN,
            text: format!(
                "{covered}, and 1 mm of error in them becomes {:.1} mm in height at a corner of the table",
                spread.height_gain
            ),
            next: wider.to_owned(),
        },
    ]
}

/// How a fit compares with the stated table and the stated camera.
fn comparison(
    terms: &Terms,
    lens: &Lens,
    made: &Plane,
    accuracy: &Accuracy,
) -> Result<Vec<Check>, Fault> {
    // What is not stated has been refused before; not a number would be refused again.
    let [height_m, up_deg] = [terms.height_m, terms.up_deg].map(|it| it.unwrap_or(f64::NAN));
    let implied = implied::camera(made, lens).ok_or(Fault::Undetermined)?;
    let shown = |share| {
        made.world_from_pixel(terms.window.pixel_at(share))
            .ok_or(Fault::Horizon)
    };
    let (middle, top, bottom) = (shown([0.5, 0.5])?, shown([0.5, 0.4])?, shown([0.5, 0.6])?);
    let found_up_deg = (top.y - bottom.y).atan2(top.x - bottom.x).to_degrees();
    let off_deg = (found_up_deg - up_deg + 180.0).rem_euclid(360.0) - 180.0;
    let [x, y, z] = terms.center_m;
    let middle_mm = (middle.x - x).hypot(middle.y - y) * 1000.0;
    let touched_m = height_at(&made.height, [x, y]);
    let higher = accuracy
        .corners
        .iter()
        .max_by(|a, b| a.above_mm.abs().total_cmp(&b.above_mm.abs()));
    let corner = higher.ok_or(Fault::Horizon)?;
    let share = implied.height_m / height_m;
    let fitting_px = lens.focal_px[0] / share;
    let places = "the pixels or the places of the points are wrong, or `camera.intrinsics`";
    Ok(vec![
        Check {
            name: "shear_deg",
            value: implied.shear_deg,
            bound: MAX_SHEAR_DEG,
            text: format!(
                "by the points and `camera.intrinsics`, the table is sheared by {:.1} degrees",
                implied.shear_deg
            ),
            next: places.to_owned(),
        },
        Check {
            name: "stretch_percent",
            value: (implied.stretch - 1.0) * 100.0,
            bound: MAX_STRETCH_PERCENT,
            text: format!(
                "by the points and `camera.intrinsics`, the table is stretched by {:.1} % along one direction",
                (implied.stretch - 1.0) * 100.0
            ),
            next: places.to_owned(),
        },
        Check {
            name: "camera_height_percent",
            value: (share - 1.0).abs() * 100.0,
            bound: MAX_CAMERA_HEIGHT_PERCENT,
            text: format!(
                "by the points the lens is {:.3} m above the table, {:.1} % from `camera.height_m`, which is {height_m}",
                implied.height_m,
                (share - 1.0).abs() * 100.0
            ),
            next: format!(
                "the pixels are of a picture of another size, the places of another unit, or `focal_px` (by the points {fitting_px:.0}) or the height is wrong"
            ),
        },
        Check {
            name: "up_deg",
            value: off_deg.abs(),
            bound: MAX_UP_DEG,
            text: format!(
                "by the points the picture's top lies at {found_up_deg:.1} degrees, {:.1} degrees from `camera.up_deg`, which is {up_deg}",
                off_deg.abs()
            ),
            next: "the points are in another frame than the arm's base, or the picture is turned"
                .to_owned(),
        },
        Check {
            name: "middle_mm",
            value: middle_mm,
            bound: MAX_MIDDLE_MM,
            text: format!(
                "by the points the window's middle shows {:.3}, {:.3}, {middle_mm:.0} mm from `table.center_m`",
                middle.x, middle.y
            ),
            next: "move the window until its middle shows the table's, or touch the points anew"
                .to_owned(),
        },
        Check {
            name: "height_mm",
            value: (touched_m - z).abs() * 1000.0,
            bound: MAX_HEIGHT_MM,
            text: format!(
                "at `table.center_m` the points put the table at {touched_m:.4} m, {:.1} mm from its height there",
                (touched_m - z).abs() * 1000.0
            ),
            next: "touch the table's middle, and state that height".to_owned(),
        },
        Check {
            name: "corner_mm",
            value: corner.above_mm.abs(),
            bound: MAX_CORNER_MM,
            text: format!(
                "at the corner {:.3}, {:.3} the points put the table {:.1} mm from the height in `table.center_m`",
                corner.at_m[0],
                corner.at_m[1],
                corner.above_mm.abs()
            ),
            next: "level the table, and touch each point with the fingertips on it".to_owned(),
        },
    ])
}

/// How the points' errors grow at a place: standard deviations there, divided by those of the points.
struct Gains {
    plane: f64,
    height: f64,
}

/// Returns the corners of what the window shows, drawn in to what the arm reaches.
fn corners(
    terms: &Terms,
    lens: &Lens,
    made: &Plane,
    points: &[Sighting],
    scatter_mm: f64,
) -> Result<Vec<(Corner, Gains)>, Fault> {
    let gain = plane::Gain::of(points).ok_or(Fault::Undetermined)?;
    let [least, most] = terms.reach_m;
    let corner = |share| {
        let shown = made
            .world_from_pixel(terms.window.pixel_at(share))
            .ok_or(Fault::Horizon)?;
        let [x, y] = [0, 1].map(|axis| shown[axis].max(least[axis]).min(most[axis]));
        let z = height_at(&made.height, [x, y]);
        let place = Point3::new(x, y, z);
        let pixel = made.pixel_from_world(place).ok_or(Fault::Horizon)?;
        let straight = lens.straightened(pixel).ok_or(Fault::Horizon)?;
        let plane = gain.in_plane(straight).ok_or(Fault::Horizon)?;
        let height = gain.in_height(place).ok_or(Fault::Undetermined)?;
        let corner = Corner {
            at_m: [x, y, z],
            above_mm: (z - terms.center_m[2]) * 1000.0,
            error_mm: plane * scatter_mm,
        };
        Ok((corner, Gains { plane, height }))
    };
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(corner)
        .into_iter()
        .collect()
}

/// Returns the error of each point, millimetres; `None` if the fit cannot locate one.
fn errors_mm(made: &Plane, points: &[Sighting]) -> Option<Vec<f64>> {
    let length = |point| Some(error(made, point)?.norm() * 1000.0);
    points.iter().map(length).collect()
}

/// Returns the error of each point under the fit of the others, millimetres.
pub(super) fn left_out(lens: &Lens, points: &[Sighting]) -> Result<Vec<f64>, Fault> {
    let length = |out: usize| {
        let others: Vec<Sighting> = points[..out]
            .iter()
            .chain(&points[out + 1..])
            .copied()
            .collect();
        Some(error(&fit(lens, &others)?, &points[out])?.norm() * 1000.0)
    };
    (0..points.len())
        .map(|out| length(out).ok_or(Fault::HangsOn { point: out + 1 }))
        .collect()
}

/// Returns the root mean square; 0 for no values.
pub(super) fn root_mean_square(errors: &[f64]) -> f64 {
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (squares / errors.len().max(1) as f64).sqrt()
}

/// Returns the extents of points on the table, metres: across the narrowest strip that contains them, and along it; the
/// longer first.
fn extent_m(points: &[Sighting]) -> [f64; 2] {
    let along = |turn_deg: f64| {
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        let places = points
            .iter()
            .map(|point| point.base.x * cos + point.base.y * sin);
        let ends = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), it| {
            (least.min(it), most.max(it))
        });
        (ends.1 - ends.0).max(0.0)
    };
    let turns = (0..180).map(f64::from);
    let sides = turns.map(|turn_deg| [along(turn_deg + 90.0), along(turn_deg)]);
    let narrowest = sides.min_by(|a, b| a[1].total_cmp(&b[1]));
    narrowest.unwrap_or_default()
}

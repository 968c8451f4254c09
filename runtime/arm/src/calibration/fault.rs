//! The faults of calibration points: one sentence each, with what would be right.
//!
//! In: the findings of the checks, and the limits they check against. Points are numbered from 1, in input order.

use super::{MIN_PAIRS, Method};

/// A fault in points, or in what is known about their camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A number that is not finite.
    #[error("point {point} has a number that is not finite")]
    NotFinite {
        /// Its number.
        point: usize,
    },
    /// The window does not lie in the picture.
    #[error(
        "the window `{left}, {top}, {side}` does not lie in the camera's picture of {} x {} px; its left and its side \
         come to {} at the most, its top and its side to {}", size_px[0], size_px[1], size_px[0], size_px[1]
    )]
    Window {
        /// Its left, pixels.
        left: u32,
        /// Its top, pixels.
        top: u32,
        /// Its side, pixels.
        side: u32,
        /// Width and height of the picture.
        size_px: [u32; 2],
    },
    /// A pixel outside the picture.
    #[error(
        "point {point} is at the pixel {}, {}, outside of the picture of {} x {} px{hint}",
        pixel[0], pixel[1], size_px[0], size_px[1]
    )]
    OutsidePicture {
        /// Its number.
        point: usize,
        /// Its pixel.
        pixel: [f64; 2],
        /// Width and height of the picture.
        size_px: [u32; 2],
        /// The likely correction; empty or `: …`.
        hint: String,
    },
    /// Positions that are not in metres.
    #[error(
        "point {point} is at {}, {}, {}, which no arm on a table reaches in metres; in {unit} it would: write metres \
         ({} of {n_all} points are so)", base[0], base[1], base[2], n_such
    )]
    Unit {
        /// The first such point's number.
        point: usize,
        /// Its position as given.
        base: [f64; 3],
        /// The likely unit.
        unit: &'static str,
        /// How many points have this fault.
        n_such: usize,
        /// Total number of points.
        n_all: usize,
    },
    /// A position that no arm reaches, in any unit.
    #[error("point {point} is at {}, {}, {}; an arm reaches about a metre, and positions are metres", base[0], base[1], base[2])]
    TooFar {
        /// Its number.
        point: usize,
        /// Its position as given.
        base: [f64; 3],
    },
    /// A depth that is not in metres.
    #[error(
        "point {point} has the depth {depth}; depths are metres, larger than 0 and at most {MAX_DEPTH_M}{hint}"
    )]
    Depth {
        /// Its number.
        point: usize,
        /// The depth as given.
        depth: f64,
        /// The likely correction; empty or `: …`.
        hint: &'static str,
    },
    /// Too few points.
    #[error(
        "{n} distinct points are too few: at least {MIN_PAIRS} are needed, because any four points fit exactly; \
         touch a grid of 4 x 4 over the table"
    )]
    TooFew {
        /// How many there are.
        n: usize,
    },
    /// The rigid method lacks depth.
    #[error(
        "the method `rigid` needs a depth at every point, and {} of {n_all} have none, starting with point {first}; \
         the method `plane` needs none",
        n_without
    )]
    NoDepth {
        /// The first point without a depth.
        first: usize,
        /// How many points have none.
        n_without: usize,
        /// Total number of points.
        n_all: usize,
    },
    /// The rigid method lacks intrinsics.
    #[error(
        "the method `rigid` needs the camera's intrinsics (`camera.intrinsics` in the settings); the method `plane` needs none"
    )]
    NoIntrinsics,
    /// Impossible intrinsics.
    #[error("the camera's intrinsics cannot be used: {why}")]
    Intrinsics {
        /// What is wrong.
        why: String,
    },
    /// Intrinsics for pictures of another size.
    #[error("the camera's intrinsics are for a picture of {} x {} px, and the picture has {} x {} px", stated[0], stated[1], size_px[0], size_px[1])]
    IntrinsicsSize {
        /// The size that the intrinsics state.
        stated: [u32; 2],
        /// The size of the picture.
        size_px: [u32; 2],
    },
    /// No ray leads to a pixel through the lens.
    #[error(
        "no ray leads through the lens to point {point}: the coefficients in `distortion` do not reach that far"
    )]
    NoRay {
        /// Its number.
        point: usize,
    },
    /// A picture of the wrong size.
    #[error("the picture has {} x {} px, and the camera's pictures {} x {} px", found[0], found[1], expected[0], expected[1])]
    PictureSize {
        /// Its size.
        found: [u32; 2],
        /// The expected size.
        expected: [u32; 2],
    },
    /// Points that do not determine a fit.
    #[error(
        "the points lie on a line, {length_mm:.0} mm long and {width_mm:.0} mm wide, or all but one do: spread them over the table, as a grid of 4 x 4"
    )]
    OnALine {
        /// Their extent along it, millimetres.
        length_mm: f64,
        /// Their extent across that line, millimetres.
        width_mm: f64,
    },
    /// A mirror image.
    #[error(
        "the points make the picture a mirror image of the table, which no camera above it sees: {hint}"
    )]
    Mirrored {
        /// The likely cause.
        hint: &'static str,
    },
    /// A point that contradicts the others.
    #[error(
        "point {point} is {off_mm:.1} mm off: the other points put its pixel at {:.4}, {:.4}, {:.4}, but it \
         was given as {:.4}, {:.4}, {:.4}; {hint}", shown_m[0], shown_m[1], shown_m[2], base_m[0], base_m[1], base_m[2]
    )]
    Mistake {
        /// Its number.
        point: usize,
        /// Its error, millimetres.
        off_mm: f64,
        /// The position of its pixel according to the others, metres, base frame.
        shown_m: [f64; 3],
        /// Its stated position.
        base_m: [f64; 3],
        /// The likely cause.
        hint: String,
    },
    /// Too large an error, without single points to blame.
    #[error(
        "the fit has a root mean square error of {rms_mm:.1} mm, and of {left_out_mm:.1} mm leaving each point out; \
         at most \
         {limit_mm} and {left_out_limit_mm:.1} mm are accepted{hint}; point {worst} is the worst, {worst_mm:.1} mm off"
    )]
    Inaccurate {
        /// Root mean square error, millimetres.
        rms_mm: f64,
        /// Root mean square of the left-out errors, millimetres.
        left_out_mm: f64,
        /// The limit of the first.
        limit_mm: f64,
        /// The limit of the second.
        left_out_limit_mm: f64,
        /// The point with the largest left-out error.
        worst: usize,
        /// That error, millimetres.
        worst_mm: f64,
        /// Another likely cause; empty or `, …`.
        hint: String,
    },
    /// The fit depends on a single point.
    #[error(
        "without point {point} the others do not determine a fit: touch more points, away from their line"
    )]
    HangsOn {
        /// Its number.
        point: usize,
    },
    /// The camera sees nothing that the arm reaches.
    #[error(
        "according to the points, the window shows x {:.2} to {:.2} and y {:.2} to {:.2} m, but the workspace is x \
         {:.2} to {:.2} and y {:.2} to {:.2} m: they do not overlap; is a sign missing, or is the window wrong?",
        shown_m[0][0], shown_m[1][0], shown_m[0][1], shown_m[1][1],
        reach_m[0][0], reach_m[1][0], reach_m[0][1], reach_m[1][1]
    )]
    OutOfReach {
        /// Least and largest x and y that the window shows.
        shown_m: [[f64; 2]; 2],
        /// Those of the workspace.
        reach_m: [[f64; 2]; 2],
    },
    /// Points that cover too small an area.
    #[error(
        "the points cover {length_mm:.0} x {width_mm:.0} mm, too little: 1 mm of error in them becomes {plane_gain:.1} \
         mm in the plane and {height_gain:.1} mm in height at the far corner of what the camera and the arm share, \
         where at most {MAX_GAIN} mm are accepted; touch points near its rim, as a grid of 4 x 4 over all of it"
    )]
    Spread {
        /// Their larger extent, millimetres.
        length_mm: f64,
        /// Their smaller extent, millimetres.
        width_mm: f64,
        /// Error amplification in the plane.
        plane_gain: f64,
        /// Error amplification in height.
        height_gain: f64,
    },
    /// A table that is not level.
    #[error(
        "according to the heights, the table is tilted by {tilt_deg:.1} degrees against the arm's base; at most \
         {MAX_TILT_DEG} are accepted: were the fingertips on the table at every point?"
    )]
    Tilted {
        /// The tilt, degrees.
        tilt_deg: f64,
    },
    /// Depth readings on a different scale than the arm.
    #[error("according to the depth readings the table is {scale:.3} times as large as according to the arm, and at \
     most {:.0} % are accepted: the depth or `focal_px` is wrong; the method `plane` needs neither", MAX_SCALE_OFF * 100.0)]
    Scale {
        /// Size according to depth, divided by size according to the arm.
        scale: f64,
    },
    /// An invalid limit.
    #[error("the limit is {limit_mm} mm; it must be larger than 0 and at most {MAX_LIMIT_MM}; the default is {} for \
     `plane` and {} for `rigid`", Method::Plane.limit_mm(), Method::Rigid.limit_mm())]
    Limit {
        /// The limit as given.
        limit_mm: f64,
    },
}

/// The largest plausible depth of a table below a camera, metres.
pub(super) const MAX_DEPTH_M: f64 = 10.0;
/// The largest tilt of a table, degrees: well above what remains after levelling it.
pub(super) const MAX_TILT_DEG: f64 = 3.0;
/// How far from 1 the scale of depth readings may be: the D435i's are within 2 % at 2 m (its data sheet).
pub(super) const MAX_SCALE_OFF: f64 = 0.03;
/// The largest limit that may be requested, millimetres: beyond it a fold's corner is missed.
pub(super) const MAX_LIMIT_MM: f64 = 20.0;
/// The largest permitted error amplification at the far corner of the reachable area.
///
/// By the plane, a grid of 4 x 4 over the middle 60 % of a window gives 1.5, one over its middle half 2.2, and two rows
/// 25 mm apart 15 (`tests/errors.rs`).
pub(super) const MAX_GAIN: f64 = 2.0;

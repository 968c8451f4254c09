//! The reach of a hand that points straight down.
//!
//! In: a point in the base frame, and heights above it that the hand must reach too. Out: joint angles at the point
//! from which the hand can go straight up; else the point's distance from the base, the range at that height, and why
//! the point is not reached. The built-in models' postures are enumerated (`tool_down`), and their last joint turns without
//! limit, so reach does not depend on the rotation of the hand. Postures of other arms are searched from many starts, those
//! near to the arm's home first; the range is the one in the direction in which the hand is at home.
//! Three conditions apply beyond the joint limits: the elbow stays above the point by more than a link's thickness,
//! because the table lies below the point; the hand stays off the base; and the path up is straight. Other collisions
//! are not checked.
//!
//! At the height of the base, the tool comes to within 0.18 m of the first axis and 0.70 m away from it (`j2n6s200`,
//! `j2n6s300`), or 0.16 m and 0.72 m (`j2s6s200`).

use super::chain::{Angles, Chain, Jacobian, nearest_turn};
use super::starts;
use super::tool_down::{ToolDown, tool_down};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// How far the elbow's axis stays above the point, metres: the radius of a large link, 0.044 (`large_ring` of
/// dm_control's `jaco_arm.xml`), plus a margin.
const ELBOW_OVER_POINT_M: f64 = 0.05;

/// How much lower than the highest an elbow may be to count as up, metres; postures that differ only in the wrist
/// differ by a few millimetres, the elbow-down posture by far more.
const ELBOW_UP_M: f64 = 0.05;

/// How far the tool stays from the first axis, metres: the radius of shoulder and base, 0.051, plus that of the palm,
/// 0.059 (meshes `shoulder.stl` and `hand_3finger_main.stl` of dm_control).
const HAND_OFF_BASE_M: f64 = 0.11;

/// From how many starts the postures of an arm that is no built-in model are searched, besides its home.
const SEARCHES: usize = 24;

/// How many postures of it are tried at most.
const MAX_FOUND: usize = 8;

/// The rotations of the hand that are tried if any will do, against the one at home.
const FREE_TURNS: [f64; 4] = [0.0, PI / 2.0, -PI / 2.0, PI];

/// Postures that differ by less are the same, radians.
const SAME_RAD: f64 = 0.05;

/// The longest step of the path up, metres.
const STEP_M: f64 = 0.02;

/// The largest coordinate or height considered, metres; no arm comes near it.
const MAX_M: f64 = 10.0;

/// Step of the search for the reachable range, metres; both ends are bisected to 0.1 mm.
const RANGE_STEP_M: f64 = 0.02;
const RANGE_HALVINGS: usize = 8;

/// Ranges are cached for heights rounded to this, metres.
const CACHE_STEP_M: f64 = 0.005;

/// The most heights in the cache.
const MAX_CACHED: usize = 4096;

/// The rotation of the hand about the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// This angle, radians: at 0 the tool's x axis lies along the base's.
    Fixed(f64),
    /// Any angle: the last joint stays at zero.
    Free,
}

/// Distances from the first joint's axis, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest.
    pub nearest_m: f64,
    /// The largest.
    pub farthest_m: f64,
}

/// A point that the hand cannot reach pointing down, or cannot leave straight up.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfReach {
    /// Distance of the point from the first joint's axis, metres.
    pub radius_m: f64,
    /// Height above the point that the hand cannot reach, metres; 0 for the point itself.
    pub above_m: f64,
    /// The range reached at that height, contiguous up to the farthest; `None` if nothing is reached.
    pub range: Option<Range>,
    /// The reason.
    pub why: WhyUnreachable,
}

/// Why a point is out of reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhyUnreachable {
    /// A coordinate is not finite, or a height is not finite or is negative.
    NotAPlace,
    /// It is too near to the base.
    TooNear,
    /// It is too far from it.
    TooFar,
    /// Nothing is reached at that height.
    Height,
    /// It lies in a narrow gap of the reachable range.
    Gap,
    /// Each posture for the point hits a limit on the straight path up, or would have to change.
    WayUp,
}

impl fmt::Display for OutOfReach {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.why == WhyUnreachable::NotAPlace {
            return write!(
                out,
                "the point or a height above it is not within {MAX_M} m of the arm's base"
            );
        }
        write!(out, "{:.2} m from the arm's base; ", self.radius_m)?;
        match (self.above_m > 0.0, self.range) {
            (true, _) => write!(out, "{:.2} m above the point ", self.above_m)?,
            (false, Some(_)) => write!(out, "at this height ")?,
            (false, None) => write!(out, "at this height, pointing down, ")?,
        }
        let Some(range) = self.range else {
            return write!(out, "it reaches nothing");
        };
        // Rounded inwards, so that a point refused by a millimetre is not reported as within range.
        let centimetre = |metres: f64, round: fn(f64) -> f64| round(metres * 100.0) / 100.0;
        let nearest_m = centimetre(range.nearest_m, f64::ceil);
        let farthest_m = centimetre(range.farthest_m, f64::floor);
        write!(out, "it reaches {nearest_m:.2} to {farthest_m:.2} m")?;
        match self.why {
            WhyUnreachable::Gap => write!(out, ", but not there"),
            WhyUnreachable::WayUp => write!(out, ", but not straight up from there"),
            _ => Ok(()),
        }
    }
}

impl std::error::Error for OutOfReach {}

/// The reach of an arm with its hand pointing down.
#[derive(Debug)]
pub struct Reach {
    chain: Chain,
    downwards: Option<ToolDown>,
    turn: Turn,
    ranges: Mutex<BTreeMap<i64, Option<Range>>>,
}

impl Reach {
    /// Computes the reach of an arm whose hand points straight down.
    pub fn tool_down(chain: &Chain, turn: Turn) -> Reach {
        Reach {
            chain: chain.clone(),
            downwards: chain.home().is_none().then(|| ToolDown::new(chain)),
            turn,
            ranges: Mutex::default(),
        }
    }

    /// Returns joint angles at a point from which the hand can rise straight to each height.
    ///
    /// Of several postures, one with the elbow up: of a built-in model the one farthest from a singularity (Yoshikawa's
    /// measure, 1985), of another arm the one nearest to its home.
    ///
    /// - `point`: the tool's target, base frame, metres.
    /// - `heights_above_m`: above the point, metres, none negative.
    pub fn check(
        &self,
        point: &Point3<f64>,
        heights_above_m: &[f64],
    ) -> Result<Vec<f64>, OutOfReach> {
        let radius_m = point.x.hypot(point.y);
        let top_m = heights_above_m.iter().copied().fold(0.0, f64::max);
        let is_height = |height: &f64| (0.0..=MAX_M).contains(height);
        if !(point.iter().all(|coordinate| coordinate.abs() <= MAX_M)
            && heights_above_m.iter().all(is_height))
        {
            return Err(OutOfReach {
                radius_m,
                above_m: 0.0,
                range: None,
                why: WhyUnreachable::NotAPlace,
            });
        }
        let postures = match &self.downwards {
            Some(downwards) => self.best_first(downwards, point),
            None => self.searched(point, MAX_FOUND),
        };
        if let Some(angles) = postures
            .iter()
            .find_map(|posture| self.rises(posture, point, top_m))
        {
            return Ok(angles);
        }
        Err(self.refusal(radius_m, point.z, heights_above_m, !postures.is_empty()))
    }

    /// Returns the range reached at a height above the base, contiguous up to the farthest; `None` if nothing is
    /// reached.
    ///
    /// Exact to 1 mm for heights that are multiples of 5 mm; others are rounded to the nearest. A gap narrower than 20
    /// mm may be missed; such gaps exist less than 0.2 m from the axis.
    pub fn range(&self, height_m: f64) -> Option<Range> {
        if height_m.is_nan() || height_m.abs() > 2.0 * MAX_M {
            return None;
        }
        let key = (height_m / CACHE_STEP_M).round();
        let mut ranges = self.ranges.lock().unwrap_or_else(PoisonError::into_inner);
        if ranges.len() >= MAX_CACHED {
            ranges.clear();
        }
        *ranges
            .entry(key as i64)
            .or_insert_with(|| self.search_range(key * CACHE_STEP_M))
    }

    fn search_range(&self, height_m: f64) -> Option<Range> {
        let reaches = |radius_m: f64| self.reaches(radius_m, height_m);
        let radii: Vec<f64> = (0..60)
            .rev()
            .map(|step| f64::from(step) * RANGE_STEP_M)
            .collect();
        let outer = radii.iter().position(|radius_m| reaches(*radius_m))?;
        let gap = radii[outer..]
            .iter()
            .position(|radius_m| !reaches(*radius_m));
        let inner = gap.map_or(radii.len(), |gap| outer + gap);
        let rim = |within_m: f64, beyond_m: f64| {
            let (mut within_m, mut beyond_m) = (within_m, beyond_m);
            for _ in 0..RANGE_HALVINGS {
                let middle_m = (within_m + beyond_m) / 2.0;
                if reaches(middle_m) {
                    within_m = middle_m;
                } else {
                    beyond_m = middle_m;
                }
            }
            within_m
        };
        Some(Range {
            nearest_m: rim(radii[inner - 1], radii.get(inner).copied().unwrap_or(0.0)),
            farthest_m: rim(radii[outer], radii[outer] + RANGE_STEP_M),
        })
    }

    /// Returns whether the hand can be at a distance and a height.
    fn reaches(&self, radius_m: f64, height_m: f64) -> bool {
        match (&self.downwards, self.chain.home()) {
            (None, Some(home)) => {
                let at_home = self.chain.tool_at(home).translation;
                let (sin, cos) = at_home.y.atan2(at_home.x).sin_cos();
                let point = Point3::new(radius_m * cos, radius_m * sin, height_m);
                !self.searched(&point, 1).is_empty()
            }
            (Some(downwards), _) => !self.postures(downwards, radius_m, height_m).is_empty(),
            (None, None) => false,
        }
    }

    /// Returns postures of an arm with a home at a point, those near to it first.
    ///
    /// - `most`: how many suffice.
    fn searched(&self, point: &Point3<f64>, most: usize) -> Vec<Angles> {
        let chain = &self.chain;
        let Some(home) = chain.home() else {
            return Vec::new();
        };
        if point.x.hypot(point.y) < self.hand_off_base_m() {
            return Vec::new();
        }
        let poses: Vec<Isometry3<f64>> = match self.turn {
            Turn::Fixed(turn_rad) => vec![tool_down(point, turn_rad)],
            Turn::Free => {
                let x = chain.tool_at(home).rotation * Vector3::x();
                let turn_rad = x.y.atan2(x.x);
                let turns = FREE_TURNS.iter();
                turns.map(|by| tool_down(point, turn_rad + by)).collect()
            }
        };
        let away = |angles: &Angles| -> f64 {
            let away = angles
                .iter()
                .zip(home)
                .map(|(at, home)| (at - home).powi(2));
            away.sum()
        };
        let mut found: Vec<Angles> = Vec::new();
        for pose in poses.iter().filter(|pose| !chain.is_beyond(pose)) {
            let starts = starts::towards(chain, pose);
            for start in [*home].iter().chain(starts.iter().take(SEARCHES)) {
                let attempt = chain.approach(pose, start);
                let angles = chain.turns_nearest(&attempt.angles, home);
                let apart = |other: &Angles| {
                    let apart = angles.iter().zip(other).map(|(a, b)| (a - b).abs());
                    apart.fold(0.0, f64::max)
                };
                let is_new = found.iter().all(|other| apart(other) > SAME_RAD);
                if attempt.reached() && is_new && self.is_elbow_over(&angles, point.z) {
                    found.push(angles);
                }
                if found.len() >= most {
                    break;
                }
            }
        }
        found.sort_by(|one, other| away(one).total_cmp(&away(other)));
        found
    }

    /// Returns how far the tool stays from the base's axis, metres.
    fn hand_off_base_m(&self) -> f64 {
        let hand = self.chain.joints().len();
        let radius_m = |link: usize| {
            let shapes = self
                .chain
                .shapes()
                .iter()
                .filter(move |shape| shape.link == link);
            shapes.map(|shape| shape.radius_m).fold(0.0, f64::max)
        };
        match self.downwards {
            Some(_) => HAND_OFF_BASE_M,
            None => radius_m(0) + radius_m(hand),
        }
    }

    /// Returns whether the elbow is above a height by more than a link's thickness; of an arm that is no built-in model,
    /// every joint between elbow and wrist.
    fn is_elbow_over(&self, angles: &Angles, height_m: f64) -> bool {
        let links = self.chain.links_at(angles);
        let last = match self.downwards {
            Some(_) => 3,
            None => self.chain.last() - 1,
        };
        let mut elbows = links[2..last].iter();
        elbows.all(|link| link.translation.z >= height_m + ELBOW_OVER_POINT_M)
    }

    /// Returns the postures of a built-in model with the tool at a distance and a height whose elbow is above the tool.
    fn postures(&self, downwards: &ToolDown, radius_m: f64, height_m: f64) -> Vec<Angles> {
        if radius_m < self.hand_off_base_m() {
            return Vec::new();
        }
        let mut postures = downwards.postures(radius_m, height_m);
        postures.retain(|posture| self.is_elbow_over(posture, height_m));
        postures
    }

    /// Returns the postures of a built-in model at a point, the best first.
    fn best_first(&self, downwards: &ToolDown, point: &Point3<f64>) -> Vec<Angles> {
        let mut postures = self.postures(downwards, point.x.hypot(point.y), point.z);
        let elbow_m = |posture: &Angles| self.chain.links_at(posture)[2].translation.z;
        let highest_m = postures
            .iter()
            .map(elbow_m)
            .fold(f64::NEG_INFINITY, f64::max);
        let dexterity = |posture: &Angles| {
            let up = if elbow_m(posture) > highest_m - ELBOW_UP_M {
                1.0
            } else {
                0.0
            };
            up + dexterity_of(self.chain.motion_at(posture).1)
        };
        postures.sort_by(|one, other| dexterity(other).total_cmp(&dexterity(one)));
        let azimuth = point.y.atan2(point.x);
        for posture in &mut postures {
            posture[0] += azimuth * self.chain.first_turns();
            for (angle, joint) in posture.iter_mut().zip(self.chain.joints()) {
                if joint.limits_rad.is_none() {
                    *angle = nearest_turn(*angle, PI);
                }
            }
        }
        postures
    }

    /// Returns the angles at the point where the hand can rise from there to `top_m`.
    fn rises(&self, posture: &Angles, point: &Point3<f64>, top_m: f64) -> Option<Vec<f64>> {
        let tool = self.chain.tool_at(posture);
        let mut target = Isometry3::from_parts(Translation3::from(point.coords), tool.rotation);
        if let Turn::Fixed(turn_rad) = self.turn {
            target = tool_down(point, turn_rad);
        }
        let top = Translation3::new(0.0, 0.0, top_m) * target;
        let near = self.chain.of_joints(posture);
        let way = self.chain.straight(&target, &top, &near, STEP_M).ok()?;
        let over_table = |joints: &Vec<f64>| {
            let angles = self.chain.angles(joints);
            angles.is_ok_and(|angles| self.is_elbow_over(&angles, point.z))
        };
        if !way.iter().all(over_table) {
            return None;
        }
        way.into_iter().next()
    }

    /// - `is_reached`: whether there is a posture at the point itself.
    fn refusal(
        &self,
        radius_m: f64,
        height_m: f64,
        heights_above_m: &[f64],
        is_reached: bool,
    ) -> OutOfReach {
        let mut above_m: Vec<f64> = [0.0].iter().chain(heights_above_m).copied().collect();
        above_m.sort_by(f64::total_cmp);
        let refused = |above_m: f64, range, why| OutOfReach {
            radius_m,
            above_m,
            range,
            why,
        };
        for above_m in above_m {
            let Some(range) = self.range(height_m + above_m) else {
                return refused(above_m, None, WhyUnreachable::Height);
            };
            if radius_m > range.farthest_m {
                return refused(above_m, Some(range), WhyUnreachable::TooFar);
            }
            if radius_m < range.nearest_m {
                return refused(above_m, Some(range), WhyUnreachable::TooNear);
            }
        }
        let why = match is_reached {
            true => WhyUnreachable::WayUp,
            false => WhyUnreachable::Gap,
        };
        refused(0.0, self.range(height_m), why)
    }
}

/// Returns how far the tool is from a singularity: the determinant of the Jacobian, generalised to more joints.
fn dexterity_of(jacobian: Jacobian) -> f64 {
    let square = (jacobian * jacobian.transpose()).determinant();
    square.max(0.0).sqrt()
}

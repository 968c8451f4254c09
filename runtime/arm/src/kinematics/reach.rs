//! The reach of a hand that points straight down.
//!
//! In: a point in the base frame, and heights above it that the hand must reach too. Out: joint angles at the point
//! from which the hand can go straight up; else the point's distance from the base, the range at that height, and why
//! the point is not reached. Postures are searched from the arm's home, then from other starts; the range is the one in
//! the direction in which the hand is at home. A point may be refused although a start that was not tried leads there.
//! Three conditions apply beyond the joint limits: the elbow stays above the point by more than a link's thickness,
//! because the table lies below the point; the hand stays off the base; and the path up is straight. Other collisions
//! are not checked.

use super::chain::{Angles, Chain};
use super::tool_down::tool_down;
use nalgebra::{Point3, Translation3};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// How far the elbow's axis stays above the point, metres: the radius of a large link, 0.044 (`large_ring` of
/// dm_control's `jaco_arm.xml`), plus a margin.
const ELBOW_OVER_POINT_M: f64 = 0.05;

/// From how many starts postures are searched.
const SEARCHES: usize = 25;

/// The longest step of the path up, metres: that of the guard, so that it finds the same path.
const STEP_M: f64 = 0.01;

/// The largest coordinate or height considered, metres; no arm comes near it.
const MAX_M: f64 = 10.0;

/// The distances that are tried for the reachable range: centimetres, as messages print them.
const RANGE_CM: std::ops::Range<u32> = 0..150;

/// Ranges are cached for heights rounded to this, metres.
const CACHE_STEP_M: f64 = 0.005;

/// Distances from the first joint's axis, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest.
    pub nearest_m: f64,
    /// The largest.
    pub farthest_m: f64,
}

/// The reach of an arm with its hand pointing down.
#[derive(Debug)]
pub struct Reach {
    chain: Chain,
    turn_rad: f64,
    ranges: Mutex<BTreeMap<i64, Option<Range>>>,
}

impl Reach {
    /// Computes the reach of an arm whose hand points straight down.
    ///
    /// - `turn_rad`: the hand's rotation about the base's vertical, as of [`tool_down`].
    pub fn tool_down(chain: &Chain, turn_rad: f64) -> Reach {
        Reach {
            chain: chain.clone(),
            turn_rad,
            ranges: Mutex::default(),
        }
    }

    /// Returns joint angles at a point from which the hand can rise straight to each height; the error says how far away it
    /// is, and what is reached.
    ///
    /// Of several postures, one with the elbow up, and the one to which the arm's home leads if there is one.
    ///
    /// - `point`: the tool's target, base frame, metres.
    /// - `heights_above_m`: above the point, metres, none negative.
    pub fn check(&self, point: &Point3<f64>, heights_above_m: &[f64]) -> Result<Vec<f64>, String> {
        let top_m = heights_above_m.iter().copied().fold(0.0, f64::max);
        let is_height = |height: &f64| (0.0..=MAX_M).contains(height);
        if !(point.iter().all(|coordinate| coordinate.abs() <= MAX_M)
            && heights_above_m.iter().all(is_height))
        {
            return Err(format!(
                "the point or a height above it is not within {MAX_M} m of the arm's base"
            ));
        }
        let mut but = ", but not there";
        for posture in self.postures(point) {
            if let Some(angles) = self.rises(&posture, point, top_m) {
                return Ok(angles);
            }
            but = ", but not straight up from there";
        }
        Err(self.refusal(point, but))
    }

    /// Returns the range reached at a height above the base, contiguous up to the farthest; `None` if nothing is
    /// reached.
    ///
    /// In whole centimetres, for heights rounded to 5 mm. A gap that is narrower may be missed.
    pub fn range(&self, height_m: f64) -> Option<Range> {
        if height_m.is_nan() || height_m.abs() > 2.0 * MAX_M {
            return None;
        }
        let key = (height_m / CACHE_STEP_M).round();
        let mut ranges = self.ranges.lock().unwrap_or_else(PoisonError::into_inner);
        *ranges
            .entry(key as i64)
            .or_insert_with(|| self.search_range(key * CACHE_STEP_M))
    }

    fn search_range(&self, height_m: f64) -> Option<Range> {
        let inwards = RANGE_CM.rev().map(|cm| f64::from(cm) / 100.0);
        let mut reached = inwards
            .skip_while(|radius_m| !self.reaches(*radius_m, height_m))
            .take_while(|radius_m| self.reaches(*radius_m, height_m));
        let farthest_m = reached.next()?;
        Some(Range {
            nearest_m: reached.last().unwrap_or(farthest_m),
            farthest_m,
        })
    }

    /// Returns whether the hand can be at a distance and a height, in the direction in which it is at home.
    fn reaches(&self, radius_m: f64, height_m: f64) -> bool {
        let home = self.chain.tool_at(self.chain.home()).translation;
        let (sin, cos) = home.y.atan2(home.x).sin_cos();
        let point = Point3::new(radius_m * cos, radius_m * sin, height_m);
        self.postures(&point).next().is_some()
    }

    /// Returns postures at a point whose elbow is above it, the one to which the arm's home leads first.
    fn postures(&self, point: &Point3<f64>) -> impl Iterator<Item = Angles> {
        let (chain, height_m) = (&self.chain, point.z);
        let pose = tool_down(point, self.turn_rad);
        let is_off_base = point.x.hypot(point.y) >= self.hand_off_base_m();
        let attempts = chain.search(pose).take(SEARCHES);
        let attempts = attempts.take_while(move |_| is_off_base);
        attempts.filter_map(move |attempt| {
            let angles = chain.turns_nearest(&attempt.angles, chain.home());
            (attempt.reached() && self.is_elbow_over(&angles, height_m)).then_some(angles)
        })
    }

    /// Returns how far the tool stays from the base's axis, metres: the radii of the first link and of the hand.
    fn hand_off_base_m(&self) -> f64 {
        let radius_m = |link: usize| {
            let shapes = self.chain.shapes().iter();
            let of_link = shapes.filter(move |shape| shape.link == link);
            of_link.map(|shape| shape.radius_m).fold(0.0, f64::max)
        };
        radius_m(0) + radius_m(self.chain.joints().len())
    }

    /// Returns whether every joint between elbow and wrist is above a height by more than a link's thickness.
    fn is_elbow_over(&self, angles: &Angles, height_m: f64) -> bool {
        let links = self.chain.links_at(angles);
        let mut elbows = links[2..self.chain.last() - 1].iter();
        elbows.all(|link| link.translation.z >= height_m + ELBOW_OVER_POINT_M)
    }

    /// Returns the angles at the point where the hand can rise from there to `top_m`.
    fn rises(&self, posture: &Angles, point: &Point3<f64>, top_m: f64) -> Option<Vec<f64>> {
        let target = tool_down(point, self.turn_rad);
        let top = Translation3::new(0.0, 0.0, top_m) * target;
        let near = self.chain.of_joints(posture);
        let way = self.chain.straight(&near, &top, STEP_M).ok()?;
        let over_table = |joints: &Vec<f64>| {
            let angles = self.chain.angles(joints);
            angles.is_ok_and(|angles| self.is_elbow_over(&angles, point.z))
        };
        if !way.iter().all(over_table) {
            return None;
        }
        way.into_iter().next()
    }

    /// Words the refusal of a point by the range at its height; within that, with a reason.
    fn refusal(&self, point: &Point3<f64>, but: &str) -> String {
        let (radius_m, range) = (point.x.hypot(point.y), self.range(point.z));
        let reached = match range {
            None => "nothing".to_owned(),
            Some(Range {
                nearest_m,
                farthest_m,
            }) => {
                let is_within = (nearest_m..=farthest_m).contains(&radius_m);
                let but = if is_within { but } else { "" };
                format!("{nearest_m:.2} to {farthest_m:.2} m{but}")
            }
        };
        format!("{radius_m:.2} m from the arm's base; at this height it reaches {reached}")
    }
}

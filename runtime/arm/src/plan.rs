//! Plans one pick and place without motion.
//!
//! In: settings, the guard, the arm's state, two points. Out: a [`Plan`]: each segment with its target, path length,
//! duration, and joint angles at its end; or the reason why a segment is not allowed or not
//! possible. A whole plan comes with its route and checked motions. Nothing is executed here.

use super::driver::{ArmState, Opening};
use super::guard::Guard;
use super::route::{Act, Route, Segment, SegmentName};
use super::settings::Settings;
use fab_program::Manner;
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

/// One pick and place, planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The arm's model.
    pub model: String,
    /// Pick point, metres, base frame.
    pub pick_m: [f64; 3],
    /// Place point, metres, base frame.
    pub place_m: [f64; 3],
    /// Position of the tool before the first segment, metres, base frame.
    pub from_m: [f64; 3],
    /// The segments in order; a refused segment is the last one.
    pub segments: Vec<PlannedSegment>,
    /// The segments that follow the grasp if the hand is empty; empty if one of `segments` is refused.
    #[serde(default)]
    pub after_missed_grasp: Vec<PlannedSegment>,
    /// Why the last segment is not allowed or not possible; `None` if all are possible.
    pub refused: Option<String>,
}

/// A segment of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedSegment {
    /// Its name.
    pub name: SegmentName,
    /// Position of the tool at its end, metres, base frame.
    pub to_m: [f64; 3],
    /// Target of the fingers, in a segment that moves only the fingers.
    pub hand: Option<Opening>,
    /// Path length of the tool, metres.
    pub way_m: f64,
    /// How long it takes within the limits of tool and joints, seconds; an estimate for a node that takes tool poses. 0
    /// for fingers, whose speed is not configured, and for a refused segment.
    pub takes_s: f64,
    /// Joint angles at its end by this crate's kinematics, degrees; a node that takes tool poses may choose others.
    pub joints_deg: Vec<f64>,
}

impl Plan {
    /// Plans a pick and place with the hand pointing down, and then the way home after a missed grasp; the route is there if
    /// all of it is possible.
    ///
    /// - `from`: the arm's state.
    /// - `points`: pick and place, metres, base frame.
    /// - `manner`: how the cloth is carried; see [`Route::new`].
    pub fn make(
        settings: &Settings,
        guard: &Guard,
        from: &ArmState,
        points: [Point3<f64>; 2],
        manner: &Manner,
    ) -> (Plan, Option<Route>) {
        let [pick, place] = points;
        let mut plan = Plan {
            model: settings.model.clone(),
            pick_m: pick.into(),
            place_m: place.into(),
            from_m: from.tool.translation.vector.into(),
            segments: Vec::new(),
            after_missed_grasp: Vec::new(),
            refused: None,
        };
        let mut route = Route::new(settings, guard.surface(), &from.tool, &pick, &place, manner);
        let n_segments = route.segments.len();
        let segments: Vec<Segment> = route.all().copied().collect();
        let mut at = from.clone();
        let mut grasped = None;
        for (index, segment) in segments.into_iter().enumerate() {
            if index == n_segments {
                at = grasped.take().unwrap_or(at);
            }
            let here = at.tool.translation.vector;
            let (to, hand) = match segment.act {
                Act::Move(to) => (to, None),
                Act::Hand(opening) => (at.tool, Some(opening)),
            };
            let mut planned = PlannedSegment {
                name: segment.name,
                to_m: to.translation.vector.into(),
                hand,
                way_m: (to.translation.vector - here).norm(),
                takes_s: 0.0,
                joints_deg: Vec::new(),
            };
            if hand.is_none() {
                match guard.motion(&at, &to, segment.speed_m_s) {
                    Ok(motion) => {
                        planned.takes_s = motion.get().takes_s();
                        let last = motion.get().waypoints.last();
                        at.joints_rad = last.map_or(Vec::new(), |last| last.joints_rad.clone());
                        at.tool = to;
                        route.motions.push(motion);
                    }
                    Err(why) => plan.refused = Some(why),
                }
            }
            if plan.refused.is_none() {
                planned.joints_deg = at.joints_rad.iter().map(|it| it.to_degrees()).collect();
            }
            if segment.name == SegmentName::Grasp {
                grasped = Some(at.clone());
            }
            if index < n_segments {
                plan.segments.push(planned);
            } else {
                plan.after_missed_grasp.push(planned);
            }
            if plan.refused.is_some() {
                return (plan, None);
            }
        }
        (plan, Some(route))
    }

    /// Returns the total path length, metres.
    pub fn way_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.way_m).sum()
    }

    /// Returns the total duration of the tool's motions, seconds.
    pub fn takes_s(&self) -> f64 {
        self.segments.iter().map(|segment| segment.takes_s).sum()
    }

    /// Returns which segment is refused and why; `None` if all are possible.
    pub fn refusal(&self) -> Option<String> {
        let why = self.refused.as_ref()?;
        let refused = match self.after_missed_grasp.last() {
            Some(segment) => Some((segment, ", after a missed grasp,")),
            None => self.segments.last().map(|segment| (segment, "")),
        };
        Some(match refused {
            Some((segment, after)) => {
                format!("`{}`{after} is not possible: {why}", segment.name.name())
            }
            None => why.clone(),
        })
    }
}

#[cfg(test)]
mod tests;

//! Plans one pick and place without motion.
//!
//! In: settings, the guard, the arm's state, two points. Out: a [`Plan`]: each segment with its target, path length,
//! duration, and joint angles at its end; or the reason why a segment is not allowed or not
//! possible. A whole plan comes with its checked route, which alone can be executed. Nothing is executed here.

use super::driver::{ArmState, Opening};
use super::guard::{Checked, Guard, Motion, Step};
use super::kinematics::reach::Reach;
use super::route::{Act, Route, SegmentName};
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
    /// The highest speed of the tool that the joints allow, m/s; not in a plan's file.
    #[serde(skip)]
    pub joints_allow_m_s: f64,
}

impl Plan {
    /// Plans a pick and place with the hand pointing down; the route is there if all of it is possible.
    ///
    /// - `from`: the arm's state; joint angles that it does not report are those of a posture with the elbow up.
    /// - `points`: pick and place, metres, base frame.
    /// - `manner`: how the cloth is carried; see [`Route::new`].
    pub fn make(
        settings: &Settings,
        guard: &Guard,
        from: &ArmState,
        points: [Point3<f64>; 2],
        manner: &Manner,
    ) -> (Plan, Option<Checked<Route>>) {
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
        let from = match with_joints(settings, guard, from) {
            Ok(from) => from,
            Err(why) => {
                plan.refused = Some(why);
                return (plan, None);
            }
        };
        let route = Route::new(settings, guard.surface(), &from.tool, &pick, &place, manner);
        let n_segments = route.segments.len();
        let (steps, route) = guard.route(&from, route);
        plan.segments = steps.iter().map(PlannedSegment::of).collect();
        if steps.len() > n_segments {
            plan.after_missed_grasp = plan.segments.split_off(n_segments);
        }
        plan.refused = route.as_ref().err().cloned();
        (plan, route.ok())
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

/// Returns the state with joint angles, if need be those of a posture with the elbow up.
fn with_joints(settings: &Settings, guard: &Guard, from: &ArmState) -> Result<ArmState, String> {
    let mut from = from.clone();
    if from.joints_rad.is_empty() {
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let here = Point3::from(from.tool.translation.vector);
        let at_rest = Reach::tool_down(guard.chain(), turn_rad).check(&here, &[0.0]);
        from.joints_rad = at_rest.map_err(|why| format!("where the tool is: {why}"))?;
    }
    Ok(from)
}

impl PlannedSegment {
    /// Describes a step; a refused one has no joint angles.
    fn of(step: &Step) -> PlannedSegment {
        let motion = step.motion.as_ref().map(Checked::get);
        let from = step.begin.tool;
        let (to, hand) = match step.segment.act {
            Act::Move(to) => (to, None),
            Act::Hand(opening) => (from, Some(opening)),
        };
        let joints_rad = step.end.iter().flat_map(|end| &end.joints_rad);
        PlannedSegment {
            name: step.segment.name,
            to_m: to.translation.vector.into(),
            hand,
            way_m: (to.translation.vector - from.translation.vector).norm(),
            takes_s: motion.map_or(0.0, Motion::takes_s),
            joints_deg: joints_rad.map(|angle| angle.to_degrees()).collect(),
            joints_allow_m_s: motion.map_or(f64::INFINITY, |motion| motion.joints_allow_m_s),
        }
    }
}

#[cfg(test)]
mod tests;

//! Plans one pick and place without motion.
//!
//! In: settings, the kinematic chain, the tool's pose, two points. Out: a [`Plan`]: each segment with its target, path
//! length, duration at the configured speed, and joint angles at its end; or the reason why a segment is not allowed or
//! not possible. Nothing is executed here.

use super::driver::Opening;
use super::kinematics::chain::Chain;
use super::kinematics::reach::{Reach, Turn};
use super::limits;
use super::route::{self, Act, Segment, SegmentName};
use super::settings::Settings;
use nalgebra::{Isometry3, Point3};
use serde::{Deserialize, Serialize};

/// Largest distance between two points of a straight path at which joint angles are solved, metres.
const STEP_M: f64 = 0.01;

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
    /// Duration at the configured speed, seconds; 0 for fingers, whose speed is not configured.
    pub takes_s: f64,
    /// Joint angles at its end by this crate's kinematics, degrees; a node that takes tool poses may choose others.
    pub joints_deg: Vec<f64>,
}

impl Plan {
    /// Plans a pick and place with the hand pointing down.
    ///
    /// - `from`: the tool's pose, `base_from_tool`.
    /// - `points`: pick and place, metres, base frame.
    pub fn make(
        settings: &Settings,
        chain: &Chain,
        from: &Isometry3<f64>,
        points: [Point3<f64>; 2],
    ) -> Plan {
        let [pick, place] = points;
        let mut plan = Plan {
            model: settings.model.clone(),
            pick_m: pick.into(),
            place_m: place.into(),
            from_m: from.translation.vector.into(),
            segments: Vec::new(),
            refused: None,
        };
        let segments = route::segments(settings, from, &pick, &place);
        plan.refused = plan.follow(settings, chain, from, &segments).err();
        plan
    }

    /// Adds segments up to the first that is not allowed or not possible; the error says why.
    fn follow(
        &mut self,
        settings: &Settings,
        chain: &Chain,
        from: &Isometry3<f64>,
        segments: &[Segment],
    ) -> Result<(), String> {
        let turn = Turn::Fixed(settings.motion.hand_turn_deg.to_radians());
        let here = Point3::from(from.translation.vector);
        let at_rest = Reach::tool_down(chain, turn).check(&here, &[0.0]);
        let mut joints_rad = at_rest.map_err(|why| format!("where the tool is: {why}"))?;
        let mut at = *from;
        for segment in segments {
            let (to, hand) = match segment.act {
                Act::Move(to) => (to, None),
                Act::Hand(opening) => (at, Some(opening)),
            };
            let way_m = (to.translation.vector - at.translation.vector).norm();
            self.segments.push(PlannedSegment {
                name: segment.name,
                to_m: to.translation.vector.into(),
                hand,
                way_m,
                takes_s: way_m / settings.motion.speed_m_s,
                joints_deg: Vec::new(),
            });
            if hand.is_none() {
                limits::check(
                    &settings.workspace,
                    settings.tolerance.position_m,
                    &at,
                    &to,
                    settings.motion.speed_m_s,
                )?;
                let path = chain.straight(&at, &to, &joints_rad, STEP_M);
                let path = path.map_err(|why| format!("the arm cannot follow: {why}"))?;
                joints_rad = path.into_iter().next_back().unwrap_or(joints_rad);
            }
            if let Some(last) = self.segments.last_mut() {
                last.joints_deg = joints_rad.iter().map(|angle| angle.to_degrees()).collect();
            }
            at = to;
        }
        Ok(())
    }

    /// Returns the total path length, metres.
    pub fn way_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.way_m).sum()
    }

    /// Returns the total duration at the configured speed, seconds.
    pub fn takes_s(&self) -> f64 {
        self.segments.iter().map(|segment| segment.takes_s).sum()
    }

    /// Returns which segment is refused and why; `None` if all are possible.
    pub fn refusal(&self) -> Option<String> {
        let why = self.refused.as_ref()?;
        Some(match self.segments.last() {
            Some(segment) => format!("`{}` is not possible: {why}", segment.name.text()),
            None => why.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::kinematics::tool_down::tool_down;

    const ROBOT: &str = "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.calibration.toml'
table = { center_m = [0.45, 0.0, 0.02] }
fingers = { count = 2, open = 0.0, closed = 6400.0, tolerance = 100.0 }
camera = { source = 'simulated', window_px = [0, 0, 720] }
[workspace]
min_m = [0.15, -0.525, 0.01]
max_m = [0.75, 0.525, 0.45]
rest_m = [0.35, -0.35, 0.25]
keep_out = [{ name = 'lamp', min_m = [0.45, 0.1, 0.0], max_m = [0.5, 0.2, 0.4] }]
";

    fn plan(pick_m: [f64; 3], place_m: [f64; 3]) -> (Plan, Chain) {
        let settings = Settings::parse(ROBOT).unwrap();
        let chain = Chain::of_model("j2n6s200").unwrap();
        let from = tool_down(&settings.workspace.rest_m.into(), 0.0);
        let points = [pick_m, place_m].map(Point3::from);
        (Plan::make(&settings, &chain, &from, points), chain)
    }

    #[test]
    fn joints_at_the_end_of_a_segment_bring_the_tool_there() {
        let (plan, chain) = plan([0.40, 0.05, 0.02], [0.52, -0.12, 0.02]);
        assert_eq!(plan.refusal(), None);
        for segment in &plan.segments {
            let joints: Vec<f64> = segment
                .joints_deg
                .iter()
                .map(|it| it.to_radians())
                .collect();
            let tool = chain.base_from_tool(&joints).unwrap();
            let off = tool.translation.vector - Point3::from(segment.to_m).coords;
            assert!(off.norm() < 1e-5, "{segment:?}");
        }
        let ways: f64 = plan.way_m();
        assert!((plan.takes_s() - ways / 0.10).abs() < 1e-9);
        let last = plan.segments.last().unwrap();
        assert_eq!(
            (last.name, last.to_m),
            (SegmentName::Rest, [0.35, -0.35, 0.25])
        );
    }

    #[test]
    fn a_plan_ends_with_the_segment_that_is_refused() {
        for (pick_m, place_m, name, why) in [
            ([0.40, 0.16, 0.02], [0.55, 0.16, 0.02], "over", "`lamp`"),
            ([0.40, 0.05, 0.02], [0.45, 0.60, 0.02], "over", "workspace"),
            (
                [0.72, 0.20, 0.02],
                [0.45, 0.0, 0.02],
                "over_pick",
                "the arm cannot follow",
            ),
        ] {
            let (plan, _) = plan(pick_m, place_m);
            let refusal = plan.refusal().unwrap_or_default();
            assert!(refusal.contains(why), "{refusal}");
            assert_eq!(plan.segments.last().unwrap().name.text(), name, "{refusal}");
        }
    }
}

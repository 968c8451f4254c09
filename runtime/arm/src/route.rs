//! The segments of one pick and place, as in the paper.
//!
//! In: two points on the table, and the motion settings. Out: a [`Route`]: segments in order, each with its name and
//! target, and those that follow a missed grasp. The paper: approach to 5 mm above the pick, down, grasp, up 5 mm, over,
//! down, release, up. Distances are exact: each segment is one motion to an absolute pose, where the authors' code
//! counts steps of 50 mm.

use super::driver::Opening;
use super::guard::{Checked, Motion, Surface};
use super::kinematics::tool_down::tool_down;
use super::settings::Settings;
use fab_program::Manner;
use nalgebra::{Isometry3, Point3};
use serde::{Deserialize, Serialize};

/// The segments of one pick and place.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// In order.
    pub segments: Vec<Segment>,
    /// Those that follow [`SegmentName::Grasp`] if the hand is empty: up, and out of the camera's view.
    pub after_missed_grasp: Vec<Segment>,
    /// The motions of both, in order, once the guard has checked them.
    pub motions: Vec<Checked<Motion>>,
}

/// One segment of a pick and place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: SegmentName,
    /// The action in it.
    pub act: Act,
    /// Speed of the tool, m/s.
    pub speed_m_s: f64,
}

/// The action in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// The tool moves straight to a pose, `base_from_tool`.
    Move(Isometry3<f64>),
    /// The fingers move.
    Hand(Opening),
}

fab_base::named! {
    /// The segments of a pick and place, in order.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum SegmentName {
        /// The hand rises to travel height.
        Rise = "rise",
        /// The fingers open, away from the cloth.
        Open = "open",
        /// The hand moves over the pick point.
        OverPick = "over_pick",
        /// It approaches to just above the cloth.
        PrePick = "pre_pick",
        /// It goes down to the cloth.
        Down = "down",
        /// The fingers close.
        Grasp = "grasp",
        /// It lifts what it grasped.
        Lift = "lift",
        /// It carries the cloth over the place point.
        Over = "over",
        /// It goes down to the table.
        DownToPlace = "down_to_place",
        /// The fingers open.
        Release = "release",
        /// It rises from the cloth.
        Up = "up",
        /// It rises to travel height.
        Away = "away",
        /// It moves out of the camera's view.
        Rest = "rest",
    }
}

impl SegmentName {
    /// Returns whether the hand may hold cloth during or after this segment.
    pub fn may_hold_cloth(self) -> bool {
        (SegmentName::Grasp..=SegmentName::Release).contains(&self)
    }
}

impl Route {
    /// Returns its segments, then those after a missed grasp.
    pub fn all(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().chain(&self.after_missed_grasp)
    }

    /// Lists the segments of one pick and place.
    ///
    /// - `from`: the tool's pose, `base_from_tool`.
    /// - `pick`, `place`: points on the cloth and the table, base frame, metres.
    /// - `manner`: a lift and a height of release count from the height of the grasp. The speed is that of the
    ///   segments between grasp and release. Nothing is pressed.
    pub fn new(
        settings: &Settings,
        surface: &Surface,
        from: &Isometry3<f64>,
        pick: &Point3<f64>,
        place: &Point3<f64>,
        manner: &Manner,
    ) -> Route {
        let motion = &settings.motion;
        let (grasp_m, retreat_m) = (motion.grasp_m, motion.retreat_m);
        let above_grasp_m =
            |stated: Option<f64>, usual_m: f64| stated.map_or(usual_m, |above_m| grasp_m + above_m);
        let lift_m = above_grasp_m(manner.lift_m, motion.lift_m);
        let release_m = above_grasp_m(manner.release_height_m, motion.release_m);
        let travel_z = [pick, place]
            .map(|point| travel_height_m(settings, surface, point))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        let turn_rad = motion.hand_turn_deg.to_radians();
        let pose = |x: f64, y: f64, z: f64| Act::Move(tool_down(&Point3::new(x, y, z), turn_rad));
        let over = |point: &Point3<f64>, above_m: f64| pose(point.x, point.y, point.z + above_m);
        let high = |x: f64, y: f64| pose(x, y, travel_z);
        let open = Act::Hand(Opening::Open);
        let here = from.translation.vector;
        let [rest_x, rest_y, rest_z] = settings.workspace.rest_m;
        // The carry height is the lift above the higher of the two points, so the cloth clears both.
        let carry_z = pick.z.max(place.z) + lift_m;
        let rest = (SegmentName::Rest, pose(rest_x, rest_y, rest_z));
        let mut segments = vec![
            (
                SegmentName::Rise,
                pose(here.x, here.y, here.z.max(travel_z)),
            ),
            (SegmentName::Open, open),
            (SegmentName::OverPick, high(pick.x, pick.y)),
            (SegmentName::PrePick, over(pick, motion.pre_pick_m)),
            (SegmentName::Down, over(pick, grasp_m)),
            (SegmentName::Grasp, Act::Hand(Opening::Closed)),
        ];
        // A drag begins where the hand is.
        if lift_m > grasp_m {
            segments.push((SegmentName::Lift, over(pick, lift_m)));
        }
        if carry_z > pick.z + lift_m {
            segments.push((SegmentName::Lift, pose(pick.x, pick.y, carry_z)));
        }
        segments.extend([
            (SegmentName::Over, pose(place.x, place.y, carry_z)),
            (SegmentName::DownToPlace, over(place, release_m)),
            (SegmentName::Release, open),
            (SegmentName::Up, over(place, retreat_m.max(release_m))),
            (SegmentName::Away, high(place.x, place.y)),
            rest,
        ]);
        let after_missed_grasp = [
            (SegmentName::Up, over(pick, retreat_m)),
            (SegmentName::Release, open),
            (SegmentName::Away, high(pick.x, pick.y)),
            rest,
        ];
        let carry_m_s = manner.speed_m_s.unwrap_or(motion.speed_m_s);
        let named = |(name, act)| Segment {
            name,
            act,
            speed_m_s: match name {
                SegmentName::Lift | SegmentName::Over | SegmentName::DownToPlace => carry_m_s,
                _ => motion.speed_m_s,
            },
        };
        Route {
            segments: segments.into_iter().map(named).collect(),
            after_missed_grasp: after_missed_grasp.map(named).to_vec(),
            motions: Vec::new(),
        }
    }
}

/// Returns the height at which the hand travels over a point, metres, base frame.
pub fn travel_height_m(settings: &Settings, surface: &Surface, point: &Point3<f64>) -> f64 {
    let table_m = surface.height_m(point.x, point.y);
    table_m.max(settings.table.center_m[2]) + settings.motion.travel_m
}

//! The segments of one pick and place, as in the paper.
//!
//! In: two points on the table, and the motion settings. Out: segments in order, each with its name and target. The
//! paper: approach to 5 mm above the pick, down, grasp, up 5 mm, over, down, release, up. Distances are exact: each
//! segment is one motion to an absolute pose, where the authors' code counts steps of 50 mm.

use super::driver::Opening;
use super::kinematics::tool_down::tool_down;
use super::settings::{MotionSettings, Settings};
use nalgebra::{Isometry3, Point3};
use serde::{Deserialize, Serialize};

/// One segment of a pick and place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: SegmentName,
    /// The action in it.
    pub act: Act,
}

/// The action in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// The tool moves straight to a pose, `base_from_tool`.
    Move(Isometry3<f64>),
    /// The fingers move.
    Hand(Opening),
}

/// The segments of a pick and place, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SegmentName {
    /// The hand rises to travel height.
    Rise,
    /// The fingers open, away from the cloth.
    Open,
    /// The hand moves over the pick point.
    OverPick,
    /// It approaches to just above the cloth.
    PrePick,
    /// It goes down to the cloth.
    Down,
    /// The fingers close.
    Grasp,
    /// It lifts what it grasped.
    Lift,
    /// It carries the cloth over the place point.
    Over,
    /// It goes down to the table.
    DownToPlace,
    /// The fingers open.
    Release,
    /// It rises from the cloth.
    Up,
    /// It rises to travel height.
    Away,
    /// It moves out of the camera's view.
    Rest,
}

impl SegmentName {
    /// Returns the name as it appears in journals and messages.
    pub fn text(self) -> &'static str {
        match self {
            SegmentName::Rise => "rise",
            SegmentName::Open => "open",
            SegmentName::OverPick => "over_pick",
            SegmentName::PrePick => "pre_pick",
            SegmentName::Down => "down",
            SegmentName::Grasp => "grasp",
            SegmentName::Lift => "lift",
            SegmentName::Over => "over",
            SegmentName::DownToPlace => "down_to_place",
            SegmentName::Release => "release",
            SegmentName::Up => "up",
            SegmentName::Away => "away",
            SegmentName::Rest => "rest",
        }
    }

    /// Returns whether the hand may hold cloth during or after this segment.
    pub fn may_hold_cloth(self) -> bool {
        (SegmentName::Grasp..=SegmentName::Release).contains(&self)
    }
}

/// Lists the segments of one pick and place.
///
/// - `from`: the tool's pose, `base_from_tool`.
/// - `pick`, `place`: points on the cloth and the table, base frame, metres.
pub fn segments(
    settings: &Settings,
    from: &Isometry3<f64>,
    pick: &Point3<f64>,
    place: &Point3<f64>,
) -> Vec<Segment> {
    let MotionSettings {
        pre_pick_m,
        grasp_m,
        lift_m,
        release_m,
        retreat_m,
        hand_turn_deg,
        ..
    } = settings.motion;
    let travel_z = travel_height_m(settings);
    let turn_rad = hand_turn_deg.to_radians();
    let pose = |x: f64, y: f64, z: f64| Act::Move(tool_down(&Point3::new(x, y, z), turn_rad));
    let over = |point: &Point3<f64>, above_m: f64| pose(point.x, point.y, point.z + above_m);
    let high = |x: f64, y: f64| pose(x, y, travel_z);
    let here = from.translation.vector;
    let [rest_x, rest_y, rest_z] = settings.workspace.rest_m;
    let mut segments = Vec::new();
    let mut add = |name, act| segments.push(Segment { name, act });
    add(
        SegmentName::Rise,
        pose(here.x, here.y, here.z.max(travel_z)),
    );
    add(SegmentName::Open, Act::Hand(Opening::Open));
    add(SegmentName::OverPick, high(pick.x, pick.y));
    add(SegmentName::PrePick, over(pick, pre_pick_m));
    add(SegmentName::Down, over(pick, grasp_m));
    add(SegmentName::Grasp, Act::Hand(Opening::Closed));
    add(SegmentName::Lift, over(pick, lift_m));
    // The carry height is the lift above the higher of the two points, so the cloth clears both.
    let carry_z = pick.z.max(place.z) + lift_m;
    if carry_z > pick.z + lift_m {
        add(SegmentName::Lift, pose(pick.x, pick.y, carry_z));
    }
    add(SegmentName::Over, pose(place.x, place.y, carry_z));
    add(SegmentName::DownToPlace, over(place, release_m));
    add(SegmentName::Release, Act::Hand(Opening::Open));
    add(SegmentName::Up, over(place, retreat_m));
    add(SegmentName::Away, high(place.x, place.y));
    add(SegmentName::Rest, pose(rest_x, rest_y, rest_z));
    segments
}

/// Returns the height at which the hand travels, metres, base frame.
pub fn travel_height_m(settings: &Settings) -> f64 {
    settings.table.center_m[2] + settings.motion.travel_m
}

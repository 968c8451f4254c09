//! The segments of one pick and place, as the paper's arm carries it out.
//!
//! In: two points of the table and how to go about it. Out: segments in order, each with its name and its end. The
//! paper: arrive 5 mm above the pick, down, grasp, up 5 mm, over, down, release, up. Distances are exact: each segment is
//! one motion to a place, where the authors' code counts steps of 50 mm.

use super::driver::Opening;
use super::kinematics::tool_down::tool_down;
use super::settings::{MotionSettings, Settings};
use nalgebra::{Isometry3, Point3};
use serde::{Deserialize, Serialize};

/// One part of a pick and place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: Name,
    /// What is done.
    pub act: Act,
}

/// What is done in a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// The tool goes straight to a pose, `base_from_tool`.
    Move(Isometry3<f64>),
    /// The fingers move.
    Hand(Opening),
}

/// The segments of a pick and place, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Name {
    /// The hand rises to the height of travel, where it is.
    Rise,
    /// The fingers open, away from the cloth.
    Open,
    /// The hand goes over the pick point.
    OverPick,
    /// It comes to just above the cloth.
    PrePick,
    /// It goes down to the cloth.
    Down,
    /// The fingers close.
    Grasp,
    /// It lifts what it grasped.
    Lift,
    /// It carries it over the place point.
    Over,
    /// It goes down to the table.
    DownToPlace,
    /// The fingers open.
    Release,
    /// It rises from the cloth.
    Up,
    /// It rises to the height of travel.
    Away,
    /// It goes out of the camera's view.
    Rest,
}

impl Name {
    /// Returns the name as journals and people read it.
    pub fn text(self) -> &'static str {
        match self {
            Name::Rise => "rise",
            Name::Open => "open",
            Name::OverPick => "over_pick",
            Name::PrePick => "pre_pick",
            Name::Down => "down",
            Name::Grasp => "grasp",
            Name::Lift => "lift",
            Name::Over => "over",
            Name::DownToPlace => "down_to_place",
            Name::Release => "release",
            Name::Up => "up",
            Name::Away => "away",
            Name::Rest => "rest",
        }
    }

    /// Tells whether the hand may hold cloth in or after this segment.
    pub fn may_hold(self) -> bool {
        (Name::Grasp..=Name::Release).contains(&self)
    }
}

/// Lists the segments of one pick and place.
///
/// - `from`: where the tool is, `base_from_tool`.
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
    add(Name::Rise, pose(here.x, here.y, here.z.max(travel_z)));
    add(Name::Open, Act::Hand(Opening::Open));
    add(Name::OverPick, high(pick.x, pick.y));
    add(Name::PrePick, over(pick, pre_pick_m));
    add(Name::Down, over(pick, grasp_m));
    add(Name::Grasp, Act::Hand(Opening::Closed));
    add(Name::Lift, over(pick, lift_m));
    // Carried at the height to which it was lifted over the higher of the two points, so that it stays above both.
    let carry_z = pick.z.max(place.z) + lift_m;
    if carry_z > pick.z + lift_m {
        add(Name::Lift, pose(pick.x, pick.y, carry_z));
    }
    add(Name::Over, pose(place.x, place.y, carry_z));
    add(Name::DownToPlace, over(place, release_m));
    add(Name::Release, Act::Hand(Opening::Open));
    add(Name::Up, over(place, retreat_m));
    add(Name::Away, high(place.x, place.y));
    add(Name::Rest, pose(rest_x, rest_y, rest_z));
    segments
}

/// Returns the height at which the hand travels, metres, base frame.
pub fn travel_height_m(settings: &Settings) -> f64 {
    settings.table.center_m[2] + settings.motion.travel_m
}

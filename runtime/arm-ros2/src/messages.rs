//! The messages in use, with the names and in the order of their ROS 2 definitions, which is the order of their bytes.
//!
//! Definitions did not change from Humble to Kilted. A test compares the bytes of each with another program's.

use serde::{Deserialize, Serialize};
use serde_bytes::ByteBuf;

/// A message with a name in DDS.
pub(crate) trait Message {
    /// Its type in DDS, e.g. `sensor_msgs::msg::dds_::JointState_`.
    const TYPE: &'static str;
}

/// Declares messages: names of types in DDS, or nothing for a part of others, and fields.
macro_rules! messages {
    ($($name:ident $(= $dds:literal)? { $($field:ident: $type:ty),* $(,)? })*) => { $(
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub(crate) struct $name { $(pub(crate) $field: $type),* }
        $(impl Message for $name { const TYPE: &'static str = $dds; })?
    )* };
}

messages! {
    Time { sec: i32, nanosec: u32 }
    Duration { sec: i32, nanosec: u32 }
    Header { stamp: Time, frame_id: String }
    Uuid { uuid: [u8; 16] }

    JointState = "sensor_msgs::msg::dds_::JointState_" {
        header: Header, name: Vec<String>, position: Vec<f64>, velocity: Vec<f64>, effort: Vec<f64>,
    }
    Image = "sensor_msgs::msg::dds_::Image_" {
        header: Header, height: u32, width: u32, encoding: String, is_bigendian: u8, step: u32, data: ByteBuf,
    }
    RegionOfInterest { x_offset: u32, y_offset: u32, height: u32, width: u32, do_rectify: bool }
    CameraInfo = "sensor_msgs::msg::dds_::CameraInfo_" {
        header: Header, height: u32, width: u32, distortion_model: String, d: Vec<f64>, k: [f64; 9], r: [f64; 9],
        p: [f64; 12], binning_x: u32, binning_y: u32, roi: RegionOfInterest,
    }

    GoalInfo { goal_id: Uuid, stamp: Time }
    GoalStatus { goal_info: GoalInfo, status: i8 }
    GoalStatusArray = "action_msgs::msg::dds_::GoalStatusArray_" { status_list: Vec<GoalStatus> }
    CancelGoalRequest { goal_info: GoalInfo }
    CancelGoalResponse { return_code: i8, goals_canceling: Vec<GoalInfo> }
    SendGoalResponse { accepted: bool, stamp: Time }
    GetResultRequest { goal_id: Uuid }

    JointTrajectoryPoint {
        positions: Vec<f64>, velocities: Vec<f64>, accelerations: Vec<f64>, effort: Vec<f64>, time_from_start: Duration,
    }
    JointTrajectory { header: Header, joint_names: Vec<String>, points: Vec<JointTrajectoryPoint> }
    MultiDofTrajectory { header: Header, joint_names: Vec<String>, points: Vec<Unused> }
    JointTolerance { name: String, position: f64, velocity: f64, acceleration: f64 }
    FollowJointTrajectoryGoal {
        trajectory: JointTrajectory, multi_dof_trajectory: MultiDofTrajectory, path_tolerance: Vec<JointTolerance>,
        component_path_tolerance: Vec<Unused>, goal_tolerance: Vec<JointTolerance>,
        component_goal_tolerance: Vec<Unused>, goal_time_tolerance: Duration,
    }
    FollowJointTrajectoryResult { error_code: i32, error_string: String }

    GripperCommand { position: f64, max_effort: f64 }
    GripperCommandGoal { command: GripperCommand }
    GripperCommandResult { position: f64, effort: f64, stalled: bool, reached_goal: bool }
    ParallelGripperCommandGoal { command: JointState }
    ParallelGripperCommandResult { state: JointState, stalled: bool, reached_goal: bool }

    // A structure of IDL has at least one member, so one that is empty in ROS has this one.
    TriggerRequest { structure_needs_at_least_one_member: u8 }
    TriggerResponse { success: bool, message: String }
}

/// The request and the response of sending a goal and of asking for its result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SendGoalRequest<G> {
    pub(crate) goal_id: Uuid,
    pub(crate) goal: G,
}

/// The answer to [`GetResultRequest`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct GetResultResponse<R> {
    pub(crate) status: i8,
    pub(crate) result: R,
}

/// The items of lists that are always empty here.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Unused {}

impl Time {
    /// Returns the nanoseconds since 1970; ROS writes 0 where there is no stamp.
    pub(crate) fn nanoseconds(&self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

#[cfg(test)]
mod tests;

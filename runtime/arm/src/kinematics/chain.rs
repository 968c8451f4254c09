//! A kinematic chain and its forward kinematics.
//!
//! In: joint angles, radians, from the base to the hand. Out: link and tool frames in the base frame, metres, and the
//! Jacobian. Joint limits are stated here and enforced by the callers that choose angles: forward kinematics accepts
//! any angle, because an arm may report one past its limit.

use super::shape::Capsule;
use nalgebra::{Isometry3, SMatrix, UnitQuaternion, Vector3, Vector6};
use std::f64::consts::TAU;

/// The fewest joints that bring a hand to any pose.
pub const MIN_JOINTS: usize = 6;

/// The most joints of a supported arm.
pub const MAX_JOINTS: usize = 7;

/// Joint angles inside of this crate, radians: those beyond the chain's joints stay 0, so that chains of either length
/// need no heap.
pub(crate) type Angles = [f64; MAX_JOINTS];

/// A Jacobian inside of this module: the columns beyond the chain's joints stay 0.
pub(super) type Jacobian = SMatrix<f64, 6, MAX_JOINTS>;

/// The largest plausible joint angle, radians: a joint that reports more than a thousand turns is broken, and the sine
/// of far larger numbers is meaningless.
const MAX_ANGLE_RAD: f64 = 6300.0;

/// The horizontal part of a unit vector that counts as vertical: URDF files round pi.
const UPRIGHT: f64 = 1e-3;

/// The length weighted like a radian, metres: about half the arm's reach.
pub(super) const METRES_PER_RAD: f64 = 0.3;

/// A joint that rotates about the z axis of its frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its frame relative to the frame before it, at angle zero.
    pub parent_from_joint_at_zero: Isometry3<f64>,
    /// The least and the largest angle, radians; `None` for a joint without limits.
    pub limits_rad: Option<[f64; 2]>,
    /// Its highest speed, rad/s.
    pub max_speed_rad_s: f64,
}

/// An arm from its base to its tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    pub(crate) model: String,
    pub(crate) names: Vec<String>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) home: Angles,
    pub(crate) last_from_tool: Isometry3<f64>,
    pub(crate) shapes: Vec<Capsule>,
}

impl Chain {
    /// Returns the model's name.
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Returns the joints' names, from the base to the hand.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns a posture with the hand down over the table, to which others should be near.
    pub(super) fn home(&self) -> &Angles {
        &self.home
    }

    /// Returns the joints, from the base to the hand.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the tool's pose at these angles.
    ///
    /// - `joints_rad`: one for each joint, from the base; limits are not checked.
    pub fn base_from_tool(&self, joints_rad: &[f64]) -> Result<Isometry3<f64>, String> {
        Ok(self.tool_at(&self.angles(joints_rad)?))
    }

    /// Returns the frames of all links at these angles, in the base frame: each joint's, then the tool's.
    pub fn frames(&self, joints_rad: &[f64]) -> Result<Vec<Isometry3<f64>>, String> {
        let angles = self.angles(joints_rad)?;
        let links = self.links_at(&angles);
        let tool = links[self.last()] * self.last_from_tool;
        let links = links.into_iter().take(self.joints.len());
        Ok(links.chain([tool]).collect())
    }

    /// Returns the index of the last joint.
    pub(super) fn last(&self) -> usize {
        self.joints.len().saturating_sub(1)
    }

    /// Returns the angles of the chain's joints.
    pub(super) fn of_joints(&self, angles: &Angles) -> Vec<f64> {
        angles[..self.joints.len()].to_vec()
    }

    /// Returns one angle for each joint as an array; the error says which is no angle, or that there are more or fewer.
    pub(super) fn angles(&self, joints_rad: &[f64]) -> Result<Angles, String> {
        let (found, joints) = (joints_rad.len(), self.joints.len());
        if found != joints {
            return Err(format!(
                "`{found}` joint angles were given to an arm with `{joints}` joints"
            ));
        }
        let mut angles = Angles::default();
        angles[..joints].copy_from_slice(joints_rad);
        let is_angle = |angle: &f64| angle.is_finite() && angle.abs() <= MAX_ANGLE_RAD;
        match angles.iter().position(|angle| !is_angle(angle)) {
            Some(index) => Err(format!(
                "the angle `{}` of joint `{}` is not a valid angle",
                angles[index],
                index + 1
            )),
            None => Ok(angles),
        }
    }

    pub(super) fn tool_at(&self, angles: &Angles) -> Isometry3<f64> {
        self.links_at(angles)[self.last()] * self.last_from_tool
    }

    pub(super) fn links_at(&self, angles: &Angles) -> [Isometry3<f64>; MAX_JOINTS] {
        let mut frames = [Isometry3::identity(); MAX_JOINTS];
        let mut parent = Isometry3::identity();
        for ((joint, angle), frame) in self.joints.iter().zip(angles).zip(&mut frames) {
            parent *= joint.parent_from_joint_at_zero;
            parent.rotation *= about_z(*angle);
            *frame = parent;
        }
        frames
    }

    /// Returns the tool's pose, and the geometric Jacobian in the base frame: column `j` is the velocity of the tool's origin
    /// (m/s), then its angular velocity (rad/s), while joint `j` turns at 1 rad/s.
    pub(super) fn motion_at(&self, angles: &Angles) -> (Isometry3<f64>, Jacobian) {
        let links = self.links_at(angles);
        let tool = links[self.last()] * self.last_from_tool;
        let mut jacobian = Jacobian::zeros();
        for (index, link) in links.iter().take(self.joints.len()).enumerate() {
            let axis = link.rotation * Vector3::z();
            let arm = tool.translation.vector - link.translation.vector;
            let moved = axis.cross(&arm);
            let column = Vector6::new(moved.x, moved.y, moved.z, axis.x, axis.y, axis.z);
            jacobian.set_column(index, &column);
        }
        (tool, jacobian)
    }

    /// Returns by how much the last joint must turn so that the tool, now at `tool`, has the rotation of `target`; if
    /// their hands point in different directions, as close as that joint can bring them.
    pub(super) fn last_joint_between(&self, tool: &Isometry3<f64>, target: &Isometry3<f64>) -> f64 {
        let last_from_tool = self.last_from_tool.rotation;
        let between =
            last_from_tool * tool.rotation.inverse() * target.rotation * last_from_tool.inverse();
        2.0 * between.k.atan2(between.w)
    }

    /// Returns 1 if a positive angle of the first joint turns the arm positively about the base's z axis, otherwise -1.
    pub(super) fn first_turns(&self) -> f64 {
        let axis = self.joints[0].parent_from_joint_at_zero.rotation * Vector3::z();
        axis.z.signum()
    }

    /// Returns whether the first joint turns the arm about a vertical, so that the first link cannot come down.
    pub(crate) fn is_upright(&self) -> bool {
        let axis = self.joints[0].parent_from_joint_at_zero.rotation * Vector3::z();
        axis.xy().norm() < UPRIGHT
    }
}

pub(super) fn about_z(angle_rad: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle_rad)
}

/// Returns the angle plus the multiple of a full turn that brings it closest to `near`.
pub(super) fn nearest_turn(angle_rad: f64, near_rad: f64) -> f64 {
    angle_rad + TAU * ((near_rad - angle_rad) / TAU).round()
}

//! The driver of an arm with a hand. It verifies every motion by measurement.
//!
//! In: checked motions of the tool and hand openings. Out: the verified state of the arm, else an [`ArmError`]. A driver trusts no
//! action server: it measures where the arm is. [`PortArm`] drives an arm through a [`Port`](super::port::Port);
//! [`Limited`](super::limits::Limited) checks its motions.

mod error;
mod fingers;
mod goal;
mod port_arm;
mod readings;

pub use error::{ArmError, Deviation};

pub use port_arm::{Commands, PortArm};

use crate::kinematics::reach::Reach;
use crate::kinematics::tool_down::tool_down;
use crate::settings::Settings;
use nalgebra::{Isometry3, Point3};

/// The state of an arm, from recent readings.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmState {
    /// When the pose was taken, on the arm's clock, seconds.
    pub at_s: f64,
    /// Pose of the tool, `base_from_tool`.
    pub tool: Isometry3<f64>,
    /// Angles of the joints from the base to the hand, radians.
    pub joints_rad: Vec<f64>,
    /// Positions of the fingers, in the arm's own units.
    pub fingers: Vec<f64>,
}

impl ArmState {
    /// Returns the state of an arm that rests with its hand down at a point; the error says why it cannot be there.
    ///
    /// - `point`: the tool's, base frame, metres.
    pub fn hand_down(settings: &Settings, point: &Point3<f64>) -> Result<ArmState, String> {
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        Ok(ArmState {
            at_s: 0.0,
            tool: tool_down(point, turn_rad),
            joints_rad: Reach::tool_down(settings.chain(), turn_rad).check(point, &[])?,
            fingers: Vec::new(),
        })
    }
}

/// The commanded opening of the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Opening {
    /// Open the fingers.
    Open,
    /// Close them until they meet or are blocked.
    Closed,
}

/// What the closed fingers hold, judged by where they stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandContents {
    /// They stopped before they met: something is between them.
    Something,
    /// They met: the hand is empty.
    Nothing,
    /// Their positions do not decide it.
    Unknown,
}

/// How a watch callback ends a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Halt {
    /// Pause: the arm stays enabled. Finger motions, and a tool close to its target, run to their end.
    Pause,
    /// End the motion and stop the arm.
    Stop(ArmError),
}

/// A callback that gets each state while an arm moves, and may end the motion.
pub type Watch<'w> = dyn FnMut(&ArmState) -> Result<(), Halt> + 'w;

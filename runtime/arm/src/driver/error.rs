//! Errors of an arm driver, and the deviation of a tool from its target.

use crate::port::PortError;
use nalgebra::Isometry3;
use std::fmt;

/// How far a tool is from its target pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Distance, metres.
    pub position_m: f64,
    /// Angle of the rotation between the two poses, radians.
    pub angle_rad: f64,
}

impl Deviation {
    /// Compares two poses.
    pub fn between(a: &Isometry3<f64>, b: &Isometry3<f64>) -> Deviation {
        Deviation {
            position_m: (a.translation.vector - b.translation.vector).norm(),
            angle_rad: a.rotation.angle_to(&b.rotation),
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} mm and {:.1} degrees",
            self.position_m * 1000.0,
            self.angle_rad.to_degrees()
        )
    }
}

/// Why an arm did not execute a command, or cannot take one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// The arm is stopped.
    #[error(
        "the arm is stopped and refuses motion; find out why, then let it go with `fabc robot recover --robot FILE`"
    )]
    Stopped,
    /// The tool came to rest away from its target, and the arm takes goals. The caller may send the motion again from
    /// where the tool is now, after the same checks as before.
    #[error("{0}")]
    Short(String),
    /// A motion was not done, or the arm cannot be driven.
    #[error("{0}")]
    Failed(String),
    /// A motion would violate a limit, so it was not started.
    #[error("not moved: {0}")]
    Refused(String),
    /// The arm violated a limit while it moved.
    #[error("stopped: {0}")]
    OutOfLimits(String),
    /// A stop was requested and is not verified: the arm may still move.
    #[error(
        "the arm was told to stop, and the stop could not be verified: use the physical stop ({0})"
    )]
    NotStopped(String),
    /// A motion was paused, and the arm is at rest.
    #[error("paused")]
    Paused,
    /// The supervisor did not confirm the motion.
    #[error("not confirmed")]
    NotConfirmed,
    /// The user interrupted the program.
    #[error("interrupted")]
    Interrupted,
    /// A motion was executed and verified, but its journal entry cannot be written.
    #[error(
        "the motion was executed and verified, but the arm's journal can no longer be written: {0}"
    )]
    JournalAfterMotion(String),
    /// The journal entry before a motion cannot be written, so the motion was not started.
    #[error("not moved: the arm's journal cannot be written: {0}")]
    JournalBeforeMotion(String),
    /// This program panicked while the arm moved.
    #[error("this program panicked while the arm moved, which is a bug: {0}")]
    Panicked(String),
}

impl ArmError {
    /// A goal did not end within its time limit, seconds.
    pub(super) fn timed_out(after_s: f64) -> ArmError {
        ArmError::Failed(format!("the motion did not end within `{after_s:.1}` s"))
    }
}

impl From<PortError> for ArmError {
    fn from(error: PortError) -> ArmError {
        ArmError::Failed(error.to_string())
    }
}

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
    /// The arm has published no reading lately.
    #[error(
        "the arm has not reported for `{for_s:.1}` s where its {what}; its driver or the network may be down"
    )]
    Silent {
        /// `tool is`, `joints are` or `fingers are`.
        what: &'static str,
        /// For how long, seconds.
        for_s: f64,
    },
    /// The arm is stopped.
    #[error(
        "the arm is stopped and refuses motion; find out why, then let it go with `fabc robot recover --robot FILE`"
    )]
    Stopped,
    /// The tool came to rest away from its target.
    #[error("the arm reported `{reported}`, but its tool is {deviation} from its target")]
    NotReached {
        /// The outcome that the arm's node reported.
        reported: &'static str,
        /// How far the tool is from the target.
        deviation: Deviation,
    },
    /// The tool came to rest away from its target, and the arm takes goals. The caller may send the motion again from
    /// where the tool is now, after the same checks as before.
    #[error("the arm reported `{reported}`, but its tool is {deviation} from its target")]
    Short {
        /// The outcome that the arm's node reported.
        reported: &'static str,
        /// How far the tool is from the target.
        deviation: Deviation,
    },
    /// The arm stalled during a motion.
    #[error("the arm stalled {deviation} before its goal: something may be in its way")]
    Stalled {
        /// How far the tool is from the target.
        deviation: Deviation,
    },
    /// A goal did not end within its time limit.
    #[error("the motion did not end within `{after_s:.1}` s")]
    TimedOut {
        /// How long the driver waited, seconds.
        after_s: f64,
    },
    /// The fingers did not reach their target.
    #[error("the fingers are at {found} and should be at `{target}`")]
    Fingers {
        /// Their measured positions, as text.
        found: String,
        /// Their target position, in the node's units.
        target: f64,
    },
    /// A motion would violate a limit, so it was not started.
    #[error("not moved: {0}")]
    Refused(String),
    /// The arm violated a limit while it moved.
    #[error("stopped: {0}")]
    OutOfLimits(String),
    /// Inverse kinematics found no joint path to the target.
    #[error("there is no joint path to the target: {0}")]
    NoPath(String),
    /// A message could not be sent, or a service did not answer.
    #[error(transparent)]
    Port(#[from] PortError),
    /// A stop was requested, nothing acknowledged it, and the arm may still move.
    #[error("the arm was told to stop, and nothing acknowledged it: use the physical stop ({why})")]
    StopNotAcknowledged {
        /// What became of the request.
        why: String,
    },
    /// A stop was acknowledged, and the arm may still move.
    #[error(
        "the arm was told to stop, but the stop could not be verified: use the physical stop ({why})"
    )]
    NotStopped {
        /// Why the stop is not verified.
        why: String,
    },
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
    /// The watchdog does not answer, so nothing may move.
    #[error("the watchdog does not answer: {0}")]
    Watchdog(String),
}

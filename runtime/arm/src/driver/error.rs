//! Why an arm did not do what it was asked for.

use crate::port::PortError;
use nalgebra::Isometry3;
use std::fmt;

/// How far a tool is from where it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// Distance, metres.
    pub position_m: f64,
    /// Angle of the turn between the two, radians.
    pub angle_rad: f64,
}

impl Off {
    /// Compares two poses.
    pub fn between(a: &Isometry3<f64>, b: &Isometry3<f64>) -> Off {
        Off {
            position_m: (a.translation.vector - b.translation.vector).norm(),
            angle_rad: a.rotation.angle_to(&b.rotation),
        }
    }
}

impl fmt::Display for Off {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} mm and {:.1} degrees",
            self.position_m * 1000.0,
            self.angle_rad.to_degrees()
        )
    }
}

/// Why an arm did not do what it was asked for, or cannot be asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// The arm has said nothing of itself lately.
    #[error(
        "the arm has not said for `{for_s:.1}` s where its {what}; its driver or the network may be down"
    )]
    Silent {
        /// `tool is`, `joints are` or `fingers are`.
        what: &'static str,
        /// For how long, seconds.
        for_s: f64,
    },
    /// The arm is stopped.
    #[error(
        "the arm is stopped and takes no motion; look why, and let it go with `fabc robot enable`"
    )]
    Stopped,
    /// The tool came to rest elsewhere.
    #[error("the arm says `{said}`, and its tool is {off} from where it was sent")]
    NotThere {
        /// How the arm's node ended the goal.
        said: String,
        /// How far.
        off: Off,
    },
    /// The arm came to a stop on its way.
    #[error("the arm stalled {off} before its goal: something may be in its way")]
    Stalled {
        /// How far from the goal.
        off: Off,
    },
    /// A goal was still not over in time.
    #[error("the arm was not done after `{after_s:.1}` s")]
    Late {
        /// How long was waited, seconds.
        after_s: f64,
    },
    /// The fingers did not do what they were asked for.
    #[error("the fingers are at {found} and should be at `{wanted}`")]
    Fingers {
        /// Where they are, as text.
        found: String,
        /// Where they should be.
        wanted: f64,
    },
    /// A motion would leave its limits, and was not begun.
    #[error("not moved: {0}")]
    Refused(String),
    /// The arm left its limits.
    #[error("stopped: {0}")]
    OutOfLimits(String),
    /// The joints cannot bring the tool there.
    #[error("no motion of the joints leads there: {0}")]
    NoWay(String),
    /// A message could not be sent, or a service gave no answer.
    #[error(transparent)]
    Port(#[from] PortError),
    /// A stop was asked for, and the arm may move yet.
    #[error(
        "the arm was told to stop, and it could not be verified that it did: use the physical stop ({why})"
    )]
    NotStopped {
        /// What is known.
        why: String,
    },
    /// A motion was ended for now, and the arm is at rest.
    #[error("paused")]
    Paused,
    /// The person who watches said no.
    #[error("not confirmed")]
    NotConfirmed,
    /// The program was asked to end.
    #[error("interrupted")]
    Interrupted,
    /// A motion was carried out and verified, and that cannot be written.
    #[error("moved and verified, but the journal of the arm cannot be written any more: {0}")]
    Unwritten(String),
    /// The journal of the motion cannot be written, so that nothing may move.
    #[error("not moved, since the journal of the arm cannot be written: {0}")]
    Journal(String),
    /// This program broke while the arm moved.
    #[error("this program broke while the arm moved, which is a mistake in it: {0}")]
    Panicked(String),
    /// The watchdog is gone, so that nothing may move.
    #[error("the watchdog does not answer: {0}")]
    Watchdog(String),
}

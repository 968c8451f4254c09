//! What motion is planned for: an arm with a hand, whose every word is doubted.
//!
//! In: poses of the tool, openings of the hand. Out: the state in which the arm verifiedly is, else an [`ArmError`] that
//! says what is known. A driver believes no server: it looks where the arm is. [`PortArm`] drives what a
//! [`Port`](super::port::Port) reaches; [`Limited`](super::limits::Limited) goes around any arm.

mod carry;
mod error;
mod fingers;
mod look;
mod pause;
pub mod resting;
mod tool;
mod way;

pub use error::{ArmError, Off};
pub use tool::PortArm;

use nalgebra::Isometry3;

/// What an arm says of itself, all of it heard lately.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmState {
    /// When the pose was heard, on the arm's clock, seconds.
    pub at_s: f64,
    /// Pose of the tool, `base_from_tool`.
    pub tool: Isometry3<f64>,
    /// Angles of the joints from the base to the hand, radians; empty where the arm does not say.
    pub joints_rad: Vec<f64>,
    /// Positions of the fingers, in the arm's own units.
    pub fingers: Vec<f64>,
}

/// What the hand is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Opening {
    /// Open the fingers.
    Open,
    /// Close them, as far as what is between them lets.
    Closed,
}

/// What is between fingers that were closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// They stopped before they met: something is there.
    Something,
    /// They met: nothing is.
    Nothing,
    /// Their positions do not tell.
    Unknown,
}

/// Why a motion is not to go on.
#[derive(Clone, Debug, PartialEq)]
pub enum Halt {
    /// It is to end for now; the arm stays enabled. Fingers, and a tool that is almost there, go on to their end.
    Pause,
    /// It is to end, and the arm to be stopped.
    Stop(ArmError),
}

/// Is shown each state while an arm moves, and may end the motion.
pub type Watch<'w> = dyn FnMut(&ArmState) -> Result<(), Halt> + 'w;

/// An arm with a hand.
///
/// Nothing that is stopped moves again before [`Arm::enable`], which nothing here calls by itself. An error of
/// [`Arm::move_tool`] or [`Arm::move_fingers`] says nothing of whether the arm is at rest, but for [`ArmError::Paused`]:
/// whoever gets another stops it.
pub trait Arm {
    /// Returns its name, e.g. `j2n6s200`.
    fn name(&self) -> String;

    /// Returns the time of a clock that never goes back, seconds.
    fn now_s(&self) -> f64;

    /// Lets time pass.
    fn wait(&mut self, seconds: f64);

    /// Returns what the arm says of itself; fails where it said nothing lately.
    fn state(&mut self) -> Result<ArmState, ArmError>;

    /// Brings the tool to a pose, in a straight line, and verifies that it is there and at rest.
    ///
    /// - `to`: `base_from_tool`.
    /// - `speed_m_s`: how fast at the most; an arm whose node takes no speed is watched only.
    fn move_tool(
        &mut self,
        to: &Isometry3<f64>,
        speed_m_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError>;

    /// Opens or closes the hand, and says what is between the fingers.
    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<Between, ArmError>;

    /// Stops the arm and verifies that it takes no motion any more.
    fn stop(&mut self) -> Result<(), ArmError>;

    /// Lets a stopped arm move again: only where a person said so.
    fn enable(&mut self) -> Result<(), ArmError>;
}

impl<A: Arm + ?Sized> Arm for Box<A> {
    fn name(&self) -> String {
        (**self).name()
    }

    fn now_s(&self) -> f64 {
        (**self).now_s()
    }

    fn wait(&mut self, seconds: f64) {
        (**self).wait(seconds);
    }

    fn state(&mut self) -> Result<ArmState, ArmError> {
        (**self).state()
    }

    fn move_tool(
        &mut self,
        to: &Isometry3<f64>,
        speed_m_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        (**self).move_tool(to, speed_m_s, watch)
    }

    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<Between, ArmError> {
        (**self).move_fingers(opening, watch)
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        (**self).stop()
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        (**self).enable()
    }
}

//! An arm that stays in one pose and refuses motion. Plans are made for it.

use super::{Arm, ArmError, ArmState, HandContents, Opening, Watch};
use crate::guard::{Checked, Motion};
use nalgebra::Isometry3;

/// An arm that is parked at a pose. No hardware is connected, so nothing can move.
pub struct ParkedArm {
    at: Isometry3<f64>,
}

impl ParkedArm {
    /// Parks an arm at a pose, `base_from_tool`.
    pub fn at(at: Isometry3<f64>) -> ParkedArm {
        ParkedArm { at }
    }

    fn refusal() -> ArmError {
        ArmError::Refused("a plan is made, and nothing moves".to_owned())
    }
}

impl Arm for ParkedArm {
    fn now_s(&self) -> f64 {
        0.0
    }

    fn wait(&mut self, _: f64) {}

    fn state(&mut self) -> Result<ArmState, ArmError> {
        Ok(ArmState {
            at_s: self.now_s(),
            tool: self.at,
            joints_rad: Vec::new(),
            fingers: Vec::new(),
        })
    }

    fn ready(&mut self, _: &mut Watch<'_>) -> Result<(), ArmError> {
        Err(ParkedArm::refusal())
    }

    fn move_tool(&mut self, _: &Checked<Motion>, _: &mut Watch<'_>) -> Result<ArmState, ArmError> {
        Err(ParkedArm::refusal())
    }

    fn move_fingers(&mut self, _: Opening, _: &mut Watch<'_>) -> Result<HandContents, ArmError> {
        Err(ParkedArm::refusal())
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        Ok(())
    }
}

//! An arm at rest that takes no motion: what plans are made for.

use super::{Arm, ArmError, ArmState, Between, Opening, Watch};
use nalgebra::Isometry3;
use std::time::{Duration, Instant};

/// An arm that stays where it is: nothing is connected to it, so that nothing can move.
pub struct Resting {
    model: String,
    at: Isometry3<f64>,
    since: Instant,
}

impl Resting {
    /// Takes an arm of a model to rest at a pose, `base_from_tool`.
    pub fn at(model: &str, at: Isometry3<f64>) -> Resting {
        Resting {
            model: model.to_owned(),
            at,
            since: Instant::now(),
        }
    }

    fn refusal() -> ArmError {
        ArmError::Refused("a plan is made, and nothing moves".to_owned())
    }
}

impl Arm for Resting {
    fn name(&self) -> String {
        self.model.clone()
    }

    fn now_s(&self) -> f64 {
        self.since.elapsed().as_secs_f64()
    }

    fn wait(&mut self, seconds: f64) {
        if let Ok(time) = Duration::try_from_secs_f64(seconds) {
            std::thread::sleep(time);
        }
    }

    fn state(&mut self) -> Result<ArmState, ArmError> {
        Ok(ArmState {
            at_s: self.now_s(),
            tool: self.at,
            joints_rad: Vec::new(),
            fingers: Vec::new(),
        })
    }

    fn move_tool(
        &mut self,
        _: &Isometry3<f64>,
        _: f64,
        _: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        Err(Resting::refusal())
    }

    fn move_fingers(&mut self, _: Opening, _: &mut Watch<'_>) -> Result<Between, ArmError> {
        Err(Resting::refusal())
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        Ok(())
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        Err(Resting::refusal())
    }
}

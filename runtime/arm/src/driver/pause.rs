//! Ends a goal for now, without lifting a stop that somebody pressed.
//!
//! kinova-ros answers a cancellation by stopping the arm and starting it again, and looks whether it was cancelled before it
//! looks whether it is stopped: a stop pressed in the tenth of a second before is lifted, and nothing says so. So a goal
//! that is over in a moment is left to end by itself, and of any other the tool must have been seen to go on until the
//! cancellation was sent. Where it came to rest before, the arm is taken for stopped. A stop that is pressed while the
//! cancellation is on its way cannot be told from it; the arm is at rest then until a person lets it go on.

use super::look::{LOOK_S, come_to_rest, looked_at};
use super::{ArmError, ArmState, Off, Watch};
use crate::port::{Ending, Goal, GoalId, GoalState, Port};
use crate::settings::Tolerance;
use nalgebra::Vector3;

/// The tool's way to its goal that is left to be gone, metres: at the speeds that are allowed a few looks of the node.
const NEAR_M: f64 = 0.02;

/// The same for the joints of a trajectory, radians.
const NEAR_RAD: f64 = 0.04;

/// The longest that a goal is left to end by itself, seconds: a hand closes in one or two.
const LET_END_S: f64 = 3.0;

/// The longest to wait until the tool is seen to move evenly, seconds: a goal takes effect within 0.15 s, and then three
/// readings are needed.
const EVEN_S: f64 = 0.6;

/// How long a cancellation may take before it counts as lost, seconds, and how often it is sent.
const CANCEL_S: f64 = 0.5;
const CANCELS: u32 = 3;

/// A tool slower than this is not seen to move, m/s.
const SLOW_M_S: f64 = 0.01;

/// How much earlier than the cancellation the tool may seem to have come to rest, seconds: readings are 1 mm exact.
const SLACK_S: f64 = 0.012;

/// The last readings of the tool's place while a goal is carried out.
#[derive(Clone, Debug, Default)]
pub(super) struct Track(Vec<(f64, Vector3<f64>)>);

impl Track {
    pub(super) fn look(&mut self, state: &ArmState) {
        if self.0.last().is_none_or(|(at_s, _)| state.at_s > *at_s) {
            self.0.push((state.at_s, state.tool.translation.vector));
        }
        if self.0.len() > 3 {
            self.0.remove(0);
        }
    }

    /// Returns until when the tool went on if it came to rest at a place, seconds; none where it was not seen to move
    /// evenly: the first of three readings may be from before the motion.
    fn went_on_until_s(&self, rest: &Vector3<f64>) -> Option<f64> {
        let [first, second, third] = self.0.as_slice() else {
            return None;
        };
        let speed_m_s = |from: &(f64, Vector3<f64>), to: &(f64, Vector3<f64>)| {
            (to.1 - from.1).norm() / (to.0 - from.0)
        };
        let lately_m_s = speed_m_s(second, third);
        if speed_m_s(first, second) < SLOW_M_S || lately_m_s < SLOW_M_S {
            return None;
        }
        Some(third.0 + (rest - third.1).norm() / lately_m_s)
    }

    fn is_even(&self) -> bool {
        let last = self.0.last().map(|(_, place)| *place);
        last.is_some_and(|place| self.went_on_until_s(&place).is_some())
    }
}

/// Ends a goal that was sent; returns [`ArmError::Paused`] where the arm is verified to be at rest and as enabled as it was.
pub(super) fn pause<P: Port>(
    port: &mut P,
    goal: &Goal,
    id: &GoalId,
    mut track: Track,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> ArmError {
    match end(port, goal, id, &mut track, tolerance, watch) {
        Ok(()) => ArmError::Paused,
        Err(why) => why,
    }
}

fn end<P: Port>(
    port: &mut P,
    goal: &Goal,
    id: &GoalId,
    track: &mut Track,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<(), ArmError> {
    let asked_s = port.now_s();
    loop {
        let state = looked_at(port, tolerance, watch)?;
        track.look(&state);
        let for_s = port.now_s() - asked_s;
        let is_waited_for = match ends_soon(goal, &state) {
            true => for_s < LET_END_S,
            false => for_s < EVEN_S && !track.is_even(),
        };
        if let GoalState::Ended(_) = port.state(id) {
            return come_to_rest(port, tolerance, watch).map(drop);
        }
        if !is_waited_for {
            break;
        }
        port.wait(LOOK_S);
    }
    let cancelled_s = port.now_s();
    let ending = cancel(port, id, tolerance, watch)?;
    let rest = come_to_rest(port, tolerance, watch)?;
    let went_on_until_s = track.went_on_until_s(&rest.tool.translation.vector);
    let went_on = went_on_until_s.is_some_and(|until_s| until_s >= cancelled_s - SLACK_S);
    match ending {
        // The only ending by which the node starts a stopped arm.
        Ending::Preempted if !went_on => {
            // Whoever gets this error stops the arm and verifies it; this is to lose no time.
            let _ = port.stop();
            Err(ArmError::Stopped)
        }
        _ => Ok(()),
    }
}

/// Cancels a goal until its server says that it is over.
fn cancel<P: Port>(
    port: &mut P,
    id: &GoalId,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<Ending, ArmError> {
    let begun_s = port.now_s();
    for _ in 0..CANCELS {
        port.cancel(id)?;
        let sent_s = port.now_s();
        while port.now_s() - sent_s < CANCEL_S {
            port.wait(LOOK_S);
            looked_at(port, tolerance, watch)?;
            if let GoalState::Ended(ending) = port.state(id) {
                return Ok(ending);
            }
        }
    }
    Err(ArmError::Late {
        after_s: port.now_s() - begun_s,
    })
}

/// Tells whether a goal is over in a moment by itself.
fn ends_soon(goal: &Goal, state: &ArmState) -> bool {
    let off = |joints_rad: &[f64]| match state.joints_rad.len() == joints_rad.len() {
        true => {
            let off = joints_rad.iter().zip(&state.joints_rad);
            off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        }
        // Nothing was heard of them lately.
        false => f64::INFINITY,
    };
    match goal {
        Goal::Fingers(_) => true,
        Goal::ToolPose(pose) => Off::between(pose, &state.tool).position_m < NEAR_M,
        Goal::JointAngles(joints_rad) => off(joints_rad) < NEAR_RAD,
        Goal::Trajectory(points) => points
            .last()
            .is_some_and(|last| off(&last.joints_rad) < NEAR_RAD),
    }
}

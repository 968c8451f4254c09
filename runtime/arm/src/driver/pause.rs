//! Pauses a goal without releasing a stop that somebody pressed.
//!
//! kinova-ros handles a cancellation by stopping the arm and starting it again, and it checks for a cancellation before
//! it checks for a stop. A stop pressed up to 0.1 s before the cancellation is therefore released, and nothing reports
//! it. So a goal that is almost done runs to its end. Any other goal is cancelled, and the tool must have kept moving
//! until the cancellation was sent; if it came to rest earlier, the arm counts as stopped. A stop that is pressed while
//! the cancellation is in transit looks the same as the cancellation; the arm then rests until a person resumes the
//! motion.

use super::goal::Goal;
use super::state::{POLL_S, REST_M, wait_until_at_rest, watched_state};
use super::{ArmError, ArmState, Deviation, Watch};
use crate::port::{Ending, GoalId, GoalState, Port};
use crate::settings::Tolerance;
use nalgebra::Vector3;

/// A tool this close to its target is left to arrive, metres: a few cycles of the node at the allowed speeds.
const NEAR_M: f64 = 0.02;

/// The same for the joints of a trajectory, radians.
const NEAR_RAD: f64 = 0.04;

/// How long a goal may take to end by itself, seconds: a hand closes in one or two.
const LET_END_S: f64 = 3.0;

/// How long to wait for steady motion, seconds: a goal takes effect within 0.15 s, and then three readings are needed.
const EVEN_S: f64 = 0.6;

/// How long a cancellation may take before it counts as lost, seconds, and how often it is sent.
const CANCEL_S: f64 = 0.5;
const CANCELS: u32 = 3;

/// A tool slower than this counts as not moving, m/s.
const SLOW_M_S: f64 = 0.01;

/// How long before the cancellation the tool may appear to have come to rest, seconds: readings have 1 mm resolution.
const SLACK_S: f64 = 0.012;

/// The last readings of the tool's position during a goal.
#[derive(Clone, Debug, Default)]
pub(super) struct Track(Vec<(f64, Vector3<f64>)>);

impl Track {
    pub(super) fn record(&mut self, state: &ArmState) {
        if self.0.last().is_none_or(|(at_s, _)| state.at_s > *at_s) {
            self.0.push((state.at_s, state.tool.translation.vector));
        }
        if self.0.len() > 3 {
            self.0.remove(0);
        }
    }

    /// Returns the time until which the tool moved if it came to rest at `rest`, seconds. `None` without steady motion:
    /// the first of three readings may be from before the motion.
    fn moved_until_s(&self, rest: &Vector3<f64>) -> Option<f64> {
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

    /// Returns whether the last three readings agree.
    pub(super) fn is_at_rest(&self) -> bool {
        let [first, .., last] = self.0.as_slice() else {
            return false;
        };
        self.0.len() == 3 && (last.1 - first.1).norm() < REST_M
    }

    fn is_even(&self) -> bool {
        let last = self.0.last().map(|(_, place)| *place);
        last.is_some_and(|place| self.moved_until_s(&place).is_some())
    }
}

/// Ends a running goal. Returns [`ArmError::Paused`] if the arm is verified to be at rest and its stop state is
/// unchanged.
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
        let state = watched_state(port, tolerance, watch)?;
        track.record(&state);
        let for_s = port.now_s() - asked_s;
        let keep_waiting = match ends_soon(goal, &state) {
            true => for_s < LET_END_S,
            false => for_s < EVEN_S && !track.is_even(),
        };
        if let GoalState::Ended(_) = port.goal(id) {
            return wait_until_at_rest(port, tolerance, watch).map(drop);
        }
        if !keep_waiting {
            break;
        }
        port.wait(POLL_S);
    }
    let cancelled_s = port.now_s();
    let ending = cancel(port, id, tolerance, watch)?;
    let rest = wait_until_at_rest(port, tolerance, watch)?;
    let moved_until_s = track.moved_until_s(&rest.tool.translation.vector);
    let kept_moving = moved_until_s.is_some_and(|until_s| until_s >= cancelled_s - SLACK_S);
    match ending {
        // Only with this ending does the node start a stopped arm.
        Ending::Preempted if !kept_moving => {
            // The caller stops the arm and verifies it; stopping here loses no time.
            let _ = port.stop();
            Err(ArmError::Stopped)
        }
        _ => Ok(()),
    }
}

/// Cancels a goal until its server reports an end.
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
            port.wait(POLL_S);
            watched_state(port, tolerance, watch)?;
            if let GoalState::Ended(ending) = port.goal(id) {
                return Ok(ending);
            }
        }
    }
    Err(ArmError::TimedOut {
        after_s: port.now_s() - begun_s,
    })
}

/// Returns whether a goal is about to end by itself.
fn ends_soon(goal: &Goal, state: &ArmState) -> bool {
    let deviation = |joints_rad: &[f64]| match state.joints_rad.len() == joints_rad.len() {
        true => {
            let pairs = joints_rad.iter().zip(&state.joints_rad);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        }
        // There is no recent reading of the joints.
        false => f64::INFINITY,
    };
    match goal {
        Goal::Fingers(_) => true,
        Goal::Pose(pose) => Deviation::between(pose.get(), &state.tool).position_m < NEAR_M,
        Goal::Trajectory(points) => points
            .get()
            .last()
            .is_some_and(|last| deviation(&last.joints_rad) < NEAR_RAD),
    }
}

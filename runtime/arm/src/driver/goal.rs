//! Executes one goal: sends it, watches the arm, and returns how the goal ended.
//!
//! In: a goal, a time limit, a watch callback. Out: the server's terminal status, or a timeout. A goal that no server
//! acknowledges may have been lost, so it is sent again, but only while the arm rests where the goal begins.

use super::pause::{Track, pause};
use super::state::{POLL_S, REST_M, state};
use super::{ArmError, Deviation, Halt, Watch};
use crate::guard::Checked;
use crate::port::{Ending, GoalId, GoalState, Port, PortError, Waypoint};
use crate::settings::Tolerance;
use nalgebra::Isometry3;

/// How long a server may take to accept a goal before it counts as lost, seconds.
const ACCEPT_S: f64 = 1.0;

/// How often an unacknowledged goal is sent again.
const RESENDS: u32 = 2;

/// A goal for one of the arm's servers. Only checked motions can be one.
#[derive(Debug, PartialEq)]
pub(crate) enum Goal {
    /// Move the tool to a pose, `base_from_tool`.
    Pose(Checked<Isometry3<f64>>),
    /// Move the joints through these points.
    Trajectory(Checked<Vec<Waypoint>>),
    /// Move the fingers to these positions, in the arm's own units.
    Fingers(Vec<f64>),
}

impl Goal {
    /// Sends the goal. Nothing else in this program makes an arm move.
    pub(super) fn send<P: Port>(&self, port: &mut P) -> Result<GoalId, PortError> {
        match self {
            Goal::Pose(tool) => port.send_pose(tool.get()),
            Goal::Trajectory(points) => port.send_trajectory(points.get()),
            Goal::Fingers(positions) => port.send_fingers(positions),
        }
    }

    /// Sends the goal once more, in place of one that was not acknowledged. A trajectory that arrives late would be
    /// under way when the second one arrives and leads back to its start, so it is cancelled first. Poses and fingers
    /// go to their target from anywhere, and a cancellation would make kinova-ros enable a stopped arm.
    fn send_again<P: Port>(&self, port: &mut P, before: &GoalId) -> Result<GoalId, PortError> {
        if let Goal::Trajectory(_) = self {
            port.cancel(before)?;
        }
        self.send(port)
    }
}

/// How a goal ended, as far as the server reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The server reported this status.
    Ended(Ending),
    /// The arm moved and came to rest, and the server reported nothing.
    Unreported,
    /// The time limit passed without a terminal status.
    TimedOut,
}

impl Outcome {
    /// Returns the outcome as errors print it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Outcome::Ended(Ending::Succeeded) => "reached",
            Outcome::Ended(Ending::Preempted) => "given up",
            Outcome::Ended(Ending::Aborted) => "aborted",
            Outcome::Ended(Ending::Rejected) => "refused",
            Outcome::Unreported | Outcome::TimedOut => "nothing",
        }
    }
}

/// Sends a goal and waits for its end, at most `limit_s` seconds.
///
/// Returns [`Outcome::TimedOut`] if no end was reported by then. After [`ArmError::Paused`] the arm is at rest.
///
/// - `sent`: set to the id that was sent last.
pub(super) fn execute<P: Port>(
    port: &mut P,
    goal: &Goal,
    limit_s: f64,
    tolerance: &Tolerance,
    sent: &mut Option<GoalId>,
    watch: &mut Watch<'_>,
) -> Result<Outcome, ArmError> {
    let begun_s = port.now_s();
    let mut sent_s = begun_s;
    let mut resends = 0;
    let mut track = Track::default();
    let begun_at = state(port, tolerance)?.tool;
    let mut id = goal.send(port)?;
    *sent = Some(id.clone());
    loop {
        port.wait(POLL_S);
        let now_s = port.now_s();
        let state = state(port, tolerance)?;
        track.record(&state);
        match watch(&state) {
            Ok(()) => {}
            Err(Halt::Pause) => return Err(pause(port, goal, &id, track, tolerance, watch)),
            Err(Halt::Stop(why)) => return Err(why),
        }
        match port.goal(&id) {
            GoalState::Ended(ending) => return Ok(Outcome::Ended(ending)),
            GoalState::Sent if now_s - sent_s > ACCEPT_S => {
                // An arm that has moved has taken the goal: only its status was lost.
                let has_moved = Deviation::between(&begun_at, &state.tool).position_m > REST_M;
                if has_moved && track.is_at_rest() {
                    return Ok(Outcome::Unreported);
                }
                if !has_moved && resends < RESENDS {
                    resends += 1;
                    sent_s = now_s;
                    id = goal.send_again(port, &id)?;
                    *sent = Some(id.clone());
                }
            }
            GoalState::Sent | GoalState::Active => {}
        }
        if now_s - begun_s > limit_s {
            return Ok(Outcome::TimedOut);
        }
    }
}

//! Executes one goal: sends it, watches the arm, and returns how the goal ended.
//!
//! In: a goal, a time limit, a watch callback. Out: the server's terminal status, or a timeout. A goal that no server
//! acknowledges may have been lost, so it is sent again; goals are absolute poses, so resending is idempotent.

use super::pause::{Track, pause};
use super::state::{POLL_S, state};
use super::{ArmError, Halt, Watch};
use crate::port::{Ending, Goal, GoalId, GoalState, Port};
use crate::settings::Tolerance;

/// How long a server may take to accept a goal before it counts as lost, seconds.
const ACCEPT_S: f64 = 1.0;

/// How often an unacknowledged goal is sent again.
const RESENDS: u32 = 2;

/// How a goal ended, as far as the server reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The server reported this status.
    Ended(Ending),
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
            Outcome::TimedOut => "nothing",
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
    let mut id = port.send(goal)?;
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
        match port.state(&id) {
            GoalState::Ended(ending) => return Ok(Outcome::Ended(ending)),
            GoalState::Sent if now_s - sent_s > ACCEPT_S && resends < RESENDS => {
                resends += 1;
                sent_s = now_s;
                id = port.send(goal)?;
                *sent = Some(id.clone());
            }
            GoalState::Sent | GoalState::Active => {}
        }
        if now_s - begun_s > limit_s {
            return Ok(Outcome::TimedOut);
        }
    }
}

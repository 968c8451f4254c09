//! Carries one goal out: sends it, watches the arm, and says how it ended.
//!
//! In: a goal, a time limit, somebody who watches. Out: the server's word, or that there was none. A goal of which
//! nothing is heard may have been lost and is sent again; it names a place and no way, so that twice is as once.

use super::look::{LOOK_S, state};
use super::pause::{Track, pause};
use super::{ArmError, Halt, Watch};
use crate::port::{Ending, Goal, GoalId, GoalState, Port};
use crate::settings::Tolerance;

/// How long a server may take to accept a goal before it counts as lost, seconds.
const ACCEPT_S: f64 = 1.0;

/// How often a goal is sent again that nobody took.
const RESENDS: u32 = 2;

/// What is heard of a goal at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word {
    /// The server's word.
    Ended(Ending),
    /// The time was up, and no server had said that it is over.
    None,
}

impl Word {
    /// Returns the word as errors print it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Word::Ended(Ending::Succeeded) => "reached",
            Word::Ended(Ending::Preempted) => "given up",
            Word::Ended(Ending::Aborted) => "aborted",
            Word::Ended(Ending::Rejected) => "refused",
            Word::None => "nothing",
        }
    }
}

/// Sends a goal and waits until it is over, at most `limit_s`.
///
/// Where nothing is heard of its end, the waiting ends all the same once the time is up. [`ArmError::Paused`] is of an arm
/// that came to rest.
///
/// - `sent`: becomes the goal that was sent last.
pub(super) fn carry_out<P: Port>(
    port: &mut P,
    goal: &Goal,
    limit_s: f64,
    tolerance: &Tolerance,
    sent: &mut Option<GoalId>,
    watch: &mut Watch<'_>,
) -> Result<Word, ArmError> {
    let begun_s = port.now_s();
    let mut sent_s = begun_s;
    let mut resends = 0;
    let mut track = Track::default();
    let mut id = port.send(goal)?;
    *sent = Some(id.clone());
    loop {
        port.wait(LOOK_S);
        let now_s = port.now_s();
        let state = state(port, tolerance)?;
        track.look(&state);
        match watch(&state) {
            Ok(()) => {}
            Err(Halt::Pause) => return Err(pause(port, goal, &id, track, tolerance, watch)),
            Err(Halt::Stop(why)) => return Err(why),
        }
        match port.state(&id) {
            GoalState::Ended(ending) => return Ok(Word::Ended(ending)),
            GoalState::Sent if now_s - sent_s > ACCEPT_S && resends < RESENDS => {
                resends += 1;
                sent_s = now_s;
                id = port.send(goal)?;
                *sent = Some(id.clone());
            }
            GoalState::Sent | GoalState::Active => {}
        }
        if now_s - begun_s > limit_s {
            return Ok(Word::None);
        }
    }
}

//! Carries one goal out: sends it, watches the arm, and says how it ended.
//!
//! In: a goal, a time limit, somebody who watches. Out: the server's word, or that there was none. A goal of which
//! nothing is heard may have been lost and is sent again; it names a place and no way, so that twice is as once.

use super::pause::{Track, pause};
use super::{ArmError, ArmState, Halt, Off, Watch};
use crate::port::{Ending, Goal, GoalId, GoalState, Heard, Port};
use crate::settings::Tolerance;

/// How often the arm is looked at, seconds.
pub(super) const LOOK_S: f64 = 0.05;

/// How long a server may take to accept a goal before it counts as lost, seconds.
const ACCEPT_S: f64 = 1.0;

/// How often a goal is sent again that nobody took.
const RESENDS: u32 = 2;

/// A tool that moves less than this between two looks is at rest, metres.
const REST_M: f64 = 0.000_5;

/// How far apart in time two such looks are, seconds: more than the 0.1 s between two reports of kinova-ros.
const REST_S: f64 = 0.25;

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

fn fresh<T>(
    heard: Option<Heard<T>>,
    what: &'static str,
    now_s: f64,
    stale_s: f64,
) -> Result<Heard<T>, ArmError> {
    let for_s = heard.as_ref().map_or(now_s, |heard| now_s - heard.at_s);
    heard
        .filter(|_| for_s <= stale_s)
        .ok_or(ArmError::Silent { what, for_s })
}

/// Returns what an arm says of itself, where that is not older than allowed; of its joints nothing where that is.
pub(super) fn state<P: Port>(port: &mut P, tolerance: &Tolerance) -> Result<ArmState, ArmError> {
    let now_s = port.now_s();
    let readings = port.readings();
    let tool = fresh(readings.tool, "tool is", now_s, tolerance.stale_s)?;
    let fingers = fresh(readings.fingers, "fingers are", now_s, tolerance.stale_s)?;
    let joints = fresh(readings.joints_rad, "joints are", now_s, tolerance.stale_s);
    let is_pose = tool
        .value
        .translation
        .vector
        .iter()
        .all(|value| value.is_finite())
        && tool
            .value
            .rotation
            .coords
            .iter()
            .all(|value| value.is_finite());
    if !is_pose {
        return Err(ArmError::OutOfLimits(
            "the arm says that its tool is at a place that is no number".to_owned(),
        ));
    }
    Ok(ArmState {
        at_s: tool.at_s,
        tool: tool.value,
        joints_rad: joints.map(|joints| joints.value).unwrap_or_default(),
        fingers: fingers.value,
    })
}

/// Returns the same, and fails where the arm has not said lately where its joints are.
pub(super) fn state_with_joints<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
) -> Result<ArmState, ArmError> {
    let joints = port.readings().joints_rad;
    let now_s = port.now_s();
    fresh(joints, "joints are", now_s, tolerance.stale_s)?;
    state(port, tolerance)
}

/// Looks at the arm and shows it to whoever watches, who may stop it; a wish to pause is left aside.
pub(super) fn looked_at<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    let state = state(port, tolerance)?;
    match watch(&state) {
        Ok(()) | Err(Halt::Pause) => Ok(state),
        Err(Halt::Stop(why)) => Err(why),
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

/// Waits until the tool is at rest; fails where it does not come to rest in time. A wish to pause is left aside.
pub(super) fn come_to_rest<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    let begun_s = port.now_s();
    let mut before = state(port, tolerance)?;
    while port.now_s() - begun_s <= tolerance.settle_s {
        port.wait(REST_S);
        let now = looked_at(port, tolerance, watch)?;
        // Only something that was said since tells of rest.
        if now.at_s > before.at_s {
            if Off::between(&now.tool, &before.tool).position_m < REST_M {
                return Ok(now);
            }
            before = now;
        }
    }
    Err(ArmError::Late {
        after_s: port.now_s() - begun_s,
    })
}

/// Tells whether the tool stays where it is for a while.
pub(super) fn is_at_rest<P: Port>(port: &mut P, tolerance: &Tolerance) -> Result<bool, ArmError> {
    let before = state(port, tolerance)?;
    port.wait(2.0 * REST_S);
    let after = state(port, tolerance)?;
    let moved_m = Off::between(&before.tool, &after.tool).position_m;
    Ok(after.at_s > before.at_s && moved_m < REST_M)
}

//! Reads an arm's state, and decides whether the arm is at rest.
//!
//! In: the port's readings with the times at which they were taken. Out: a state no older than `stale_s`, or the reading that is missing. The
//! arm is at rest when two readings agree; what a server reports is not trusted.

use super::{ArmError, ArmState, Deviation, Halt, Watch};
use crate::kinematics::inverse::is_pose;
use crate::port::{Port, Reading};
use crate::settings::Tolerance;

/// Interval between two polls of the arm, seconds.
pub(super) const POLL_S: f64 = 0.05;

/// A tool that moves less than this between two readings is at rest, metres.
pub(super) const REST_M: f64 = 0.000_5;

/// Time between those two readings, seconds: more than the 0.1 s between two messages of kinova-ros.
const REST_S: f64 = 0.25;

/// How long a motion may take beyond its time, seconds; an arm that stalls is noticed only after that.
pub(super) const SETTLE_S: f64 = 5.0;

fn fresh<T>(
    heard: Option<Reading<T>>,
    what: &'static str,
    now_s: f64,
    stale_s: f64,
) -> Result<Reading<T>, ArmError> {
    let for_s = heard.as_ref().map_or(now_s, |heard| now_s - heard.at_s);
    heard
        .filter(|_| for_s <= stale_s)
        .ok_or(ArmError::Silent { what, for_s })
}

/// Returns the arm's state. Fails on a stale tool or finger reading; stale joint angles are left empty.
pub(super) fn state<P: Port>(port: &mut P, tolerance: &Tolerance) -> Result<ArmState, ArmError> {
    let now_s = port.now_s();
    let readings = port.state();
    let tool = fresh(readings.tool, "tool is", now_s, tolerance.stale_s)?;
    let fingers = fingers(port, tolerance)?;
    let joints = fresh(readings.joints_rad, "joints are", now_s, tolerance.stale_s);
    if !is_pose(&tool.value) {
        return Err(ArmError::OutOfLimits(
            "the arm reports a tool position that is not finite".to_owned(),
        ));
    }
    Ok(ArmState {
        at_s: tool.at_s,
        tool: tool.value,
        joints_rad: joints.map(|joints| joints.value).unwrap_or_default(),
        fingers: fingers.value,
    })
}

/// Returns the last finger positions; fails on stale ones.
pub(super) fn fingers<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
) -> Result<Reading<Vec<f64>>, ArmError> {
    let (now_s, heard) = (port.now_s(), port.state().fingers);
    fresh(heard, "fingers are", now_s, tolerance.stale_s)
}

/// Returns the arm's state; stale joint angles are an error too.
pub(super) fn state_with_joints<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
) -> Result<ArmState, ArmError> {
    let joints = port.state().joints_rad;
    let now_s = port.now_s();
    fresh(joints, "joints are", now_s, tolerance.stale_s)?;
    state(port, tolerance)
}

/// Reads the state and passes it to the watch callback, which may stop the arm; a pause request is ignored.
pub(super) fn watched_state<P: Port>(
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

/// Waits under the watch callback; returns the state at the end.
pub(super) fn watched_wait<P: Port>(
    port: &mut P,
    seconds: f64,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    let begun_s = port.now_s();
    loop {
        port.wait(POLL_S);
        let state = watched_state(port, tolerance, watch)?;
        // A clock may count in steps that do not add up exactly.
        if port.now_s() - begun_s >= seconds - 1e-9 {
            return Ok(state);
        }
    }
}

/// Waits until the tool is at rest; fails after [`SETTLE_S`]. A pause request is ignored.
pub(super) fn wait_until_at_rest<P: Port>(
    port: &mut P,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<ArmState, ArmError> {
    let begun_s = port.now_s();
    let mut before = state(port, tolerance)?;
    while port.now_s() - begun_s <= SETTLE_S {
        let now = watched_wait(port, REST_S, tolerance, watch)?;
        // Only a new reading can show rest.
        if now.at_s > before.at_s {
            if Deviation::between(&now.tool, &before.tool).position_m < REST_M {
                return Ok(now);
            }
            before = now;
        }
    }
    Err(ArmError::TimedOut {
        after_s: port.now_s() - begun_s,
    })
}

/// Returns whether the tool stays in place for two rest intervals.
pub(super) fn is_at_rest<P: Port>(port: &mut P, tolerance: &Tolerance) -> Result<bool, ArmError> {
    let before = state(port, tolerance)?;
    port.wait(2.0 * REST_S);
    let after = state(port, tolerance)?;
    let moved_m = Deviation::between(&before.tool, &after.tool).position_m;
    Ok(after.at_s > before.at_s && moved_m < REST_M)
}

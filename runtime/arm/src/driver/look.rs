//! Looks where an arm is, and whether it is at rest.
//!
//! In: what is heard of an arm, with when it was heard. Out: a state that is not older than allowed, or what the arm was
//! silent of. Rest is what two looks agree on, since no server is believed.

use super::{ArmError, ArmState, Halt, Off, Watch};
use crate::port::{Heard, Port};
use crate::settings::Tolerance;

/// How often the arm is looked at, seconds.
pub(super) const LOOK_S: f64 = 0.05;

/// A tool that moves less than this between two looks is at rest, metres.
const REST_M: f64 = 0.000_5;

/// How far apart in time two such looks are, seconds: more than the 0.1 s between two reports of kinova-ros.
const REST_S: f64 = 0.25;

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

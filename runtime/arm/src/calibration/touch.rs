//! The tool's position after a person has guided it to a point.
//!
//! In: the arm's readings over a moment. Out: the tool's position, or why it cannot be used: there is no new reading,
//! the arm still moves, or the hand is tilted. The arm is not moved.

use crate::kinematics::inverse::is_pose;
use crate::port::{Port, Reading};
use nalgebra::{Isometry3, Vector3};

/// How long the arm is observed, seconds: kinova-ros publishes ten times a second.
const LOOK_S: f64 = 0.5;

/// Time between two polls, seconds.
const STEP_S: f64 = 0.05;

/// A tool that moves farther than this in that time is not at rest, metres.
const REST_M: f64 = 0.000_5;

/// How far the hand may be tilted from straight down, degrees. The tool's point is at the last joints of closed fingers
/// (kinova_description: 0.115 m to the fingers' first joint plus 0.044 m, of 0.160 m). The fingertip beyond it is about
/// as long as the link before it, so 4 degrees of tilt move it by 3 mm on the table.
const MAX_TILT_DEG: f64 = 4.0;

/// Returns the tool's position at rest, metres, base frame; fails with the reason.
///
/// - `stale_s`: the largest age of a reading, seconds.
pub fn place_at_rest(port: &mut dyn Port, stale_s: f64) -> Result<[f64; 3], String> {
    let begun_s = port.now_s();
    let first = tool_reading(port, stale_s)?;
    let (mut farthest_m, mut last) = (0.0_f64, first);
    while port.now_s() - begun_s < LOOK_S {
        port.wait(STEP_S);
        last = tool_reading(port, stale_s)?;
        let away = last.value.translation.vector - first.value.translation.vector;
        farthest_m = farthest_m.max(away.norm());
    }
    if last.at_s <= begun_s {
        return Err(silent(port.now_s() - last.at_s));
    }
    if farthest_m > REST_M {
        return Err(format!(
            "the arm still moves: its tool went {:.1} mm in {LOOK_S} s; hold it still, and enter the point again",
            farthest_m * 1000.0
        ));
    }
    let out_of_hand = last.value.rotation * Vector3::z();
    let tilt_deg = out_of_hand.angle(&-Vector3::z()).to_degrees();
    if tilt_deg > MAX_TILT_DEG {
        return Err(format!(
            "the hand is tilted by {tilt_deg:.1} degrees, so that its place is not that of the fingertips; point it straight \
             down, to {MAX_TILT_DEG} degrees at the most"
        ));
    }
    Ok(last.value.translation.vector.into())
}

/// Returns the last reading of the tool; fails if it is older than `stale_s`.
fn tool_reading(port: &mut dyn Port, stale_s: f64) -> Result<Reading<Isometry3<f64>>, String> {
    let now_s = port.now_s();
    let Some(tool) = port.state().tool else {
        return Err("the arm has not reported yet where its tool is".to_owned());
    };
    if now_s - tool.at_s > stale_s {
        return Err(silent(now_s - tool.at_s));
    }
    if !is_pose(&tool.value) {
        return Err("the arm reports a tool position that is not finite".to_owned());
    }
    Ok(tool)
}

fn silent(for_s: f64) -> String {
    format!(
        "the arm has not reported for {for_s:.1} s where its tool is; its driver or the network may be down"
    )
}

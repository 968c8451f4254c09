//! The tool's position after a person has guided it to a point.
//!
//! In: an arm. Out: its tool's position, or why it cannot be used: there is no new reading, the arm still moves, or the
//! hand is tilted. The arm is not moved.

use crate::driver::PortArm;
use crate::port::Port;
use nalgebra::Vector3;

/// How far the hand may be tilted from straight down, degrees. The tool's point is at the last joints of closed fingers
/// (kinova_description: 0.115 m to the fingers' first joint plus 0.044 m, of 0.160 m). The fingertip beyond it is about
/// as long as the link before it, so 4 degrees of tilt move it by 3 mm on the table.
const MAX_TILT_DEG: f64 = 4.0;

/// Returns the tool's position at rest, metres, base frame; fails with the reason.
pub fn place_at_rest<P: Port + ?Sized>(arm: &mut PortArm<P>) -> Result<[f64; 3], String> {
    if !arm.is_at_rest().map_err(|error| error.to_string())? {
        return Err(
            "the arm still moves, or reports nothing new; hold it still, and enter the point again"
                .to_owned(),
        );
    }
    let tool = arm.state().map_err(|error| error.to_string())?.tool;
    let out_of_hand = tool.rotation * Vector3::z();
    let tilt_deg = out_of_hand.angle(&-Vector3::z()).to_degrees();
    if tilt_deg > MAX_TILT_DEG {
        return Err(format!(
            "the hand is tilted by {tilt_deg:.1} degrees, so that its place is not that of the fingertips; point it straight \
             down, to {MAX_TILT_DEG} degrees at the most"
        ));
    }
    Ok(tool.translation.vector.into())
}

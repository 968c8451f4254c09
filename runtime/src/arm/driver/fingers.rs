//! The hand: where its fingers stop says more than what the server calls it.
//!
//! A finger goal that is given up because cloth is between the fingers is a grasp; one that is given up because the arm
//! is stopped is none. Both come with the same word, so that only positions decide.

use super::carry::{LOOK_S, Word, carry_out, state};
use super::{ArmError, Between, Opening, Watch};
use crate::arm::port::{Ending, Goal, Port};
use crate::arm::settings::{FingerSettings, Tolerance};

/// The longest that the hand may take, seconds.
const LIMIT_S: f64 = 8.0;

/// Two looks at the fingers this far apart, in time, must agree before they count as at rest.
const REST_S: f64 = 0.25;

/// How often that is tried.
const LOOKS: u32 = 12;

/// Opens or closes a hand and says what is between the fingers.
pub(super) fn move_fingers<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
    opening: Opening,
    watch: &mut Watch<'_>,
) -> Result<Between, ArmError> {
    let wanted = match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    };
    let goal = Goal::Fingers(vec![wanted; settings.count]);
    let word = carry_out(port, &goal, LIMIT_S, tolerance, &mut None, watch)?;
    let found = at_rest(port, settings, tolerance)?;
    judge(settings, opening, word, &found)
}

/// Decides by the positions at which the fingers came to rest.
fn judge(
    settings: &FingerSettings,
    opening: Opening,
    word: Word,
    found: &[f64],
) -> Result<Between, ArmError> {
    let wanted = match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    };
    let wrong = || ArmError::Fingers {
        found: found
            .iter()
            .map(|position| format!("`{position:.0}`"))
            .collect::<Vec<_>>()
            .join(", "),
        wanted,
    };
    let off = |from: f64| {
        let off = found.iter().map(|position| (position - from).abs());
        off.fold(0.0, f64::max)
    };
    let are_there = off(wanted) <= settings.tolerance;
    match opening {
        Opening::Open if are_there => Ok(Between::Unknown),
        Opening::Open => Err(wrong()),
        // Fingers that have not left their open position grasp nothing: the goal was refused or never came.
        Opening::Closed if off(settings.open) <= settings.tolerance => Err(wrong()),
        // A node gives fingers that stall up as preempted; it aborts the goal of a hand that is stopped on its way.
        Opening::Closed if matches!(word, Word::Ended(Ending::Aborted | Ending::Rejected)) => {
            Err(wrong())
        }
        Opening::Closed => match settings.cloth {
            Some(cloth) if off(settings.closed) >= cloth => Ok(Between::Something),
            Some(_) if are_there => Ok(Between::Nothing),
            None if are_there => Ok(Between::Unknown),
            // Given up on the way by a node that waits for its own tolerance: that much is between them.
            None if word != Word::None => Ok(Between::Something),
            _ => Err(wrong()),
        },
    }
}

/// Returns where the fingers are once they do not move any more.
fn at_rest<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
) -> Result<Vec<f64>, ArmError> {
    let mut before = taken(port, settings, tolerance)?;
    for _ in 0..LOOKS {
        port.wait(REST_S.max(LOOK_S));
        let now = taken(port, settings, tolerance)?;
        let moved = now.iter().zip(&before).map(|(a, b)| (a - b).abs());
        if moved.fold(0.0, f64::max) <= 0.2 * settings.tolerance {
            return Ok(now);
        }
        before = now;
    }
    Err(ArmError::Late {
        after_s: f64::from(LOOKS) * REST_S,
    })
}

/// Returns the positions of the fingers that the hand has; a node may report three for a hand of two.
fn taken<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
) -> Result<Vec<f64>, ArmError> {
    let mut fingers = state(port, tolerance)?.fingers;
    fingers.truncate(settings.count);
    let are_numbers = fingers.iter().all(|position| position.is_finite());
    if fingers.len() == settings.count && are_numbers {
        return Ok(fingers);
    }
    Err(ArmError::Fingers {
        found: format!("{} positions", fingers.len()),
        wanted: settings.count as f64,
    })
}

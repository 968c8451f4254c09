//! Moves the fingers, and decides from where they stop what they hold.
//!
//! A finger goal that is aborted because cloth blocks the fingers is a grasp; one that is aborted because the arm is
//! stopped is not. The server may report both alike, so finger positions decide. The caller checks whether the arm is
//! stopped.

use super::goal::{Goal, Outcome, execute};
use super::state::{fingers, watched_wait};
use super::{ArmError, HandContents, Opening, Watch};
use crate::port::{Ending, Port, Reading};
use crate::settings::{FingerSettings, Tolerance};

/// Time limit of a finger goal, seconds.
const LIMIT_S: f64 = 8.0;

/// Two finger readings this far apart must agree before the fingers count as at rest, seconds.
const REST_S: f64 = 0.25;

/// How many readings are compared before giving up.
const LOOKS: u32 = 12;

/// Opens or closes a hand and returns what is between the fingers.
pub(super) fn move_fingers<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
    opening: Opening,
    watch: &mut Watch<'_>,
) -> Result<FingerResult, ArmError> {
    let target = match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    };
    let goal = Goal::Fingers(vec![target; settings.count]);
    let outcome = execute(port, &goal, LIMIT_S, tolerance, &mut None, watch)?;
    let found = resting_positions(port, settings, tolerance, watch)?;
    Ok(FingerResult {
        contents: classify(settings, opening, outcome, &found)?,
        was_aborted: matches!(outcome, Outcome::Ended(Ending::Aborted | Ending::Rejected)),
    })
}

/// The result of a finger goal.
pub(super) struct FingerResult {
    /// What is between the fingers, judged by their positions.
    pub contents: HandContents,
    /// Whether the node aborted or rejected the goal, as it also does when the arm is stopped.
    pub was_aborted: bool,
}

/// Classifies the positions at which the fingers came to rest.
fn classify(
    settings: &FingerSettings,
    opening: Opening,
    outcome: Outcome,
    found: &[f64],
) -> Result<HandContents, ArmError> {
    let target = match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    };
    let wrong = || ArmError::Fingers {
        found: found
            .iter()
            // Grippers count in metres or radians, and other hands in thousands.
            .map(|position| format!("`{}`", (position * 1e4).round() / 1e4))
            .collect::<Vec<_>>()
            .join(", "),
        target,
    };
    let distance = |from: f64| found.iter().map(move |position| (position - from).abs());
    let are_at_target = distance(target).fold(0.0, f64::max) <= settings.tolerance;
    // The minimum over the fingers: a finger that is stuck open cannot hold anything against the other.
    let from_open = distance(settings.open).fold(f64::INFINITY, f64::min);
    let from_closed = distance(settings.closed).fold(0.0, f64::max);
    match opening {
        Opening::Open if are_at_target => Ok(HandContents::Unknown),
        Opening::Open => Err(wrong()),
        // Fingers still at their open position hold nothing: the goal was refused or lost.
        Opening::Closed if from_open <= settings.tolerance => Err(wrong()),
        Opening::Closed => match settings.cloth {
            Some(cloth) if from_closed >= cloth => Ok(HandContents::Something),
            Some(_) if are_at_target => Ok(HandContents::Nothing),
            None if are_at_target => Ok(HandContents::Unknown),
            // Stopped between open and closed: without `cloth` this may be a grasp or a jam.
            None if outcome != Outcome::TimedOut => Ok(HandContents::Unknown),
            _ => Err(wrong()),
        },
    }
}

/// Waits until the fingers are at rest, and returns their positions.
fn resting_positions<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<Vec<f64>, ArmError> {
    let mut before = positions(port, settings, tolerance)?;
    for _ in 0..LOOKS {
        watched_wait(port, REST_S, tolerance, watch)?;
        let now = positions(port, settings, tolerance)?;
        // Only a new reading can show rest.
        if now.at_s > before.at_s {
            let moved = now.value.iter().zip(&before.value);
            let moved = moved.map(|(now, before)| (now - before).abs());
            if moved.fold(0.0, f64::max) <= 0.2 * settings.tolerance {
                return Ok(now.value);
            }
            before = now;
        }
    }
    Err(ArmError::TimedOut {
        after_s: f64::from(LOOKS) * REST_S,
    })
}

/// Returns one position per finger; a node may report three for a hand with two.
fn positions<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
) -> Result<Reading<Vec<f64>>, ArmError> {
    let mut fingers = fingers(port, tolerance)?;
    fingers.value.truncate(settings.count);
    let are_numbers = fingers.value.iter().all(|position| position.is_finite());
    if fingers.value.len() == settings.count && are_numbers {
        return Ok(fingers);
    }
    Err(ArmError::Fingers {
        found: format!("{} positions", fingers.value.len()),
        target: settings.count as f64,
    })
}

#[cfg(test)]
mod tests;

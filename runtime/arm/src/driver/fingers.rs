//! The hand: where its fingers stop says more than what the server calls it.
//!
//! A finger goal that is given up because cloth is between the fingers is a grasp; one that is given up because the arm
//! is stopped is none. Both may come with the same word, so that positions decide, and whether the arm is stopped is
//! looked at by whoever calls.

use super::carry::{Word, carry_out};
use super::look::{LOOK_S, looked_at};
use super::{ArmError, Between, Opening, Watch};
use crate::port::{Ending, Goal, Port};
use crate::settings::{FingerSettings, Tolerance};

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
) -> Result<Closed, ArmError> {
    let wanted = match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    };
    let goal = Goal::Fingers(vec![wanted; settings.count]);
    let word = carry_out(port, &goal, LIMIT_S, tolerance, &mut None, watch)?;
    let found = at_rest(port, settings, tolerance, watch)?;
    Ok(Closed {
        between: judge(settings, opening, word, &found)?,
        was_given_up: matches!(word, Word::Ended(Ending::Aborted | Ending::Rejected)),
    })
}

/// What came of a finger goal.
pub(super) struct Closed {
    /// What is between the fingers, by their positions.
    pub between: Between,
    /// Whether the node gave the goal up, as it does too where the arm is stopped.
    pub was_given_up: bool,
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
    let off = |from: f64| found.iter().map(move |position| (position - from).abs());
    let are_there = off(wanted).fold(0.0, f64::max) <= settings.tolerance;
    // The least over the fingers: one that is stuck open holds nothing against the other.
    let have_left = off(settings.open).fold(f64::INFINITY, f64::min);
    let off_closed = off(settings.closed).fold(0.0, f64::max);
    match opening {
        Opening::Open if are_there => Ok(Between::Unknown),
        Opening::Open => Err(wrong()),
        // Fingers that have not left their open position grasp nothing: the goal was refused or never came.
        Opening::Closed if have_left <= settings.tolerance => Err(wrong()),
        Opening::Closed => match settings.cloth {
            Some(cloth) if off_closed >= cloth => Ok(Between::Something),
            Some(_) if are_there => Ok(Between::Nothing),
            None if are_there => Ok(Between::Unknown),
            // Given up on the way: without knowing how far cloth keeps them apart, it may as well be a jam.
            None if word != Word::None => Ok(Between::Unknown),
            _ => Err(wrong()),
        },
    }
}

/// Returns where the fingers are once they do not move any more.
fn at_rest<P: Port>(
    port: &mut P,
    settings: &FingerSettings,
    tolerance: &Tolerance,
    watch: &mut Watch<'_>,
) -> Result<Vec<f64>, ArmError> {
    let mut before = taken(port, settings, tolerance, watch)?;
    for _ in 0..LOOKS {
        port.wait(REST_S.max(LOOK_S));
        let now = taken(port, settings, tolerance, watch)?;
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
    watch: &mut Watch<'_>,
) -> Result<Vec<f64>, ArmError> {
    let mut fingers = looked_at(port, tolerance, watch)?.fingers;
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

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: FingerSettings = FingerSettings {
        count: 2,
        open: 0.0,
        closed: 6400.0,
        cloth: Some(200.0),
        tolerance: 100.0,
    };

    #[test]
    fn positions_tell_what_is_between_the_fingers() {
        let without = FingerSettings {
            cloth: None,
            ..SETTINGS
        };
        let given_up = Word::Ended(Ending::Aborted);
        let done = Word::Ended(Ending::Succeeded);
        for (settings, word, found, expected) in [
            (SETTINGS, done, [6390.0, 6350.0], Some(Between::Nothing)),
            (SETTINGS, done, [6100.0, 6150.0], Some(Between::Something)),
            (
                SETTINGS,
                given_up,
                [5000.0, 5200.0],
                Some(Between::Something),
            ),
            (
                SETTINGS,
                Word::None,
                [5000.0, 5200.0],
                Some(Between::Something),
            ),
            // One finger that is stuck open, whatever the other does, holds nothing.
            (SETTINGS, done, [0.0, 6400.0], None),
            (SETTINGS, done, [6100.0, 40.0], None),
            (SETTINGS, given_up, [0.0, 0.0], None),
            (SETTINGS, done, [6250.0, 6250.0], None),
            (without, done, [6390.0, 6350.0], Some(Between::Unknown)),
            (without, given_up, [5000.0, 5200.0], Some(Between::Unknown)),
            (without, Word::None, [5000.0, 5200.0], None),
        ] {
            let judged = judge(&settings, Opening::Closed, word, &found);
            assert_eq!(judged.ok(), expected, "{word:?} at {found:?}");
        }
    }
}

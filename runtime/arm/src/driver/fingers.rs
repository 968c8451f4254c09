//! Moves the fingers, and decides from where they stop what they hold.
//!
//! A finger goal that is aborted because cloth blocks the fingers is a grasp; one that is aborted because the arm is
//! stopped is not. The server may report both alike, so finger positions decide. The caller checks whether the arm is
//! stopped.

use super::goal::{Goal, Outcome};
use super::{ArmError, HandContents, Opening, PortArm, Watch};
use crate::phase::Event;
use crate::port::{Port, Reading};
use crate::settings::FingerSettings;

/// Time limit of a finger goal, seconds.
const LIMIT_S: f64 = 8.0;

/// How long the fingers may take to come to rest afterwards, seconds.
const SETTLE_S: f64 = 3.0;

impl<P: Port + ?Sized> PortArm<P> {
    /// Opens or closes the hand and returns what is between the fingers.
    pub(super) fn try_move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<HandContents, ArmError> {
        self.ready(watch)?;
        self.phase = self.phase.after(Event::Begin);
        let settings = self.fingers;
        let goal = Goal::Fingers(vec![target(&settings, opening); settings.count]);
        let outcome = self.execute(&goal, LIMIT_S, watch)?;
        let found = self.resting_positions(watch)?;
        let contents = classify(&settings, opening, outcome, &found);
        // Probe only when no goal is in progress: the probe would preempt it, and the node then enables a stopped arm.
        if contents.is_err() || outcome.is_refusal() {
            // If the arm was stopped meanwhile, report that and not the finger positions.
            self.ready(watch)?;
        }
        contents.map_err(ArmError::Failed)
    }

    /// Waits until the fingers are at rest, and returns their positions.
    fn resting_positions(&mut self, watch: &mut Watch<'_>) -> Result<Vec<f64>, ArmError> {
        let most = 0.2 * self.fingers.tolerance;
        let agree = |now: &Vec<f64>, before: &Vec<f64>| {
            let moved = now.iter().zip(before);
            let moved = moved.map(|(now, before)| (now - before).abs());
            moved.fold(0.0, f64::max) <= most
        };
        self.settled(PortArm::positions, agree, SETTLE_S, watch)
    }

    /// Returns one position per finger; a node may report three for a hand with two.
    fn positions(&mut self) -> Result<Reading<Vec<f64>>, ArmError> {
        let mut fingers = self.fingers()?;
        fingers.value.truncate(self.fingers.count);
        let are_numbers = fingers.value.iter().all(|position| position.is_finite());
        if fingers.value.len() == self.fingers.count && are_numbers {
            return Ok(fingers);
        }
        Err(ArmError::Failed(format!(
            "the arm reports {} positions of fingers, and has {}",
            fingers.value.len(),
            self.fingers.count
        )))
    }
}

fn target(settings: &FingerSettings, opening: Opening) -> f64 {
    match opening {
        Opening::Open => settings.open,
        Opening::Closed => settings.closed,
    }
}

/// Classifies the positions at which the fingers came to rest.
fn classify(
    settings: &FingerSettings,
    opening: Opening,
    outcome: Outcome,
    found: &[f64],
) -> Result<HandContents, String> {
    let target = target(settings, opening);
    let wrong = || {
        // Grippers count in metres or radians, and other hands in thousands.
        let rounded = |position: &f64| format!("`{}`", (position * 1e4).round() / 1e4);
        let found: Vec<String> = found.iter().map(rounded).collect();
        let found = found.join(", ");
        format!("the fingers are at {found} and should be at `{target}`")
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

#[cfg(test)]
mod tests;

//! Executes one goal: sends it, watches the arm, pauses it on request, and returns how the goal ended.
//!
//! In: a goal, a time limit, a watch callback. Out: the server's terminal status, or a timeout.
//!
//! A pause must not release a stop that somebody pressed, and the node of some arms enables them when a goal is cancelled
//! ([`Port::moved_until_s`]). So a goal that is almost done runs to its end. Any other goal is cancelled, and the tool
//! must have kept moving until the cancellation was sent; if it came to rest earlier, the arm counts as stopped. A stop
//! that is pressed while the cancellation is in transit looks the same as the cancellation; the arm then rests until a
//! person resumes the motion.

use super::readings::POLL_S;
use super::{ArmError, ArmState, Deviation, Halt, PortArm, Watch};
use crate::guard::Checked;
use crate::port::{Ending, GoalId, GoalState, Port, Waypoint};
use nalgebra::Isometry3;

/// A tool this close to its target is left to arrive, metres: a few cycles of the node at the allowed speeds.
const NEAR_M: f64 = 0.02;

/// The same for the joints of a trajectory, radians.
const NEAR_RAD: f64 = 0.04;

/// How far the tool may move during a probe, metres: the accuracy with which the arm's node holds a pose.
const STAY_M: f64 = 0.010;

/// How long a goal may take to end by itself, seconds: a hand closes in one or two.
const LET_END_S: f64 = 3.0;

/// How long to wait for steady motion, seconds: a goal takes effect within 0.15 s, and then three readings are needed.
const EVEN_S: f64 = 0.6;

/// How long a cancelled goal may take to end, seconds; a controller slows down first.
const CANCEL_S: f64 = 1.0;

/// How long before the cancellation the tool may appear to have come to rest, seconds: readings have 1 mm resolution.
const SLACK_S: f64 = 0.012;

/// A goal for one of the arm's servers. Only checked motions can be one.
#[derive(Debug, PartialEq)]
pub(crate) enum Goal {
    /// Move the tool to a pose, `base_from_tool`.
    Pose(Checked<Isometry3<f64>>),
    /// Move the joints through these points.
    Trajectory(Checked<Vec<Waypoint>>),
    /// Move the fingers to these positions, in the arm's own units.
    Fingers(Vec<f64>),
    /// Move nothing, and show whether the arm is stopped.
    Probe,
}

/// How a goal ended, as far as the server reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The server reported this status.
    Ended(Ending),
    /// The time limit passed without a terminal status.
    TimedOut,
    /// The arm has no goal that a stop refuses.
    NotProbed,
}

impl Outcome {
    /// Returns the outcome as errors print it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Outcome::Ended(Ending::Succeeded) => "reached",
            Outcome::Ended(Ending::Preempted) => "given up",
            Outcome::Ended(Ending::Aborted) => "aborted",
            Outcome::Ended(Ending::Rejected) => "refused",
            Outcome::TimedOut | Outcome::NotProbed => "nothing",
        }
    }

    /// Returns whether the server aborted or refused the goal, as it also does when the arm is stopped.
    pub(super) fn is_refusal(self) -> bool {
        matches!(self, Outcome::Ended(Ending::Aborted | Ending::Rejected))
    }
}

impl<P: Port + ?Sized> PortArm<P> {
    /// Sends a goal; `None` if it is a probe and the arm has none. Nothing else in this program makes an arm move.
    pub(super) fn send(&mut self, goal: &Goal) -> Result<Option<GoalId>, ArmError> {
        let id = match goal {
            Goal::Pose(tool) => self.port.send_pose(tool.get())?,
            Goal::Trajectory(points) => self.port.send_trajectory(points.get())?,
            Goal::Fingers(positions) => self.port.send_fingers(positions)?,
            Goal::Probe => return Ok(self.port.probe()?),
        };
        if let Goal::Trajectory(_) = goal {
            self.trajectory = Some(id.clone());
        }
        Ok(Some(id))
    }

    /// Sends a goal and waits for its end, at most `limit_s` seconds.
    ///
    /// Returns [`Outcome::TimedOut`] if no end was reported by then. After [`ArmError::Paused`] the arm is at rest.
    pub(super) fn execute(
        &mut self,
        goal: &Goal,
        limit_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome, ArmError> {
        let begun_s = self.port.now_s();
        let begun_at = self.state()?.tool;
        let Some(id) = self.send(goal)? else {
            return Ok(Outcome::NotProbed);
        };
        loop {
            self.port.wait(POLL_S);
            let state = self.state()?;
            match watch(&state) {
                Ok(()) => {}
                Err(Halt::Pause) => {
                    self.pause(goal, &id, watch)?;
                    return Err(ArmError::Paused);
                }
                Err(Halt::Stop(why)) => return Err(why),
            }
            if *goal == Goal::Probe {
                stays(&begun_at, &state)?;
            }
            if let GoalState::Ended(ending) = self.port.goal(&id) {
                return Ok(Outcome::Ended(ending));
            }
            if self.port.now_s() - begun_s > limit_s {
                return Ok(Outcome::TimedOut);
            }
        }
    }

    /// Ends a running goal; afterwards the arm is verified to be at rest, and its stop state is unchanged.
    fn pause(&mut self, goal: &Goal, id: &GoalId, watch: &mut Watch<'_>) -> Result<(), ArmError> {
        let asked_s = self.port.now_s();
        loop {
            let state = self.watched(watch)?;
            let for_s = self.port.now_s() - asked_s;
            let keep_waiting = if goal.ends_soon(&state) {
                for_s < LET_END_S
            } else {
                for_s < EVEN_S && self.port.moved_until_s(None).is_none()
            };
            if let GoalState::Ended(_) = self.port.goal(id) {
                return self.wait_until_at_rest(watch).map(drop);
            }
            if !keep_waiting {
                break;
            }
            self.port.wait(POLL_S);
        }
        let cancelled_s = self.port.now_s();
        let ending = self.cancel(id, watch)?;
        let rest = self.wait_until_at_rest(watch)?.tool.translation.vector;
        let moved_until_s = self.port.moved_until_s(Some(&rest));
        let kept_moving = moved_until_s.is_some_and(|until_s| until_s >= cancelled_s - SLACK_S);
        // Only with this ending does the node start a stopped arm.
        if ending == Ending::Preempted && !kept_moving {
            // The caller stops the arm and verifies it; stopping here loses no time.
            let _ = self.port.stop();
            return Err(ArmError::Stopped);
        }
        Ok(())
    }

    /// Cancels a goal, and waits for its end.
    fn cancel(&mut self, id: &GoalId, watch: &mut Watch<'_>) -> Result<Ending, ArmError> {
        self.port.cancel(id)?;
        let ending = self.ending(id, watch)?;
        ending.ok_or_else(|| ArmError::timed_out(CANCEL_S))
    }

    /// Waits for the end of a cancelled or replaced goal; `None` if none is reported in time.
    pub(super) fn ending(
        &mut self,
        id: &GoalId,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Ending>, ArmError> {
        let begun_s = self.port.now_s();
        while self.port.now_s() - begun_s < CANCEL_S {
            self.port.wait(POLL_S);
            self.watched(watch)?;
            if let GoalState::Ended(ending) = self.port.goal(id) {
                return Ok(Some(ending));
            }
        }
        Ok(None)
    }
}

impl Goal {
    /// Returns whether the goal is about to end by itself.
    fn ends_soon(&self, state: &ArmState) -> bool {
        match self {
            Goal::Fingers(_) | Goal::Probe => true,
            Goal::Pose(pose) => Deviation::between(pose.get(), &state.tool).position_m < NEAR_M,
            Goal::Trajectory(points) => points.get().last().is_some_and(|last| {
                let pairs = last.joints_rad.iter().zip(&state.joints_rad);
                pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < NEAR_RAD
            }),
        }
    }
}

/// Fails if a tool that nothing told to move has left its place.
fn stays(place: &Isometry3<f64>, state: &ArmState) -> Result<(), ArmError> {
    let moved_m = Deviation::between(place, &state.tool).position_m;
    // NaN must stop the arm too.
    let stays = moved_m <= STAY_M;
    if stays {
        return Ok(());
    }
    Err(ArmError::OutOfLimits(format!(
        "the tool moved by {:.0} mm while nothing told it to",
        moved_m * 1000.0
    )))
}

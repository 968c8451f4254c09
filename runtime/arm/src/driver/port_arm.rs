//! Drives an arm through a port, and verifies each motion by measurement.
//!
//! The node reports a goal as reached when the tool is up to 10 mm and 2 degrees off, a cancelled or stalled goal
//! leaves the arm enabled, and only a refused goal reveals a stop. So each motion starts with a probe ([`Port::probe`])
//! and ends with measurements of the pose; a stop is requested until a probe is refused. After a stop
//! nothing is cancelled and nothing else is sent, because the node takes either as a reason to enable the arm. The
//! exception is the trajectory controller: it ignores the stop and would resume once the arm is enabled, so its
//! trajectory is ended.
//!
//! An arm that takes goals after a stop has no probe: its stop is verified when it was
//! acknowledged, its trajectory has ended, and the tool is at rest.

use super::goal::{Goal, Outcome};
use super::readings::{POLL_S, SETTLE_S};
use super::{ArmError, ArmState, Deviation, Halt, HandContents, Opening, Watch};
use crate::guard::{Checked, Motion};
use crate::phase::{Event, Phase};
use crate::port::{Ending, GoalId, GoalState, Port};
use crate::settings::{FingerSettings, Tolerance};

/// How long a probe may take, seconds, and how often it is sent if its end is not reported.
const PROBE_S: f64 = 3.0;
const PROBES: u32 = 2;

/// How often a stop is requested until it is verified.
const STOPS: u32 = 3;

/// How an arm is told to move its tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Commands {
    /// By trajectories of its joints, which are what was checked.
    Trajectories,
    /// By poses of the tool. The node solves the inverse kinematics and chooses speed and joint path, so the path of
    /// elbow and wrist may be another than the one that was checked: a person has to watch them.
    Poses,
}

/// An arm with a hand, behind a port.
///
/// A stopped arm does not move again until [`PortArm::recover`], which nothing here calls by itself. After an error of
/// [`PortArm::move_tool`] or [`PortArm::move_fingers`] other than [`ArmError::Paused`] the arm may still be moving: the
/// caller must stop it.
pub struct PortArm<P: Port + ?Sized> {
    pub(super) port: Box<P>,
    commands: Commands,
    pub(super) fingers: FingerSettings,
    pub(super) tolerance: Tolerance,
    pub(super) phase: Phase,
    /// The last trajectory that was sent to the controller.
    pub(super) trajectory: Option<GoalId>,
}

impl<P: Port + ?Sized> PortArm<P> {
    /// Drives the arm behind a port.
    pub fn new(
        port: Box<P>,
        commands: Commands,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        PortArm {
            port,
            commands,
            fingers,
            tolerance,
            phase: Phase::default(),
            trajectory: None,
        }
    }

    /// Returns the port, e.g. to inspect a simulated arm.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Returns the time of a monotonic clock, seconds.
    pub fn now_s(&self) -> f64 {
        self.port.now_s()
    }

    /// Waits.
    pub fn wait(&mut self, seconds: f64) {
        self.port.wait(seconds);
    }

    /// Makes a straight motion of the tool, and verifies that it arrived and is at rest.
    ///
    /// One call sends one motion. After [`ArmError::Short`] the caller may check the rest of the way and call again.
    ///
    /// - `motion`: from where the arm is; an arm that has left that place is stopped. A node that takes no speed is only
    ///   monitored.
    pub fn move_tool(
        &mut self,
        motion: &Checked<Motion>,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let moved = self.try_move_tool(motion, watch);
        self.ended(moved)
    }

    /// Opens or closes the hand, and returns what is between the fingers.
    pub fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<HandContents, ArmError> {
        let moved = self.try_move_fingers(opening, watch);
        self.ended(moved)
    }

    /// Stops the arm and verifies that it refuses motion.
    pub fn stop(&mut self) -> Result<(), ArmError> {
        self.phase = self.phase.after(Event::Stop);
        let mut stopped = self.try_stop();
        for _ in 1..STOPS {
            stopped = stopped.or_else(|_| self.try_stop());
        }
        stopped
    }

    /// Returns whether the arm is stopped, by whomever.
    pub fn is_stopped(&mut self) -> Result<bool, ArmError> {
        match self.ready(&mut unwatched) {
            Err(ArmError::Stopped) => Ok(true),
            other => other.map(|()| false),
        }
    }

    /// Lets a stopped arm move again, and verifies that it takes motions. Call it only at a person's request.
    pub fn recover(&mut self) -> Result<(), ArmError> {
        if self.commands != Commands::Poses || self.trajectory.is_some() {
            // Replace whatever trajectory the controller still has, whoever sent it.
            let here = self.state()?;
            let outcome = self.execute(&hold_position(&here), PROBE_S, &mut unwatched)?;
            // Acceptance is enough: servers differ in whether a held arm counts as arrived.
            let is_accepted = match (outcome, &self.trajectory) {
                (Outcome::Ended(ending), _) => ending != Ending::Rejected,
                (_, Some(id)) => self.port.goal(id) == GoalState::Active,
                (_, None) => false,
            };
            if !is_accepted {
                return Err(ArmError::timed_out(PROBE_S));
            }
        }
        self.port.start()?;
        if !self.is_at_rest()? {
            self.stop()?;
            return Err(ArmError::OutOfLimits(
                "the arm moved by itself when it was enabled".to_owned(),
            ));
        }
        self.phase = self.phase.after(Event::Recover);
        self.ready(&mut unwatched)
    }

    /// Fails if the arm is stopped, or the watch callback ends it. This may take seconds, so it is asked before a motion
    /// is checked, and not between the check and [`PortArm::move_tool`].
    pub fn ready(&mut self, watch: &mut Watch<'_>) -> Result<(), ArmError> {
        if !self.phase.takes_motions() {
            return Err(ArmError::Stopped);
        }
        for _ in 0..PROBES {
            match self.execute(&Goal::Probe, PROBE_S, watch)? {
                Outcome::NotProbed | Outcome::Ended(Ending::Succeeded) => return Ok(()),
                Outcome::Ended(Ending::Aborted | Ending::Rejected) => {
                    self.phase = self.phase.after(Event::Stop);
                    return Err(ArmError::Stopped);
                }
                Outcome::Ended(Ending::Preempted) => break,
                // The report of its end may have been lost.
                Outcome::TimedOut => {}
            }
        }
        Err(ArmError::timed_out(PROBE_S))
    }

    /// Notes how a motion ended. After any other error the arm may still be moving.
    fn ended<T>(&mut self, result: Result<T, ArmError>) -> Result<T, ArmError> {
        let event = match &result {
            Ok(_) | Err(ArmError::Short(_)) => Event::Verify,
            Err(ArmError::Paused) => Event::Pause,
            Err(ArmError::Stopped) => Event::Stop,
            Err(_) => return result,
        };
        self.phase = self.phase.after(event);
        result
    }

    fn try_move_tool(
        &mut self,
        motion: &Checked<Motion>,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let by_pose = self.commands == Commands::Poses;
        if !self.phase.takes_motions() {
            return Err(ArmError::Stopped);
        }
        let from = self.state()?;
        match watch(&from) {
            Ok(()) => {}
            Err(Halt::Pause) => return Err(ArmError::Paused),
            Err(Halt::Stop(why)) => return Err(why),
        }
        if !motion.get().begins_at(&from) {
            let moved = Deviation::between(&from.tool, &motion.get().from);
            return Err(ArmError::OutOfLimits(format!(
                "the arm has moved since this motion was checked, its tool by {moved}"
            )));
        }
        let goal = if by_pose {
            Goal::Pose(motion.pose())
        } else if motion.get().waypoints.len() > 1 {
            Goal::Trajectory(motion.trajectory())
        } else {
            hold_position(&from)
        };
        self.phase = self.phase.after(Event::Begin);
        let takes_s = motion.get().takes_s();
        let limit_s = 2.0 * takes_s + SETTLE_S;
        let begun_s = self.port.now_s();
        let outcome = self.execute(&goal, limit_s, watch)?;
        if !by_pose && outcome == Outcome::Ended(Ending::Succeeded) {
            // A controller may report a goal as reached before its time, while the arm begins to move.
            let left_s = begun_s + takes_s - self.port.now_s();
            self.watched_wait(left_s, watch)?;
        }
        let now = self.wait_until_at_rest(watch)?;
        let deviation = Deviation::between(&now.tool, &motion.get().to);
        if deviation.position_m <= self.tolerance.position_m
            && deviation.angle_rad <= self.tolerance.angle_deg.to_radians()
        {
            return Ok(now);
        }
        // A refused goal may mean that the arm was stopped. A stop does not end a trajectory; a pose in progress would be
        // preempted by the probe.
        if outcome.is_refusal() || outcome == Outcome::TimedOut && !by_pose {
            self.ready(watch)?;
        }
        let reported = outcome.name();
        let why =
            format!("the arm reported `{reported}`, but its tool is {deviation} from its target");
        Err(match outcome {
            Outcome::Ended(Ending::Succeeded) | Outcome::NotProbed => ArmError::Short(why),
            Outcome::Ended(Ending::Preempted) => ArmError::Failed(format!(
                "the arm stalled {deviation} before its goal: something may be in its way"
            )),
            Outcome::Ended(Ending::Aborted | Ending::Rejected) => ArmError::Failed(why),
            Outcome::TimedOut => ArmError::timed_out(limit_s),
        })
    }

    /// Returns whether a stop is verified: the arm is at rest, and refuses a probe or has no trajectory left.
    fn is_stop_verified(&mut self) -> Result<bool, ArmError> {
        if !self.is_at_rest()? {
            return Ok(false);
        }
        Ok(match self.execute(&Goal::Probe, PROBE_S, &mut unwatched)? {
            Outcome::NotProbed => self.trajectory.is_none(),
            outcome => outcome.is_refusal(),
        })
    }

    /// Ends the controller's last trajectory, so that it does not resume once the arm is enabled.
    fn end_trajectory(&mut self) -> Result<(), ArmError> {
        let Some(mut id) = self.trajectory.clone() else {
            return Ok(());
        };
        match self.port.goal(&id) {
            GoalState::Ended(Ending::Succeeded | Ending::Preempted | Ending::Rejected) => {
                self.trajectory = None;
                return Ok(());
            }
            // The server is done with it, but the controller may not be: only another trajectory replaces it.
            GoalState::Ended(Ending::Aborted) => {
                let here = self.state()?;
                id = self.send(&hold_position(&here))?.unwrap_or(id);
            }
            GoalState::Sent | GoalState::Active => self.port.cancel(&id)?,
        }
        if self.ending(&id, &mut unwatched)?.is_some() {
            self.trajectory = None;
        } else if self.port.goal(&id) == GoalState::Active {
            return Err(ArmError::Failed(
                "the controller does not end its trajectory".to_owned(),
            ));
        }
        Ok(())
    }

    /// Stops the arm, and verifies the stop.
    fn try_stop(&mut self) -> Result<(), ArmError> {
        let has_trajectory = self.trajectory.is_some();
        let mut stopped = self.port.stop();
        let ended = self.end_trajectory();
        if has_trajectory {
            // Some versions of the controller also enable the arm on a cancellation.
            stopped = stopped.and(self.port.stop());
        }
        stopped.map_err(|error| ArmError::NotStopped(error.to_string()))?;
        let why = match ended.and_then(|()| self.is_stop_verified()) {
            Ok(true) => return Ok(()),
            Ok(false) => "it still takes goals, or moves".to_owned(),
            Err(error) => error.to_string(),
        };
        Err(ArmError::NotStopped(why))
    }
}

fn unwatched(_: &ArmState) -> Result<(), Halt> {
    Ok(())
}

/// Returns a trajectory that holds the joints where they are. It has two points because kinova-ros's controller needs
/// two.
fn hold_position(state: &ArmState) -> Goal {
    Goal::Trajectory(Checked::hold(state, &[POLL_S, 2.0 * POLL_S]))
}

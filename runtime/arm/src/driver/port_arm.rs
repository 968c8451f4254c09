//! Drives an arm through a port, and verifies each motion by measurement.
//!
//! The node reports a goal as reached when the tool is up to 10 mm and 2 degrees off, a cancelled or stalled goal
//! leaves the arm enabled, and only a refused pose reveals a stop. So each motion starts with a probe (a goal at the
//! current pose) and ends with measurements of the pose; a stop is requested until a probe is refused. After a stop
//! nothing is cancelled and nothing else is sent, because the node takes either as a reason to enable the arm. The
//! exception is the trajectory controller: it ignores the stop and would resume once the arm is enabled, so its
//! trajectory is ended.
//!
//! An arm that takes goals after a stop ([`AfterStop::Accepts`]) needs no probe: its stop is verified when it was
//! acknowledged, its trajectory has ended, and the tool is at rest.

use super::command::{CommandMode, hold_position};
use super::fingers::move_fingers;
use super::goal::{Goal, Outcome, execute};
use super::state::{
    SETTLE_S, is_at_rest, state, state_with_joints, wait_until_at_rest, watched_wait,
};
use super::{Arm, ArmError, ArmState, Deviation, Halt, HandContents, Opening, Watch};
use crate::guard::{Checked, Guard, Motion};
use crate::port::{AfterStop, Ending, GoalId, GoalState, Port};
use crate::settings::{FingerSettings, Tolerance};

/// How long a probe may take, seconds, and how often it is sent if its end is not reported.
const PROBE_S: f64 = 3.0;
const PROBES: u32 = 2;

/// How often a stop is requested until it is verified.
const STOPS: u32 = 3;

/// How long a cancelled trajectory may take to end, seconds, and how often that is polled.
const CANCEL_S: f64 = 0.5;
const CANCEL_LOOK_S: f64 = 0.02;

/// An arm behind a port.
pub struct PortArm<P: Port> {
    port: P,
    mode: CommandMode,
    guard: Guard,
    fingers: FingerSettings,
    tolerance: Tolerance,
    /// The speed of tool poses, m/s, if the arm follows trajectories at every other speed.
    pose_speed_m_s: Option<f64>,
    /// Whether this driver stopped the arm, or found it stopped, and it was not enabled since.
    is_stopped: bool,
    /// The last trajectory that was sent to the controller.
    trajectory: Option<GoalId>,
}

impl<P: Port> PortArm<P> {
    /// Drives the node of kinova-ros with tool poses.
    ///
    /// The node solves the inverse kinematics and does not report the joint path, so the path of elbow and wrist that
    /// was checked may be another one. A person has to watch them.
    pub fn by_poses(
        port: P,
        guard: Guard,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        PortArm {
            port,
            mode: CommandMode::Poses,
            guard,
            fingers,
            tolerance,
            pose_speed_m_s: None,
            is_stopped: false,
            trajectory: None,
        }
    }

    /// Drives an arm that takes both: tool poses at its own speed, which poses cannot change, and joint trajectories at
    /// every other speed.
    pub fn by_poses_at(
        pose_speed_m_s: f64,
        port: P,
        guard: Guard,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        PortArm {
            pose_speed_m_s: Some(pose_speed_m_s),
            ..PortArm::by_poses(port, guard, fingers, tolerance)
        }
    }

    /// Drives a `FollowJointTrajectory` controller with joint trajectories.
    ///
    /// The node of kinova-ros must run as well: its pose server reveals a stop, while the controller accepts
    /// trajectories even when the arm is stopped.
    pub fn by_trajectories(
        port: P,
        guard: Guard,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        PortArm {
            mode: CommandMode::Trajectories,
            ..PortArm::by_poses(port, guard, fingers, tolerance)
        }
    }

    /// Returns the port, e.g. to inspect a simulated arm.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Returns which kind of goal commands a motion of this speed.
    fn mode_at(&self, speed_m_s: f64) -> CommandMode {
        match self.pose_speed_m_s {
            Some(pose_speed_m_s) if speed_m_s != pose_speed_m_s => CommandMode::Trajectories,
            _ => self.mode,
        }
    }

    /// Returns the arm's state, with joint angles if the command mode needs them.
    fn current_state(&mut self, mode: CommandMode) -> Result<ArmState, ArmError> {
        match mode {
            CommandMode::Poses => state(&mut self.port, &self.tolerance),
            CommandMode::Trajectories => state_with_joints(&mut self.port, &self.tolerance),
        }
    }

    /// Executes a goal, and remembers a trajectory that was sent and a stop that was found.
    fn execute(
        &mut self,
        goal: &Goal,
        limit_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Outcome, ArmError> {
        let mut sent = None;
        let outcome = execute(
            &mut self.port,
            goal,
            limit_s,
            &self.tolerance,
            &mut sent,
            watch,
        );
        if let (Goal::Trajectory(_), Some(id)) = (goal, sent) {
            self.trajectory = Some(id);
        }
        if outcome == Err(ArmError::Stopped) {
            self.is_stopped = true;
        }
        outcome
    }

    /// Re-sends the current pose; a stopped arm aborts it, which reveals the stop.
    fn probe(&mut self, watch: &mut Watch<'_>) -> Result<Outcome, ArmError> {
        let here = state(&mut self.port, &self.tolerance)?;
        self.execute(&Goal::Pose(Checked::here(&here)), PROBE_S, watch)
    }

    /// Fails if the arm is stopped.
    fn check_enabled(&mut self, watch: &mut Watch<'_>) -> Result<(), ArmError> {
        if self.is_stopped {
            return Err(ArmError::Stopped);
        }
        if self.port.after_stop() == AfterStop::Accepts {
            return Ok(());
        }
        for _ in 0..PROBES {
            match self.probe(watch)? {
                Outcome::Ended(Ending::Succeeded) => return Ok(()),
                Outcome::Ended(Ending::Aborted | Ending::Rejected) => {
                    self.is_stopped = true;
                    return Err(ArmError::Stopped);
                }
                Outcome::Ended(Ending::Preempted) => break,
                // The report of its end may have been lost.
                Outcome::Unreported | Outcome::TimedOut => {}
            }
        }
        Err(ArmError::TimedOut { after_s: PROBE_S })
    }

    /// Returns the arm's state if the watch callback allows motion.
    fn check_motion_allowed(
        &mut self,
        mode: CommandMode,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let here = self.current_state(mode)?;
        match watch(&here) {
            Ok(()) => Ok(here),
            Err(Halt::Pause) => Err(ArmError::Paused),
            Err(Halt::Stop(why)) => Err(why),
        }
    }

    fn is_reached(&self, deviation: Deviation) -> bool {
        deviation.position_m <= self.tolerance.position_m
            && deviation.angle_rad <= self.tolerance.angle_deg.to_radians()
    }

    /// Returns whether a stop is verified: the arm is at rest, and refuses a probe or has no trajectory left.
    fn is_stop_verified(&mut self) -> Result<bool, ArmError> {
        if !is_at_rest(&mut self.port, &self.tolerance)? {
            return Ok(false);
        }
        if self.port.after_stop() == AfterStop::Accepts {
            return Ok(self.trajectory.is_none());
        }
        let outcome = self.probe(&mut |_: &ArmState| Ok(()))?;
        Ok(matches!(
            outcome,
            Outcome::Ended(Ending::Aborted | Ending::Rejected)
        ))
    }

    /// Ends the controller's last trajectory, so that it does not resume once the arm is enabled.
    fn end_trajectory(&mut self) -> Result<(), ArmError> {
        let Some(id) = self.trajectory.clone() else {
            return Ok(());
        };
        match self.port.goal(&id) {
            GoalState::Ended(Ending::Succeeded | Ending::Preempted | Ending::Rejected) => {
                self.trajectory = None;
                return Ok(());
            }
            // The server is done with it, but the controller may not be: only another trajectory replaces it.
            GoalState::Ended(Ending::Aborted) => {
                let here = state_with_joints(&mut self.port, &self.tolerance)?;
                self.trajectory = Some(hold_position(&here).send(&mut self.port)?);
            }
            GoalState::Sent | GoalState::Active => self.port.cancel(&id)?,
        }
        let begun_s = self.port.now_s();
        let mut last = GoalState::Sent;
        while self.port.now_s() - begun_s < CANCEL_S && !matches!(last, GoalState::Ended(_)) {
            self.port.wait(CANCEL_LOOK_S);
            last = match &self.trajectory {
                Some(id) => self.port.goal(id),
                None => return Ok(()),
            };
        }
        match last {
            GoalState::Ended(_) => self.trajectory = None,
            // The goal never arrived.
            GoalState::Sent => {}
            GoalState::Active => return Err(ArmError::TimedOut { after_s: CANCEL_S }),
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
        stopped.map_err(|error| ArmError::StopNotAcknowledged {
            why: error.to_string(),
        })?;
        let why = match ended.and_then(|()| self.is_stop_verified()) {
            Ok(true) => return Ok(()),
            Ok(false) => "it still takes goals, or moves".to_owned(),
            Err(error) => error.to_string(),
        };
        Err(ArmError::NotStopped { why })
    }
}

impl<P: Port> Arm for PortArm<P> {
    fn name(&self) -> String {
        self.guard.chain().model().to_owned()
    }

    fn now_s(&self) -> f64 {
        self.port.now_s()
    }

    fn wait(&mut self, seconds: f64) {
        self.port.wait(seconds);
    }

    fn state(&mut self) -> Result<ArmState, ArmError> {
        state(&mut self.port, &self.tolerance)
    }

    fn move_tool(
        &mut self,
        motion: &Checked<Motion>,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let Motion { to, speed_m_s, .. } = motion.get();
        let mode = self.mode_at(*speed_m_s);
        self.check_enabled(watch)?;
        let from = self.check_motion_allowed(mode, watch)?;
        let goal = mode.goal(&from, motion)?;
        let takes_s = motion.get().takes_s(&from.tool);
        let limit_s = 2.0 * takes_s + SETTLE_S;
        let begun_s = self.port.now_s();
        let outcome = self.execute(&goal, limit_s, watch)?;
        if let (Goal::Trajectory(_), Outcome::Ended(Ending::Succeeded)) = (&goal, outcome) {
            // A controller may report a goal as reached before its time, while the arm begins to move.
            let left_s = begun_s + takes_s - self.port.now_s();
            watched_wait(&mut self.port, left_s, &self.tolerance, watch)?;
        }
        let now = wait_until_at_rest(&mut self.port, &self.tolerance, watch)?;
        let deviation = Deviation::between(&now.tool, to);
        if self.is_reached(deviation) {
            return Ok(now);
        }
        let reported = outcome.name().to_owned();
        match outcome {
            Outcome::Ended(Ending::Succeeded) | Outcome::Unreported => Err(ArmError::Short {
                reported,
                deviation,
            }),
            Outcome::Ended(Ending::Preempted) => Err(ArmError::Stalled { deviation }),
            Outcome::Ended(Ending::Aborted | Ending::Rejected) => {
                // Refused because the arm is stopped, or for another reason.
                self.check_enabled(watch)?;
                Err(ArmError::NotReached {
                    reported,
                    deviation,
                })
            }
            Outcome::TimedOut => {
                // A stop does not end a trajectory. A pose goal in progress would be preempted by the probe.
                if let CommandMode::Trajectories = mode {
                    self.check_enabled(watch)?;
                }
                Err(ArmError::TimedOut { after_s: limit_s })
            }
        }
    }

    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<HandContents, ArmError> {
        self.check_enabled(watch)?;
        let (fingers, tolerance) = (self.fingers, self.tolerance);
        let result = move_fingers(&mut self.port, &fingers, &tolerance, opening, watch);
        // Probe only when no goal is in progress: the probe would preempt it, and the node then enables a stopped arm.
        let may_be_stopped = match &result {
            Ok(result) => result.was_aborted,
            Err(error) => matches!(error, ArmError::Fingers { .. }),
        };
        if may_be_stopped {
            // If the arm was stopped meanwhile, report that and not the finger positions.
            self.check_enabled(watch)?;
        }
        result.map(|result| result.contents)
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        self.is_stopped = true;
        let mut stopped = self.try_stop();
        for _ in 1..STOPS {
            if stopped.is_ok() {
                break;
            }
            stopped = self.try_stop();
        }
        stopped
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        let unwatched = &mut |_: &ArmState| Ok(());
        if self.mode == CommandMode::Trajectories || self.trajectory.is_some() {
            // Replace whatever trajectory the controller still has, whoever sent it.
            let here = state_with_joints(&mut self.port, &self.tolerance)?;
            let outcome = self.execute(&hold_position(&here), PROBE_S, unwatched)?;
            // Acceptance is enough: servers differ in whether a held arm counts as arrived.
            let is_accepted = match (outcome, &self.trajectory) {
                (Outcome::Ended(ending), _) => ending != Ending::Rejected,
                (_, Some(id)) => self.port.goal(id) == GoalState::Active,
                (_, None) => false,
            };
            if !is_accepted {
                return Err(ArmError::TimedOut { after_s: PROBE_S });
            }
        }
        self.port.start()?;
        self.is_stopped = false;
        if !is_at_rest(&mut self.port, &self.tolerance)? {
            self.stop()?;
            return Err(ArmError::OutOfLimits(
                "the arm moved by itself when it was enabled".to_owned(),
            ));
        }
        self.check_enabled(unwatched)
    }
}

//! Moves an arm through a port, and looks itself where the arm came to.
//!
//! What the arm's node calls reached may be 10 mm and 2 degrees off, a cancelled or stalled goal leaves the arm enabled,
//! and nothing says that it is stopped but a pose that is refused. So each motion begins with a pose that is no motion
//! (that in which the arm is), ends with looks at the pose, and a stop is asked for until such a pose is refused.
//! After a stop nothing is cancelled and nothing else sent: the node takes either as a reason to enable the arm. Only its
//! controller of trajectories knows no stop and would go on where the arm is let go, so that it is emptied.

use super::carry::{Word, carry_out};
use super::fingers::move_fingers;
use super::look::{come_to_rest, is_at_rest, state, state_with_joints};
use super::way::{Way, hold, lasts_s};
use super::{Arm, ArmError, ArmState, Between, Halt, Off, Opening, Watch};
use crate::kinematics::chain::Chain;
use crate::port::{Ending, Goal, GoalId, GoalState, Port};
use crate::settings::{FingerSettings, Tolerance};
use nalgebra::Isometry3;

/// How long a goal that is no motion may take, seconds, and how often it is sent where nothing is heard of its end.
const PROBE_S: f64 = 3.0;
const PROBES: u32 = 2;

/// How often a stop is asked for until it is verified.
const STOPS: u32 = 3;

/// How long a trajectory may take to end once it was cancelled, seconds, and how often that is looked at.
const CANCEL_S: f64 = 0.5;
const CANCEL_LOOK_S: f64 = 0.02;

/// An arm behind a port.
pub struct PortArm<P: Port> {
    port: P,
    name: String,
    way: Way,
    fingers: FingerSettings,
    tolerance: Tolerance,
    /// Whether this driver stopped it, or saw that it is stopped, and nobody let it go since.
    is_stopped: bool,
    /// The last trajectory that its controller was sent.
    trajectory: Option<GoalId>,
}

impl<P: Port> PortArm<P> {
    /// Drives the node of kinova-ros by poses of the tool.
    ///
    /// The node finds the joints' way by itself and does not say which: nothing here knows whether elbow and wrist stay clear
    /// of the table, and only a person who watches does.
    pub fn by_poses(
        port: P,
        name: &str,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        PortArm {
            port,
            name: name.to_owned(),
            way: Way::Poses,
            fingers,
            tolerance,
            is_stopped: false,
            trajectory: None,
        }
    }

    /// Drives a `FollowJointTrajectory` controller by trajectories of the joints, beside the node of kinova-ros, whose
    /// server for poses is what tells a stopped arm: the controller takes trajectories all the same.
    pub fn by_trajectories(
        port: P,
        chain: Chain,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        let name = chain.model().to_owned();
        PortArm {
            way: Way::by_trajectories(chain),
            ..PortArm::by_poses(port, &name, fingers, tolerance)
        }
    }

    /// Refuses trajectories that bring a joint below a height; by poses that cannot be known, and this does nothing.
    ///
    /// - `floor_m`: base frame, metres.
    pub fn with_floor(mut self, floor_m: f64) -> PortArm<P> {
        if let Way::Trajectories(trajectories) = &mut self.way {
            trajectories.floor_m = floor_m;
        }
        self
    }

    /// Returns the port, e.g. to look at a simulated arm.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Returns where the arm is, with what its way of motion needs to know.
    fn here(&mut self) -> Result<ArmState, ArmError> {
        match self.way {
            Way::Poses => state(&mut self.port, &self.tolerance),
            Way::Trajectories(_) => state_with_joints(&mut self.port, &self.tolerance),
        }
    }

    /// Carries a goal of the tool out.
    fn carry(
        &mut self,
        goal: &Goal,
        limit_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Word, ArmError> {
        let mut sent = None;
        let word = carry_out(
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
        if word == Err(ArmError::Stopped) {
            self.is_stopped = true;
        }
        word
    }

    /// Sends a pose that is no motion, which a stopped arm refuses.
    fn probe(&mut self, watch: &mut Watch<'_>) -> Result<Word, ArmError> {
        let here = state(&mut self.port, &self.tolerance)?;
        self.carry(&Goal::ToolPose(here.tool), PROBE_S, watch)
    }

    /// Finds out whether the arm takes motion.
    fn check_enabled(&mut self, watch: &mut Watch<'_>) -> Result<(), ArmError> {
        if self.is_stopped {
            return Err(ArmError::Stopped);
        }
        for _ in 0..PROBES {
            match self.probe(watch)? {
                Word::Ended(Ending::Succeeded) => return Ok(()),
                Word::Ended(Ending::Aborted | Ending::Rejected) => {
                    self.is_stopped = true;
                    return Err(ArmError::Stopped);
                }
                Word::Ended(Ending::Preempted) => break,
                // Its end may have got lost on the way.
                Word::None => {}
            }
        }
        Err(ArmError::Late { after_s: PROBE_S })
    }

    /// Returns where the arm is, at rest and let go by whoever watches.
    fn may_go(&mut self, watch: &mut Watch<'_>) -> Result<ArmState, ArmError> {
        let here = self.here()?;
        match watch(&here) {
            Ok(()) => Ok(here),
            Err(Halt::Pause) => Err(ArmError::Paused),
            Err(Halt::Stop(why)) => Err(why),
        }
    }

    fn is_there(&self, off: Off) -> bool {
        off.position_m <= self.tolerance.position_m
            && off.angle_rad <= self.tolerance.angle_deg.to_radians()
    }

    /// Verifies a stop: the arm is at rest and refuses a pose that is no motion.
    fn is_verified(&mut self) -> Result<bool, ArmError> {
        if !is_at_rest(&mut self.port, &self.tolerance)? {
            return Ok(false);
        }
        let word = self.probe(&mut |_: &ArmState| Ok(()))?;
        Ok(matches!(
            word,
            Word::Ended(Ending::Aborted | Ending::Rejected)
        ))
    }

    /// Ends what the controller of trajectories was sent last, so that it does not go on once the arm is let go.
    fn end_trajectory(&mut self) -> Result<(), ArmError> {
        let Some(id) = self.trajectory.clone() else {
            return Ok(());
        };
        match self.port.state(&id) {
            GoalState::Ended(Ending::Succeeded | Ending::Preempted | Ending::Rejected) => {
                self.trajectory = None;
                return Ok(());
            }
            // Its server is done with it; its controller may not be, and only another trajectory takes its place.
            GoalState::Ended(Ending::Aborted) => {
                let joints = state_with_joints(&mut self.port, &self.tolerance)?.joints_rad;
                self.trajectory = Some(self.port.send(&hold(&joints))?);
            }
            GoalState::Sent | GoalState::Active => self.port.cancel(&id)?,
        }
        let begun_s = self.port.now_s();
        let mut last = GoalState::Sent;
        while self.port.now_s() - begun_s < CANCEL_S && !matches!(last, GoalState::Ended(_)) {
            self.port.wait(CANCEL_LOOK_S);
            last = match &self.trajectory {
                Some(id) => self.port.state(id),
                None => return Ok(()),
            };
        }
        match last {
            GoalState::Ended(_) => self.trajectory = None,
            // It never arrived.
            GoalState::Sent => {}
            GoalState::Active => return Err(ArmError::Late { after_s: CANCEL_S }),
        }
        Ok(())
    }

    /// Stops the arm, and tells whether that is verified.
    fn try_stop(&mut self) -> Result<bool, ArmError> {
        let stopped = self.port.stop();
        if self.trajectory.is_some() {
            self.end_trajectory()?;
            // Some versions of the controller take a cancellation, too, as a reason to enable the arm.
            self.port.stop()?;
        }
        stopped?;
        self.is_verified()
    }
}

impl<P: Port> Arm for PortArm<P> {
    fn name(&self) -> String {
        self.name.clone()
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
        to: &Isometry3<f64>,
        speed_m_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        self.check_enabled(watch)?;
        let mut tries = 0;
        loop {
            let from = self.may_go(watch)?;
            let goal = self.way.goal(&from, to, speed_m_s)?;
            let way_s = Off::between(&from.tool, to).position_m / speed_m_s;
            let limit_s = 2.0 * lasts_s(&goal).unwrap_or(way_s) + self.tolerance.settle_s;
            let word = self.carry(&goal, limit_s, watch)?;
            let now = come_to_rest(&mut self.port, &self.tolerance, watch)?;
            let off = Off::between(&now.tool, to);
            if self.is_there(off) {
                return Ok(now);
            }
            match word {
                Word::Ended(Ending::Preempted) => return Err(ArmError::Stalled { off }),
                Word::Ended(Ending::Aborted | Ending::Rejected) => {
                    // Refused because it is stopped, or for a reason of the node's own.
                    self.check_enabled(watch)?;
                    return Err(ArmError::NotThere {
                        said: word.name().to_owned(),
                        off,
                    });
                }
                Word::None => {
                    // A stop does not end a trajectory; a pose under way would give way to the question.
                    if let Way::Trajectories(_) = self.way {
                        self.check_enabled(watch)?;
                    }
                    return Err(ArmError::Late { after_s: limit_s });
                }
                Word::Ended(Ending::Succeeded) if tries < self.tolerance.corrections => tries += 1,
                Word::Ended(Ending::Succeeded) => {
                    return Err(ArmError::NotThere {
                        said: word.name().to_owned(),
                        off,
                    });
                }
            }
        }
    }

    fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<Between, ArmError> {
        self.check_enabled(watch)?;
        let (fingers, tolerance) = (self.fingers, self.tolerance);
        let closed = move_fingers(&mut self.port, &fingers, &tolerance, opening, watch);
        // Only once no goal is under way: one that is would give way, and the node then lets a stopped arm go.
        let may_be_stopped = match &closed {
            Ok(closed) => closed.was_given_up,
            Err(error) => matches!(error, ArmError::Fingers { .. }),
        };
        if may_be_stopped {
            // An arm that was stopped meanwhile leaves its fingers anywhere: that is the reason to tell.
            self.check_enabled(watch)?;
        }
        closed.map(|closed| closed.between)
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        self.is_stopped = true;
        let mut why = String::new();
        for _ in 0..STOPS {
            match self.try_stop() {
                Ok(true) => return Ok(()),
                Ok(false) => why = "it still takes goals, or moves".to_owned(),
                Err(error) => why = error.to_string(),
            }
        }
        Err(ArmError::NotStopped { why })
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        let nobody = &mut |_: &ArmState| Ok(());
        if let Way::Trajectories(_) = self.way {
            // Whatever its controller has left to do, and whoever sent it, it is not to go on with it.
            let joints = state_with_joints(&mut self.port, &self.tolerance)?.joints_rad;
            let word = self.carry(&hold(&joints), PROBE_S, nobody)?;
            // It is enough that the controller took it; whether a held arm counts as arrived is the server's taste.
            let is_taken = match (word, &self.trajectory) {
                (Word::Ended(ending), _) => ending != Ending::Rejected,
                (Word::None, Some(id)) => self.port.state(id) == GoalState::Active,
                (Word::None, None) => false,
            };
            if !is_taken {
                return Err(ArmError::Late { after_s: PROBE_S });
            }
        }
        self.port.start()?;
        self.is_stopped = false;
        if !is_at_rest(&mut self.port, &self.tolerance)? {
            self.stop()?;
            return Err(ArmError::OutOfLimits(
                "the arm moved by itself when it was let go".to_owned(),
            ));
        }
        self.check_enabled(nobody)
    }
}

//! Moves an arm through a port, and looks itself where the arm came to.
//!
//! What the arm's node calls reached may be 10 mm and 2 degrees off, a cancelled or stalled goal leaves the arm enabled,
//! and nothing says that it is stopped but a goal that is refused. So each motion begins with a goal that is no motion
//! (the pose in which the arm is), ends with looks at the pose, and a stop is asked for until such a goal is refused.
//! After a stop nothing is cancelled and nothing else sent: the node takes either as a reason to enable the arm.

use super::carry::{LOOK_S, Word, carry_out, state};
use super::fingers::move_fingers;
use super::{Arm, ArmError, ArmState, Between, Off, Opening, Watch};
use crate::arm::kinematics::chain::Chain;
use crate::arm::port::{Ending, Goal, Port, Waypoint};
use crate::arm::settings::{FingerSettings, Tolerance};
use nalgebra::Isometry3;

/// A tool that moves less than this between two looks is at rest, metres.
const REST_M: f64 = 0.000_5;

/// How far apart in time two such looks are, seconds: more than the 0.1 s between two reports of kinova-ros.
const REST_S: f64 = 0.25;

/// How long a goal that is no motion may take, seconds.
const PROBE_S: f64 = 3.0;

/// How often a stop is asked for until it is verified.
const STOPS: u32 = 3;

/// The longest step between two points of a trajectory, metres.
const STEP_M: f64 = 0.01;

/// How motions are said to an arm's node.
enum Way {
    /// As poses of the tool; the node finds the joints.
    Poses,
    /// As trajectories of the joints, which this crate's kinematics find.
    Trajectories(Box<Chain>),
}

/// An arm behind a port.
pub struct PortArm<P: Port> {
    port: P,
    name: String,
    way: Way,
    fingers: FingerSettings,
    tolerance: Tolerance,
    /// Whether this driver stopped it, or saw that it is stopped, and nobody let it go since.
    is_stopped: bool,
}

impl<P: Port> PortArm<P> {
    /// Drives the node of kinova-ros by poses of the tool.
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
        }
    }

    /// Drives a `FollowJointTrajectory` controller by trajectories of the joints.
    pub fn by_trajectories(
        port: P,
        chain: Chain,
        fingers: FingerSettings,
        tolerance: Tolerance,
    ) -> PortArm<P> {
        let name = chain.model().to_owned();
        PortArm {
            way: Way::Trajectories(Box::new(chain)),
            ..PortArm::by_poses(port, &name, fingers, tolerance)
        }
    }

    /// Returns the port, e.g. to look at a simulated arm.
    pub fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Finds out whether the arm takes motion, by a goal that is none.
    fn check_enabled(&mut self, watch: &mut Watch<'_>) -> Result<(), ArmError> {
        if self.is_stopped {
            return Err(ArmError::Stopped);
        }
        let here = state(&mut self.port, &self.tolerance)?;
        let goal = self.goal(&here, &here.tool, f64::INFINITY)?;
        let word = carry_out(&mut self.port, &goal, PROBE_S, &self.tolerance, watch)?;
        match word {
            Word::Ended(Ending::Succeeded) => Ok(()),
            Word::Ended(Ending::Aborted | Ending::Rejected) => {
                self.is_stopped = true;
                Err(ArmError::Stopped)
            }
            Word::Ended(Ending::Preempted) | Word::None => Err(ArmError::Late { after_s: PROBE_S }),
        }
    }

    /// Says a motion to a pose in the words of the arm's node.
    fn goal(&self, from: &ArmState, to: &Isometry3<f64>, speed_m_s: f64) -> Result<Goal, ArmError> {
        let Way::Trajectories(chain) = &self.way else {
            return Ok(Goal::ToolPose(*to));
        };
        let no_way = |why: String| ArmError::NoWay(why);
        let off = Off::between(&from.tool, to);
        if off.position_m < 1e-6 && off.angle_rad < 1e-6 {
            return Ok(Goal::Trajectory(vec![Waypoint {
                joints_rad: from.joints_rad.clone(),
                at_s: LOOK_S,
            }]));
        }
        let points = chain
            .straight(&from.tool, to, &from.joints_rad, STEP_M)
            .map_err(|why| no_way(why.to_string()))?;
        let step_s = off.position_m / speed_m_s / (points.len().max(2) - 1) as f64;
        let mut at_s = 0.0;
        let mut before = from.joints_rad.clone();
        let mut waypoints = Vec::with_capacity(points.len());
        for joints_rad in points {
            // No joint is faster than it can be, whatever the tool's speed.
            let turns = joints_rad.iter().zip(&before).zip(chain.joints());
            let slowest_s = turns
                .map(|((a, b), joint)| (a - b).abs() / joint.max_speed_rad_s)
                .fold(0.0, f64::max);
            at_s += step_s.max(slowest_s).max(1e-3);
            before = joints_rad.clone();
            waypoints.push(Waypoint { joints_rad, at_s });
        }
        Ok(Goal::Trajectory(waypoints))
    }

    /// Returns the state in which the arm comes to rest; fails where it does not.
    fn at_rest(&mut self, watch: &mut Watch<'_>) -> Result<ArmState, ArmError> {
        let begun_s = self.port.now_s();
        let mut before = state(&mut self.port, &self.tolerance)?;
        while self.port.now_s() - begun_s <= self.tolerance.settle_s {
            self.port.wait(REST_S);
            let now = state(&mut self.port, &self.tolerance)?;
            match watch(&now) {
                Ok(()) => {}
                Err(super::Halt::Pause) => return Err(ArmError::Paused),
                Err(super::Halt::Stop(why)) => return Err(why),
            }
            // Only something that was said since tells of rest.
            if now.at_s > before.at_s {
                if Off::between(&now.tool, &before.tool).position_m < REST_M {
                    return Ok(now);
                }
                before = now;
            }
        }
        Err(ArmError::Late {
            after_s: self.port.now_s() - begun_s,
        })
    }

    fn is_there(&self, off: Off) -> bool {
        off.position_m <= self.tolerance.position_m
            && off.angle_rad <= self.tolerance.angle_deg.to_radians()
    }

    /// Tells whether the arm refuses a goal that is no motion, so that it takes none.
    fn refuses(&mut self) -> Result<bool, ArmError> {
        let here = state(&mut self.port, &self.tolerance)?;
        let goal = self.goal(&here, &here.tool, f64::INFINITY)?;
        let nobody = &mut |_: &ArmState| Ok(());
        let word = carry_out(&mut self.port, &goal, PROBE_S, &self.tolerance, nobody)?;
        Ok(matches!(
            word,
            Word::Ended(Ending::Aborted | Ending::Rejected)
        ))
    }

    /// Tells whether the tool stays where it is.
    fn is_at_rest(&mut self) -> Result<bool, ArmError> {
        let before = state(&mut self.port, &self.tolerance)?;
        self.port.wait(2.0 * REST_S);
        let after = state(&mut self.port, &self.tolerance)?;
        let moved_m = Off::between(&before.tool, &after.tool).position_m;
        Ok(after.at_s > before.at_s && moved_m < REST_M)
    }

    /// Verifies a stop: the arm is at rest and, where its node has such a state, refuses a goal.
    fn is_verified(&mut self) -> Result<bool, ArmError> {
        if !self.is_at_rest()? {
            return Ok(false);
        }
        match self.way {
            Way::Poses => self.refuses(),
            // A controller of trajectories knows no stopped state: what holds it is that nothing is sent any more.
            Way::Trajectories(_) => Ok(true),
        }
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
            let from = self.state()?;
            let goal = self.goal(&from, to, speed_m_s)?;
            let way_s = Off::between(&from.tool, to).position_m / speed_m_s;
            let limit_s = 2.0 * way_s + self.tolerance.settle_s;
            let word = carry_out(&mut self.port, &goal, limit_s, &self.tolerance, watch)?;
            let now = self.at_rest(watch)?;
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
                Word::None => return Err(ArmError::Late { after_s: limit_s }),
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
        let between = move_fingers(&mut self.port, &fingers, &tolerance, opening, watch);
        // Only once no goal is under way: one that is would give way, and the node then lets a stopped arm go.
        if let Err(ArmError::Fingers { .. }) = between {
            // An arm that was stopped meanwhile leaves its fingers anywhere: that is the reason to tell.
            self.check_enabled(watch)?;
        }
        between
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        self.is_stopped = true;
        let mut why = String::new();
        for _ in 0..STOPS {
            if let Err(error) = self.port.stop() {
                why = error.to_string();
                continue;
            }
            match self.is_verified() {
                Ok(true) => return Ok(()),
                Ok(false) => why = "it still takes goals, or moves".to_owned(),
                Err(error) => why = error.to_string(),
            }
        }
        Err(ArmError::NotStopped { why })
    }

    fn enable(&mut self) -> Result<(), ArmError> {
        self.port.start()?;
        self.is_stopped = false;
        let nobody = &mut |_: &ArmState| Ok(());
        self.check_enabled(nobody)
    }
}

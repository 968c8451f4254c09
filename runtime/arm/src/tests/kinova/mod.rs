//! A simulated arm that behaves like the node of kinova-ros, for tests.
//!
//! In: the messages of a [`Port`], on a clock that only [`Port::wait`] advances. Out: a moving [`SimulatedArm`], and reports
//! that arrive late. As with kinova-ros, readings come ten times a second; a goal counts as reached within 10 mm and
//! 2 degrees; a goal that is cancelled, preempted or stalls makes the node stop the arm and *start it again*; and a
//! stopped arm aborts every goal, except a trajectory, which waits until the arm is enabled and is aborted after twice
//! its duration. Tests of other packages include this folder by its path, with the crate as `arm`.

mod body;
mod node;

use super::arm::port::{GoalId, GoalState, Port, PortError, Reading, Readings, Stamps, Waypoint};
use super::arm::settings::Settings;
use super::arm::simulated::SimulatedArm;
use body::Body;
use nalgebra::Isometry3;
use node::{Goal, Node};

/// A step of the clock, seconds.
const TICK_S: f64 = 0.01;

/// Time between two readings, seconds (kinova-ros: `status_interval_seconds`).
const READING_S: f64 = 0.1;

/// How far the arm's own clock is ahead of the port's, seconds: clocks of two machines differ.
const AHEAD_S: f64 = 1000.0;

/// A simulated arm and the node that moves it.
pub struct KinovaArm {
    body: Body,
    node: Node,
    clock_s: f64,
    readings: Readings,
    read_s: f64,
    stamps: Stamps,
}

impl KinovaArm {
    /// Puts the node before an arm.
    ///
    /// - `seed`: determines where within its repeatability the arm comes to rest.
    pub fn around(arm: SimulatedArm, settings: &Settings, seed: u64) -> KinovaArm {
        let mut arm = KinovaArm {
            body: Body::new(arm, settings, seed),
            node: Node::default(),
            clock_s: 0.0,
            readings: Readings::default(),
            read_s: f64::NEG_INFINITY,
            stamps: Stamps::default(),
        };
        arm.read();
        arm
    }

    /// Returns whether the arm is stopped.
    pub fn is_stopped(&self) -> bool {
        self.node.is_stopped()
    }

    /// Returns the true pose of the tool, `base_from_tool`; readings of it arrive later.
    pub fn tool(&self) -> Isometry3<f64> {
        self.body.tool()
    }

    /// Returns whether a goal is being executed.
    pub fn is_busy(&self) -> bool {
        self.node.is_busy()
    }

    /// Jams the joints for good.
    pub fn jam_joints(&mut self) {
        self.body.stick();
    }

    /// Jams the fingers for good.
    pub fn jam_fingers(&mut self) {
        self.body.stick_fingers();
    }

    /// Takes the first joint off its path, by an angle in radians.
    pub fn run_away(&mut self, by_rad: f64) {
        self.body.run_away(by_rad);
    }

    fn tick(&mut self) {
        self.clock_s += TICK_S;
        self.body.advance();
        self.node.advance(self.clock_s, &mut self.body);
        if self.clock_s - self.read_s >= READING_S - 1e-9 {
            self.read();
        }
    }

    fn read(&mut self) {
        self.read_s = self.clock_s;
        let stamp_s = AHEAD_S + self.clock_s;
        let Some(at_s) = self.stamps.taken_s(stamp_s, self.clock_s) else {
            return;
        };
        self.readings = Readings {
            tool: Some(Reading {
                value: self.body.tool(),
                at_s,
            }),
            joints_rad: Some(Reading {
                value: self.body.joints_rad().to_vec(),
                at_s,
            }),
            fingers: Some(Reading {
                value: self.body.fingers().to_vec(),
                at_s,
            }),
        };
    }

    fn send(&mut self, goal: Goal) -> GoalId {
        self.node.send(goal, self.clock_s)
    }
}

impl Port for KinovaArm {
    fn now_s(&self) -> f64 {
        self.clock_s
    }

    fn wait(&mut self, seconds: f64) {
        let ticks = (seconds.clamp(0.0, 3600.0) / TICK_S).round().max(1.0) as u64;
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        Ok(self.send(Goal::Trajectory(points.to_vec())))
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        Ok(self.send(Goal::Pose(*tool)))
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        Ok(self.send(Goal::Fingers(positions.to_vec())))
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        self.node.goal_state(goal, self.clock_s)
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.node.cancel(goal, self.clock_s);
        Ok(())
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.node.stop(&mut self.body);
        Ok(())
    }

    fn probe(&mut self) -> Result<Option<GoalId>, PortError> {
        let here = self.readings.tool;
        here.map(|here| self.send_pose(&here.value)).transpose()
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.node.start(&mut self.body);
        Ok(())
    }

    fn state(&mut self) -> Readings {
        self.readings.clone()
    }
}

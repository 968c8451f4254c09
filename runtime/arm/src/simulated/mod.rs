//! A simulated arm that behaves like the node of the real one.
//!
//! In: the messages of a [`Port`], on a clock that only [`Port::wait`] advances. Out: moving joints and fingers,
//! reports that arrive late, and cloth under the hand. As with kinova-ros, readings come ten times a second; a
//! goal counts as reached within 10 mm and 2 degrees; a goal that is cancelled, preempted or stalls makes the node stop
//! the arm and *start it again*; and a stopped arm aborts every goal, except a trajectory, which waits until the arm is
//! enabled and is aborted after twice its duration. There are no dynamics: joints are where their motion says, which
//! takes the time that plans state, and a stop ends it at once.

mod body;
mod node;

pub use body::SimulatedTable;

use super::kinematics::chain::Chain;
use super::kinematics::reach::Reach;
use super::port::{
    AfterStop, GoalId, GoalState, Port, PortError, Reading, Readings, Stamps, Waypoint,
};
use super::settings::{FingerSettings, Settings};
use super::timing::JointLimits;
use body::Body;
use nalgebra::{Isometry3, Point3};
use node::{Goal, Node};
use std::cell::RefCell;
use std::rc::Rc;

/// A step of the clock, seconds.
const TICK_S: f64 = 0.01;

/// Time between two readings, seconds (kinova-ros: `status_interval_seconds`).
const READING_S: f64 = 0.1;

/// How far the arm's own clock is ahead of the port's, seconds: clocks of two machines differ.
const AHEAD_S: f64 = 1000.0;

/// How far from its target the tool comes to rest at most, metres.
const REPEATABILITY_M: f64 = 0.001;

/// A simulated arm and the node that moves it.
pub struct SimulatedArm {
    body: Body,
    node: Node,
    clock_s: f64,
    readings: Readings,
    read_s: f64,
    stamps: Stamps,
}

/// How an arm is simulated.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Its joints.
    pub chain: Chain,
    /// How fast they turn in Cartesian goals.
    pub joint_limits: JointLimits,
    /// The meaning of its finger positions.
    pub fingers: FingerSettings,
    /// Initial joint angles, radians.
    pub joints_rad: Vec<f64>,
    /// Speed of the tool in Cartesian goals, m/s; the real node accepts none.
    pub speed_m_s: f64,
    /// Largest distance between a goal and the end of its motion, metres.
    pub repeatability_m: f64,
    /// Seeds everything random.
    pub seed: u64,
}

impl Simulation {
    /// Makes a simulation of the settings' arm, starting at `rest_m`; the error says why it cannot be there.
    pub fn of(settings: &Settings) -> Result<Simulation, String> {
        let chain = settings.chain().clone();
        let [x, y, z] = settings.workspace.rest_m;
        let turn_rad = settings.motion.hand_turn_deg.to_radians();
        let joints_rad = Reach::tool_down(&chain, turn_rad)
            .check(&Point3::new(x, y, z), &[0.0])
            .map_err(|why| format!("the arm cannot rest at `rest_m`: {why}"))?;
        Ok(Simulation {
            joint_limits: JointLimits::of(settings, &chain),
            chain,
            fingers: settings.fingers,
            joints_rad,
            speed_m_s: settings.motion.speed_m_s,
            repeatability_m: REPEATABILITY_M,
            seed: 0,
        })
    }
}

impl SimulatedArm {
    /// Sets up an arm, over a table if there is one.
    pub fn new(
        simulation: Simulation,
        table: Option<Rc<RefCell<dyn SimulatedTable>>>,
    ) -> SimulatedArm {
        let body = Body::new(simulation, table);
        let mut arm = SimulatedArm {
            body,
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

    /// Jams the joints for good, for tests.
    pub fn jam_joints(&mut self) {
        self.body.stick();
    }

    /// Jams the fingers for good, for tests.
    pub fn jam_fingers(&mut self) {
        self.body.stick_fingers();
    }

    /// Takes the first joint off its path, by an angle in radians, for tests.
    pub fn run_away(&mut self, by_rad: f64) {
        self.body.run_away(by_rad);
    }

    fn tick(&mut self) {
        self.clock_s += TICK_S;
        self.body.advance(TICK_S);
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

impl Port for SimulatedArm {
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

    fn after_stop(&self) -> AfterStop {
        AfterStop::Refuses
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.node.start(&mut self.body);
        Ok(())
    }

    fn state(&mut self) -> Readings {
        self.readings.clone()
    }
}

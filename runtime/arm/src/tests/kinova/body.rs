//! Joints and fingers of the vendor's arm: a simulated arm that takes poses, and holds trajectories during a stop.

use super::super::arm::guard::STEP_M;
use super::super::arm::kinematics::chain::Chain;
use super::super::arm::port::{Port, Waypoint};
use super::super::arm::settings::Settings;
use super::super::arm::simulated::SimulatedArm;
use super::super::arm::timing::JointLimits;
use super::TICK_S;
use fab_base::chance::Chance;
use nalgebra::{Isometry3, Translation3, Vector3};

/// A shorter way is no motion, metres.
const LEAST_M: f64 = 1e-4;

/// How far from its target the tool comes to rest at most, metres.
const REPEATABILITY_M: f64 = 0.001;

/// A joint motion in progress.
struct Motion {
    points: Vec<Waypoint>,
    for_s: f64,
    /// Whether it waits during a stop and then resumes, as a trajectory in its controller does.
    outlives_stop: bool,
}

/// Joints and fingers.
pub(super) struct Body {
    arm: SimulatedArm,
    chain: Chain,
    joint_limits: JointLimits,
    speed_m_s: f64,
    finger_way: f64,
    motion: Option<Motion>,
    /// The end of the last Cartesian goal: where the joints come to rest, and where they were commanded to.
    arrival: Option<(Vec<f64>, Vec<f64>)>,
    finger_goal: Option<f64>,
    chance: Chance,
    is_stopped: bool,
    is_stuck: bool,
    are_fingers_stuck: bool,
}

impl Body {
    pub(super) fn new(arm: SimulatedArm, settings: &Settings, seed: u64) -> Body {
        let chain = settings.chain().clone();
        Body {
            arm,
            joint_limits: JointLimits::of(settings, &chain),
            chain,
            speed_m_s: settings.motion.speed_m_s,
            finger_way: (settings.fingers.closed - settings.fingers.open).abs(),
            motion: None,
            arrival: None,
            finger_goal: None,
            chance: Chance::seeded(seed),
            is_stopped: false,
            is_stuck: false,
            are_fingers_stuck: false,
        }
    }

    pub(super) fn joints_rad(&self) -> &[f64] {
        self.arm.joints_rad()
    }

    pub(super) fn fingers(&self) -> &[f64] {
        self.arm.fingers()
    }

    /// Returns how far the fingers go from open to closed, in their own units.
    pub(super) fn finger_way(&self) -> f64 {
        self.finger_way
    }

    pub(super) fn tool(&self) -> Isometry3<f64> {
        self.arm.tool()
    }

    fn tool_at(&self, joints_rad: &[f64]) -> Isometry3<f64> {
        let tool = self.chain.base_from_tool(joints_rad);
        tool.expect("a body's joints are its chain's")
    }

    /// Starts a straight motion to a pose, within the repeatability; fails if there is no joint path.
    pub(super) fn move_straight(&mut self, to: &Isometry3<f64>) -> Result<(), String> {
        let is_motion = |from: &Isometry3<f64>| {
            (to.translation.vector - from.translation.vector).norm() > LEAST_M
        };
        let is_new = is_motion(&self.tool());
        let here = self.joints_rad().to_vec();
        let begin = if is_new && is_motion(&self.tool_at(self.commanded())) {
            self.commanded().to_vec()
        } else {
            // A probe goes nowhere; the same goal once more is a way from where the joints are.
            here.clone()
        };
        let from = self.tool_at(&begin);
        let path = self.chain.straight(&begin, to, STEP_M);
        let path = path.map_err(|why| why.to_string())?;
        let way_m = (to.translation.vector - from.translation.vector).norm();
        let mut points = self.joint_limits.time(&path, way_m, self.speed_m_s)?;
        if let Some(commanded) = points.last().map(|last| last.joints_rad.clone())
            && is_new
        {
            let off = Vector3::from_fn(|_, _| {
                (2.0 * self.chance.fraction() - 1.0) * REPEATABILITY_M * 0.577
            });
            let mut reached = *to;
            reached.translation = Translation3::from(to.translation.vector + off);
            let reached = self.chain.straight(&commanded, &reached, STEP_M)?;
            let reached = reached.last().cloned().unwrap_or_default();
            // Where the joints are differs from where they are commanded to be, and that changes evenly.
            let steps = (points.len() - 1).max(1) as f64;
            for (step, point) in points.iter_mut().enumerate() {
                let share = step as f64 / steps;
                for (joint, angle) in point.joints_rad.iter_mut().enumerate() {
                    let before = here[joint] - begin[joint];
                    let after = reached[joint] - commanded[joint];
                    *angle += before + share * (after - before);
                }
            }
            self.arrival = Some((reached, commanded));
        }
        self.follow(&points, false)
    }

    /// Returns the angles to which the joints were commanded: of the goal that they have reached, else where they are.
    fn commanded(&self) -> &[f64] {
        match &self.arrival {
            Some((reached, commanded)) if reached == self.joints_rad() => commanded,
            _ => self.joints_rad(),
        }
    }

    /// Starts a motion through points that a stop only suspends; fails if they do not fit the arm.
    pub(super) fn stream(&mut self, points: &[Waypoint]) -> Result<(), String> {
        self.follow(points, true)
    }

    fn follow(&mut self, points: &[Waypoint], outlives_stop: bool) -> Result<(), String> {
        let joints = self.joints_rad().len();
        let fit = points.iter().all(|point| {
            point.joints_rad.len() == joints
                && point.at_s.is_finite()
                && point.joints_rad.iter().all(|angle| angle.is_finite())
        });
        if points.is_empty() || !fit {
            return Err("a trajectory's points are not this arm's".to_owned());
        }
        self.motion = Some(Motion {
            points: points.to_vec(),
            for_s: 0.0,
            outlives_stop,
        });
        self.resume();
        Ok(())
    }

    /// Goes on with the motions that are left.
    fn resume(&mut self) {
        let _ = self.arm.stop();
        if let Some(motion) = &self.motion
            && !self.is_stuck
            && !self.is_stopped
        {
            let left = motion.points.iter().map(|point| Waypoint {
                at_s: point.at_s - motion.for_s,
                ..point.clone()
            });
            // A probe's only point is where the arm is.
            let left: Vec<Waypoint> = left.collect();
            let _ = self.arm.send_trajectory(&left);
        }
        if let Some(goal) = self.finger_goal
            && !self.are_fingers_stuck
        {
            let _ = self.arm.send_fingers(&[goal]);
        }
    }

    /// Starts a motion of the fingers.
    pub(super) fn move_fingers(&mut self, position: f64) {
        self.finger_goal = Some(position);
        if !self.are_fingers_stuck {
            let _ = self.arm.send_fingers(&[position]);
        }
    }

    /// Ends every motion where it is.
    pub(super) fn halt(&mut self) {
        self.motion = None;
        self.finger_goal = None;
        self.resume();
    }

    /// Suspends all motion until `start`.
    pub(super) fn stop(&mut self) {
        self.is_stopped = true;
        self.finger_goal = None;
        self.motion = self.motion.take().filter(|motion| motion.outlives_stop);
        self.resume();
    }

    /// Allows motion again, and resumes what a stop only suspended.
    pub(super) fn start(&mut self) {
        let was_stopped = std::mem::take(&mut self.is_stopped);
        if was_stopped {
            self.resume();
        }
    }

    pub(super) fn stick(&mut self) {
        let was_stuck = std::mem::replace(&mut self.is_stuck, true);
        if !was_stuck {
            self.resume();
        }
    }

    pub(super) fn stick_fingers(&mut self) {
        let were_stuck = std::mem::replace(&mut self.are_fingers_stuck, true);
        if !were_stuck {
            self.resume();
        }
    }

    /// Turns the first joint, whatever the goal is.
    pub(super) fn run_away(&mut self, by_rad: f64) {
        self.motion = None;
        if !self.is_stuck {
            let mut turned = self.joints_rad().to_vec();
            turned[0] += by_rad;
            let _ = self
                .arm
                .send_trajectory(&[Waypoint::at_rest(turned, TICK_S)]);
        }
    }

    /// Advances time by a tick.
    pub(super) fn advance(&mut self) {
        if let Some(motion) = &mut self.motion
            && !self.is_stuck
            && !self.is_stopped
        {
            motion.for_s += TICK_S;
            if motion.points.iter().all(|point| point.at_s <= motion.for_s) {
                self.motion = None;
            }
        }
        self.arm.wait(TICK_S);
    }
}

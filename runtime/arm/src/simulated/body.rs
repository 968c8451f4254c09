//! Joints and fingers of a simulated arm, and the table under its hand.

use super::Simulation;
use crate::guard::STEP_M;
use crate::kinematics::chain::Chain;
use crate::port::Waypoint;
use crate::settings::FingerSettings;
use fab_base::chance::Chance;
use nalgebra::{Isometry3, Translation3, Vector3};
use std::cell::RefCell;
use std::rc::Rc;

/// Speed of the fingers: a second from open to closed.
const FINGER_S: f64 = 1.0;

/// Cloth keeps the fingers open by this share of their travel.
const CLOTH_SHARE: f64 = 0.08;

/// A shorter way is no motion, metres.
const LEAST_M: f64 = 1e-4;

/// A table with cloth on it, under a hand.
pub trait SimulatedTable {
    /// Advances time with the hand at a pose.
    ///
    /// - `tool`: `base_from_tool`.
    /// - `are_closed`: whether the fingers are closed as far as they go.
    fn advance(&mut self, seconds: f64, tool: &Isometry3<f64>, are_closed: bool);

    /// Returns whether cloth is between the fingers at a tool pose.
    fn is_cloth_between_fingers(&self, tool: &Isometry3<f64>) -> bool;
}

/// A joint motion in progress.
struct Motion {
    /// At least two; the first is where the joints were at its start.
    points: Vec<Waypoint>,
    for_s: f64,
    /// Whether it waits during a stop and then resumes, as a trajectory in its controller does.
    outlives_stop: bool,
}

/// Joints and fingers.
pub(super) struct Body {
    simulation: Simulation,
    joints_rad: Vec<f64>,
    motion: Option<Motion>,
    /// The end of the last Cartesian goal: where the joints come to rest, and where they were commanded to.
    arrival: Option<(Vec<f64>, Vec<f64>)>,
    fingers: Vec<f64>,
    finger_goal: Option<f64>,
    table: Option<Rc<RefCell<dyn SimulatedTable>>>,
    chance: Chance,
    is_stopped: bool,
    is_stuck: bool,
    are_fingers_stuck: bool,
}

impl Body {
    pub(super) fn new(
        simulation: Simulation,
        table: Option<Rc<RefCell<dyn SimulatedTable>>>,
    ) -> Body {
        let FingerSettings { count, open, .. } = simulation.fingers;
        Body {
            joints_rad: simulation.joints_rad.clone(),
            motion: None,
            arrival: None,
            fingers: vec![open; count],
            finger_goal: None,
            table,
            chance: Chance::seeded(simulation.seed),
            is_stopped: false,
            is_stuck: false,
            are_fingers_stuck: false,
            simulation,
        }
    }

    pub(super) fn chain(&self) -> &Chain {
        &self.simulation.chain
    }

    pub(super) fn joints_rad(&self) -> &[f64] {
        &self.joints_rad
    }

    pub(super) fn fingers(&self) -> &[f64] {
        &self.fingers
    }

    /// Returns how far the fingers go from open to closed, in their own units.
    pub(super) fn finger_way(&self) -> f64 {
        let FingerSettings { open, closed, .. } = self.simulation.fingers;
        (closed - open).abs()
    }

    pub(super) fn tool(&self) -> Isometry3<f64> {
        self.tool_at(&self.joints_rad)
    }

    fn tool_at(&self, joints_rad: &[f64]) -> Isometry3<f64> {
        let tool = self.chain().base_from_tool(joints_rad);
        tool.expect("a body's joints are its chain's")
    }

    /// Starts a straight motion to a pose, within the repeatability; fails if there is no joint path.
    pub(super) fn move_straight(&mut self, to: &Isometry3<f64>) -> Result<(), String> {
        let is_motion = |from: &Isometry3<f64>| {
            (to.translation.vector - from.translation.vector).norm() > LEAST_M
        };
        let is_new = is_motion(&self.tool());
        let begin = match is_new && is_motion(&self.tool_at(self.commanded())) {
            true => self.commanded().to_vec(),
            // A probe goes nowhere; the same goal once more is a way from where the joints are.
            false => self.joints_rad.clone(),
        };
        let from = self.tool_at(&begin);
        let path = self.chain().straight(&begin, to, STEP_M);
        let path = path.map_err(|why| why.to_string())?;
        let way_m = (to.translation.vector - from.translation.vector).norm();
        let limits = &self.simulation.joint_limits;
        let mut points = limits.time(&path, way_m, self.simulation.speed_m_s)?;
        if let Some(commanded) = points.last().map(|last| last.joints_rad.clone())
            && is_new
        {
            let most_m = self.simulation.repeatability_m;
            let off =
                Vector3::from_fn(|_, _| (2.0 * self.chance.fraction() - 1.0) * most_m * 0.577);
            let mut reached = *to;
            reached.translation = Translation3::from(to.translation.vector + off);
            let reached = self.chain().solve(&reached, &commanded);
            let reached = reached.map_err(|why| why.to_string())?;
            // Where the joints are differs from where they are commanded to be, and that changes evenly.
            let steps = (points.len() - 1).max(1) as f64;
            for (step, point) in points.iter_mut().enumerate() {
                let share = step as f64 / steps;
                for (joint, angle) in point.joints_rad.iter_mut().enumerate() {
                    let before = self.joints_rad[joint] - begin[joint];
                    let after = reached[joint] - commanded[joint];
                    *angle += before + share * (after - before);
                }
            }
            self.arrival = Some((reached, commanded));
        }
        self.follow(&points)
    }

    /// Returns the angles to which the joints were commanded: of the goal that they have reached, else where they are.
    fn commanded(&self) -> &[f64] {
        match &self.arrival {
            Some((reached, commanded)) if *reached == self.joints_rad => commanded,
            _ => &self.joints_rad,
        }
    }

    /// Starts a motion through points; fails if they do not fit the arm.
    pub(super) fn follow(&mut self, points: &[Waypoint]) -> Result<(), String> {
        let joints = self.joints_rad.len();
        let fit = points.iter().all(|point| {
            point.joints_rad.len() == joints
                && point.at_s.is_finite()
                && point.joints_rad.iter().all(|angle| angle.is_finite())
        });
        if points.is_empty() || !fit {
            return Err("a trajectory's points are not this arm's".to_owned());
        }
        // As a controller does, begin where the joints are.
        let mut way = vec![Waypoint::at_rest(self.joints_rad.clone(), 0.0)];
        way.extend(points.iter().filter(|point| point.at_s > 0.0).cloned());
        self.motion = Some(Motion {
            points: way,
            for_s: 0.0,
            outlives_stop: false,
        });
        Ok(())
    }

    /// Starts a motion through points that a stop only suspends; fails if they do not fit the arm.
    pub(super) fn stream(&mut self, points: &[Waypoint]) -> Result<(), String> {
        self.follow(points)?;
        if let Some(motion) = &mut self.motion {
            motion.outlives_stop = true;
        }
        Ok(())
    }

    /// Starts a motion of the fingers.
    pub(super) fn move_fingers(&mut self, position: f64) {
        self.finger_goal = Some(position);
    }

    /// Ends every motion where it is.
    pub(super) fn halt(&mut self) {
        self.motion = None;
        self.finger_goal = None;
    }

    /// Suspends all motion until `start`.
    pub(super) fn stop(&mut self) {
        self.is_stopped = true;
        self.finger_goal = None;
        self.motion = self.motion.take().filter(|motion| motion.outlives_stop);
    }

    /// Allows motion again, and resumes what a stop only suspended.
    pub(super) fn start(&mut self) {
        self.is_stopped = false;
    }

    pub(super) fn stick(&mut self) {
        self.is_stuck = true;
    }

    pub(super) fn stick_fingers(&mut self) {
        self.are_fingers_stuck = true;
    }

    /// Turns the first joint, whatever the goal is.
    pub(super) fn run_away(&mut self, by_rad: f64) {
        self.motion = None;
        if !self.is_stuck {
            self.joints_rad[0] += by_rad;
        }
    }

    /// Advances time.
    pub(super) fn advance(&mut self, seconds: f64) {
        if !self.is_stuck && !self.is_stopped {
            self.advance_joints(seconds);
        }
        let tool = self.tool();
        if !self.are_fingers_stuck {
            self.advance_fingers(seconds, &tool);
        }
        let FingerSettings { open, closed, .. } = self.simulation.fingers;
        let share = (self.fingers[0] - open) / (closed - open);
        if let Some(table) = &self.table {
            let are_closed = share >= 1.0 - 1.5 * CLOTH_SHARE;
            table.borrow_mut().advance(seconds, &tool, are_closed);
        }
    }

    fn advance_joints(&mut self, seconds: f64) {
        let Some(motion) = &mut self.motion else {
            return;
        };
        motion.for_s += seconds;
        let pairs = motion.points.windows(2);
        let mut ahead = pairs.filter(|pair| pair[1].at_s > motion.for_s);
        if let Some(pair) = ahead.next() {
            self.joints_rad = pair[0].towards(&pair[1], motion.for_s);
            return;
        }
        if let Some(motion) = self.motion.take()
            && let Some(last) = motion.points.last()
        {
            self.joints_rad.clone_from(&last.joints_rad);
        }
    }

    fn advance_fingers(&mut self, seconds: f64, tool: &Isometry3<f64>) {
        let Some(goal) = self.finger_goal else {
            return;
        };
        let FingerSettings { open, closed, .. } = self.simulation.fingers;
        let step = (closed - open).abs() * seconds / FINGER_S;
        let is_cloth_between_fingers = self
            .table
            .as_ref()
            .is_some_and(|table| table.borrow().is_cloth_between_fingers(tool));
        let stop = match is_cloth_between_fingers {
            true => closed - CLOTH_SHARE * (closed - open),
            false => closed,
        };
        for position in &mut self.fingers {
            let goal = match closed > open {
                true => goal.min(stop),
                false => goal.max(stop),
            };
            *position += (goal - *position).clamp(-step, step);
        }
    }
}

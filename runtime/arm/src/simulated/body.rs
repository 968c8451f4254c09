//! Joints and fingers of a simulated arm, and the table under its hand.

use super::Simulation;
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

/// The longest step between two points of a motion, metres.
const STEP_M: f64 = 0.02;

/// A table with cloth on it, under a hand.
pub trait SimulatedTable {
    /// Advances time with the hand at a pose.
    ///
    /// - `tool`: `base_from_tool`.
    /// - `are_closed`: whether the fingers are closed as far as they go.
    fn advance(&mut self, seconds: f64, tool: &Isometry3<f64>, are_closed: bool);

    /// Returns whether cloth is between the fingers at a tool pose.
    fn is_cloth_between_fingers(&self, tool: &Isometry3<f64>) -> bool;

    /// Makes the camera over the table stop delivering pictures.
    fn lose_camera(&mut self) {}
}

/// A joint motion in progress.
struct Motion {
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
        let tool = self.simulation.chain.base_from_tool(&self.joints_rad);
        tool.expect("a body's joints are its chain's")
    }

    /// Starts a straight motion to a pose, within the repeatability; fails if there is no joint path.
    ///
    /// - `short_m`: distance before the pose at which it ends.
    pub(super) fn move_straight(
        &mut self,
        to: &Isometry3<f64>,
        short_m: f64,
    ) -> Result<(), String> {
        let from = self.tool();
        let way = to.translation.vector - from.translation.vector;
        let way_m = way.norm();
        let mut aimed = *to;
        if way_m > 1e-4 {
            let most_m = self.simulation.repeatability_m;
            let off =
                Vector3::from_fn(|_, _| (2.0 * self.chance.fraction() - 1.0) * most_m * 0.577);
            let short = way * (short_m / way_m).min(1.0);
            aimed.translation = Translation3::from(to.translation.vector + off - short);
        }
        let points = self
            .chain()
            .straight(&from, &aimed, &self.joints_rad, STEP_M)
            .map_err(|why| why.to_string())?;
        let step_s = way_m / self.simulation.speed_m_s / points.len().max(1) as f64;
        let timed = points
            .into_iter()
            .enumerate()
            .map(|(index, joints_rad)| Waypoint {
                joints_rad,
                at_s: step_s.max(1e-3) * (index + 1) as f64,
            });
        self.motion = Some(Motion {
            points: timed.collect(),
            for_s: 0.0,
            outlives_stop: false,
        });
        Ok(())
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
        self.motion = Some(Motion {
            points: points.to_vec(),
            for_s: 0.0,
            outlives_stop: false,
        });
        Ok(())
    }

    /// Starts a motion through points that a stop only suspends; fails if they do not fit the arm.
    ///
    /// - `short_share`: the share of the last step that is left out.
    pub(super) fn stream(&mut self, points: &[Waypoint], short_share: f64) -> Result<(), String> {
        self.follow(points)?;
        let Some(motion) = &mut self.motion else {
            return Ok(());
        };
        motion.outlives_stop = true;
        if let [.., before, last] = motion.points.as_mut_slice() {
            for (angle, before) in last.joints_rad.iter_mut().zip(&before.joints_rad) {
                *angle -= short_share * (*angle - before);
            }
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

    /// Loses the camera over the table.
    pub(super) fn lose_camera(&mut self) {
        if let Some(table) = &self.table {
            table.borrow_mut().lose_camera();
        }
    }

    /// Turns the first joint, whatever the goal is.
    pub(super) fn run_away(&mut self, seconds: f64) {
        self.motion = None;
        if !self.is_stuck {
            self.joints_rad[0] += 0.3 * seconds;
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
        let before_s = motion.for_s;
        motion.for_s += seconds;
        let now_s = motion.for_s;
        // Use the last point whose time has come; this skips points closer together than a clock step.
        let ahead = motion
            .points
            .iter()
            .find(|point| point.at_s > now_s)
            .or(motion.points.last());
        let Some(next) = ahead.filter(|point| point.at_s > before_s) else {
            self.motion = None;
            return;
        };
        // Interpolate towards the next point by the share of the remaining time.
        let share = ((now_s - before_s) / (next.at_s - before_s)).min(1.0);
        for (angle, goal) in self.joints_rad.iter_mut().zip(&next.joints_rad) {
            *angle += share * (goal - *angle);
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

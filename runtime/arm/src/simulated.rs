//! A simulated arm: joints that follow trajectories, and fingers that close on cloth.
//!
//! In: the messages of a [`Port`], on a clock that only [`Port::wait`] advances. Out: moving joints and fingers, and readings
//! ten times a second. There are no dynamics: joints are where their trajectory says, which takes the time that plans
//! state. A stop ends every motion at once, and the arm takes goals afterwards.

use super::driver::ArmState;
use super::kinematics::chain::Chain;
use super::port::{Ending, GoalId, GoalState, Port, PortError, Reading, Readings, Waypoint};
use super::settings::{FingerSettings, Settings};
use nalgebra::Isometry3;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// A step of the clock, seconds.
const TICK_S: f64 = 0.01;

/// Time between two readings, seconds.
const READING_S: f64 = 0.1;

/// How long the fingers take from open to closed, seconds.
const FINGER_S: f64 = 1.0;

/// Cloth keeps the fingers open by this share of their way.
const CLOTH_SHARE: f64 = 0.08;

/// Fingers this near to their goal are there, as a share of their way.
const FINGER_REACHED: f64 = 0.01;

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
struct Trajectory {
    id: GoalId,
    /// The first is where the joints were at its start.
    points: Vec<Waypoint>,
    for_s: f64,
}

/// An arm that this program simulates.
pub struct SimulatedArm {
    chain: Chain,
    hand: FingerSettings,
    joints_rad: Vec<f64>,
    fingers: Vec<f64>,
    table: Option<Rc<RefCell<dyn SimulatedTable>>>,
    trajectory: Option<Trajectory>,
    finger_goal: Option<(GoalId, f64)>,
    ended: BTreeMap<GoalId, Ending>,
    n_goals: u64,
    clock_s: f64,
    readings: Readings,
}

impl SimulatedArm {
    /// Sets up the settings' arm at `rest_m`, over a table if there is one; the error says why it cannot be there.
    pub fn new(
        settings: &Settings,
        table: Option<Rc<RefCell<dyn SimulatedTable>>>,
    ) -> Result<SimulatedArm, String> {
        let (chain, hand) = (settings.chain().clone(), settings.fingers);
        let rest = ArmState::hand_down(settings, &settings.workspace.rest_m.into())
            .map_err(|why| format!("the arm cannot rest at `rest_m`: {why}"))?;
        let mut arm = SimulatedArm {
            chain,
            hand,
            joints_rad: rest.joints_rad,
            fingers: vec![hand.open; hand.count],
            table,
            trajectory: None,
            finger_goal: None,
            ended: BTreeMap::new(),
            n_goals: 0,
            clock_s: 0.0,
            readings: Readings::default(),
        };
        arm.read();
        Ok(arm)
    }

    /// Returns the true pose of the tool, `base_from_tool`; readings of it are older.
    pub fn tool(&self) -> Isometry3<f64> {
        let tool = self.chain.base_from_tool(&self.joints_rad);
        tool.expect("the joints are the chain's")
    }

    /// Returns the true angles of the joints, radians.
    pub fn joints_rad(&self) -> &[f64] {
        &self.joints_rad
    }

    /// Returns the true positions of the fingers.
    pub fn fingers(&self) -> &[f64] {
        &self.fingers
    }

    fn next_id(&mut self) -> GoalId {
        self.n_goals += 1;
        GoalId(format!("goal-{:06}", self.n_goals))
    }

    fn end_trajectory(&mut self, ending: Ending) {
        if let Some(ended) = self.trajectory.take() {
            self.ended.insert(ended.id, ending);
        }
    }

    fn end_fingers(&mut self, ending: Ending) {
        if let Some((id, _)) = self.finger_goal.take() {
            self.ended.insert(id, ending);
        }
    }

    fn tick(&mut self) {
        self.clock_s += TICK_S;
        self.advance_joints();
        let tool = self.tool();
        self.advance_fingers(&tool);
        let FingerSettings { open, closed, .. } = self.hand;
        let share = (self.fingers[0] - open) / (closed - open);
        if let Some(table) = &self.table {
            let are_closed = share >= 1.0 - 1.5 * CLOTH_SHARE;
            table.borrow_mut().advance(TICK_S, &tool, are_closed);
        }
        let read_s = self.readings.tool.map_or(0.0, |tool| tool.at_s);
        if self.clock_s - read_s >= READING_S - 1e-9 {
            self.read();
        }
    }

    fn advance_joints(&mut self) {
        let Some(motion) = &mut self.trajectory else {
            return;
        };
        motion.for_s += TICK_S;
        let pairs = motion.points.windows(2);
        let mut ahead = pairs.filter(|pair| pair[1].at_s > motion.for_s);
        if let Some(pair) = ahead.next() {
            let share = (motion.for_s - pair[0].at_s) / (pair[1].at_s - pair[0].at_s);
            let ends = pair[0].joints_rad.iter().zip(&pair[1].joints_rad);
            self.joints_rad = ends.map(|(from, to)| from + share * (to - from)).collect();
            return;
        }
        if let Some(last) = motion.points.last() {
            self.joints_rad.clone_from(&last.joints_rad);
        }
        self.end_trajectory(Ending::Succeeded);
    }

    /// Moves the fingers towards their goal; where cloth stops them short of it, the goal is aborted.
    fn advance_fingers(&mut self, tool: &Isometry3<f64>) {
        let Some((_, goal)) = self.finger_goal else {
            return;
        };
        let FingerSettings { open, closed, .. } = self.hand;
        let way = (closed - open).abs();
        let step = way * TICK_S / FINGER_S;
        let table = self.table.as_ref();
        let is_blocked = table.is_some_and(|table| table.borrow().is_cloth_between_fingers(tool));
        let stop = if is_blocked {
            closed - CLOTH_SHARE * (closed - open)
        } else {
            closed
        };
        let reached = if closed > open {
            goal.min(stop)
        } else {
            goal.max(stop)
        };
        for position in &mut self.fingers {
            *position += (reached - *position).clamp(-step, step);
        }
        if self.fingers.iter().all(|position| *position == reached) {
            let is_there = (reached - goal).abs() < FINGER_REACHED * way;
            self.end_fingers(if is_there {
                Ending::Succeeded
            } else {
                Ending::Aborted
            });
        }
    }

    fn read(&mut self) {
        let at_s = self.clock_s;
        self.readings = Readings {
            tool: Some(Reading {
                value: self.tool(),
                at_s,
            }),
            joints_rad: Some(Reading {
                value: self.joints_rad.clone(),
                at_s,
            }),
            fingers: Some(Reading {
                value: self.fingers.clone(),
                at_s,
            }),
        };
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
        let n_joints = self.joints_rad.len();
        if points.is_empty() || points.iter().any(|it| it.joints_rad.len() != n_joints) {
            return Err(PortError {
                what: "a trajectory".to_owned(),
                why: format!("its points are not those of {n_joints} joints"),
            });
        }
        self.end_trajectory(Ending::Preempted);
        let id = self.next_id();
        // As a controller does, begin where the joints are.
        let mut way = vec![Waypoint::at_rest(self.joints_rad.clone(), 0.0)];
        way.extend(points.iter().filter(|point| point.at_s > 0.0).cloned());
        self.trajectory = Some(Trajectory {
            id: id.clone(),
            points: way,
            for_s: 0.0,
        });
        Ok(id)
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.end_fingers(Ending::Preempted);
        let id = self.next_id();
        let goal = positions.first().copied().unwrap_or_default();
        self.finger_goal = Some((id.clone(), goal));
        Ok(id)
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        let ended = self.ended.get(goal).copied();
        ended.map_or(GoalState::Active, GoalState::Ended)
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        if self.trajectory.as_ref().is_some_and(|it| it.id == *goal) {
            self.end_trajectory(Ending::Preempted);
        }
        if self.finger_goal.as_ref().is_some_and(|(id, _)| id == goal) {
            self.end_fingers(Ending::Preempted);
        }
        Ok(())
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.end_trajectory(Ending::Preempted);
        self.end_fingers(Ending::Preempted);
        Ok(())
    }

    fn start(&mut self) -> Result<(), PortError> {
        Ok(())
    }

    fn state(&mut self) -> Readings {
        self.readings.clone()
    }
}

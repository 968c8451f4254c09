//! The node of kinova-ros: its action servers, with the behaviour of the real ones.

use super::super::arm::driver::Deviation;
use super::super::arm::port::{Ending, GoalId, GoalState, Waypoint};
use super::body::Body;
use nalgebra::Isometry3;
use std::collections::BTreeMap;
use std::mem::discriminant;

/// Latency of a message, seconds.
const LATENCY_S: f64 = 0.03;

/// Cycle time of a server, seconds (kinova-ros: `rate_hz` 10).
const LOOK_S: f64 = 0.1;

/// A pose this near counts as reached: metres, radians.
const REACHED_M: f64 = 0.010;
const REACHED_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Fingers this near count as there, as a share of their way (kinova-ros: 1 %).
const FINGER_REACHED: f64 = 0.01;

/// Fingers that move less of their way from look to look do not move.
const FINGER_MOVED: f64 = 1.0 / 6400.0;

/// A motion slower than this for so long counts as stalled: metres, seconds for the tool, seconds for the fingers.
const STALL_M: f64 = 0.000_5;
const STALL_S: f64 = 1.0;
const FINGER_STALL_S: f64 = 0.5;

/// A trajectory is aborted after twice its duration plus this, seconds.
const TRAJECTORY_S: f64 = 3.0;

/// The most ended goals that are remembered.
const MAX_REMEMBERED: usize = 64;

/// A goal as it arrives at the node, which moves to whatever it is told.
#[derive(Clone, Debug)]
pub(super) enum Goal {
    Pose(Isometry3<f64>),
    Trajectory(Vec<Waypoint>),
    Fingers(Vec<f64>),
}

/// A goal that a server is executing.
struct Active {
    id: GoalId,
    goal: Goal,
    /// The last measured motion, to detect a stall: position of the tool, fingers.
    last: (nalgebra::Vector3<f64>, f64),
    last_moved_s: f64,
    begun_s: f64,
}

/// The node.
#[derive(Default)]
pub(super) struct Node {
    sent: u64,
    /// Goals and cancellations in transit, with their arrival times.
    in_transit: Vec<(f64, Message)>,
    /// At most one for each server.
    active: Vec<Active>,
    /// How goals ended, and when the report arrives.
    ended: BTreeMap<GoalId, (Ending, f64)>,
    is_stopped: bool,
    looked_s: f64,
}

enum Message {
    Goal(GoalId, Goal),
    Cancel(GoalId),
}

impl Node {
    pub(super) fn is_stopped(&self) -> bool {
        self.is_stopped
    }

    pub(super) fn is_busy(&self) -> bool {
        !self.active.is_empty()
    }

    pub(super) fn send(&mut self, goal: Goal, now_s: f64) -> GoalId {
        self.sent += 1;
        let id = GoalId(format!("goal-{:06}", self.sent));
        let message = Message::Goal(id.clone(), goal);
        self.in_transit.push((now_s + LATENCY_S, message));
        id
    }

    pub(super) fn cancel(&mut self, goal: &GoalId, now_s: f64) {
        let message = Message::Cancel(goal.clone());
        self.in_transit.push((now_s + LATENCY_S, message));
    }

    /// Returns the state of a goal as its sender sees it by now.
    pub(super) fn goal_state(&self, goal: &GoalId, now_s: f64) -> GoalState {
        match self.ended.get(goal) {
            Some((ending, heard_s)) if *heard_s <= now_s => GoalState::Ended(*ending),
            Some(_) => GoalState::Active,
            None if self.active.iter().any(|active| active.id == *goal) => GoalState::Active,
            None => GoalState::Sent,
        }
    }

    pub(super) fn stop(&mut self, body: &mut Body) {
        self.is_stopped = true;
        body.stop();
    }

    pub(super) fn start(&mut self, body: &mut Body) {
        self.is_stopped = false;
        body.start();
    }

    /// Handles messages that have arrived, and runs a server cycle when it is due.
    pub(super) fn advance(&mut self, now_s: f64, body: &mut Body) {
        let arrived: Vec<Message> = {
            let (here, later) = std::mem::take(&mut self.in_transit)
                .into_iter()
                .partition(|(at_s, _)| *at_s <= now_s);
            self.in_transit = later;
            let here: Vec<(f64, Message)> = here;
            here.into_iter().map(|(_, message)| message).collect()
        };
        for message in arrived {
            match message {
                Message::Goal(id, goal) => self.take(id, goal, now_s, body),
                Message::Cancel(id) => self.preempt(|active| active.id == id, now_s, body),
            }
        }
        if now_s - self.looked_s >= LOOK_S - 1e-9 {
            self.looked_s = now_s;
            self.look(now_s, body);
        }
    }

    fn take(&mut self, id: GoalId, goal: Goal, now_s: f64, body: &mut Body) {
        let server = discriminant(&goal);
        let same = |active: &Active| discriminant(&active.goal) == server;
        self.preempt(same, now_s, body);
        let started = match (self.is_stopped, &goal) {
            // The controller accepts a trajectory at any time; a stop only holds the joints.
            (_, Goal::Trajectory(points)) => body.stream(points),
            (true, _) => Err(String::new()),
            (false, Goal::Pose(pose)) => body.move_straight(pose),
            (false, Goal::Fingers(positions)) => match positions.first() {
                Some(position) if position.is_finite() => {
                    body.move_fingers(*position);
                    Ok(())
                }
                _ => Err(String::new()),
            },
        };
        if started.is_err() {
            if !self.is_stopped {
                body.halt();
            }
            self.end(id, Ending::Aborted, now_s);
            return;
        }
        self.active.push(Active {
            id,
            goal,
            last: measure(body),
            last_moved_s: now_s,
            begun_s: now_s,
        });
    }

    /// Preempts an active goal as kinova-ros does: it stops the arm and starts it again; for a trajectory it empties
    /// the controller instead.
    fn preempt(&mut self, is_meant: impl Fn(&Active) -> bool, now_s: f64, body: &mut Body) {
        let Some(index) = self.active.iter().position(is_meant) else {
            return;
        };
        let active = self.active.remove(index);
        body.halt();
        if !matches!(active.goal, Goal::Trajectory(_)) {
            self.start(body);
        }
        self.end(active.id, Ending::Preempted, now_s);
    }

    fn end(&mut self, id: GoalId, ending: Ending, now_s: f64) {
        while self.ended.len() >= MAX_REMEMBERED {
            self.ended.pop_first();
        }
        self.ended.insert(id, (ending, now_s + LATENCY_S));
    }

    fn look(&mut self, now_s: f64, body: &mut Body) {
        let is_stopped = self.is_stopped;
        let mut over = Vec::new();
        for active in &mut self.active {
            if let Some(ending) = active.ending(is_stopped, now_s, body) {
                over.push((active.id.clone(), ending));
            }
        }
        for (id, ending) in over {
            match ending {
                Ending::Preempted => self.preempt(|active| active.id == id, now_s, body),
                // On success the arm continues to the goal by itself: only the server is done.
                _ => {
                    self.active.retain(|active| active.id != id);
                    self.end(id, ending, now_s);
                }
            }
        }
    }
}

impl Active {
    /// Returns how a server cycle ends the goal, if it does.
    fn ending(&mut self, is_stopped: bool, now_s: f64, body: &Body) -> Option<Ending> {
        let measured = measure(body);
        let moved = (measured.0 - self.last.0).norm() > STALL_M
            || (measured.1 - self.last.1).abs() > FINGER_MOVED * body.finger_way();
        if moved {
            self.last = measured;
            self.last_moved_s = now_s;
        }
        let (is_reached, stall_s) = match &self.goal {
            Goal::Pose(pose) => {
                let deviation = Deviation::between(&body.tool(), pose);
                let is_reached =
                    deviation.position_m < REACHED_M && deviation.angle_rad < REACHED_RAD;
                (is_reached, STALL_S)
            }
            Goal::Fingers(positions) => {
                let off = |(a, b): (&f64, &f64)| (a - b).abs();
                let fingers = body.fingers().iter().zip(positions).map(off);
                (
                    fingers.fold(0.0, f64::max) < FINGER_REACHED * body.finger_way(),
                    FINGER_STALL_S,
                )
            }
            Goal::Trajectory(points) => {
                // The controller keeps the trajectory after an abort, or holds it until the arm is enabled.
                let duration_s = points.last().map_or(0.0, |last| last.at_s);
                return match is_near(body, points) {
                    true => Some(Ending::Succeeded),
                    false => (now_s - self.begun_s > 2.0 * duration_s + TRAJECTORY_S)
                        .then_some(Ending::Aborted),
                };
            }
        };
        match (is_stopped, is_reached) {
            (true, _) => Some(Ending::Aborted),
            (false, true) => Some(Ending::Succeeded),
            (false, false) => (now_s - self.last_moved_s > stall_s).then_some(Ending::Preempted),
        }
    }
}

/// Returns whether the joints are near the end of a trajectory.
fn is_near(body: &Body, points: &[Waypoint]) -> bool {
    points
        .last()
        .is_some_and(|last| near(body, &last.joints_rad))
}

/// Returns whether the joints are within a degree of the given angles.
fn near(body: &Body, joints_rad: &[f64]) -> bool {
    let off = |(a, b): (&f64, &f64)| (a - b).abs();
    body.joints_rad()
        .iter()
        .zip(joints_rad)
        .map(off)
        .fold(0.0, f64::max)
        < 0.017
}

fn measure(body: &Body) -> (nalgebra::Vector3<f64>, f64) {
    let fingers = body.fingers().iter().sum();
    (body.tool().translation.vector, fingers)
}

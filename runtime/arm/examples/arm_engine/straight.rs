//! An arm whose tool, joints and fingers move straight to their targets, and a camera that sees a pattern.
//!
//! In: goals, and time. Out: readings, and pictures. It treats goals like the node of kinova-ros: a stopped arm aborts
//! them, and a new goal preempts the previous one. The node runs ten times a second; it preempts a cancelled goal with
//! a stop and a start, which also enables an arm that was stopped in between.

use super::Stage;
use fab_arm::port::{Ending, GoalId, GoalState, Port, PortError, Reading, Readings, Waypoint};
use fab_arm::rgbd::{Intrinsics, RgbdSource, Shot};
use fab_picture::DepthImage;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Metres a second.
const TOOL_SPEED: f64 = 0.2;
/// Finger units a second.
const FINGER_SPEED: f64 = 3000.0;
/// Cycle time of the node, seconds.
const LOOK_S: f64 = 0.1;

/// A goal of one of the servers.
#[derive(Clone)]
enum Goal {
    Pose(Isometry3<f64>),
    Fingers(Vec<f64>),
    Trajectory(Vec<Waypoint>),
}

/// An arm without kinematics: its tool and its joints are independent.
pub struct Arm {
    time_s: f64,
    tool: Isometry3<f64>,
    joints: Vec<f64>,
    fingers: Vec<f64>,
    is_stopped: bool,
    goals: BTreeMap<String, GoalState>,
    /// The active goals, with their start times.
    tasks: Vec<(String, Goal, f64)>,
    cancelled: BTreeSet<String>,
    next_look_s: f64,
}

impl Default for Arm {
    fn default() -> Arm {
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        Arm {
            time_s: 0.0,
            tool: Isometry3::from_parts(Translation3::new(0.3, -0.2, 0.4), down),
            joints: vec![4.8, 2.9, 1.0, 4.2, 1.4, 1.3],
            fingers: vec![0.0; 2],
            is_stopped: false,
            goals: BTreeMap::new(),
            tasks: Vec::new(),
            cancelled: BTreeSet::new(),
            next_look_s: 0.0,
        }
    }
}

impl Arm {
    fn end(&mut self, ending: Ending, is_ended: impl Fn(&str, &Goal) -> bool) {
        let goals = &mut self.goals;
        self.tasks.retain(|(id, goal, _)| {
            let is_ended = is_ended(id, goal);
            if is_ended {
                goals.insert(id.clone(), GoalState::Ended(ending));
            }
            !is_ended
        });
    }

    fn look(&mut self) {
        let cancelled = std::mem::take(&mut self.cancelled);
        let n_tasks = self.tasks.len();
        self.end(Ending::Preempted, |id, _| cancelled.contains(id));
        if self.tasks.len() < n_tasks {
            self.is_stopped = false;
        } else if self.is_stopped {
            self.end(Ending::Aborted, |_, _| true);
        }
    }

    fn send(&mut self, goal: Goal) -> GoalId {
        let id = format!("goal {}", self.goals.len());
        let is_same = |other: &Goal| std::mem::discriminant(other) == std::mem::discriminant(&goal);
        self.end(Ending::Preempted, |_, other| is_same(other));
        let state = if self.is_stopped {
            GoalState::Ended(Ending::Aborted)
        } else {
            GoalState::Active
        };
        self.goals.insert(id.clone(), state);
        if !self.is_stopped {
            self.tasks.push((id.clone(), goal, self.time_s));
        }
        GoalId(id)
    }

    /// Moves towards a goal for `seconds`; returns whether it is reached.
    fn follow(&mut self, goal: &Goal, began_s: f64, seconds: f64) -> bool {
        match goal {
            Goal::Pose(target) => {
                let way = target.translation.vector - self.tool.translation.vector;
                let part = (TOOL_SPEED * seconds / way.norm().max(1e-9)).min(1.0);
                self.tool.translation.vector += way * part;
                self.tool.rotation = self.tool.rotation.slerp(&target.rotation, part);
                part >= 1.0
            }
            Goal::Fingers(targets) => approach(&mut self.fingers, targets, FINGER_SPEED * seconds),
            Goal::Trajectory(points) => {
                let at_s = self.time_s - began_s;
                self.joints = along(points, at_s);
                points.last().is_none_or(|last| at_s >= last.at_s)
            }
        }
    }
}

fn approach(values: &mut [f64], targets: &[f64], step: f64) -> bool {
    for (value, target) in values.iter_mut().zip(targets) {
        *value += (target - *value).clamp(-step, step);
    }
    values
        .iter()
        .zip(targets)
        .all(|(value, target)| value == target)
}

fn along(points: &[Waypoint], at_s: f64) -> Vec<f64> {
    let next = points.iter().position(|point| point.at_s > at_s);
    match next {
        Some(0) => points[0].joints_rad.clone(),
        Some(next) => {
            let (before, after) = (&points[next - 1], &points[next]);
            let part = (at_s - before.at_s) / (after.at_s - before.at_s);
            let mix = |(from, to): (&f64, &f64)| from + (to - from) * part;
            before
                .joints_rad
                .iter()
                .zip(&after.joints_rad)
                .map(mix)
                .collect()
        }
        None => points
            .last()
            .map(|point| point.joints_rad.clone())
            .unwrap_or_default(),
    }
}

impl Port for Arm {
    fn now_s(&self) -> f64 {
        self.time_s
    }

    fn wait(&mut self, seconds: f64) {
        self.time_s += seconds;
        if self.time_s >= self.next_look_s {
            self.next_look_s = self.time_s + LOOK_S;
            self.look();
        }
        if self.is_stopped {
            return;
        }
        let mut reached = Vec::new();
        for (id, goal, began_s) in self.tasks.clone() {
            if self.follow(&goal, began_s, seconds) {
                reached.push(id);
            }
        }
        self.end(Ending::Succeeded, |id, _| {
            reached.iter().any(|reached| reached == id)
        });
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
        self.goals
            .get(&goal.0)
            .cloned()
            .unwrap_or(GoalState::Ended(Ending::Rejected))
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.cancelled.insert(goal.0.clone());
        Ok(())
    }

    fn stop(&mut self) -> Result<(), PortError> {
        self.is_stopped = true;
        Ok(())
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.is_stopped = false;
        Ok(())
    }

    fn state(&mut self) -> Readings {
        let at_s = self.time_s;
        Readings {
            tool: Some(Reading {
                value: self.tool,
                at_s,
            }),
            joints_rad: Some(Reading {
                value: self.joints.clone(),
                at_s,
            }),
            fingers: Some(Reading {
                value: self.fingers.clone(),
                at_s,
            }),
        }
    }
}

/// A pattern: colour `[column, row, column xor row]`, depth 500 mm plus a millimetre per column, and no reading in row
/// 0.
impl RgbdSource for Arm {
    fn name(&self) -> String {
        "pattern".to_owned()
    }

    fn shoot(&mut self) -> Result<Shot, String> {
        let (width, height) = (64, 48);
        let depth = |column: u32, row: u32| {
            if row == 0 {
                0.0
            } else {
                (500 + column) as f32 / 1000.0
            }
        };
        Ok(Shot {
            rgb: image::RgbImage::from_fn(width, height, |column, row| {
                image::Rgb([column as u8, row as u8, (column ^ row) as u8])
            }),
            depth_m: DepthImage::from_fn(width, height, |column, row| {
                image::Luma([depth(column, row)])
            }),
            intrinsics: Some(Intrinsics {
                size_px: [width, height],
                focal_px: [80.0, 81.0],
                middle_px: [32.25, 24.5],
                distortion: vec![0.1, -0.02, 0.001, 0.002, 0.0],
            }),
        })
    }
}

impl Stage for Arm {}

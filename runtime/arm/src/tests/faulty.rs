//! A simulated arm behind the vendor's node, with which something goes wrong.
//!
//! In: a simulated arm, and faults with their times. Out: the arm as a [`Port`]. Tests of other packages include this
//! file by its path, with `fault.rs` and `kinova` beside it and the crate as `arm`.

use super::arm::kinematics::chain::Chain;
use super::arm::port::{Ending, GoalId, GoalState, Port, PortError, Readings, Track, Waypoint};
use super::arm::settings::Settings;
use super::arm::simulated::{SimulatedArm, SimulatedTable};
use super::fault::FaultKind;
use super::kinova::KinovaArm;
use nalgebra::{Isometry3, Translation3, Vector3};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Deref, DerefMut};
use std::rc::Rc;

/// A step of the arm's clock, seconds.
const TICK_S: f64 = 0.01;

/// Distance before its goal at which a motion that falls short ends, metres.
const SHORT_M: f64 = 0.007;

/// A shorter way is no motion, metres.
const MOTION_M: f64 = 0.010;

/// How long a short silence lasts, seconds.
const SHORT_SILENCE_S: f64 = 0.6;

/// Speed of the first joint of an arm that runs away, rad/s.
const RUNAWAY_RAD_S: f64 = 0.3;

/// A fault that occurs once, at or after a time of the arm's clock.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// The fault.
    pub kind: FaultKind,
    /// Its earliest time, seconds.
    pub from_s: f64,
}

/// A simulated arm with faults.
pub struct Faulty {
    arm: KinovaArm,
    chain: Chain,
    pending: Vec<Fault>,
    lasting: Vec<FaultKind>,
    goals_to_lose: u32,
    n_lost: u32,
    /// What the sender hears of goals, where it is not the truth.
    heard: HashMap<GoalId, GoalState>,
    track: Track,
    readings: Readings,
    /// The tool's place when the arm was stopped, and its largest distance from there since, metres.
    since_stop: Option<(Vector3<f64>, f64)>,
    /// Bounds of all places of the tool so far, metres: least and largest.
    extent_m: [[f64; 3]; 2],
}

impl Faulty {
    /// - `seed`: determines where within its repeatability the arm comes to rest.
    pub fn new(
        settings: &Settings,
        seed: u64,
        table: Option<Rc<RefCell<dyn SimulatedTable>>>,
        faults: Vec<Fault>,
    ) -> Result<Faulty, String> {
        let arm = SimulatedArm::new(settings, table)?;
        Ok(Faulty::of(arm, settings, seed, faults))
    }

    pub fn of(arm: SimulatedArm, settings: &Settings, seed: u64, faults: Vec<Fault>) -> Faulty {
        let mut arm = KinovaArm::around(arm, settings, seed);
        let at: [f64; 3] = arm.tool().translation.vector.into();
        Faulty {
            readings: arm.state(),
            since_stop: None,
            extent_m: [at, at],
            arm,
            chain: settings.chain().clone(),
            pending: faults,
            lasting: Vec::new(),
            goals_to_lose: 0,
            n_lost: 0,
            heard: HashMap::new(),
            track: Track::default(),
        }
    }

    /// Returns the largest distance of the tool from its place at the last stop, metres; `None` if the arm is not
    /// stopped.
    pub fn moved_after_stop_m(&self) -> Option<f64> {
        self.since_stop.map(|(_, moved_m)| moved_m)
    }

    /// Returns the least and the largest coordinates of the tool so far, metres, base frame.
    pub fn extent_m(&self) -> [[f64; 3]; 2] {
        self.extent_m
    }

    /// Injects a fault from now on.
    pub fn fail(&mut self, kind: FaultKind) {
        let from_s = self.arm.now_s();
        self.pending.push(Fault { kind, from_s });
    }

    /// Returns whether the camera has stopped delivering pictures.
    pub fn has_lost_camera(&mut self) -> bool {
        self.is_active(FaultKind::NoPicture, self.arm.now_s())
    }

    /// Consumes a due fault of a kind; returns whether there was one.
    fn take(&mut self, kind: FaultKind, now_s: f64) -> bool {
        let due = |fault: &Fault| fault.kind == kind && fault.from_s <= now_s;
        let index = self.pending.iter().position(due);
        index.map(|index| self.pending.remove(index)).is_some()
    }

    /// Returns whether a lasting fault of a kind has started.
    fn is_active(&mut self, kind: FaultKind, now_s: f64) -> bool {
        if self.take(kind, now_s) {
            self.lasting.push(kind);
        }
        self.lasting.contains(&kind)
    }

    fn is_silent(&mut self, now_s: f64) -> bool {
        let is_short = |fault: &Fault| {
            fault.kind == FaultKind::ShortSilence
                && (fault.from_s..fault.from_s + SHORT_SILENCE_S).contains(&now_s)
        };
        self.pending.iter().any(is_short)
            || self.is_active(FaultKind::Silence, now_s)
            || self.is_active(FaultKind::RepeatedReading, now_s)
    }

    fn tick(&mut self) {
        let now_s = self.arm.now_s() + TICK_S;
        if self.take(FaultKind::PressedStop, now_s) {
            let _ = self.stop_arm();
        }
        if self.is_active(FaultKind::StuckJoint, now_s) {
            self.arm.jam_joints();
        }
        if self.is_active(FaultKind::StuckFingers, now_s) {
            self.arm.jam_fingers();
        }
        let may_move = !self.arm.is_stopped() && self.arm.is_busy();
        if may_move && self.is_active(FaultKind::Runaway, now_s) {
            self.arm.run_away(RUNAWAY_RAD_S * TICK_S);
        }
        self.arm.wait(TICK_S);
        let at = self.arm.tool().translation.vector;
        for axis in 0..3 {
            self.extent_m[0][axis] = self.extent_m[0][axis].min(at[axis]);
            self.extent_m[1][axis] = self.extent_m[1][axis].max(at[axis]);
        }
        if let Some((from, moved_m)) = &mut self.since_stop {
            *moved_m = moved_m.max((at - *from).norm());
        }
        if !self.is_silent(now_s) {
            self.readings = self.arm.state();
        }
    }

    fn stop_arm(&mut self) -> Result<(), PortError> {
        // A second stop must not reset the distance since the first.
        let at = self.arm.tool().translation.vector;
        self.since_stop.get_or_insert((at, 0.0));
        self.arm.stop()
    }

    /// Sends a goal, unless something happens to it.
    fn send(
        &mut self,
        is_motion: bool,
        send: impl FnOnce(&mut KinovaArm) -> Result<GoalId, PortError>,
    ) -> Result<GoalId, PortError> {
        self.track = Track::default();
        let now_s = self.arm.now_s();
        self.goals_to_lose += 3 * u32::from(self.take(FaultKind::LostGoals, now_s));
        self.goals_to_lose += u32::from(self.take(FaultKind::LostGoal, now_s));
        let lost = if self.goals_to_lose > 0 {
            self.goals_to_lose -= 1;
            Some(GoalState::Sent)
        } else {
            let is_aborted = is_motion && self.take(FaultKind::AbortedGoal, now_s);
            is_aborted.then_some(GoalState::Ended(Ending::Aborted))
        };
        if let Some(state) = lost {
            self.n_lost += 1;
            let id = GoalId(format!("lost-{}", self.n_lost));
            self.heard.insert(id.clone(), state);
            return Ok(id);
        }
        let id = send(&mut self.arm)?;
        if is_motion && self.take(FaultKind::LostStatus, now_s) {
            self.heard.insert(id.clone(), GoalState::Sent);
        }
        Ok(id)
    }

    fn falls_short(&mut self, is_motion: bool) -> bool {
        let now_s = self.arm.now_s();
        self.is_active(FaultKind::FallsShortAlways, now_s)
            || is_motion && self.take(FaultKind::FallsShort, now_s)
    }

    fn place(&self, point: &Waypoint) -> Vector3<f64> {
        let tool = self.chain.base_from_tool(&point.joints_rad);
        tool.expect("a trajectory's points are the arm's")
            .translation
            .vector
    }

    /// Ends a way where the tool is still [`SHORT_M`] before its end, or where it begins.
    fn shortened(&self, points: &[Waypoint]) -> Vec<Waypoint> {
        let mut way = points.to_vec();
        if let Some(now) = &self.readings.joints_rad {
            way.insert(0, Waypoint::at_rest(now.value.clone(), 0.0));
        }
        let end = self.place(&way[way.len() - 1]);
        let left_m: Vec<f64> = way
            .iter()
            .map(|point| (self.place(point) - end).norm())
            .collect();
        let last = left_m.iter().rposition(|left_m| *left_m >= SHORT_M);
        let (kept, share) = last.map_or((0, 0.0), |at| {
            (at, (left_m[at] - SHORT_M) / (left_m[at] - left_m[at + 1]))
        });
        if let [before, after, ..] = &way[kept..] {
            let angles = before.joints_rad.iter().zip(&after.joints_rad);
            let angles = angles.map(|(before, after)| before + share * (after - before));
            let rest = Waypoint::at_rest(angles.collect(), after.at_s);
            way.truncate(kept + 1);
            way.push(rest);
        }
        way
    }
}

impl Deref for Faulty {
    type Target = KinovaArm;

    fn deref(&self) -> &KinovaArm {
        &self.arm
    }
}

impl DerefMut for Faulty {
    fn deref_mut(&mut self) -> &mut KinovaArm {
        &mut self.arm
    }
}

impl Port for Faulty {
    fn now_s(&self) -> f64 {
        self.arm.now_s()
    }

    fn wait(&mut self, seconds: f64) {
        let n_ticks = (seconds.clamp(0.0, 3600.0) / TICK_S).round().max(1.0) as u64;
        for _ in 0..n_ticks {
            self.tick();
        }
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        let end = points.last().map(|last| self.place(last));
        let here = self.arm.tool().translation.vector;
        let is_motion = end.is_some_and(|end| (end - here).norm() > 0.001);
        let points = if self.falls_short(is_motion) {
            self.shortened(points)
        } else {
            points.to_vec()
        };
        self.send(is_motion, |arm| arm.send_trajectory(&points))
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        let mut pose = *tool;
        let here = self.arm.tool().translation.vector;
        let way = tool.translation.vector - here;
        let is_motion = way.norm() > MOTION_M;
        if self.falls_short(is_motion) {
            let left = (1.0 - SHORT_M / way.norm().max(SHORT_M)) * way;
            pose.translation = Translation3::from(here + left);
        }
        self.send(is_motion, |arm| arm.send_pose(&pose))
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.send(true, |arm| arm.send_fingers(positions))
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        if let Some(state) = self.heard.get(goal) {
            return state.clone();
        }
        let state = self.arm.goal(goal);
        let is_ended = matches!(state, GoalState::Ended(_));
        if is_ended && self.take(FaultKind::LostResult, self.arm.now_s()) {
            self.heard.insert(goal.clone(), GoalState::Active);
            return GoalState::Active;
        }
        state
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.track.end();
        if self.take(FaultKind::LostCancel, self.arm.now_s()) {
            return Ok(());
        }
        self.arm.cancel(goal)
    }

    fn stop(&mut self) -> Result<(), PortError> {
        if !self.take(FaultKind::LostStop, self.arm.now_s()) {
            return self.stop_arm();
        }
        self.wait(1.0);
        Err(PortError {
            what: "the service `in/stop`".to_owned(),
            why: "no answer within 1 s".to_owned(),
        })
    }

    fn probe(&mut self) -> Result<Option<GoalId>, PortError> {
        let here = self.readings.tool;
        here.map(|here| self.send_pose(&here.value)).transpose()
    }

    fn start(&mut self) -> Result<(), PortError> {
        self.since_stop = None;
        self.arm.start()
    }

    fn state(&mut self) -> Readings {
        if let Some(tool) = &self.readings.tool {
            self.track.record(tool.at_s, tool.value.translation.vector);
        }
        self.readings.clone()
    }

    fn moved_until_s(&mut self, rest: Option<&Vector3<f64>>) -> Option<f64> {
        self.track.moved_until_s(rest)
    }
}

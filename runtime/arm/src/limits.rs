//! Stops an arm that violates its limits while it moves, and sends a motion again that ended short of its goal.
//!
//! In: places for the tool. Out: motions to them that the [`Guard`] allows from where the arm is, and a stop if measured
//! positions, angles or speeds leave its limits.

use super::driver::{ArmError, ArmState, Deviation, Halt, HandContents, Opening, PortArm, Watch};
use super::guard::{Checked, Guard, Motion};
use super::port::Port;
use nalgebra::Isometry3;

/// How often a motion that ended short of its goal is sent again: after two the arm is not where it says.
const CORRECTIONS: u32 = 2;

/// Factor by which the measured speed may exceed the limit before the arm is stopped: positions have 1 mm resolution.
const SPEED_SLACK: f64 = 1.5;

/// How far the tool may move during a finger motion, metres: the accuracy with which the arm's node holds a pose.
const FINGERS_STAY_M: f64 = 0.010;

/// Time over which speed is measured, seconds.
const SPEED_OVER_S: f64 = 0.4;

/// An arm that is checked against its limits while it moves.
pub struct Limited<P: Port + ?Sized> {
    arm: PortArm<P>,
    guard: Guard,
    /// Motions of the route that it has not made.
    pub(super) planned: Vec<Checked<Motion>>,
}

impl<P: Port + ?Sized> Limited<P> {
    /// Wraps an arm.
    pub fn new(arm: PortArm<P>, guard: Guard) -> Limited<P> {
        Limited {
            arm,
            guard,
            planned: Vec::new(),
        }
    }

    /// Takes the motions of a route, in place of those of the route before.
    pub fn plan(&mut self, motions: &[Checked<Motion>]) {
        self.planned = motions.to_vec();
    }

    /// Returns the wrapped arm.
    pub fn arm(&mut self) -> &mut PortArm<P> {
        &mut self.arm
    }

    /// Moves the tool straight to a pose, `base_from_tool`, if the guard allows it from where the arm is. A planned motion
    /// that begins there is sent as it was checked; any other is checked now.
    ///
    /// - `speed_m_s`: the highest speed.
    pub fn move_tool(
        &mut self,
        to: &Isometry3<f64>,
        speed_m_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let mut corrections = 0;
        loop {
            self.arm.ready(watch)?;
            let from = self.arm.state()?;
            let mut planned = self.planned.iter().map(Checked::get);
            let planned = planned
                .position(|it| it.to == *to && it.speed_m_s == speed_m_s && it.begins_at(&from));
            let motion = match planned {
                Some(index) => self.planned.swap_remove(index),
                None => {
                    let checked = self.guard.motion(&from, to, speed_m_s);
                    checked.map_err(ArmError::Refused)?
                }
            };
            let mut monitor = LimitMonitor::new(&self.guard);
            let moved = self.arm.move_tool(&motion, &mut |state| {
                monitor.check(state)?;
                watch(state)
            });
            match moved {
                Err(ArmError::Short(_)) if corrections < CORRECTIONS => corrections += 1,
                moved => return moved,
            }
        }
    }

    /// Opens or closes the hand, and returns what is between the fingers.
    pub fn move_fingers(
        &mut self,
        opening: Opening,
        watch: &mut Watch<'_>,
    ) -> Result<HandContents, ArmError> {
        let mut monitor = LimitMonitor::new(&self.guard);
        let begun_at = self.arm.state()?.tool;
        self.arm.move_fingers(opening, &mut |state| {
            monitor.check(state)?;
            let carried_m = Deviation::between(&begun_at, &state.tool).position_m;
            // NaN must stop the arm too.
            let stays = carried_m <= FINGERS_STAY_M;
            if !stays {
                return Err(Halt::Stop(ArmError::OutOfLimits(format!(
                    "the tool moved by {:.0} mm while only the fingers should",
                    carried_m * 1000.0
                ))));
            }
            watch(state)
        })
    }
}

/// Checks the arm against its limits while it moves.
struct LimitMonitor<'l> {
    guard: &'l Guard,
    /// Recent times and poses of the tool.
    recent: Vec<(f64, Isometry3<f64>)>,
}

impl LimitMonitor<'_> {
    fn new(guard: &Guard) -> LimitMonitor<'_> {
        LimitMonitor {
            guard,
            recent: Vec::new(),
        }
    }

    fn check(&mut self, state: &ArmState) -> Result<(), Halt> {
        let out = |why: String| Halt::Stop(ArmError::OutOfLimits(why));
        self.guard.measured(state).map_err(out)?;
        self.recent.push((state.at_s, state.tool));
        let is_old = |(at_s, _): &(f64, Isometry3<f64>)| state.at_s - at_s >= SPEED_OVER_S;
        let Some(begin) = self.recent.iter().rposition(is_old) else {
            return Ok(());
        };
        self.recent.drain(..begin);
        let (begin_s, begin) = self.recent[0];
        let moved_m = Deviation::between(&begin, &state.tool).position_m;
        let (speed_m_s, most_m_s) = (moved_m / (state.at_s - begin_s), self.guard.max_speed_m_s());
        if speed_m_s > SPEED_SLACK * most_m_s {
            return Err(out(format!(
                "the tool moves at {speed_m_s:.2} m/s, and `{most_m_s}` m/s are allowed"
            )));
        }
        Ok(())
    }
}

//! Stops an arm that violates its limits while it moves, and sends a motion again that ended short of its goal.
//!
//! In: places for the tool. Out: motions to them that the [`Guard`] allows from where the arm is, and a stop if measured
//! positions, angles or speeds leave its limits.

use super::driver::{ArmError, ArmState, Deviation, Halt, HandContents, Opening, PortArm, Watch};
use super::guard::Guard;
use super::port::Port;
use nalgebra::Isometry3;
use std::collections::VecDeque;

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
}

impl<P: Port + ?Sized> Limited<P> {
    /// Wraps an arm.
    pub fn new(arm: PortArm<P>, guard: Guard) -> Limited<P> {
        Limited { arm, guard }
    }

    /// Returns the wrapped arm.
    pub fn arm(&mut self) -> &mut PortArm<P> {
        &mut self.arm
    }

    /// Returns the time of the arm's clock, seconds.
    pub fn now_s(&self) -> f64 {
        self.arm.now_s()
    }

    /// Returns the arm's state; fails if its readings are stale.
    pub fn state(&mut self) -> Result<ArmState, ArmError> {
        self.arm.state()
    }

    /// Moves the tool straight to a pose, `base_from_tool`, if the guard allows it from where the arm is.
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
            let motion = self.guard.motion(&from, to, speed_m_s);
            let motion = motion.map_err(ArmError::Refused)?;
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
    recent: VecDeque<(f64, Isometry3<f64>)>,
}

impl LimitMonitor<'_> {
    fn new(guard: &Guard) -> LimitMonitor<'_> {
        LimitMonitor {
            guard,
            recent: VecDeque::new(),
        }
    }

    fn check(&mut self, state: &ArmState) -> Result<(), Halt> {
        let out = |why: String| Halt::Stop(ArmError::OutOfLimits(why));
        self.guard.measured(state).map_err(out)?;
        if self
            .recent
            .back()
            .is_none_or(|(at_s, _)| state.at_s > *at_s)
        {
            self.recent.push_back((state.at_s, state.tool));
        }
        while self.recent.len() > 2
            && self
                .recent
                .get(1)
                .is_some_and(|(at_s, _)| state.at_s - at_s >= SPEED_OVER_S)
        {
            self.recent.pop_front();
        }
        let Some((first_s, first)) = self.recent.front() else {
            return Ok(());
        };
        let (took_s, way_m) = (
            state.at_s - first_s,
            Deviation::between(first, &state.tool).position_m,
        );
        let most_m_s = self.guard.max_speed_m_s();
        if took_s >= SPEED_OVER_S && way_m / took_s > SPEED_SLACK * most_m_s {
            return Err(out(format!(
                "the tool moves at {:.2} m/s, and `{most_m_s}` m/s are allowed",
                way_m / took_s
            )));
        }
        Ok(())
    }
}

//! Reads an arm's state, and decides whether the arm is at rest.
//!
//! In: the port's readings with the times at which they were taken. Out: a state no older than `stale_s`, or the reading
//! that is missing. The arm is at rest when two readings agree; what a server reports is not trusted.

use super::{ArmError, ArmState, Deviation, Halt, PortArm, Watch};
use crate::kinematics::inverse::is_pose;
use crate::port::{Port, Reading};

/// Interval between two polls of the arm, seconds.
pub(super) const POLL_S: f64 = 0.05;

/// A tool that moves less than this between two readings is at rest, metres.
pub(super) const REST_M: f64 = 0.000_5;

/// Time between two readings that must agree, seconds: more than the 0.1 s between two messages of kinova-ros.
const REST_S: f64 = 0.25;

/// How long a motion may take beyond its time, seconds; an arm that stalls is noticed only after that.
pub(super) const SETTLE_S: f64 = 5.0;

impl<P: Port + ?Sized> PortArm<P> {
    fn fresh<T>(
        &self,
        heard: Option<Reading<T>>,
        what: &'static str,
    ) -> Result<Reading<T>, ArmError> {
        let now_s = self.port.now_s();
        let for_s = heard.as_ref().map_or(now_s, |heard| now_s - heard.at_s);
        let heard = heard.filter(|_| for_s <= self.tolerance.stale_s);
        heard.ok_or_else(|| {
            ArmError::Failed(format!(
                "the arm has not reported for `{for_s:.1}` s where its {what}; its driver or the network may be down"
            ))
        })
    }

    /// Returns the arm's state; fails on a stale reading.
    pub fn state(&mut self) -> Result<ArmState, ArmError> {
        let readings = self.port.state();
        let tool = self.fresh(readings.tool, "tool is")?;
        let fingers = self.fresh(readings.fingers, "fingers are")?;
        let joints = self.fresh(readings.joints_rad, "joints are")?;
        if !is_pose(&tool.value) {
            return Err(ArmError::OutOfLimits(
                "the arm reports a tool position that is not finite".to_owned(),
            ));
        }
        Ok(ArmState {
            at_s: tool.at_s,
            tool: tool.value,
            joints_rad: joints.value,
            fingers: fingers.value,
        })
    }

    /// Returns the last finger positions; fails on stale ones.
    pub(super) fn fingers(&mut self) -> Result<Reading<Vec<f64>>, ArmError> {
        let heard = self.port.state().fingers;
        self.fresh(heard, "fingers are")
    }

    /// Reads the state and passes it to the watch callback, which may stop the arm; a pause request is ignored.
    pub(super) fn watched(&mut self, watch: &mut Watch<'_>) -> Result<ArmState, ArmError> {
        let state = self.state()?;
        match watch(&state) {
            Ok(()) | Err(Halt::Pause) => Ok(state),
            Err(Halt::Stop(why)) => Err(why),
        }
    }

    /// Waits under the watch callback.
    pub(super) fn watched_wait(
        &mut self,
        seconds: f64,
        watch: &mut Watch<'_>,
    ) -> Result<(), ArmError> {
        let begun_s = self.port.now_s();
        loop {
            self.port.wait(POLL_S);
            self.watched(watch)?;
            // A clock may count in steps that do not add up exactly.
            if self.port.now_s() - begun_s >= seconds - 1e-9 {
                return Ok(());
            }
        }
    }

    /// Waits under the watch callback until two readings agree, and returns the last; fails after `limit_s` seconds.
    pub(super) fn settled<T>(
        &mut self,
        read: impl Fn(&mut Self) -> Result<Reading<T>, ArmError>,
        agree: impl Fn(&T, &T) -> bool,
        limit_s: f64,
        watch: &mut Watch<'_>,
    ) -> Result<T, ArmError> {
        let begun_s = self.port.now_s();
        let mut before = read(self)?;
        while self.port.now_s() - begun_s <= limit_s {
            self.watched_wait(REST_S, watch)?;
            let now = read(self)?;
            // Only a new reading can show rest.
            if now.at_s > before.at_s {
                if agree(&now.value, &before.value) {
                    return Ok(now.value);
                }
                before = now;
            }
        }
        Err(ArmError::timed_out(self.port.now_s() - begun_s))
    }

    /// Waits until the tool is at rest; fails after [`SETTLE_S`]. A pause request is ignored.
    pub(super) fn wait_until_at_rest(
        &mut self,
        watch: &mut Watch<'_>,
    ) -> Result<ArmState, ArmError> {
        let read = |arm: &mut Self| {
            let value = arm.state()?;
            Ok(Reading {
                at_s: value.at_s,
                value,
            })
        };
        self.settled(read, ArmState::rests_at, SETTLE_S, watch)
    }

    /// Returns whether the tool stays in place, without a watch.
    pub(crate) fn is_at_rest(&mut self) -> Result<bool, ArmError> {
        let before = self.state()?;
        self.port.wait(2.0 * REST_S);
        let after = self.state()?;
        Ok(after.at_s > before.at_s && after.rests_at(&before))
    }
}

impl ArmState {
    /// Returns whether the tool is where it was in another state.
    pub(super) fn rests_at(&self, before: &ArmState) -> bool {
        Deviation::between(&self.tool, &before.tool).position_m < REST_M
    }
}

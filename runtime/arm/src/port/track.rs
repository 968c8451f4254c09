//! Whether the tool moved until a goal was cancelled.
//!
//! In: readings of its position. Out: until when it moved. kinova-ros handles a cancellation by stopping the arm and
//! starting it again, and it checks for a cancellation before it checks for a stop. A stop pressed up to 0.1 s before the
//! cancellation is therefore released, and nothing reports it. But its tool came to rest before the cancellation.

use nalgebra::Vector3;

/// A tool slower than this counts as not moving, m/s.
const SLOW_M_S: f64 = 0.01;

/// The last three readings since a goal was sent, and before it was cancelled.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// When they were taken, seconds, and the tool's position, metres.
    readings: Vec<(f64, Vector3<f64>)>,
    is_ended: bool,
}

impl Track {
    /// Notes a reading; one that is repeated counts once.
    pub fn record(&mut self, at_s: f64, position_m: Vector3<f64>) {
        let is_new = self
            .readings
            .last()
            .is_none_or(|(last_s, _)| at_s > *last_s);
        if is_new && !self.is_ended {
            self.readings.push((at_s, position_m));
        }
        if self.readings.len() > 3 {
            self.readings.remove(0);
        }
    }

    /// Ends it: the goal is cancelled.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Returns the time until which the tool moved if it came to rest at `rest`, or where it is now, seconds. `None`
    /// without steady motion: the first of three readings may be from before the motion.
    pub fn moved_until_s(&self, rest: Option<&Vector3<f64>>) -> Option<f64> {
        let [first, second, third] = self.readings.as_slice() else {
            return None;
        };
        let speed_m_s = |from: &(f64, Vector3<f64>), to: &(f64, Vector3<f64>)| {
            (to.1 - from.1).norm() / (to.0 - from.0)
        };
        let lately_m_s = speed_m_s(second, third);
        if speed_m_s(first, second) < SLOW_M_S || lately_m_s < SLOW_M_S {
            return None;
        }
        let left_m = (rest.unwrap_or(&third.1) - third.1).norm();
        Some(third.0 + left_m / lately_m_s)
    }
}

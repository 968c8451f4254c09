//! When a reading was taken, on this program's clock, from the stamp that its sender gave it.
//!
//! In: stamps on the sender's clock, with the times of receipt on ours. Out: a time on ours for each new reading; none
//! for a repeated one, so that an arm that says the same over and over grows stale like a silent one. The clocks need
//! not agree: their difference is taken to be the least that was seen, which contains the shortest transit. So a delay
//! that grows is seen, and one that was there from the first reading on is not. A sender's clock that is set back
//! counts as silence.

/// How fast two clocks may drift apart, seconds per second: twice what NTP slews at most (500 ppm).
const DRIFT: f64 = 1e-3;

/// The stamps of one topic.
#[derive(Clone, Debug, Default)]
pub struct Stamps {
    last: Option<Stamp>,
}

#[derive(Clone, Copy, Debug)]
struct Stamp {
    stamp_s: f64,
    heard_s: f64,
    /// Our clock minus the sender's, with the shortest transit.
    offset_s: f64,
}

impl Stamps {
    /// Returns when a reading was taken, on our clock, seconds: never later than `heard_s`, and later than the one
    /// before. `None` if it is not newer than the one before.
    ///
    /// - `stamp_s`: on the sender's clock, seconds.
    /// - `heard_s`: the time of receipt on ours, seconds.
    pub fn taken_s(&mut self, stamp_s: f64, heard_s: f64) -> Option<f64> {
        let seen_s = heard_s - stamp_s;
        let offset_s = match self.last {
            _ if !stamp_s.is_finite() => return None,
            Some(last) if stamp_s <= last.stamp_s => return None,
            Some(last) => seen_s.min(last.offset_s + DRIFT * (heard_s - last.heard_s)),
            None => seen_s,
        };
        self.last = Some(Stamp {
            stamp_s,
            heard_s,
            offset_s,
        });
        Some(stamp_s + offset_s)
    }
}

#[cfg(test)]
mod tests;

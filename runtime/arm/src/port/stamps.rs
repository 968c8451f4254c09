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
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The ages at their receipt of readings given by stamp and time of receipt; `None` for those that are not new.
    fn ages(heard: &[(f64, f64)]) -> Vec<Option<f64>> {
        let mut stamps = Stamps::default();
        let age = |(stamp_s, heard_s): &(f64, f64)| {
            let taken_s = stamps.taken_s(*stamp_s, *heard_s)?;
            Some(((heard_s - taken_s) * 1000.0).round() / 1000.0)
        };
        heard.iter().map(age).collect()
    }

    #[test]
    fn a_reading_is_as_old_as_its_stamp_says() {
        let new = |age_s: f64| Some(age_s);
        for (told, heard, expected) in [
            (
                "clocks that differ",
                vec![(900.0, 1.0), (900.1, 1.1), (900.2, 1.2)],
                vec![new(0.0), new(0.0), new(0.0)],
            ),
            (
                "a pose that is repeated",
                vec![(5.0, 1.0), (5.0, 1.1), (5.0, 9.0)],
                vec![new(0.0), None, None],
            ),
            (
                "a delay that grows",
                vec![(5.0, 1.0), (5.1, 1.3), (5.2, 2.0)],
                vec![new(0.0), new(0.2), new(0.799)],
            ),
            (
                "a quicker transit than the first",
                vec![(5.0, 1.3), (5.1, 1.2), (5.2, 1.4)],
                vec![new(0.0), new(0.0), new(0.1)],
            ),
            (
                "a clock that is set back",
                vec![(5.0, 1.0), (3.0, 1.1), (3.1, 1.2)],
                vec![new(0.0), None, None],
            ),
            (
                "a clock that is set forward",
                vec![(5.0, 1.0), (905.1, 1.1), (905.2, 1.2)],
                vec![new(0.0), new(0.0), new(0.0)],
            ),
            (
                "no time at all",
                vec![(f64::NAN, 1.0), (5.0, 1.1), (f64::NAN, 1.2)],
                vec![None, new(0.0), None],
            ),
        ] {
            assert_eq!(ages(&heard), expected, "{told}");
        }
    }

    proptest! {
        /// Two clocks with any offset and drift, and any transit: every reading counts, none from the future.
        #[test]
        fn readings_are_as_fresh_as_their_transit(
            ahead_s in -1e9_f64..1e9,
            drift in -5e-4_f64..5e-4,
            transits in prop::collection::vec(0.0_f64..0.05, 2..200),
        ) {
            let mut stamps = Stamps::default();
            let mut before_s = f64::NEG_INFINITY;
            for (index, transit_s) in transits.iter().enumerate() {
                let taken_s = index as f64 * 0.1;
                let heard_s = taken_s + transit_s;
                let found_s = stamps.taken_s(ahead_s + taken_s * (1.0 + drift), heard_s).unwrap_or(f64::NAN);
                // A stamp near 1e9 s resolves a tenth of a microsecond.
                prop_assert!(found_s <= heard_s + 1e-6 && found_s > before_s);
                prop_assert!(heard_s - found_s < 0.05 + 1e-2);
                before_s = found_s;
            }
        }
    }
}

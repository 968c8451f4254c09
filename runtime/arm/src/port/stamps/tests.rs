//! Tests of `stamps`.

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

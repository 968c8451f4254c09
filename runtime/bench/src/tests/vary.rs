//! Unit tests of `vary`.

#![allow(clippy::unwrap_used)]
use super::*;
use proptest::prelude::*;

fn vary(text: &str) -> Result<Vary, String> {
    toml::from_str(text).map_err(|error: toml::de::Error| error.message().to_owned())
}

#[test]
fn axes_are_read_in_the_order_of_the_table_and_written_as_they_were() {
    let vary = vary("hue_deg = [-20, 20]\nfriction = [0.5, 1.2]\nseed = 7").unwrap();
    let names: Vec<_> = vary.ranges.iter().map(|range| range.axis.name).collect();
    assert_eq!((vary.seed, &names[..]), (7, &["friction", "hue_deg"][..]));
    let written = serde_json::json!(vary);
    assert_eq!(
        written,
        serde_json::json!({"seed": 7, "friction": [0.5, 1.2], "hue_deg": [-20.0, 20.0]})
    );
    assert_eq!(serde_json::from_value::<Vary>(written).unwrap(), vary);
    let names = |vary: &Vary| {
        let all = vary.variations();
        all.iter().map(Variation::name).collect::<Vec<_>>()
    };
    assert_eq!(
        names(&vary),
        [Some("friction"), Some("hue_deg"), Some("all")]
    );
    // All axes at once are the only one.
    let one = super::tests::vary("size = [1, 1]").unwrap();
    assert_eq!(names(&one), [Some("size")]);
    assert_eq!(one.variations()[0].values(3).0["size"], 1.0);
    assert!(Variation::default().values(3).is_empty());
}

#[test]
fn what_is_wrong_with_a_table_is_said_with_what_would_be_right() {
    for (text, wanted) in [
        ("", "`[vary]` names no axis; state at least one"),
        ("seed = 3", "`[vary]` names no axis"),
        ("seed = -3\nsize = [1, 1]", "invalid value: integer `-3`"),
        (
            "fricton = [0.5, 1.2]",
            "`[vary]` has no axis `fricton`; did you mean `friction`?",
        ),
        (
            "camera_height = [640, 660]",
            "has no axis `camera_height`; did you mean `camera_height_mm`?",
        ),
        (
            "wind = [1, 2]",
            "has no axis `wind`; there are `size`, `friction`, `self_friction`",
        ),
        (
            "size = 1.1",
            "`vary.size` is `1.1`; it takes two numbers, the lowest and the highest value, such as `[0.5, 2]`",
        ),
        ("size = [1]", "`vary.size` is `[1]`; it takes two numbers"),
        ("size = [1, \"2\"]", "`vary.size` is `[1, \"2\"]`"),
        ("size = [1, nan]", "`vary.size` is `[1, nan]`"),
        ("size = [1, inf]", "`vary.size`: inf is not from 0.5 to 2"),
        ("size = [0.9, 1.0, 1.1]", "`vary.size` is `[0.9, 1.0, 1.1]`"),
        (
            "size = [1.1, 0.9]",
            "`vary.size`: 1.1 is greater than 0.9; the lowest value comes first",
        ),
        (
            "size = [0.9, 11]",
            "`vary.size`: 11 is not from 0.5 to 2 (factor)",
        ),
        (
            "camera_height_mm = [0.64, 0.66]",
            "`vary.camera_height_mm`: 0.64 is not from 100 to 5000 (mm)",
        ),
    ] {
        let said = vary(text).unwrap_err();
        assert!(said.contains(wanted), "{text}: {said}");
    }
}

#[test]
fn draws_are_those_of_the_stated_generator() {
    // From twenty lines of Python after `docs/bench.md`: SHA-256 of `hashlib`, SplitMix64 in whole numbers.
    for (seed, axis, [low, high], start, wanted) in [
        (0, "friction", [0.5, 1.2], 0, 0.873456),
        (0, "friction", [0.5, 1.2], 1, 1.090418),
        (7, "size", [0.9, 1.1], 39, 1.030945),
        (7, "camera_height_mm", [640.0, 660.0], 13, 644.402821),
    ] {
        let axis = Axis::find(axis).unwrap();
        let range = AxisRange { axis, low, high };
        assert_eq!(range.draw(seed, start), wanted, "{axis:?}");
    }
}

#[test]
fn draws_fill_their_range_evenly_and_axes_are_independent() {
    const STARTS: u64 = 4000;
    let hundredths = |axis: &'static Axis| {
        let range = AxisRange {
            axis,
            low: 2.0,
            high: 4.0,
        };
        let drawn = (0..STARTS).map(|start| range.draw(5, start));
        let drawn = drawn.map(|value| ((value - 2.0) * 50.0) as usize);
        drawn.collect::<Vec<_>>()
    };
    let [a, b] = [&AXES[1], &AXES[2]].map(hundredths);
    for drawn in [&a, &b] {
        for ten in drawn.chunks(10) {
            let mut tenths: Vec<usize> = ten.iter().map(|it| it / 10).collect();
            tenths.sort_unstable();
            assert!(tenths.iter().copied().eq(0..10), "{ten:?}");
        }
        // 40 are expected in each hundredth, and likewise in each pair of tenths: give or take 6.
        for hundredth in 0..100 {
            let count = drawn.iter().filter(|it| **it == hundredth).count();
            assert!((12..80).contains(&count), "{hundredth}: {count}");
        }
    }
    for pair in 0..100 {
        let both = a
            .iter()
            .zip(&b)
            .filter(|(a, b)| *a / 10 * 10 + *b / 10 == pair);
        let count = both.count();
        assert!((12..80).contains(&count), "{pair}: {count}");
    }
    // The order of tenths is another in each block.
    assert_ne!(a[..10], a[10..20]);
}

proptest! {
    #[test]
    fn an_axis_draws_the_same_by_itself_among_others_and_for_every_method(
        seed: u64,
        start: u64,
        kept in proptest::sample::subsequence((0..AXES.len()).collect::<Vec<_>>(), 2..AXES.len()),
    ) {
        let ranges = kept.iter().map(|at| {
            let axis = &AXES[*at];
            AxisRange { axis, low: axis.low, high: axis.low + (axis.high - axis.low) / 3.0 }
        });
        let vary = Vary { seed, ranges: ranges.collect() };
        let variations = vary.variations();
        let all = variations.last().unwrap().values(start);
        prop_assert_eq!(all.0.len(), kept.len());
        for (variation, range) in variations.iter().zip(&vary.ranges) {
            let alone = variation.values(start);
            prop_assert_eq!(&alone, &variation.clone().values(start));
            let value = alone.0[range.axis.name];
            prop_assert_eq!(value, all.0[range.axis.name]);
            prop_assert!((range.low..=range.high).contains(&value), "{} {:?}", value, range);
            let written = serde_json::to_string(&alone).unwrap();
            prop_assert_eq!(serde_json::from_str::<AxisValues>(&written).unwrap(), alone);
        }
    }
}

//! Unit tests of `chance`.

use super::*;

#[test]
fn the_stream_is_that_of_the_published_generator() {
    // The first numbers of the authors' reference code for seed 1234567.
    let mut chance = Chance::seeded(1_234_567);
    let expected = [
        6_457_827_717_110_365_317,
        3_203_168_211_198_807_973,
        9_817_491_932_198_370_423,
        4_593_380_528_125_082_431,
    ];
    assert_eq!(expected.map(|_| chance.draw()), expected);
}

#[test]
fn whole_numbers_stay_below_their_bound_and_reach_each_value_about_as_often() {
    let mut chance = Chance::of("a text");
    let mut counts = [0u32; 7];
    for _ in 0..70_000 {
        counts[chance.below(7)] += 1;
    }
    assert!(
        counts.iter().all(|count| (9_500..10_500).contains(count)),
        "{counts:?}"
    );
    assert_eq!(chance.below(0), 0);
    assert_eq!(chance.below(1), 0);
}

#[test]
fn fractions_lie_below_one() {
    let mut chance = Chance::seeded(3);
    let drawn: Vec<f64> = (0..10_000).map(|_| chance.fraction()).collect();
    assert!(drawn.iter().all(|value| (0.0..1.0).contains(value)));
    let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
    assert!((mean - 0.5).abs() < 0.02, "{mean}");
}

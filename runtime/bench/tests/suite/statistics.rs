//! Tests of the tables' statistics, against results of numpy and scipy, and by their laws.
use fab_bench::statistics;
use fab_bench::statistics::{Clusters, Statistic, Summary};
use proptest::prelude::*;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

/// Every start is a cluster of its own.
fn single(n_starts: usize) -> Clusters {
    let starts: Vec<_> = (0..n_starts).map(|start| BTreeSet::from([start])).collect();
    Clusters::joined(&starts)
}

#[derive(Deserialize)]
struct Fixture {
    samples: Vec<Sample>,
    shares: Vec<Share>,
    gap: Gap,
}

#[derive(Deserialize)]
struct Sample {
    name: String,
    by_start: Vec<Vec<f64>>,
    percentiles: BTreeMap<String, f64>,
    median: f64,
    larger_quartile_distance: f64,
    mean: f64,
    sd: f64,
    mean_ci95: Option<[f64; 2]>,
    median_ci95: Option<[f64; 2]>,
}

#[derive(Deserialize)]
struct Share {
    successes: usize,
    trials: usize,
    ci95: [f64; 2],
}

#[derive(Deserialize)]
struct Gap {
    a: Vec<f64>,
    b: Vec<f64>,
    mean: f64,
    mean_ci95: [f64; 2],
    median: f64,
    median_ci95: [f64; 2],
}

fn summary(statistic: Statistic, by_start: &[Vec<f64>]) -> Option<Summary> {
    statistics::summary(statistic, by_start, &single(by_start.len()))
}

fn gap(statistic: Statistic, a: &[Vec<f64>], b: &[Vec<f64>]) -> Option<Summary> {
    statistics::gap(statistic, a, b, &single(a.len()))
}

fn fixture() -> Fixture {
    serde_json::from_str(include_str!("fixtures/statistics.json")).unwrap()
}

fn assert_near(found: f64, wanted: f64, what: &str) {
    assert!(
        (found - wanted).abs() <= 1e-12 * wanted.abs().max(1.0),
        "{what}: {found}, not {wanted}"
    );
}

/// Compares an interval with one from other resamples, to within a fraction of its length.
fn assert_alike(found: Option<[f64; 2]>, wanted: Option<[f64; 2]>, what: &str) {
    let Some([low, high]) = wanted else {
        return;
    };
    let [found_low, found_high] = found.unwrap();
    // The mean of five values has coarse steps, and 10 000 resamples may hit the next one.
    let tolerance = 0.08 * (high - low);
    let off = (found_low - low).abs().max((found_high - high).abs());
    assert!(off <= tolerance, "{what}: {found:?}, not {wanted:?}");
}

#[test]
fn values_and_spreads_are_those_of_numpy() {
    for sample in fixture().samples {
        let what = sample.name.as_str();
        let all = sample.by_start.concat();
        for (percent, wanted) in &sample.percentiles {
            let share = percent.parse::<f64>().unwrap() / 100.0;
            assert_near(statistics::percentile(&all, share).unwrap(), *wanted, what);
        }
        let median = summary(Statistic::Median, &sample.by_start).unwrap();
        assert_near(median.value, sample.median, what);
        assert_near(
            median.spread.unwrap(),
            sample.larger_quartile_distance,
            what,
        );
        assert_alike(median.ci95, sample.median_ci95, what);
        let mean = summary(Statistic::Mean, &sample.by_start).unwrap();
        assert_near(mean.value, sample.mean, what);
        assert_near(mean.spread.unwrap(), sample.sd, what);
        assert_alike(mean.ci95, sample.mean_ci95, what);
    }
}

#[test]
fn shares_have_wilsons_interval() {
    for Share {
        successes,
        trials,
        ci95,
    } in fixture().shares
    {
        let happened = |trial| vec![f64::from(u8::from(trial < successes))];
        let by_start: Vec<Vec<f64>> = (0..trials).map(happened).collect();
        let found = summary(Statistic::Share, &by_start).unwrap();
        let what = format!("{successes} of {trials}");
        assert_near(found.value, successes as f64 / trials as f64, &what);
        let [low, high] = found.ci95.unwrap();
        assert!(
            (low - ci95[0]).abs() < 1e-9 && (high - ci95[1]).abs() < 1e-9,
            "{what}: {low} {high}, not {ci95:?}"
        );
    }
}

#[test]
fn gaps_are_paired() {
    let Gap {
        a,
        b,
        mean,
        mean_ci95,
        median,
        median_ci95,
    } = fixture().gap;
    let single = |all: &[f64]| all.iter().map(|value| vec![*value]).collect::<Vec<_>>();
    let (a, b) = (single(&a), single(&b));
    let found = gap(Statistic::Mean, &a, &b).unwrap();
    assert_near(found.value, mean, "mean");
    assert_alike(found.ci95, Some(mean_ci95), "mean");
    let found = gap(Statistic::Median, &a, &b).unwrap();
    assert_near(found.value, median, "median");
    assert_alike(found.ci95, Some(median_ci95), "median");
}

#[test]
fn nothing_comes_of_nothing() {
    for statistic in [Statistic::Median, Statistic::Mean, Statistic::Share] {
        assert_eq!(summary(statistic, &[]), None);
        assert_eq!(summary(statistic, &[vec![], vec![]]), None);
        assert_eq!(gap(statistic, &[vec![1.0]], &[vec![]]), None);
    }
    let single = summary(Statistic::Mean, &[vec![2.0, 4.0], vec![]]);
    let expected = Summary {
        value: 3.0,
        spread: Some(0.0),
        ci95: None,
    };
    assert_eq!(single, Some(expected));
}

#[test]
fn starts_with_a_common_answer_are_drawn_together() {
    let answers = |by_start: &[&[&'static str]]| {
        let sets = by_start.iter().map(|it| it.iter().copied().collect());
        Clusters::joined(&sets.collect::<Vec<_>>())
    };
    let [a, b, c] = [0.0, 10.0, 40.0].map(|value| vec![value]);
    // The first three starts are joined through the second one; the fourth has no sample.
    let clusters = answers(&[&["x"], &["x", "y"], &["y", "own"], &["z"], &["z"], &[]]);
    let samples = [
        a.clone(),
        b.clone(),
        a.clone(),
        vec![],
        c.clone(),
        c.clone(),
    ];
    assert_eq!(clusters.count(&samples), 3);
    let joined = statistics::summary(Statistic::Mean, &samples, &clusters).unwrap();
    let alone = summary(Statistic::Mean, &samples).unwrap();
    assert_eq!((joined.value, joined.spread), (alone.value, alone.spread));
    let wide = |summary: Summary| summary.ci95.map(|[low, high]| high - low);
    assert!(wide(joined) > wide(alone), "{joined:?} {alone:?}");
    // A draw of nothing but the first cluster has the mean of its three starts.
    assert_eq!(joined.ci95.unwrap()[0], 10.0 / 3.0);
    let gap = statistics::gap(Statistic::Mean, &samples, &samples, &clusters).unwrap();
    assert_eq!((gap.value, gap.ci95), (0.0, Some([0.0, 0.0])));

    let one = answers(&[&["x"], &["x"], &["x"]]);
    let samples = [vec![1.0], vec![1.0], vec![0.0]];
    assert_eq!(
        statistics::summary(Statistic::Mean, &samples, &one)
            .unwrap()
            .ci95,
        None
    );
    assert_eq!(
        statistics::gap(Statistic::Mean, &samples, &samples, &one)
            .unwrap()
            .ci95,
        None
    );
    let share = statistics::summary(Statistic::Share, &samples, &one).unwrap();
    assert_eq!(share.ci95, statistics::wilson(2.0 / 3.0, 1));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Intervals contain their value, shift and scale with the data, and are reproducible.
    #[test]
    #[ignore = "long"]
    fn summaries_move_with_the_data(
        by_start in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 1..4), 3..20),
        shift in -10.0..10.0f64,
    ) {
        for statistic in [Statistic::Median, Statistic::Mean] {
            let found = summary(statistic, &by_start).unwrap();
            prop_assert_eq!(Some(found), summary(statistic, &by_start));
            let [low, high] = found.ci95.unwrap();
            prop_assert!(low <= found.value + 1e-12 && found.value <= high + 1e-12);
            let moved: Vec<Vec<f64>> = by_start
                .iter()
                .map(|repeats| repeats.iter().map(|value| value + shift).collect())
                .collect();
            let there = summary(statistic, &moved).unwrap();
            prop_assert!((there.value - found.value - shift).abs() < 1e-9);
            prop_assert!((there.spread.unwrap() - found.spread.unwrap()).abs() < 1e-9);
            prop_assert!((there.ci95.unwrap()[0] - low - shift).abs() < 1e-9);
            let gap = gap(statistic, &moved, &by_start).unwrap();
            prop_assert!((gap.value - shift).abs() < 1e-9);
            let [gap_low, gap_high] = gap.ci95.unwrap();
            prop_assert!((gap_low - shift).abs() < 1e-9 && (gap_high - shift).abs() < 1e-9);
        }
    }

    /// Repeating a start's rollout with the same result changes no mean.
    #[test]
    fn equal_repeats_change_no_mean(values in prop::collection::vec(0.0..1.0f64, 3..15)) {
        let once: Vec<Vec<f64>> = values.iter().map(|value| vec![*value]).collect();
        let thrice: Vec<Vec<f64>> = values.iter().map(|value| vec![*value; 3]).collect();
        let (a, b) = (
            summary(Statistic::Mean, &once).unwrap(),
            summary(Statistic::Mean, &thrice).unwrap(),
        );
        prop_assert!((a.value - b.value).abs() < 1e-12);
        for (a, b) in a.ci95.unwrap().iter().zip(b.ci95.unwrap()) {
            prop_assert!((a - b).abs() < 1e-12);
        }
    }
}

//! Statistics of many rollouts: a value, its spread, and a 95 % interval.
//!
//! In: samples by start, because repeats of one start are not independent, and the clusters of starts that share answers
//! of a model. Out: the statistics that the paper prints
//! (median with the larger quartile distance; mean with standard deviation), with a percentile bootstrap over clusters,
//! and Wilson's interval for shares. Equal samples give equal bits.

use fab_base::chance::Chance;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Number of bootstrap resamples for an interval.
const RESAMPLES: usize = 10_000;
/// The seed of the resamples; a fixed one makes tables reproducible.
const SEED: u64 = 2406_09640;
/// The 97.5 % point of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

fab_base::named! {
    /// A statistic of a sample.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Statistic {
        /// The median of all rollouts, with `max(|Q50 - Q25|, |Q75 - Q50|)`.
        Median = "median",
        /// The mean over starts, each start's repeats averaged first, with the standard deviation over starts.
        Mean = "mean",
        /// The share of rollouts in which something happened; it has no spread.
        Share = "share",
    }
}

/// The computed statistic of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Median, mean or share.
    pub value: f64,
    /// Its spread; see [`Statistic`].
    pub spread: Option<f64>,
    /// The bounds of its 95 % interval; `None` for a single cluster, except for a share.
    pub ci95: Option<[f64; 2]>,
}

/// Starts by what makes them dependent: those of one cluster are drawn together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clusters {
    /// The cluster of each start: the index of its first start.
    of: Vec<usize>,
}

impl Clusters {
    /// Joins the starts that have something in common, directly or through others; one set for each start.
    pub fn joined<T: Ord>(by_start: &[BTreeSet<T>]) -> Clusters {
        let mut of: Vec<usize> = (0..by_start.len()).collect();
        let mut first: BTreeMap<&T, usize> = BTreeMap::new();
        for (start, used) in by_start.iter().enumerate() {
            for it in used {
                let (a, b) = (of[*first.entry(it).or_insert(start)], of[start]);
                for cluster in &mut of {
                    if *cluster == a.max(b) {
                        *cluster = a.min(b);
                    }
                }
            }
        }
        Clusters { of }
    }

    /// Returns the number of clusters of the starts with samples.
    pub fn count(&self, by_start: &[Vec<f64>]) -> usize {
        self.filled(by_start).len()
    }

    /// Returns the indices of the starts with samples, by cluster.
    fn filled(&self, by_start: &[Vec<f64>]) -> Vec<Vec<usize>> {
        let mut clusters: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (start, cluster) in self.of.iter().enumerate() {
            if by_start.get(start).is_some_and(|it| !it.is_empty()) {
                clusters.entry(*cluster).or_default().push(start);
            }
        }
        clusters.into_values().collect()
    }
}

/// Summarises samples by start: one list of repeats for each.
///
/// Starts without samples are ignored; `None` if none is left. Non-finite samples are not allowed.
pub fn summary(
    statistic: Statistic,
    by_start: &[Vec<f64>],
    clusters: &Clusters,
) -> Option<Summary> {
    let clusters = clusters.filled(by_start);
    let filled = filled(by_start);
    let value = value_of(statistic, &filled)?;
    let (spread, ci95) = match statistic {
        Statistic::Median => {
            let of = |drawn: &[usize]| value_of(statistic, &pick(by_start, drawn));
            let spread = larger_quartile_distance(&filled.concat());
            (spread, bootstrap(&clusters, of))
        }
        Statistic::Mean => {
            // A start without samples is in no cluster, so its zero is never drawn.
            let all = by_start.iter().map(|it| mean(it).unwrap_or_default());
            let all: Vec<f64> = all.collect();
            let ci95 = bootstrap(&clusters, |drawn| mean(&pick(&all, drawn)));
            (standard_deviation(&means(&filled)), ci95)
        }
        Statistic::Share => (None, wilson(value, clusters.len())),
    };
    Some(Summary {
        value,
        spread,
        ci95,
    })
}

/// Summarises by how much `a` exceeds `b`, both by start and in the same order of starts.
///
/// The interval is paired: both are resampled at the same starts. Starts missing in one of them are ignored.
pub fn gap(
    statistic: Statistic,
    a: &[Vec<f64>],
    b: &[Vec<f64>],
    clusters: &Clusters,
) -> Option<Summary> {
    let both = a.iter().zip(b).map(|(a, b)| {
        if a.is_empty() || b.is_empty() {
            (Vec::new(), Vec::new())
        } else {
            (a.clone(), b.clone())
        }
    });
    let (a, b): (Vec<_>, Vec<_>) = both.unzip();
    let of = |drawn: &[usize]| {
        Some(value_of(statistic, &pick(&a, drawn))? - value_of(statistic, &pick(&b, drawn))?)
    };
    let clusters = clusters.filled(&a);
    let mut all = clusters.concat();
    all.sort_unstable();
    Some(Summary {
        value: of(&all)?,
        spread: None,
        ci95: bootstrap(&clusters, of),
    })
}

/// Returns a percentile by numpy's default method, `linear`; `share` from 0 to 1.
pub fn percentile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let at = share.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64))
}

/// Returns `max(|Q50 - Q25|, |Q75 - Q50|)`.
pub fn larger_quartile_distance(values: &[f64]) -> Option<f64> {
    let [low, middle, high] = [0.25, 0.5, 0.75].map(|share| percentile(values, share));
    Some((middle? - low?).abs().max((high? - middle?).abs()))
}

/// Returns the mean.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Returns the standard deviation of the values themselves (divided by their number, numpy's default).
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    Some((squares.sum::<f64>() / values.len() as f64).sqrt())
}

/// Returns Wilson's 95 % interval for a share of `count` independent trials (Wilson 1927), without correction.
///
/// With repeats, `count` is the number of clusters: repeats of a start are not independent.
pub fn wilson(share: f64, count: usize) -> Option<[f64; 2]> {
    if count == 0 {
        return None;
    }
    let n = count as f64;
    let middle = share + Z * Z / (2.0 * n);
    let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let over = 1.0 + Z * Z / n;
    Some([
        ((middle - half) / over).max(0.0),
        ((middle + half) / over).min(1.0),
    ])
}

fn value_of(statistic: Statistic, by_start: &[Vec<f64>]) -> Option<f64> {
    match statistic {
        Statistic::Median => percentile(&by_start.concat(), 0.5),
        Statistic::Mean | Statistic::Share => mean(&means(by_start)),
    }
}

fn filled(by_start: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let filled = by_start.iter().filter(|repeats| !repeats.is_empty());
    filled.cloned().collect()
}

fn means(by_start: &[Vec<f64>]) -> Vec<f64> {
    by_start
        .iter()
        .filter_map(|repeats| mean(repeats))
        .collect()
}

fn pick<T: Clone>(all: &[T], indices: &[usize]) -> Vec<T> {
    indices.iter().map(|index| all[*index].clone()).collect()
}

/// Returns the percentile interval of a statistic over resampled clusters; `of` gets the indices of their starts.
fn bootstrap(clusters: &[Vec<usize>], of: impl Fn(&[usize]) -> Option<f64>) -> Option<[f64; 2]> {
    let count = clusters.len();
    if count < 2 {
        return None;
    }
    let mut chance = Chance::seeded(SEED);
    let mut values = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        let drawn = (0..count).flat_map(|_| &clusters[chance.below(count)]);
        let drawn: Vec<usize> = drawn.copied().collect();
        values.push(of(&drawn)?);
    }
    Some([percentile(&values, 0.025)?, percentile(&values, 0.975)?])
}

//! Statistics of many rollouts: a value, its spread, and a 95 % interval.
//!
//! In: samples by start, because repeats of one start are not independent. Out: the statistics that the paper prints
//! (median with the larger quartile distance; mean with standard deviation), with a percentile bootstrap over starts,
//! and Wilson's interval for shares. Equal samples give equal bits.

use fab_base::chance::Chance;
use serde::{Deserialize, Serialize};

/// Number of bootstrap resamples for an interval.
const RESAMPLES: usize = 10_000;
/// The seed of the resamples; a fixed one makes tables reproducible.
const SEED: u64 = 2406_09640;
/// The 97.5 % point of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// A statistic of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// The median of all rollouts, with `max(|Q50 - Q25|, |Q75 - Q50|)`.
    Median,
    /// The mean over starts, each start's repeats averaged first, with the standard deviation over starts.
    Mean,
    /// The share of rollouts in which something happened; it has no spread.
    Share,
}

impl Statistic {
    /// Returns its name in tables and JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Statistic::Median => "median",
            Statistic::Mean => "mean",
            Statistic::Share => "share",
        }
    }
}

/// The computed statistic of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Median, mean or share.
    pub value: f64,
    /// Its spread; see [`Statistic`].
    pub spread: Option<f64>,
    /// The bounds of its 95 % interval; `None` for a single start, except for a share.
    pub ci95: Option<[f64; 2]>,
}

/// Summarises samples by start: one list of repeats for each.
///
/// Starts without samples are ignored; `None` if none is left. Non-finite samples are not allowed.
pub fn summary(statistic: Statistic, by_start: &[Vec<f64>]) -> Option<Summary> {
    let by_start = filled(by_start);
    let value = value_of(statistic, &by_start)?;
    let (spread, ci95) = match statistic {
        Statistic::Median => (
            larger_quartile_distance(&by_start.concat()),
            bootstrap(by_start.len(), |drawn| {
                value_of(statistic, &pick(&by_start, drawn))
            }),
        ),
        Statistic::Mean => {
            let means = means(&by_start);
            let spread = standard_deviation(&means);
            let ci95 = bootstrap(means.len(), |drawn| mean(&pick(&means, drawn)));
            (spread, ci95)
        }
        Statistic::Share => (None, wilson(value, by_start.len())),
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
pub fn gap(statistic: Statistic, a: &[Vec<f64>], b: &[Vec<f64>]) -> Option<Summary> {
    let both = a.iter().zip(b);
    let both = both.filter(|(a, b)| !a.is_empty() && !b.is_empty());
    let (a, b): (Vec<_>, Vec<_>) = both.map(|(a, b)| (a.clone(), b.clone())).unzip();
    let of = |drawn: &[usize]| {
        Some(value_of(statistic, &pick(&a, drawn))? - value_of(statistic, &pick(&b, drawn))?)
    };
    let all: Vec<usize> = (0..a.len()).collect();
    Some(Summary {
        value: of(&all)?,
        spread: None,
        ci95: bootstrap(a.len(), of),
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
/// With repeats, `count` is the number of starts: repeats of a start are not independent.
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

/// Returns the percentile interval of a statistic over resampled starts; `of` gets their indices.
fn bootstrap(count: usize, of: impl Fn(&[usize]) -> Option<f64>) -> Option<[f64; 2]> {
    if count < 2 {
        return None;
    }
    let mut chance = Chance::seeded(SEED);
    let mut values = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        let drawn: Vec<usize> = (0..count).map(|_| chance.below(count)).collect();
        values.push(of(&drawn)?);
    }
    Some([percentile(&values, 0.025)?, percentile(&values, 0.975)?])
}

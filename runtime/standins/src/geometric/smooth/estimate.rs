//! Estimates the gain of a pull from its features.
//!
//! In: the numbers of [`features`](super::features). Out: the gain of true coverage, as a share of the flat cloth. The
//! estimate is the mean of small networks with one hidden layer each, fitted to pulls in the simulator; `estimate.json`
//! holds their weights, and documents the starts they were fitted to and their accuracy on others.

use super::features::NAMES;
use serde::Deserialize;
use std::sync::LazyLock;

/// The weights, and the scaling of features.
#[derive(Deserialize)]
struct Estimate {
    /// The features' names, in order.
    features: Vec<String>,
    /// Mean of each feature over the fitted pulls.
    mean: Vec<f64>,
    deviation: Vec<f64>,
    /// Scaled features are clamped to this, either way: the fit has no data beyond it.
    limit: f64,
    networks: Vec<Network>,
}

/// One network: hidden units with rectifiers, and their weighted sum.
#[derive(Deserialize)]
struct Network {
    hidden: Vec<Unit>,
    bias: f64,
}

#[derive(Deserialize)]
struct Unit {
    weights: Vec<f64>,
    bias: f64,
    /// Its weight in the sum.
    counts: f64,
}

static ESTIMATE: LazyLock<Estimate> = LazyLock::new(|| {
    let estimate: Estimate = serde_json::from_str(include_str!("estimate.json"))
        .expect("the embedded weights are whole");
    assert_eq!(
        estimate.features, NAMES,
        "the weights are of these features"
    );
    estimate
});

/// Estimates the gain of a pull, as a share of the flat cloth's area.
pub fn gain(features: &[f64; NAMES.len()]) -> f64 {
    let estimate = &*ESTIMATE;
    let scaled: Vec<f64> = features
        .iter()
        .zip(estimate.mean.iter().zip(&estimate.deviation))
        .map(|(value, (mean, deviation))| {
            ((value - mean) / deviation).clamp(-estimate.limit, estimate.limit)
        })
        .collect();
    let of_network = |network: &Network| {
        let of_unit = |unit: &Unit| {
            let weighted = unit.weights.iter().zip(&scaled);
            let sum: f64 = weighted.map(|(weight, value)| weight * value).sum();
            unit.counts * (sum + unit.bias).max(0.0)
        };
        network.bias + network.hidden.iter().map(of_unit).sum::<f64>()
    };
    let gains = estimate.networks.iter().map(of_network);
    gains.sum::<f64>() / estimate.networks.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct Fitted {
        example: Example,
    }

    /// A pull, with the gain computed by the fitting program.
    #[derive(Deserialize)]
    struct Example {
        features: [f64; NAMES.len()],
        gain: f64,
    }

    #[test]
    fn the_weights_are_whole() {
        let estimate = &*ESTIMATE;
        assert_eq!(estimate.mean.len(), NAMES.len());
        assert_eq!(estimate.deviation.len(), NAMES.len());
        assert!(estimate.deviation.iter().all(|&deviation| deviation > 0.0));
        assert!(estimate.limit > 0.0 && !estimate.networks.is_empty());
        let units = estimate.networks.iter().flat_map(|network| &network.hidden);
        assert!(
            units
                .into_iter()
                .all(|unit| unit.weights.len() == NAMES.len())
        );
    }

    #[test]
    fn a_pull_has_the_gain_that_the_fit_gave_it() {
        let Fitted { example } = serde_json::from_str(include_str!("estimate.json"))
            .expect("the embedded weights are whole");
        let gain = gain(&example.features);
        assert!(
            (gain - example.gain).abs() < 1e-3,
            "{gain} and {}",
            example.gain
        );
    }
}

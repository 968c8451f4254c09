//! Estimates the gain of a pull from the picture around its pick, and from its features.
//!
//! In: a [`Window`], and the numbers of [`features`](super::features). Out: the gain of true coverage, as a share of the
//! flat cloth. The estimate is the mean of small convolutional networks, fitted to pulls in the simulator;
//! `estimate.json` holds their weights, and documents the starts they were fitted to and their accuracy on others.

use super::features::NAMES;
use super::window::{CELLS, CHANNELS, Window};
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

/// One network: convolutions of the window, then layers that also take the features.
#[derive(Deserialize)]
struct Network {
    convolutions: Vec<Convolution>,
    /// The last has one unit, and no rectifier.
    layers: Vec<Vec<Unit>>,
}

/// A convolution by every second cell, with zeros beyond the border, and rectifiers.
#[derive(Deserialize)]
struct Convolution {
    /// By output channel, input channel, row and column; as many rows as columns, an odd number.
    kernels: Vec<Vec<Vec<Vec<f32>>>>,
    /// By output channel.
    bias: Vec<f32>,
}

#[derive(Deserialize)]
struct Unit {
    weights: Vec<f32>,
    bias: f32,
}

/// Square channels, by channel, row and column.
struct Image {
    channels: usize,
    side: usize,
    values: Vec<f32>,
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

/// What the networks saw in a window and in its mirror image, which a pull cannot tell apart.
pub struct Seen(Vec<[Vec<f32>; 2]>);

impl Seen {
    /// Looks at a window.
    pub fn of(window: &Window) -> Seen {
        let image = |values| Image {
            channels: CHANNELS,
            side: CELLS,
            values,
        };
        let rows = window.as_flattened();
        let mirrored = window.iter().flat_map(|rows| rows.iter().rev().flatten());
        let images = [
            image(rows.as_flattened().to_vec()),
            image(mirrored.copied().collect()),
        ];
        let see = |network: &Network| images.each_ref().map(|image| network.see(image));
        Seen(ESTIMATE.networks.iter().map(see).collect())
    }

    /// Estimates the gain of a pull of this window, as a share of the flat cloth's area.
    pub fn gain(&self, features: &[f64; NAMES.len()]) -> f64 {
        let estimate = &*ESTIMATE;
        let scales = estimate.mean.iter().zip(&estimate.deviation);
        let scaled = features
            .iter()
            .zip(scales)
            .map(|(value, (mean, deviation))| {
                ((value - mean) / deviation).clamp(-estimate.limit, estimate.limit) as f32
            });
        let scaled: Vec<f32> = scaled.collect();
        let sides = estimate
            .networks
            .iter()
            .zip(&self.0)
            .flat_map(|(network, seen)| seen.each_ref().map(|seen| network.judge(seen, &scaled)));
        sides.map(f64::from).sum::<f64>() / (2 * self.0.len()).max(1) as f64
    }
}

impl Network {
    /// Returns what is left of an image after all convolutions.
    fn see(&self, image: &Image) -> Vec<f32> {
        let mut convolutions = self.convolutions.iter();
        let first = convolutions.next().map(|first| first.apply(image));
        let last = convolutions.fold(first, |image, next| image.map(|image| next.apply(&image)));
        last.map(|image| image.values).unwrap_or_default()
    }

    fn judge(&self, seen: &[f32], features: &[f32]) -> f32 {
        let mut values = [seen, features].concat();
        for (depth, layer) in self.layers.iter().enumerate() {
            let is_last = depth + 1 == self.layers.len();
            let of_unit = |unit: &Unit| {
                let sum = unit.bias + dot(&unit.weights, &values);
                if is_last { sum } else { sum.max(0.0) }
            };
            values = layer.iter().map(of_unit).collect();
        }
        values.iter().sum()
    }
}

impl Convolution {
    /// Returns an image of half as many rows and columns.
    fn apply(&self, image: &Image) -> Image {
        let side = image.side.div_ceil(2);
        let mut values = Vec::with_capacity(self.kernels.len() * side * side);
        for (kernel, &bias) in self.kernels.iter().zip(&self.bias) {
            for row in 0..side {
                values.extend((0..side).map(|column| {
                    let sum = bias + image.under(kernel, [2 * row, 2 * column]);
                    sum.max(0.0)
                }));
            }
        }
        Image {
            channels: self.kernels.len(),
            side,
            values,
        }
    }
}

impl Image {
    /// Adds the products of a kernel, centered at a cell, and the cells under it; beyond the border nothing counts.
    fn under(&self, kernel: &[Vec<Vec<f32>>], [row, column]: [usize; 2]) -> f32 {
        let border = kernel[0].len() / 2;
        let before = border.saturating_sub(column);
        let from = column.saturating_sub(border);
        let mut sum = 0.0;
        for (channel, kernel) in kernel.iter().enumerate().take(self.channels) {
            for (down, weights) in kernel.iter().enumerate() {
                let row = (row + down).checked_sub(border);
                if let Some(row) = row.filter(|&row| row < self.side) {
                    let begin = (channel * self.side + row) * self.side;
                    let cells = &self.values[begin + from..begin + self.side];
                    sum += dot(&weights[before..], cells);
                }
            }
        }
        sum
    }
}

/// Adds the products of two lists, as far as the shorter one goes.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[derive(Deserialize)]
    struct Fitted {
        example: Example,
    }

    /// A pull, with the gain computed by the fitting program.
    #[derive(Deserialize)]
    struct Example {
        window: Vec<Vec<Vec<f32>>>,
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
        for network in &estimate.networks {
            let (mut channels, mut side) = (CHANNELS, CELLS);
            for Convolution { kernels, bias } in &network.convolutions {
                assert_eq!(kernels.len(), bias.len());
                for kernel in kernels {
                    assert_eq!(kernel.len(), channels);
                    let size = kernel[0].len();
                    assert!(size % 2 == 1 && kernel.iter().flatten().all(|row| row.len() == size));
                }
                (channels, side) = (kernels.len(), side.div_ceil(2));
            }
            let mut inputs = channels * side * side + NAMES.len();
            for layer in &network.layers {
                assert!(layer.iter().all(|unit| unit.weights.len() == inputs));
                inputs = layer.len();
            }
            assert_eq!(inputs, 1);
        }
    }

    #[test]
    fn a_pull_has_the_gain_that_the_fit_gave_it() {
        let Fitted { example } = serde_json::from_str(include_str!("estimate.json")).unwrap();
        let mut window = [[[0.0; CELLS]; CELLS]; CHANNELS];
        for (channel, rows) in example.window.iter().enumerate() {
            for (row, cells) in rows.iter().enumerate() {
                window[channel][row].copy_from_slice(cells);
            }
        }
        let gain = Seen::of(&window).gain(&example.features);
        let fitted = example.gain;
        assert!((gain - fitted).abs() < 1e-3, "{gain} and {fitted}");
    }
}

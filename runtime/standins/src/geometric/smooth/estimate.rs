//! Estimates the gain of a pull from the picture around its pick, and from its features.
//!
//! In: a [`Window`], and the numbers of [`features`](super::features). Out: the gain of true coverage, as a share of the
//! flat cloth. The estimate is the mean of small convolutional networks, fitted to pulls in the simulator;
//! `estimate.json` holds their weights, and documents the starts they were fitted to and their accuracy on others.

use super::features::NAMES;
use super::window::{CELLS, Window};
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
#[derive(Clone)]
struct Image {
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

/// A window and its mirror image, for which the gain is the same, as each network's convolutions encode them.
pub struct Encoded(Vec<[Vec<f32>; 2]>);

impl Encoded {
    /// Encodes a window.
    pub fn of(window: &Window) -> Encoded {
        let rows = window.iter().flatten().flatten();
        let mirrored = window.iter().flat_map(|rows| rows.iter().rev().flatten());
        let (plain, mirrored) = (rows.copied().collect(), mirrored.copied().collect());
        let images = [plain, mirrored].map(|values: Vec<f32>| Image {
            side: CELLS,
            values,
        });
        let encode =
            |network: &Network| images.each_ref().map(|image| network.encode(image.clone()));
        Encoded(ESTIMATE.networks.iter().map(encode).collect())
    }

    /// Estimates the gain of a pull of this window, as a share of the flat cloth's area.
    pub fn gain(&self, features: &[f64; NAMES.len()]) -> f64 {
        let estimate = &*ESTIMATE;
        let scales = estimate.mean.iter().zip(&estimate.deviation);
        let scaled = |(value, (mean, deviation)): (&f64, (&f64, &f64))| {
            ((value - mean) / deviation).clamp(-estimate.limit, estimate.limit) as f32
        };
        let scaled: Vec<f32> = features.iter().zip(scales).map(scaled).collect();
        let networks = estimate.networks.iter().zip(&self.0);
        let gains = networks.flat_map(|(network, encoded)| {
            let [plain, mirrored] = encoded;
            [plain, mirrored].map(|encoded| f64::from(network.gain(encoded, &scaled)))
        });
        gains.sum::<f64>() / (2 * self.0.len()) as f64
    }
}

impl Network {
    /// Returns what is left of an image after all convolutions.
    fn encode(&self, image: Image) -> Vec<f32> {
        let convolutions = self.convolutions.iter();
        convolutions
            .fold(image, |image, next| next.apply(&image))
            .values
    }

    fn gain(&self, encoded: &[f32], features: &[f32]) -> f32 {
        let mut values = [encoded, features].concat();
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
                    let sum = bias + image.correlate_at(kernel, [2 * row, 2 * column]);
                    sum.max(0.0)
                }));
            }
        }
        Image { side, values }
    }
}

impl Image {
    /// Adds the products of a kernel, centered at a cell, and the cells under it; beyond the border nothing counts.
    fn correlate_at(&self, kernel: &[Vec<Vec<f32>>], [row, column]: [usize; 2]) -> f32 {
        let border = kernel[0].len() / 2;
        let before = border.saturating_sub(column);
        let from = column.saturating_sub(border);
        let mut sum = 0.0;
        for (channel, kernel) in kernel.iter().enumerate() {
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
    use super::super::window::CHANNELS;
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
        let gain = Encoded::of(&window).gain(&example.features);
        let fitted = example.gain;
        assert!((gain - fitted).abs() < 1e-3, "{gain} and {fitted}");
    }
}

//! Tests of calibrations with a simulated camera over a table and a simulated arm that touches it.
#![allow(clippy::unwrap_used)]

mod errors;
mod files;
mod lines;
mod refusals;
mod touches;
mod truth;
mod views;

use super::*;
use nalgebra::{Isometry3, Point3, Vector3};
use truth::{Noise, Truth, terms, window};

/// Returns a usual grid of `side * side` measured points, with errors of 0.5 mm and 0.3 pixels.
fn measured_grid(seed: u64, side: u32, share: f64) -> Vec<Pair> {
    let mut noise = Noise::new(seed);
    let grid = Truth::usual().grid(side, share);
    grid.iter()
        .map(|pair| noise.measured(pair, 0.0005, 0.3))
        .collect()
}

/// Calibrates without a picture.
fn make(terms: Terms, pairs: Vec<Pair>) -> Result<Calibration, Refusal> {
    Calibration::make(terms, pairs, "2026-11-22", None)
}

impl Noise {
    /// A measured point: the tool and the pixel have errors with these standard deviations.
    pub fn measured(&mut self, pair: &Pair, tool_m: f64, pixel_px: f64) -> Pair {
        Pair {
            pixel: pair.pixel.map(|it| it + pixel_px * self.normal()),
            base_m: pair.base_m.map(|it| it + tool_m * self.normal()),
            ..*pair
        }
    }
}

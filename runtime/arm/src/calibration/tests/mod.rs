//! Tests of calibrations with a simulated camera over a table and a simulated arm that touches it.
#![allow(clippy::unwrap_used)]

mod errors;
mod files;
mod lines;
mod mistakes;
mod touches;
mod views;

mod truth;

use super::*;
use nalgebra::{Isometry3, Point3, Vector3};
use truth::{Noise, Truth, terms, window};

/// Returns a usual grid of `side * side` measured points, with errors of 0.5 mm, 0.3 pixels and `depth_m`.
fn measured_grid(seed: u64, side: u32, share: f64, depth_m: f64) -> Vec<Pair> {
    let mut noise = Noise::new(seed);
    let grid = Truth::usual().grid(side, share);
    grid.iter()
        .map(|pair| noise.measured(pair, 0.0005, 0.3, depth_m))
        .collect()
}

impl Noise {
    /// A measured point: the tool, the pixel and the depth have errors with these standard deviations.
    pub fn measured(&mut self, pair: &Pair, tool_m: f64, pixel_px: f64, depth_m: f64) -> Pair {
        Pair {
            pixel: pair.pixel.map(|it| it + pixel_px * self.normal()),
            base_m: pair.base_m.map(|it| it + tool_m * self.normal()),
            depth_m: pair.depth_m.map(|it| it + depth_m * self.normal()),
        }
    }
}

//! Tests of calibrations with a simulated camera over a table and a simulated arm that touches it.
#![allow(clippy::unwrap_used)]

mod files;
mod fits;
mod lines;
mod refusals;
mod touches;
mod truth;
mod views;

use super::view::pixel_at;
use super::*;
use crate::settings::Settings;
use nalgebra::{Isometry3, Point3, Vector3};
use truth::{Noise, Truth, WINDOW};

/// Returns a usual grid of `side * side` measured points, with errors of 0.5 mm and 0.3 pixels.
fn measured_grid(seed: u64, side: u32, share: f64) -> Vec<Pair> {
    let mut noise = Noise::new(seed);
    let grid = Truth::usual().grid(side, share);
    grid.iter()
        .map(|pair| noise.measured(pair, 0.0005, 0.3))
        .collect()
}

fn terms() -> Terms {
    Truth::usual().terms()
}

/// Calibrates without a picture.
fn make(pairs: Vec<Pair>) -> Result<Calibration, String> {
    Calibration::make(terms(), pairs, "2026-11-22", None)
}

/// Calibrates, and judges the table of the usual settings by it.
fn judged(pairs: Vec<Pair>) -> Result<[Corner; 4], String> {
    make(pairs)?.over_table(&settings())
}

/// What a person would state in the settings of this camera and table.
fn settings() -> Settings {
    let truth = Truth::usual();
    let [x, y, z]: [f64; 3] = truth.table(pixel_at(WINDOW, [0.5; 2])).into();
    let text = format!(
        "
name = 'lab'
model = 'j2n6s200'
driver = 'simulated'
calibration = 'lab.toml'
table = {{ center_m = [{x:.3}, {y:.3}, {z:.4}] }}
workspace = {{ min_m = [0.15, -0.525, 0.012], max_m = [0.75, 0.525, 0.5], rest_m = [0.3, -0.4, 0.25] }}
fingers = {{ count = 2, open = 0.0, closed = 6400.0, tolerance = 200.0 }}
[camera]
source = 'directory'
folder = 'shots'
window_px = [80, 0, 480]
[camera.intrinsics]
size_px = [640, 480]
focal_px = [600.0, 602.0]
middle_px = [322.0, 238.0]
distortion = [0.0, 0.0, 0.0, 0.0, 0.0]
"
    );
    Settings::parse(&text).unwrap()
}

impl Noise {
    /// A measured point: the tool and the pixel have errors with these standard deviations.
    pub fn measured(&mut self, pair: &Pair, tool_m: f64, pixel_px: f64) -> Pair {
        Pair {
            pixel: pair.pixel.map(|it| it + pixel_px * self.normal()),
            base_m: pair.base_m.map(|it| it + tool_m * self.normal()),
        }
    }
}

//! Cloths of measured materials, against what textile laboratories measure and what mechanics says.
//!
//! The specimens and readings are those of [`fab_sim::measure`], which `fabc sim measure` prints. Elastica are integrated
//! apart from the simulator, in `elastica`. Figures in the docs of tests are readings of the solver; what a test holds are its bounds.

mod bending;
mod declarable;
mod elastica;
mod folding;
mod motion;
mod rest;
mod symmetry;

use crate::shipped;
use fab_sim::{Directions, Grid, Material, Params, Simulator};

const SPACING_M: f32 = 0.00625;

/// Returns the shipped materials, from the softest to the stiffest.
fn materials() -> [(&'static str, Material); 4] {
    ["silk", "cotton", "towel", "denim"].map(|name| (name, shipped::material(name).unwrap()))
}

/// Returns a material with a bending length in all directions, on the bias nearly.
fn of_length(millimetres: f32) -> Material {
    let [_, (_, cotton), ..] = materials();
    let length = 0.001 * millimetres;
    Material {
        bending_length_m: Directions {
            warp: length,
            weft: length,
            bias: 0.95 * length,
        },
        ..cotton
    }
}

fn params(material: &Material) -> Params {
    Params {
        material: Some(material.clone()),
        ..Params::default()
    }
}

fn square(dim: usize, material: &Material) -> Simulator {
    Simulator::flat(Grid::new(dim, dim, SPACING_M).unwrap(), &params(material))
}

fn run(cloth: &mut Simulator, steps: u32) {
    for _ in 0..steps {
        cloth.step().unwrap();
    }
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squares = (0..3).map(|axis| (a[axis] - b[axis]).powi(2));
    squares.sum::<f32>().sqrt()
}

fn farthest(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let apart = a.iter().zip(b).map(|(p, q)| distance(*p, *q));
    apart.fold(0.0, f32::max)
}

/// Returns the greatest stretch of an edge along a side, as a share of its length.
fn stretch(grid: Grid, points: &[[f32; 3]]) -> f32 {
    let mut most = 0.0f32;
    for i in 0..points.len() {
        let right = (i % grid.dimx + 1 < grid.dimx).then_some(i + 1);
        let front = (i + grid.dimx < points.len()).then_some(i + grid.dimx);
        for other in right.into_iter().chain(front) {
            most = most.max(distance(points[i], points[other]) / grid.spacing_m - 1.0);
        }
    }
    most
}

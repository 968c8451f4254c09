//! Cloths of measured materials, against what textile laboratories measure and what mechanics says.
//!
//! The specimens and readings are those of [`fab_sim::measure`], which `fabc sim measure` prints. Elastica are integrated
//! apart from the simulator, in `elastica`. Figures in the docs of tests are what the tests measured when they were written.
#![allow(clippy::unwrap_used)]

mod bending;
mod crossings;
mod elastica;
mod folding;
mod motion;
mod rest;
mod symmetry;

use fab_sim::{Directions, Grid, Material, Params, Simulator};

const SPACING_M: f32 = 0.00625;

/// Returns the materials of `tasks/lib/materials.fab`, which says where each value comes from.
fn materials() -> [(&'static str, Material); 4] {
    let row = |weight, thickness, bending, recovery, stretch, friction: [f32; 2]| {
        let directions = |[warp, weft, bias]: [f32; 3]| Directions { warp, weft, bias };
        Material {
            weight_kg_m2: weight,
            thickness_m: thickness,
            bending_length_m: directions(bending),
            crease_recovery_deg: recovery,
            stretch: directions(stretch),
            table_friction: friction[0],
            self_friction: friction[1],
        }
    };
    #[rustfmt::skip] // a table, one material a line
    let rows = [
        ("silk", row(0.035, 0.0001, [0.013, 0.012, 0.011], 125.0, [0.01, 0.02, 0.08], [0.2, 0.3])),
        ("cotton", row(0.167, 0.00035, [0.018, 0.016, 0.016], 75.0, [0.015, 0.025, 0.06], [0.27, 0.6])),
        ("towel", row(0.42, 0.0021, [0.021, 0.018, 0.019], 110.0, [0.03, 0.04, 0.1], [0.4, 0.9])),
        ("denim", row(0.324, 0.0007, [0.0272, 0.0312, 0.0285], 100.0, [0.01, 0.03, 0.03], [0.35, 0.6])),
    ];
    rows
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

//! Physical laws that the cloth must obey, with stated tolerances.
//!
//! All tests run with the default parameters, changed only where a law needs it, with the reason. The laws of bodies
//! without friction need the sleeping rules off. Those rules stand for static friction, and stop a slow particle
//! wherever it is (`hanging.rs` and `friction.rs` show how strongly).

mod catenary;
mod cloth_friction;
mod falling;
mod folding;
mod friction;
mod hanging;
mod layers;
mod momentum;
mod outlines;
mod parameters;
mod swinging;
mod symmetry;

use fab_sim::{Aim, Grid, Params, Simulator};

const SPACING_M: f32 = 0.00625;
const REST_HEIGHT_M: f32 = 0.005;
const G: f64 = 9.8;

fn grid(dimx: usize, dimy: usize) -> Grid {
    Grid::new(dimx, dimy, SPACING_M).unwrap()
}

fn flat(dimx: usize, dimy: usize) -> Simulator {
    Simulator::flat(grid(dimx, dimy), &Params::default())
}

/// The default parameters without the rules that stand for static friction.
fn sleepless() -> Params {
    Params {
        sleep_speed_m_s: 0.0,
        rest_speed_m_s: 0.0,
        ..Params::default()
    }
}

fn at_height(grid: Grid, z_m: f32) -> Vec<[f32; 3]> {
    let flat = grid.flat_positions(&Params::default());
    flat.iter().map(|p| [p[0], p[1], z_m]).collect()
}

/// A grid that hangs straight down from its back row, at the given height.
fn upright(grid: Grid, top_m: f32) -> Vec<[f32; 3]> {
    let place = |i: usize| {
        let (ix, iy) = (i % grid.dimx, i / grid.dimx);
        [
            ix as f32 * grid.spacing_m,
            0.0,
            top_m - iy as f32 * grid.spacing_m,
        ]
    };
    (0..grid.particle_count()).map(place).collect()
}

fn back_row(grid: Grid) -> Vec<usize> {
    (0..grid.dimx).collect()
}

fn run(cloth: &mut Simulator, steps: u32) {
    for _ in 0..steps {
        cloth.step().unwrap();
    }
}

fn xy(point: [f32; 3]) -> [f32; 2] {
    [point[0], point[1]]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squares = (0..3).map(|axis| (a[axis] - b[axis]).powi(2));
    squares.sum::<f32>().sqrt()
}

fn farthest(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let apart = a.iter().zip(b).map(|(p, q)| distance(*p, *q));
    apart.fold(0.0, f32::max)
}

fn lowest(points: &[[f32; 3]]) -> f32 {
    points.iter().map(|p| p[2]).fold(f32::INFINITY, f32::min)
}

/// Returns the stretch of every edge along a side, ascending: its length divided by its rest length, minus 1.
fn stretches(grid: Grid, points: &[[f32; 3]]) -> Vec<f64> {
    let mut all = Vec::new();
    for i in 0..points.len() {
        let right = (i % grid.dimx + 1 < grid.dimx).then_some(i + 1);
        let front = (i + grid.dimx < points.len()).then_some(i + grid.dimx);
        for other in right.into_iter().chain(front) {
            all.push(f64::from(distance(points[i], points[other]) / grid.spacing_m) - 1.0);
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

fn fold_corner(cloth: &mut Simulator, corner: usize, to: [f32; 2]) -> Option<usize> {
    let from = xy(cloth.positions()[corner]);
    cloth.pick_and_place(from, to, &|| false).unwrap().grasped
}

//! Physical laws that the cloth has to keep, with stated tolerances.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use sim::{Grid, Params, Simulator};

const SPACING_M: f32 = 0.00625;
const REST_HEIGHT_M: f32 = 0.005;

fn grid(dimx: usize, dimy: usize) -> Grid {
    Grid::new(dimx, dimy, SPACING_M).unwrap()
}

fn flat(dimx: usize, dimy: usize) -> Simulator {
    Simulator::flat(grid(dimx, dimy), &Params::default())
}

fn at_height(grid: Grid, z_m: f32) -> Vec<[f32; 3]> {
    let flat = grid.flat_positions(&Params::default());
    flat.iter().map(|p| [p[0], p[1], z_m]).collect()
}

fn xy(point: [f32; 3]) -> [f32; 2] {
    [point[0], point[1]]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).powi(2))
        .sum::<f32>()
        .sqrt()
}

fn farthest(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    a.iter()
        .zip(b)
        .map(|(p, q)| distance(*p, *q))
        .fold(0.0, f32::max)
}

fn fold_corner(cloth: &mut Simulator, corner: usize, to: [f32; 2]) -> Option<usize> {
    let from = xy(cloth.positions()[corner]);
    cloth.pick_and_place(from, to, &|| false).unwrap().grasped
}

#[test]
fn a_falling_cloth_covers_half_g_t_squared() {
    let params = Params {
        damping_per_s: 0.0,
        ..Params::default()
    };
    let grid = grid(10, 8);
    let mut cloth = Simulator::from_positions(grid, &at_height(grid, 1.0), &params).unwrap();
    for _ in 0..30 {
        cloth.step().unwrap();
    }
    // Symplectic Euler falls g t dt / 2 farther than the parabola; dt is a substep of 2.5 ms.
    let (t, dt) = (0.3, 0.0025);
    let expected = 0.5 * 9.8 * t * t + 0.5 * 9.8 * t * dt;
    for point in cloth.positions() {
        let fallen = 1.0 - point[2];
        // Positions round to 6e-8 m, which at 2.5 ms a substep adds up to a few tenths of a millimetre.
        assert!(
            (fallen - expected).abs() < 5e-4,
            "{fallen} instead of {expected}"
        );
    }
    for velocity in cloth.velocities() {
        assert!((velocity[2] + 9.8 * t).abs() < 3e-3, "{velocity:?}");
    }
}

#[test]
fn damping_slows_a_fall_towards_g_over_damping() {
    let grid = grid(4, 4);
    let mut cloth =
        Simulator::from_positions(grid, &at_height(grid, 2.0), &Params::default()).unwrap();
    for _ in 0..50 {
        cloth.step().unwrap();
    }
    let expected = 9.8 * (1.0 - (-0.5f32).exp());
    let speed = -cloth.velocities()[0][2];
    assert!(
        (speed - expected).abs() < 0.01 * expected,
        "{speed} instead of {expected}"
    );
}

#[test]
fn a_crumpled_cloth_in_free_fall_keeps_its_sideways_momentum() {
    let params = Params {
        gravity_m_s2: 0.0,
        damping_per_s: 0.0,
        sleep_speed_m_s: 0.0,
        rest_speed_m_s: 0.0,
        ..Params::default()
    };
    let grid = grid(16, 12);
    let mut points = at_height(grid, 1.0);
    for (i, point) in points.iter_mut().enumerate() {
        point[2] += 0.002 * ((i * 7 % 11) as f32 - 5.0) / 5.0;
        point[0] *= 1.1;
    }
    let mut cloth = Simulator::from_positions(grid, &points, &params).unwrap();
    let energy = |cloth: &Simulator| -> f32 {
        cloth
            .velocities()
            .iter()
            .map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
            .sum()
    };
    let mut highest: f32 = 0.0;
    for _ in 0..40 {
        cloth.step().unwrap();
        highest = highest.max(energy(&cloth));
    }
    assert!(
        highest > 1.0,
        "the cloth was released stretched and has to move"
    );
    let n = points.len() as f32;
    for axis in 0..3 {
        let mean: f32 = cloth.velocities().iter().map(|v| v[axis]).sum::<f32>() / n;
        assert!(
            mean.abs() < 2e-3,
            "mean velocity along axis {axis} is {mean} m/s"
        );
    }
    // Nothing drives the cloth, so its internal motion dies down.
    assert!(
        energy(&cloth) < 0.5 * highest,
        "{} of {highest}",
        energy(&cloth)
    );
}

#[test]
fn no_particle_accelerates_beyond_the_limit() {
    let params = Params {
        gravity_m_s2: 0.0,
        ..Params::default()
    };
    let grid = grid(12, 12);
    let stretched: Vec<[f32; 3]> = at_height(grid, 0.5)
        .iter()
        .map(|p| [1.5 * p[0], 1.5 * p[1], p[2]])
        .collect();
    let mut cloth = Simulator::from_positions(grid, &stretched, &params).unwrap();
    cloth.step().unwrap();
    let speeds = cloth
        .velocities()
        .into_iter()
        .map(|v| distance(v, [0.0; 3]));
    let fastest = speeds.fold(0.0, f32::max);
    // 100 m/s^2 for 10 ms.
    assert!((0.01..1.001).contains(&fastest), "{fastest} m/s");
}

#[test]
fn a_flat_cloth_at_rest_stays_bitwise_at_rest() {
    let mut cloth = flat(55, 44);
    let start = cloth.digest();
    for _ in 0..20 {
        cloth.step().unwrap();
    }
    assert_eq!(cloth.digest(), start);
    assert!(cloth.velocities().iter().flatten().all(|&v| v == 0.0));
    assert_eq!(cloth.steps(), 20);
    assert!((cloth.time_s() - 0.2).abs() < 1e-6);
}

#[test]
fn a_dropped_cloth_comes_to_rest_on_the_table() {
    let grid = grid(12, 12);
    let mut cloth =
        Simulator::from_positions(grid, &at_height(grid, 0.05), &Params::default()).unwrap();
    let steps = cloth.settle(500).unwrap();
    assert!(steps > 5 && steps < 500, "{steps}");
    for point in cloth.positions() {
        assert!((point[2] - REST_HEIGHT_M).abs() < 5e-4, "{point:?}");
    }
}

#[test]
fn no_particle_ends_below_the_table_at_any_step_of_a_fold() {
    let mut cloth = flat(24, 24);
    let from = xy(cloth.positions()[0]);
    let place = [0.03, -0.02];
    let total = cloth
        .clone()
        .pick_and_place(from, place, &|| false)
        .unwrap()
        .steps;
    // Interrupts an action after ever more steps, to look at the cloth in between.
    for stop in (0..total).step_by(7) {
        let asked = std::cell::Cell::new(0);
        let interrupted = || {
            asked.set(asked.get() + 1);
            asked.get() > stop
        };
        let mut partial = cloth.clone();
        partial
            .pick_and_place(from, place, &interrupted)
            .unwrap_err();
        assert_eq!(partial.steps(), u64::from(stop));
        let lowest = partial
            .positions()
            .iter()
            .map(|p| p[2])
            .fold(f32::INFINITY, f32::min);
        assert!(lowest > 0.0, "{lowest} m after {stop} steps");
    }
    cloth.pick_and_place(from, place, &|| false).unwrap();
    let lowest = cloth
        .positions()
        .iter()
        .map(|p| p[2])
        .fold(f32::INFINITY, f32::min);
    assert!(lowest > REST_HEIGHT_M - 5e-4, "{lowest}");
}

#[test]
fn a_fold_stays_folded_with_one_thickness_between_its_layers() {
    let mut cloth = flat(36, 36);
    let opposite = xy(cloth.positions()[36 * 36 - 1]);
    assert_eq!(
        fold_corner(&mut cloth, 0, [0.6 * opposite[0], 0.6 * opposite[1]]),
        Some(0)
    );
    cloth.settle(200).unwrap();
    let settled = cloth.positions();
    for _ in 0..200 {
        cloth.step().unwrap();
    }
    assert!(farthest(&cloth.positions(), &settled) < 1e-3);
    // Well inside the folded triangle, away from the crease.
    let mut upper: Vec<f32> = settled
        .iter()
        .map(|p| p[2])
        .filter(|&z| z > 0.012)
        .collect();
    upper.sort_by(f32::total_cmp);
    assert!(
        upper.len() > 200,
        "{} particles in the upper layer",
        upper.len()
    );
    let gap = upper[upper.len() / 2] - REST_HEIGHT_M;
    assert!((0.0096..0.0118).contains(&gap), "layers are {gap} m apart");
}

#[test]
fn mirrored_folds_from_the_four_corners_agree() {
    let dim = 50;
    let corners = [(0, 0), (dim - 1, 0), (0, dim - 1), (dim - 1, dim - 1)];
    let ends = corners.map(|(ix, iy)| {
        let mut cloth = flat(dim, dim);
        let corner = iy * dim + ix;
        let [x, y, _] = cloth.positions()[corner];
        assert_eq!(
            fold_corner(&mut cloth, corner, [0.1 * x, 0.1 * y]),
            Some(corner)
        );
        // Turns the picture so that the folded corner is particle 0 at the back left.
        let (sign_x, sign_y) = (-x.signum(), y.signum());
        let points = cloth.positions();
        let mirrored = |jx: usize, jy: usize| {
            let sx = if ix == 0 { jx } else { dim - 1 - jx };
            let sy = if iy == 0 { jy } else { dim - 1 - jy };
            let p = points[sy * dim + sx];
            [sign_x * p[0], sign_y * p[1], p[2]]
        };
        (0..dim * dim)
            .map(|i| mirrored(i % dim, i / dim))
            .collect::<Vec<_>>()
    });
    for other in &ends[1..] {
        let mean = ends[0]
            .iter()
            .zip(other)
            .map(|(a, b)| distance(*a, *b))
            .sum::<f32>()
            / ends[0].len() as f32;
        // The sweeps run from one corner to the other, so the folds differ a little, by 0.14 mm here.
        // Cloths whose layers lock into each other differently can be a spacing apart.
        assert!(mean < 3e-4, "mean difference {mean} m");
    }
}

#[test]
fn the_cloth_does_not_stretch_when_folded() {
    let dim = 40;
    let mut cloth = flat(dim, dim);
    fold_corner(&mut cloth, 0, [0.05, -0.05]);
    let points = cloth.positions();
    let mut stretch: Vec<f32> = (0..dim * dim)
        .filter(|i| i % dim + 1 < dim)
        .map(|i| distance(points[i], points[i + 1]) / SPACING_M)
        .collect();
    stretch.sort_by(f32::total_cmp);
    let mean = stretch.iter().sum::<f32>() / stretch.len() as f32;
    assert!((0.99..1.01).contains(&mean), "mean stretch {mean}");
    assert!(stretch[stretch.len() - 1] < 1.25, "{stretch:?}");
}

#[test]
fn a_sphere_that_holds_nothing_drags_the_cloth_that_it_slides_over() {
    let params = Params {
        picker_capture_m: 0.0,
        picker_lift_height_m: 0.05,
        ..Params::default()
    };
    let mut cloth = Simulator::flat(grid(30, 30), &params);
    let before = cloth.positions();
    // From 0.1 m in front of the cloth to its middle, so low that it rubs on the cloth.
    let done = cloth
        .pick_and_place([0.0, -0.19], [0.0, 0.0], &|| false)
        .unwrap();
    assert_eq!(done.grasped, None);
    let middle = 15 * 30 + 15;
    let moved = cloth.positions()[middle][1] - before[middle][1];
    assert!(
        moved > 5e-3,
        "the middle moved {moved} m along the sphere's way"
    );
}

#[test]
fn more_friction_drags_less_cloth() {
    let slide = |table_friction: f32| {
        let params = Params {
            table_friction,
            ..Params::default()
        };
        let grid = grid(20, 20);
        let points = at_height(grid, REST_HEIGHT_M);
        let mut cloth = Simulator::from_positions(grid, &points, &params).unwrap();
        // Pulls the corner away from the cloth, which can only follow.
        let corner = points[0];
        let to = [corner[0] - 0.06, corner[1] + 0.06];
        cloth.pick_and_place(xy(corner), to, &|| false).unwrap();
        let last = cloth.positions()[399];
        distance(last, points[399])
    };
    let (slippery, rough) = (slide(0.1), slide(0.75));
    assert!(slippery > rough + 1e-3, "{slippery} m and {rough} m");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn any_fold_leaves_a_finite_cloth_above_the_table(
        dimx in 2usize..16, dimy in 2usize..16,
        pick in prop::array::uniform2(-0.06f32..0.06), place in prop::array::uniform2(-0.1f32..0.1),
    ) {
        let mut cloth = flat(dimx, dimy);
        cloth.pick_and_place(pick, place, &|| false).unwrap();
        for point in cloth.positions() {
            prop_assert!(point.iter().all(|v| v.is_finite() && v.abs() < 0.5), "{:?}", point);
            prop_assert!(point[2] > 0.0, "{:?}", point);
        }
    }
}

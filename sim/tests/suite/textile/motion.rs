//! The laws of moving bodies, for every material.

use super::*;
use fab_sim::{Mask, RestShortcut, measure};

const G: f64 = 9.8;

fn undamped(material: &Material) -> Params {
    Params {
        damping_per_s: 0.0,
        ..params(material)
    }
}

fn at_height(grid: Grid, z_m: f32) -> Vec<[f32; 3]> {
    let flat = grid.flat_positions(&Params::default());
    flat.iter().map(|p| [p[0], p[1], z_m]).collect()
}

/// `z = g t^2 / 2`, with a relative error of one substep.
#[test]
fn every_material_falls_freely() {
    let grid = Grid::new(10, 10, SPACING_M).unwrap();
    for (name, material) in materials() {
        let mut cloth =
            Simulator::from_positions(grid, &at_height(grid, 0.5), &undamped(&material)).unwrap();
        run(&mut cloth, 25);
        let fallen = 0.5 - f64::from(cloth.positions()[37][2]);
        let expected = 0.5 * G * 0.25f64.powi(2);
        assert!(
            (fallen / expected - 1.0).abs() < 0.005,
            "{name}: {fallen} m of {expected} m"
        );
    }
}

/// Without gravity and contact, momentum stays, to the rounding of positions half a metre above the table: 6e-8 m in each
/// of 800 substeps of each of 144 particles add up to 0.02 m/s, and to the error of crease directions that are kept for
/// some substeps.
#[test]
fn a_tumbling_cloth_keeps_its_momentum() {
    let grid = Grid::new(12, 12, SPACING_M).unwrap();
    for (name, material) in materials() {
        let weightless = Params {
            gravity_m_s2: [0.0; 3],
            ..undamped(&material)
        };
        let start = at_height(grid, 0.5);
        let mut cloth = Simulator::from_positions(grid, &start, &weightless).unwrap();
        // It turns about X and is bent meanwhile.
        let spin: Vec<[f32; 3]> = start
            .iter()
            .map(|p| [0.1, 0.0, 4.0 * p[1] + 60.0 * p[0] * p[0]])
            .collect();
        cloth.set_velocities(&spin).unwrap();
        let momenta = |cloth: &Simulator| {
            let (points, velocities) = (cloth.positions(), cloth.velocities());
            let mut sums = [0.0f64; 6];
            for (p, v) in points.iter().zip(&velocities) {
                let (p, v) = (p.map(f64::from), v.map(f64::from));
                let spin = [
                    p[1] * v[2] - p[2] * v[1],
                    p[2] * v[0] - p[0] * v[2],
                    p[0] * v[1] - p[1] * v[0],
                ];
                for axis in 0..3 {
                    sums[axis] += v[axis];
                    sums[3 + axis] += spin[axis];
                }
            }
            sums
        };
        let before = momenta(&cloth);
        run(&mut cloth, 40);
        let after = momenta(&cloth);
        for (k, (before, after)) in before.into_iter().zip(after).enumerate() {
            let within = if k < 3 { 0.05 } else { 0.1 };
            assert!(
                (before - after).abs() < within,
                "{name}, part {k}: {before} and {after}"
            );
        }
    }
}

/// A patch on a slope accelerates with `g (sin - friction cos)`, and stays where friction is above the slope.
#[test]
fn every_material_slides_and_sticks_by_its_friction() {
    for (name, material) in materials() {
        let friction = measure::table_friction(&material, SPACING_M).unwrap();
        assert!(
            (friction - f64::from(material.table_friction)).abs() < 0.01,
            "{name}: {friction}"
        );
        let slope = 0.9 * material.table_friction;
        let gentle = Params {
            gravity_m_s2: [9.8 * slope, 0.0, -9.8],
            ..undamped(&material)
        };
        let mut cloth = Simulator::flat(Grid::new(6, 6, SPACING_M).unwrap(), &gentle);
        let start = cloth.positions();
        run(&mut cloth, 15);
        let moved = farthest(&cloth.positions(), &start);
        assert!(moved < 1e-4, "{name}: {moved} m");
    }
}

/// A cloth held by its back row hangs as long as it is: the threads' lines are solved as a whole.
#[test]
fn a_hanging_cloth_hardly_stretches() {
    let grid = Grid::new(8, 40, SPACING_M).unwrap();
    for (name, material) in materials() {
        let upright: Vec<[f32; 3]> = (0..grid.particle_count())
            .map(|i| {
                [
                    (i % 8) as f32 * SPACING_M,
                    0.0,
                    0.5 - (i / 8) as f32 * SPACING_M,
                ]
            })
            .collect();
        let mut cloth = Simulator::from_positions(grid, &upright, &params(&material)).unwrap();
        cloth.hold(&[0, 1, 2, 3, 4, 5, 6, 7]).unwrap();
        run(&mut cloth, 100);
        let most = stretch(grid, &cloth.positions());
        assert!(most < 0.002, "{name}: {most}");
    }
}

/// A strip without bending stiffness to speak of, held at both ends, hangs in a catenary `z = a cosh(x / a)`.
///
/// Measured: the farthest particle 0.5 mm away, of a strip of 0.3 m.
#[test]
fn a_soft_strip_hangs_in_a_catenary() {
    const LENGTH_M: f64 = 0.3;
    const SPAN_M: f64 = 0.2;
    const PARTICLES: usize = 49;
    let (mut low, mut high) = (0.01, 10.0);
    for _ in 0..100 {
        let a: f64 = 0.5 * (low + high);
        if 2.0 * a * (SPAN_M / (2.0 * a)).sinh() > LENGTH_M {
            low = a
        } else {
            high = a
        }
    }
    let a = low;
    let grid = Grid::new(PARTICLES, 2, (LENGTH_M / 48.0) as f32).unwrap();
    let drop = (LENGTH_M.powi(2) - SPAN_M.powi(2)).sqrt() / 2.0;
    let along = |i: usize| (i % PARTICLES) as f64 / 48.0 * 2.0 - 1.0;
    let start: Vec<[f32; 3]> = (0..2 * PARTICLES)
        .map(|i| {
            let share = along(i);
            let y = (i / PARTICLES) as f64 * -LENGTH_M / 48.0;
            [
                (share * SPAN_M / 2.0) as f32,
                y as f32,
                (0.5 - drop * (1.0 - share.abs())) as f32,
            ]
        })
        .collect();
    let soft = Params {
        damping_per_s: 5.0,
        ..params(&Material {
            crease_recovery_deg: 180.0,
            ..of_length(3.0)
        })
    };
    let mut cloth = Simulator::from_positions(grid, &start, &soft).unwrap();
    cloth
        .hold(&[0, PARTICLES - 1, PARTICLES, 2 * PARTICLES - 1])
        .unwrap();
    run(&mut cloth, 200);
    let most = cloth
        .positions()
        .iter()
        .enumerate()
        .map(|(i, point)| {
            let x = a * (along(i) * LENGTH_M / 2.0 / a).asinh();
            let z = 0.5 + a * (x / a).cosh() - a * (SPAN_M / (2.0 * a)).cosh();
            (f64::from(point[0]) - x).hypot(f64::from(point[2]) - z)
        })
        .fold(0.0, f64::max);
    assert!(most < 2e-3, "{most} m");
}

/// Columns and rows of a sheet, the rows of a slack band at its front edge, and the sides of a patch at the band's end.
const SHEET: usize = 24;
const BAND: usize = 12;
const PATCH: usize = 12;

/// Lays a patch on a sheet that is held, both parts of one cloth, under gravity that is tilted by `slope` towards
/// `way`; returns how far the patch has moved after 0.5 s and after 2 s, metres.
fn slid(material: &Material, slope: f32, way: [f32; 2]) -> [f32; 2] {
    let soft = Material {
        crease_recovery_deg: 180.0,
        bending_length_m: of_length(3.0).bending_length_m,
        ..material.clone()
    };
    let per = 1.0 / (1.0 + slope * slope).sqrt();
    let params = Params {
        gravity_m_s2: [
            9.8 * slope * per * way[0],
            9.8 * slope * per * way[1],
            -9.8 * per,
        ],
        ..params(&soft)
    };
    let grid = Grid::new(SHEET, SHEET + BAND + PATCH, SPACING_M).unwrap();
    let is_patch = |ix: usize, iy: usize| iy >= SHEET + BAND && (6..18).contains(&ix);
    let mask = Mask::from_fn(grid, |ix, iy| {
        iy < SHEET || (iy < SHEET + BAND && (11..13).contains(&ix)) || is_patch(ix, iy)
    })
    .unwrap();
    let gap = soft.gap_m() / SPACING_M;
    let place = |i: usize| {
        let (ix, iy) = ((i % SHEET) as f32, i / SHEET);
        let [x, y, z] = if iy < SHEET {
            [ix, -(iy as f32), 0.5 * gap]
        } else if iy < SHEET + BAND {
            // An arc from the sheet's edge to the patch, 13 spacings long over 6 of table.
            let share = (iy - SHEET + 1) as f32 / (BAND + 1) as f32;
            let turn = 2.02 * (2.0 * share - 1.0);
            let radius = 13.0 / 4.04;
            let rise = radius * (turn.cos() - 2.02f32.cos());
            [
                ix + 0.3 * share,
                -20.0 + radius * turn.sin(),
                rise + gap * (0.5 + share),
            ]
        } else {
            // Aside of the sheet's particles, so that they do not lie in rows.
            [ix + 0.3, (iy - SHEET - BAND) as f32 - 16.8, 1.5 * gap]
        };
        [x, y, z].map(|value| value * SPACING_M)
    };
    let start: Vec<[f32; 3]> = (0..grid.particle_count()).map(place).collect();
    let mut cloth = Simulator::from_positions(&mask, &start, &params).unwrap();
    cloth.set_rest_shortcut(RestShortcut::Compute);
    let held = (0..grid.particle_count()).filter(|&i| mask.has(i) && i / SHEET < SHEET + BAND - 4);
    cloth.hold(&held.collect::<Vec<_>>()).unwrap();
    let patch: Vec<usize> = (0..grid.particle_count())
        .filter(|&i| is_patch(i % SHEET, i / SHEET))
        .collect();
    [50, 150].map(|steps| {
        run(&mut cloth, steps);
        let points = cloth.positions();
        let moved = patch.iter().map(|&i| {
            way[0] * (points[i][0] - start[i][0]) + way[1] * (points[i][1] - start[i][1])
        });
        moved.sum::<f32>() / patch.len() as f32
    })
}

/// Cloth on cloth that friction holds does not creep: by at most 0.05 mm in a second at nine tenths of the friction, and
/// it slides above.
///
/// Measured: 0.03 mm/s at most, from the front to the back; it was 0.4 mm/s when slip counted from each substep on.
#[test]
fn layers_do_not_creep_below_the_angle_of_friction() {
    let [(_, silk), (_, cotton), ..] = materials();
    for (material, way) in [(&cotton, [0.0, -1.0]), (&silk, [1.0, 0.0])] {
        let [soon, late] = slid(material, 0.9 * material.self_friction, way);
        assert!(
            (late - soon).abs() < 7.5e-5,
            "{way:?}: {soon} m, then {late} m"
        );
    }
    let [soon, _] = slid(&cotton, 1.2 * cotton.self_friction, [0.0, -1.0]);
    assert!(soon > 0.02, "{soon} m");
}

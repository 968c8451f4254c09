//! Swinging: energy never grows, and only long substeps lose it.

use super::*;

const ROWS: usize = 16;

/// Energy per particle above that of hanging straight down, J/kg.
fn energy(cloth: &Simulator) -> f64 {
    let square = |v: &[f32; 3]| v.iter().map(|&v| f64::from(v).powi(2)).sum::<f64>();
    let points = cloth.positions();
    let both = points.iter().zip(cloth.velocities());
    let sum: f64 = both
        .map(|(point, v)| G * f64::from(point[2] - 0.5) + 0.5 * square(&v))
        .sum();
    let depth = G * f64::from((ROWS - 1) as f32 * SPACING_M) / 2.0;
    sum / points.len() as f64 + depth
}

/// A strip held by its back row, straight, at an angle to the vertical.
fn raised(degrees: f32, params: &Params) -> Simulator {
    let grid = grid(4, ROWS);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let tilt = |p: [f32; 3]| [p[0], -sin * (0.5 - p[2]), 0.5 - cos * (0.5 - p[2])];
    let start: Vec<[f32; 3]> = upright(grid, 0.5).into_iter().map(tilt).collect();
    let mut cloth = Simulator::from_positions(grid, &start, params).unwrap();
    cloth.hold(&back_row(grid)).unwrap();
    cloth
}

#[test]
fn an_undamped_swing_gains_no_energy_and_loses_less_with_more_substeps() {
    let lost = [4, 8, 16, 32].map(|substeps| {
        // Only the springs may reduce the energy.
        let params = Params {
            substeps,
            damping_per_s: 0.0,
            max_acceleration_m_s2: 1e6,
            ..sleepless()
        };
        let mut cloth = raised(60.0, &params);
        let start = energy(&cloth);
        for step in 0..160 {
            cloth.step().unwrap();
            let now = energy(&cloth);
            assert!(now < 1.0005 * start, "step {step}: {now} of {start}");
        }
        1.0 - energy(&cloth) / start
    });
    // Measured: 0.61, 0.41, 0.25 and 0.17 in 1.6 s, about two swings.
    for pair in lost.windows(2) {
        assert!(pair[1] < 0.8 * pair[0], "{lost:?}");
    }
    assert!(lost[3] < 0.2, "{lost:?}");
}

/// The rules that stand for static friction on the table must not stop a hanging cloth, however slowly it swings.
#[test]
fn a_gentle_swing_in_the_air_comes_to_hang_straight_down() {
    for degrees in [20.0, 2.0] {
        let mut cloth = raised(degrees, &Params::default());
        run(&mut cloth, 400);
        let (first, last) = (cloth.positions()[0], cloth.positions()[4 * (ROWS - 1)]);
        let angle = (last[1] / (first[2] - last[2])).atan().to_degrees();
        assert!(angle.abs() < 0.15 * degrees, "{degrees}: {angle}");
    }
}

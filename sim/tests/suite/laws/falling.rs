//! Falling: free, damped, onto the table; and things that must not fall at all.

use super::*;

#[test]
fn a_falling_cloth_covers_half_g_t_squared() {
    // Damping would slow the fall.
    let params = Params {
        damping_per_s: 0.0,
        ..Params::default()
    };
    let grid = grid(10, 8);
    let mut cloth = Simulator::from_positions(grid, &at_height(grid, 1.0), &params).unwrap();
    run(&mut cloth, 30);
    // Symplectic Euler falls g t dt / 2 farther than the parabola; dt is a substep of 2.5 ms.
    let (t, dt) = (0.3, 0.0025);
    let expected = 0.5 * 9.8 * t * t + 0.5 * 9.8 * t * dt;
    for point in cloth.positions() {
        let fallen = 1.0 - point[2];
        // Positions round to 6e-8 m. At 2.5 ms per substep this adds up to a few tenths of a millimetre.
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
    run(&mut cloth, 50);
    // v(t) = g / c (1 - exp(-c t)) after half a second.
    let c = Params::default().damping_per_s;
    let expected = 9.8 / c * (1.0 - (-0.5 * c).exp());
    let speed = -cloth.velocities()[0][2];
    assert!(
        (speed - expected).abs() < 0.01 * expected,
        "{speed} instead of {expected}"
    );
}

/// A particle in the air does not sleep, however little speed gravity gives it in one substep.
#[test]
fn a_cloth_begins_to_fall_however_short_the_substep() {
    for substeps in [1, 4, 8, 32] {
        let params = Params {
            substeps,
            ..Params::default()
        };
        let grid = grid(4, 4);
        let mut cloth = Simulator::from_positions(grid, &at_height(grid, 0.5), &params).unwrap();
        run(&mut cloth, 10);
        let fallen_m = 0.5 - cloth.positions()[5][2];
        assert!(fallen_m > 0.04, "{substeps} substeps: {fallen_m} m");
    }
}

#[test]
fn no_particle_accelerates_beyond_the_limit() {
    // Nothing else may accelerate the cloth.
    let params = Params {
        gravity_m_s2: [0.0; 3],
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
    run(&mut cloth, 20);
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

/// A cloth falls as one body and lands flat, from the smallest to the largest grid.
#[test]
fn rectangles_of_every_size_fall_alike_and_land_flat() {
    for [dimx, dimy] in [
        [2, 2],
        [2, 3],
        [3, 2],
        [7, 8],
        [8, 7],
        [9, 17],
        [2, 200],
        [200, 2],
        [200, 200],
    ] {
        let grid = grid(dimx, dimy);
        let mut cloth =
            Simulator::from_positions(grid, &at_height(grid, 0.02), &Params::default()).unwrap();
        run(&mut cloth, 3);
        let points = cloth.positions();
        // A single body: 12 substeps of 2.5 ms with damping.
        let keep = 1.0 - 0.0025 * Params::default().damping_per_s;
        let (expected, _) = (0..12).fold((0.0, 0.0), |(way, speed), _| {
            let speed = keep * speed + 9.8 * 0.0025;
            (way + 0.0025 * speed, speed)
        });
        let fallen = 0.02 - lowest(&points);
        assert!(
            (fallen - expected).abs() < 1e-5,
            "{dimx} x {dimy}: {fallen} m instead of {expected} m"
        );
        run(&mut cloth, 12);
        for (point, start) in cloth.positions().iter().zip(at_height(grid, REST_HEIGHT_M)) {
            assert!(distance(*point, start) < 5e-4, "{dimx} x {dimy}: {point:?}");
        }
    }
}

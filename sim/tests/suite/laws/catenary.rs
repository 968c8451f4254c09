//! A strip held at both ends hangs in a catenary.

use super::*;

/// Length of the strip and distance between its ends, metres.
const LENGTH_M: f64 = 0.3;
const SPAN_M: f64 = 0.2;
const TOP_M: f64 = 0.5;

/// Returns the parameter of the catenary `z = a cosh(x / a)` of this length and span, by bisection.
fn parameter() -> f64 {
    let (mut low, mut high) = (0.01, 10.0);
    for _ in 0..100 {
        let a: f64 = 0.5 * (low + high);
        if 2.0 * a * (SPAN_M / (2.0 * a)).sinh() > LENGTH_M {
            low = a;
        } else {
            high = a;
        }
    }
    low
}

/// Hangs a strip two particles wide; returns the largest distance of a particle from the catenary, metres.
fn error_m(particles: usize, substeps: u32) -> f64 {
    let spacing = LENGTH_M / (particles - 1) as f64;
    let grid = Grid::new(particles, 2, spacing as f32).unwrap();
    // A chain has no bending stiffness and hangs in the air, where the sleeping rule would stop it. Damping stops it
    // soon.
    let params = Params {
        bend: 0.0,
        damping_per_s: 5.0,
        substeps,
        ..sleepless()
    };
    // It starts as two straight lines.
    let half = LENGTH_M / 2.0;
    let drop = (half * half - SPAN_M * SPAN_M / 4.0).sqrt();
    let along = |i: usize| (i % particles) as f64 * spacing - half;
    let place = |i: usize| {
        let share = along(i) / half;
        let y = (i / particles) as f64 * spacing;
        let z = TOP_M - drop * (1.0 - share.abs());
        [(share * SPAN_M / 2.0) as f32, -y as f32, z as f32]
    };
    let start: Vec<[f32; 3]> = (0..2 * particles).map(place).collect();
    let mut cloth = Simulator::from_positions(grid, &start, &params).unwrap();
    cloth
        .hold(&[0, particles - 1, particles, 2 * particles - 1])
        .unwrap();
    run(&mut cloth, 200);
    let a = parameter();
    let apart = |(i, point): (usize, &[f32; 3])| {
        let x = a * (along(i) / a).asinh();
        let z = TOP_M + a * (x / a).cosh() - a * (SPAN_M / (2.0 * a)).cosh();
        (f64::from(point[0]) - x).hypot(f64::from(point[2]) - z)
    };
    let points = cloth.positions();
    points.iter().enumerate().map(apart).fold(0.0, f64::max)
}

#[test]
fn refining_particles_and_substeps_brings_a_strip_to_the_catenary() {
    // Measured: 2.0, 0.54 and 0.19 mm; then 1.1, 0.27 and 0.19 mm.
    let substeps = [4, 8, 16].map(|substeps| error_m(33, substeps));
    let particles = [9, 17, 33].map(|particles| error_m(particles, 16));
    for errors in [substeps, particles] {
        assert!(errors[0] > 1.3 * errors[1], "{errors:?}");
        assert!(errors[1] > 1.3 * errors[2], "{errors:?}");
        assert!(errors[2] < 3e-4, "{errors:?}");
    }
}

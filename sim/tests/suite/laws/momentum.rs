//! Momentum without gravity and contact: which passes conserve it, and which do not.
//!
//! Springs conserve linear momentum up to rounding, and angular momentum to first order in the substep. Self-contacts
//! do not: a particle moves by the mean of its contacts' corrections, and its partners by other means. Damping, the
//! limit of acceleration, the sleeping rules, table and picker reduce it by design.

use super::*;

/// Only springs act: no gravity, no damping, no limit; the contact distance is shorter than any distance here.
fn springs_alone(substeps: u32) -> Params {
    Params {
        gravity_m_s2: [0.0; 3],
        damping_per_s: 0.0,
        max_acceleration_m_s2: 1e9,
        self_contact_m: 1e-3,
        substeps,
        ..sleepless()
    }
}

/// Returns the sums of velocities, and of position x velocity around the vertical through the origin; all masses are
/// 1.
fn momenta(cloth: &Simulator) -> ([f64; 3], f64) {
    let mut linear = [0.0; 3];
    let mut angular = 0.0;
    for (point, velocity) in cloth.positions().iter().zip(cloth.velocities()) {
        let [x, y, _] = point.map(f64::from);
        let [u, v, w] = velocity.map(f64::from);
        for (sum, part) in linear.iter_mut().zip([u, v, w]) {
            *sum += part;
        }
        angular += x * v - y * u;
    }
    (linear, angular)
}

#[test]
fn springs_keep_the_linear_momentum_of_a_crumpled_cloth() {
    let grid = grid(16, 12);
    let mut points = at_height(grid, 0.1);
    for (i, point) in points.iter_mut().enumerate() {
        point[2] += 0.0005 * ((i * 7 % 11) as f32 - 5.0) / 5.0;
        point[0] *= 1.1;
    }
    let mut cloth = Simulator::from_positions(grid, &points, &springs_alone(4)).unwrap();
    let start: Vec<[f32; 3]> = (0..points.len())
        .map(|i| [0.05 * (i % 5) as f32, 0.0, 0.02 * (i % 3) as f32])
        .collect();
    cloth.set_velocities(&start).unwrap();
    let (before, _) = momenta(&cloth);
    let mut fastest = 0.0f32;
    for _ in 0..50 {
        cloth.step().unwrap();
        let speeds = cloth
            .velocities()
            .into_iter()
            .map(|v| distance(v, [0.0; 3]));
        fastest = speeds.fold(fastest, f32::max);
        let (now, _) = momenta(&cloth);
        for axis in 0..3 {
            // At 0.1 m positions round to 4e-9 m, or 1.5e-6 m/s per substep. With 192 particles and 200 substeps of
            // 84 corrections each, random errors add up to about 3e-3 m/s.
            let gained = now[axis] - before[axis];
            assert!(gained.abs() < 6e-3, "axis {axis} gained {gained} m/s");
        }
    }
    assert!(fastest > 0.3, "{fastest} m/s: the springs have to work");
}

#[test]
fn springs_lose_angular_momentum_in_proportion_to_the_substep() {
    let lost = [2, 4, 8].map(|substeps| {
        let grid = grid(13, 13);
        let points = at_height(grid, 0.1);
        let mut cloth = Simulator::from_positions(grid, &points, &springs_alone(substeps)).unwrap();
        let spin: Vec<[f32; 3]> = points
            .iter()
            .map(|p| [-10.0 * p[1], 10.0 * p[0], 0.0])
            .collect();
        cloth.set_velocities(&spin).unwrap();
        let (_, before) = momenta(&cloth);
        run(&mut cloth, 25);
        1.0 - momenta(&cloth).1 / before
    });
    for pair in lost.windows(2) {
        assert!((0.3..0.7).contains(&(pair[1] / pair[0])), "{lost:?}");
    }
}

/// A pair that touches nothing else separates evenly. A stack does not, but the error is bounded.
#[test]
fn self_contacts_keep_momentum_pair_by_pair_but_not_in_stacks() {
    // Two rows of particles touch. Other rows that no spring joins are between them: springs would carry momentum
    // too.
    let parted = |gap_m: f32, shift_m: f32| {
        let grid = grid(6, 12);
        let params = Params {
            stretch: 0.0,
            shear: 0.0,
            bend: 0.0,
            self_contact_m: Params::default().self_contact_m,
            ..springs_alone(4)
        };
        let half = |i: usize| i / grid.dimx < 6;
        let mut points = at_height(grid, 0.1);
        for (i, point) in points.iter_mut().enumerate() {
            if !half(i) {
                let over = (2 * 6 - 1 - i / 6) * 6 + i % 6;
                let below = grid.flat_positions(&params)[over];
                *point = [below[0] + shift_m, below[1] + 0.3 * shift_m, 0.1 + gap_m];
            }
        }
        let mut cloth = Simulator::from_positions(grid, &points, &params).unwrap();
        run(&mut cloth, 5);
        let (linear, _) = momenta(&cloth);
        let moved: f64 = cloth
            .velocities()
            .iter()
            .map(|v| f64::from(distance(*v, [0.0; 3])))
            .sum();
        let kept = linear.iter().map(|p| p * p).sum::<f64>().sqrt();
        (kept / moved, moved)
    };
    // Directly above each other at 11 mm, every particle has one contact; when shifted, up to four.
    let (pairs, moved) = parted(0.011, 0.0);
    assert!(moved > 0.1 && pairs < 1e-4, "{pairs} of {moved} m/s");
    let (stacks, moved) = parted(0.008, 0.0023);
    assert!(
        moved > 0.1 && (1e-3..0.2).contains(&stacks),
        "{stacks} of {moved} m/s"
    );
}

//! Friction on the table: Coulomb's cone, measured on a slope made by tilting gravity.

use super::*;

/// A patch that slides down a slope made by tilted gravity; positions are in the slope's frame.
struct Slide {
    /// Mean distance slid, metres.
    way_m: f64,
    /// Mean speed at the end, metres per second.
    speed: f64,
}

fn slide(degrees: f64, speed: f32, steps: u32, params: Params) -> Slide {
    let (sin, cos) = degrees.to_radians().sin_cos();
    // Damping would slow the slide.
    let params = Params {
        gravity_m_s2: [(G * sin) as f32, 0.0, (-G * cos) as f32],
        damping_per_s: 0.0,
        ..params
    };
    let mut cloth = Simulator::flat(grid(10, 10), &params);
    cloth.set_velocities(&[[speed, 0.0, 0.0]; 100]).unwrap();
    let mean =
        |vectors: Vec<[f32; 3]>| vectors.iter().map(|v| f64::from(v[0])).sum::<f64>() / 100.0;
    let start = mean(cloth.positions());
    run(&mut cloth, steps);
    Slide {
        way_m: mean(cloth.positions()) - start,
        speed: mean(cloth.velocities()),
    }
}

/// Angle of friction, degrees.
fn cone() -> f64 {
    f64::from(Params::default().table_friction)
        .atan()
        .to_degrees()
}

fn expected_acceleration(degrees: f64) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    G * (sin - f64::from(Params::default().table_friction) * cos)
}

#[test]
fn a_sliding_patch_stops_below_the_angle_of_friction_and_speeds_up_above() {
    // It starts faster than the sleep speed. Two degrees below the cone, 0.1 m/s last 0.23 s.
    let below = slide(cone() - 2.0, 0.1, 40, Params::default());
    assert_eq!(below.speed, 0.0);
    let braking = 0.01 / (2.0 * -expected_acceleration(cone() - 2.0));
    assert!(
        (below.way_m / braking - 1.0).abs() < 0.1,
        "{} m, {braking} m",
        below.way_m
    );
    for beyond in [-1.0, -0.5, 0.5, 2.0, 10.0] {
        let degrees = cone() + beyond;
        let end = slide(degrees, 0.2, 30, Params::default());
        let expected = 0.2 + 0.3 * expected_acceleration(degrees);
        assert!(
            (end.speed - expected).abs() < 2e-3,
            "{beyond}: {} m/s, {expected} m/s",
            end.speed
        );
    }
}

#[test]
fn without_sleep_a_resting_patch_stays_below_the_angle_of_friction_and_slides_above() {
    for below in [-2.0, -0.5] {
        let end = slide(cone() + below, 0.0, 40, sleepless());
        assert!(end.way_m.abs() < 1e-7, "{} m", end.way_m);
    }
    for above in [0.5, 2.0] {
        let end = slide(cone() + above, 0.0, 40, sleepless());
        let expected = 0.4 * expected_acceleration(cone() + above);
        assert!(
            (end.speed / expected - 1.0).abs() < 0.02,
            "{} m/s, {expected} m/s",
            end.speed
        );
    }
}

/// Known limit: a resting particle starts only if one substep gives it the sleep speed of 0.02 m/s.
///
/// That takes 8 m/s^2 along the slope beyond friction, so a resting patch stays on slopes of up to 77 degrees.
#[test]
fn the_sleeping_rule_holds_a_resting_patch_on_much_steeper_slopes() {
    assert_eq!(slide(77.0, 0.0, 40, Params::default()).way_m, 0.0);
    assert!(slide(78.0, 0.0, 40, Params::default()).way_m > 0.1);
}

#[test]
fn more_friction_drags_less_cloth() {
    let pull = |table_friction: f32| {
        let params = Params {
            table_friction,
            ..Params::default()
        };
        let mut cloth = Simulator::flat(grid(20, 20), &params);
        let points = cloth.positions();
        // Pulls the corner away from the cloth by hand, because the picker's sphere would rub on it too.
        cloth.hold(&[0]).unwrap();
        for _ in 0..30 {
            cloth.step_held([-0.002, 0.002, 0.0]).unwrap();
        }
        distance(cloth.positions()[399], points[399])
    };
    let (slippery, rough) = (pull(0.1), pull(0.75));
    assert!(slippery > rough + 1e-3, "{slippery} m and {rough} m");
}

/// The sphere is pressed 5 mm into the cloth that it slides over; without friction it would slip (0.05 mm).
#[test]
fn a_sphere_that_holds_nothing_drags_the_cloth_that_it_slides_over() {
    // It must not grasp, and must stay low on its way.
    let params = Params {
        picker_capture_m: 0.0,
        picker_grasp_height_m: 0.055,
        picker_lift_height_m: 0.055,
        ..Params::default()
    };
    let mut cloth = Simulator::flat(grid(30, 30), &params);
    let middle = 15 * 30 + 15;
    let before = cloth.positions()[middle];
    let done = cloth
        .pick_and_place([0.0, -0.06], [0.0, 0.06], &|| false)
        .unwrap();
    assert_eq!(done.grasped, None);
    let moved = cloth.positions()[middle][1] - before[1];
    assert!(
        moved > 0.02,
        "the middle moved {moved} m along the sphere's way of 0.12 m"
    );
}

//! Friction of cloth on cloth: a patch that slides on a sheet.
//!
//! Both are parts of one cloth, joined by a slack band two particles wide, and the sheet is held. Layers of particles
//! are bumpy: a patch that slides over them loses speed even without friction, so the tests compare differences.

use super::*;
use fab_sim::Mask;

const COLUMNS: usize = 30;
const SHEET_ROWS: usize = 24;
const BAND_ROWS: usize = 12;
const PATCH: usize = 14;
/// First column of the patch.
const LEFT: usize = 3;

fn mask() -> Mask {
    let band = [LEFT + PATCH / 2 - 1, LEFT + PATCH / 2];
    let there = |ix: usize, iy: usize| {
        iy < SHEET_ROWS
            || (iy < SHEET_ROWS + BAND_ROWS && band.contains(&ix))
            || (iy >= SHEET_ROWS + BAND_ROWS && (LEFT..LEFT + PATCH).contains(&ix))
    };
    Mask::from_fn(grid(COLUMNS, SHEET_ROWS + BAND_ROWS + PATCH), there).unwrap()
}

/// Lays the sheet flat and the patch on it, turned by 30 degrees so that particles do not lie in rows of hollows.
fn start() -> Vec<[f32; 3]> {
    let turn = 30f32.to_radians();
    let middle = LEFT as f32 + (PATCH as f32 - 1.0) / 2.0;
    let patch = |across: f32, row: f32| {
        let along = row - (PATCH as f32 - 1.0) / 2.0;
        let x = middle + across * turn.cos() - along * turn.sin();
        let y = SHEET_ROWS as f32 - 11.5 - across * turn.sin() - along * turn.cos();
        [x, y]
    };
    let place = |i: usize| {
        let (ix, iy) = (i % COLUMNS, i / COLUMNS);
        let across = ix as f32 - middle;
        let ([x, y], z) = if iy < SHEET_ROWS {
            ([ix as f32, iy as f32], REST_HEIGHT_M)
        } else if iy >= SHEET_ROWS + BAND_ROWS {
            let row = (iy - SHEET_ROWS - BAND_ROWS) as f32;
            (patch(across, row), REST_HEIGHT_M + 0.0105)
        } else {
            // An arch from the sheet's front edge to the patch's first row.
            let share = (iy - SHEET_ROWS + 1) as f32 / (BAND_ROWS + 1) as f32;
            let rise = (std::f32::consts::PI * share).sin();
            let (from, to) = ([ix as f32, SHEET_ROWS as f32 - 1.0], patch(across, 0.0));
            let [x, y] = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            let z = REST_HEIGHT_M + 0.0105 * share + 0.03 * rise;
            ([x, y + 3.2 * rise], z)
        };
        [x * SPACING_M - 0.09, 0.07 - y * SPACING_M, z]
    };
    (0..COLUMNS * (SHEET_ROWS + BAND_ROWS + PATCH))
        .map(place)
        .collect()
}

/// Returns the patch's mean speed after each step on a slope, starting at 0.2 m/s.
fn speeds(degrees: f32, self_friction: f32, steps: u32) -> Vec<f64> {
    let mask = mask();
    let sheet: Vec<usize> = (0..COLUMNS * SHEET_ROWS).collect();
    let count = mask.grid().particle_count();
    let patch: Vec<usize> = (COLUMNS * (SHEET_ROWS + BAND_ROWS)..count)
        .filter(|&i| mask.has(i))
        .collect();
    // The patch settles on level ground; damping calms the band.
    let settling = Params {
        damping_per_s: 5.0,
        self_friction,
        ..Params::default()
    };
    let mut level = Simulator::from_positions(&mask, &start(), &settling).unwrap();
    level.hold(&sheet).unwrap();
    run(&mut level, 40);
    let (sin, cos) = degrees.to_radians().sin_cos();
    // Damping would slow the slide.
    let params = Params {
        gravity_m_s2: [9.8 * sin, 0.0, -9.8 * cos],
        damping_per_s: 0.0,
        self_friction,
        ..Params::default()
    };
    let mut cloth = Simulator::from_positions(&mask, &start(), &params).unwrap();
    cloth.restore(&level.snapshot()).unwrap();
    let mut velocities = vec![[0.0; 3]; count];
    for &i in &patch {
        velocities[i] = [0.2, 0.0, 0.0];
    }
    cloth.set_velocities(&velocities).unwrap();
    let mut speeds = Vec::new();
    for _ in 0..steps {
        cloth.step().unwrap();
        let v = cloth.velocities();
        speeds.push(patch.iter().map(|&i| f64::from(v[i][0])).sum::<f64>() / patch.len() as f64);
    }
    speeds
}

#[test]
fn a_patch_on_a_sheet_stops_two_degrees_below_the_angle_of_friction() {
    let degrees = Params::default().self_friction.atan().to_degrees() - 2.0;
    let speeds = speeds(degrees, Params::default().self_friction, 25);
    assert!(speeds[24].abs() < 0.005, "{speeds:?}");
}

#[test]
fn friction_between_layers_brakes_by_its_share_of_the_weight() {
    let braking = |self_friction: f32| {
        let speeds = speeds(0.0, self_friction, 3);
        (0.2 - speeds[1]) / 0.02
    };
    let bumps = braking(0.0);
    for self_friction in [0.1, 0.2, 0.3, 0.4] {
        let expected = G * f64::from(self_friction);
        let got = braking(self_friction) - bumps;
        assert!(
            (got / expected - 1.0).abs() < 0.3,
            "{self_friction}: {got} m/s^2 instead of {expected}"
        );
    }
}

/// Known limit: bumps between particles brake by up to 1 m/s^2 more at 0.2 m/s, which is about 6 degrees of slope.
#[test]
fn a_patch_on_a_sheet_speeds_up_ten_degrees_above_the_angle_of_friction() {
    let cone = Params::default().self_friction.atan().to_degrees();
    let speeds = speeds(cone + 10.0, Params::default().self_friction, 12);
    assert!(speeds[11] > 0.2, "{speeds:?}");
}

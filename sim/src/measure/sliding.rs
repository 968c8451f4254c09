//! Friction on the table and of the cloth on itself, by patches that slide down a slope.

use super::{Fineness, MeasureError, frictionless};
use crate::grid::Grid;
use crate::mask::Mask;
use crate::material::{Directions, Material};
use crate::params::Params;
use crate::simulator::{RestShortcut, Simulator};

/// Measures the friction on the table: a patch on a slope slides with `g (sin - friction cos)`.
pub fn table_friction(material: &Material, at: impl Into<Fineness>) -> Result<f64, MeasureError> {
    let at = at.into();
    let grid = Grid::new(6, 6, at.spacing_m)?;
    let params = on_slope(material, material.table_friction, at);
    let mut cloth = Simulator::flat(grid, &params);
    slide(&mut cloth, &params, &(0..36).collect::<Vec<_>>(), [10, 15])
}

/// Measures the friction of the cloth on itself: a patch slides on a sheet that slopes.
pub fn self_friction(material: &Material, at: impl Into<Fineness>) -> Result<f64, MeasureError> {
    let at = at.into();
    let params = on_slope(&limp(material), material.self_friction, at);
    let (mut cloth, patch) = patch_on_sheet(&params, at.spacing_m)?;
    // It comes to the sheet's edge after 6 spacings, at most at four tenths of gravity.
    let steps = (100.0 * (10.0 * at.spacing_m / 3.9).sqrt()) as u32;
    slide(&mut cloth, &params, &patch, [steps / 4, steps - steps / 4])
}

/// Returns the material with threads that hardly resist bending, so that a slack band of it neither pulls nor pushes.
pub fn limp(material: &Material) -> Material {
    Material {
        bending_length_m: Directions {
            warp: 0.003,
            weft: 0.003,
            bias: 0.00285,
        },
        ..frictionless(material)
    }
}

/// Columns and rows of a sheet, the rows of a slack band at its front edge, and the sides of a patch at the band's end.
const SHEET: usize = 24;
const BAND: usize = 12;
const PATCH: usize = 12;

/// Lays a patch on a sheet that is held, both parts of one cloth; returns it, and which particles are the patch's.
pub fn patch_on_sheet(
    params: &Params,
    spacing_m: f32,
) -> Result<(Simulator, Vec<usize>), MeasureError> {
    let grid = Grid::new(SHEET, SHEET + BAND + PATCH, spacing_m)?;
    let is_patch = |ix: usize, iy: usize| iy >= SHEET + BAND && (6..18).contains(&ix);
    let mask = Mask::from_fn(grid, |ix, iy| {
        iy < SHEET || (iy < SHEET + BAND && (11..13).contains(&ix)) || is_patch(ix, iy)
    })?;
    let gap = 2.0 * params.rest_height_m() / spacing_m;
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
        [x, y, z].map(|value| value * spacing_m)
    };
    let start: Vec<[f32; 3]> = (0..grid.particle_count()).map(place).collect();
    let mut cloth = Simulator::from_positions(&mask, &start, params)?;
    cloth.set_rest_shortcut(RestShortcut::Compute);
    let held = (0..grid.particle_count()).filter(|&i| mask.has(i) && i / SHEET < SHEET + BAND - 4);
    cloth.hold(&held.collect::<Vec<_>>())?;
    let patch = (0..grid.particle_count()).filter(|&i| is_patch(i % SHEET, i / SHEET));
    Ok((cloth, patch.collect()))
}

/// Returns parameters under which the table slopes towards -Y, by more than a friction holds.
fn on_slope(material: &Material, friction: f32, at: Fineness) -> Params {
    let slope = friction + 0.4;
    let per = 1.0 / (1.0 + slope * slope).sqrt();
    Params {
        gravity_m_s2: [0.0, -9.8 * slope * per, -9.8 * per],
        damping_per_s: 0.0,
        substeps: at.substeps,
        material: Some(material.clone()),
        ..Params::default()
    }
}

/// Lets a patch slide down and returns the friction that its acceleration shows.
///
/// - `steps`: before the acceleration is read, and while it is.
fn slide(
    cloth: &mut Simulator,
    params: &Params,
    patch: &[usize],
    [before, steps]: [u32; 2],
) -> Result<f64, MeasureError> {
    let speed = |cloth: &Simulator| {
        let velocities = cloth.velocities();
        let sum: f64 = patch.iter().map(|&i| f64::from(velocities[i][1])).sum();
        sum / patch.len() as f64
    };
    for _ in 0..before {
        cloth.step()?;
    }
    let slow = speed(cloth);
    for _ in 0..steps {
        cloth.step()?;
    }
    let secs = f64::from(params.step_secs) * f64::from(steps);
    let acceleration = (speed(cloth) - slow) / secs;
    let [_, along, down] = params.gravity_m_s2.map(f64::from);
    Ok((along - acceleration) / down)
}

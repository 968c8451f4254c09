//! The fold that speed is measured on: one corner carried along the diagonal by hand.
//!
//! In: a cloth's grid. Out: the folded cloth, after every step of it was computed. 50 x 50 particles make it
//! the scenario that other engines were timed with.

use crate::error::SimError;
use crate::grid::Grid;
use crate::params::Params;
use crate::simulator::{RestShortcut, Simulator};

/// How high the corner is raised, metres.
const RAISE_M: f32 = 0.05;
/// How far the corner is carried per step, metres.
const TRAVEL_M: f32 = 0.005;
/// Steps of settling after the release.
const SETTLING_STEPS: u32 = 50;

/// Folds corner 0 of a flat cloth over its centre to just short of the opposite corner, by hand.
///
/// 50 x 50 particles at 6.25 mm take 10 steps up, 87 along the diagonal (0.433 m), 10 down and 50 of
/// settling. Every step is computed, and the picker stays away.
///
/// - `interrupted`: asked before every step; `true` ends the fold early.
pub fn diagonal_fold(
    grid: Grid,
    params: &Params,
    interrupted: &dyn Fn() -> bool,
) -> Result<Simulator, SimError> {
    let mut cloth = Simulator::flat(grid, params);
    cloth.set_rest_shortcut(RestShortcut::Compute);
    cloth.hold(&[0])?;
    let corners = cloth.positions();
    let [from, to] = [corners[0], corners[corners.len() - 1]];
    let way = [to[0] - from[0], to[1] - from[1], 0.0];
    carry(&mut cloth, [0.0, 0.0, RAISE_M], interrupted)?;
    carry(&mut cloth, way, interrupted)?;
    carry(&mut cloth, [0.0, 0.0, -RAISE_M], interrupted)?;
    cloth.hold(&[])?;
    for _ in 0..SETTLING_STEPS {
        step(&mut cloth, [0.0; 3], interrupted)?;
    }
    Ok(cloth)
}

/// Moves what is held along a straight way, in equal steps of at most `TRAVEL_M`.
fn carry(
    cloth: &mut Simulator,
    way: [f32; 3],
    interrupted: &dyn Fn() -> bool,
) -> Result<(), SimError> {
    let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
    let steps = (length / TRAVEL_M).ceil();
    for _ in 0..steps as u32 {
        step(cloth, way.map(|axis| axis / steps), interrupted)?;
    }
    Ok(())
}

fn step(
    cloth: &mut Simulator,
    shift: [f32; 3],
    interrupted: &dyn Fn() -> bool,
) -> Result<(), SimError> {
    if interrupted() {
        return Err(SimError::Interrupted {
            steps: cloth.steps() as u32,
        });
    }
    cloth.step_held(shift)
}

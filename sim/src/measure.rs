//! What a textile laboratory would measure of a simulated cloth.
//!
//! In: a material and the distance between particles. Out: the numbers of the standards, to be compared with those
//! that the material declares. Each measurement cuts its own specimen, and takes nothing but positions from the
//! simulator. A particle stands for a square patch of cloth of one spacing a side, so that the cloth goes on for half a
//! spacing beyond the last one.

use crate::error::{SimError, StartError};
use crate::grid::{Grid, GridError};
use crate::mask::{Mask, MaskError};
use crate::material::{Directions, Material};
use crate::params::Params;
use crate::simulator::{RestShortcut, Simulator};

/// A measurement that could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// The specimen is no grid.
    #[error("the specimen: {0}")]
    Grid(#[from] GridError),
    /// The specimen is no cloth.
    #[error("the specimen: {0}")]
    Mask(#[from] MaskError),
    /// The specimen cannot lie where the measurement needs it.
    #[error("the specimen: {0}")]
    Start(#[from] StartError),
    /// The simulation stopped.
    #[error(transparent)]
    Sim(#[from] SimError),
}

/// A direction in which a strip is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Along the warp.
    Warp,
    /// Along the weft.
    Weft,
    /// At 45 degrees to both.
    Bias,
}

impl Cut {
    /// All directions.
    pub const ALL: [Cut; 3] = [Cut::Warp, Cut::Weft, Cut::Bias];

    /// Returns the value of a direction.
    pub fn of(self, values: Directions) -> f32 {
        match self {
            Cut::Warp => values.warp,
            Cut::Weft => values.weft,
            Cut::Bias => values.bias,
        }
    }
}

/// Width of a strip, metres (ASTM D1388: 25 mm).
const STRIP_M: f32 = 0.025;
/// Height at which strips are held, metres: above the table, whatever hangs from there.
const HIGH_M: f32 = 1.0;

/// A strip that lies straight along +X, high above the table.
struct Strip {
    mask: Mask,
    positions: Vec<[f32; 3]>,
    /// By particle: the distance from the strip's back end along it, in rows.
    row: Vec<usize>,
    /// Distance between rows along the strip, metres.
    pitch_m: f32,
}

impl Strip {
    fn cut(cut: Cut, rows: usize, spacing_m: f32) -> Result<Strip, MeasureError> {
        let across = ((STRIP_M / spacing_m).round() as usize).max(3);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        // Along and across the strip, in rows, and the particle's place.
        let (mask, along, pitch_m): (Mask, Vec<[f32; 2]>, f32) = match cut {
            Cut::Warp => {
                let grid = Grid::new(rows, across, spacing_m)?;
                let at = (0..rows * across).map(|i| [(i % rows) as f32, (i / rows) as f32]);
                (Mask::full(grid), at.collect(), spacing_m)
            }
            Cut::Weft => {
                let grid = Grid::new(across, rows, spacing_m)?;
                let at = (0..rows * across).map(|i| [(i / across) as f32, (i % across) as f32]);
                (Mask::full(grid), at.collect(), spacing_m)
            }
            Cut::Bias => {
                let wide = (2.0 * STRIP_M / (spacing_m * half) / 2.0).round() as isize;
                let dim = (rows + 2 * wide as usize).div_ceil(2) + 1;
                let grid = Grid::new(dim, dim, spacing_m)?;
                // Whole cells only, so that the ends are zigzag lines; a cell begins at its corner nearest the back end.
                let cell = |ix: isize, iy: isize| {
                    let row = ix + iy - wide;
                    ix.min(iy) >= 0 && (ix - iy).abs() < wide && row >= 0 && row + 2 < rows as isize
                };
                let there = |ix: usize, iy: usize| {
                    let (ix, iy) = (ix as isize, iy as isize);
                    [(0, 0), (1, 0), (0, 1), (1, 1)]
                        .iter()
                        .any(|(x, y)| cell(ix - x, iy - y))
                };
                let mask = Mask::from_fn(grid, there)?;
                let at = (0..dim * dim).map(|i| {
                    let (ix, iy) = (i % dim, i / dim);
                    [(ix + iy) as f32 - wide as f32, iy as f32 - ix as f32]
                });
                (mask, at.collect(), spacing_m * half)
            }
        };
        let positions = along
            .iter()
            .map(|[along, across]| [along * pitch_m, -across * pitch_m, HIGH_M]);
        Ok(Strip {
            positions: positions.collect(),
            row: along
                .iter()
                .map(|[along, _]| along.max(0.0) as usize)
                .collect(),
            mask,
            pitch_m,
        })
    }

    fn rows(&self, rows: impl Fn(usize) -> bool) -> Vec<usize> {
        (0..self.row.len())
            .filter(|&i| self.mask.has(i) && rows(self.row[i]))
            .collect()
    }

    /// Returns the mean place of the particles of a row.
    fn mean(&self, points: &[[f32; 3]], row: usize) -> [f64; 3] {
        let particles = self.rows(|it| it == row);
        let sum = |axis: usize| {
            particles
                .iter()
                .map(|&i| f64::from(points[i][axis]))
                .sum::<f64>()
        };
        [0, 1, 2].map(|axis| sum(axis) / particles.len() as f64)
    }
}

/// Returns the parameters under which a specimen of a material comes to rest soon.
fn calm(material: &Material) -> Params {
    Params {
        damping_per_s: 12.0,
        material: Some(material.clone()),
        ..Params::default()
    }
}

/// Steps until no particle moves faster than 0.1 mm/s, at most for a time.
fn settle(cloth: &mut Simulator, most_secs: f32) -> Result<(), SimError> {
    cloth.set_rest_shortcut(RestShortcut::Skip);
    for step in 0..(100.0 * most_secs) as u32 {
        cloth.step()?;
        let fastest = cloth
            .velocities()
            .iter()
            .flatten()
            .fold(0.0f32, |most, v| most.max(v.abs()));
        if step > 20 && fastest < 1e-4 {
            break;
        }
    }
    Ok(())
}

/// What a cantilever shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cantilever {
    /// Length that overhangs, metres.
    pub overhang_m: f64,
    /// Angle of the line from edge to tip below the horizontal, radians.
    pub angle_rad: f64,
    /// Bending length, metres.
    pub bending_length_m: f64,
}

/// Measures the bending length on a cantilever (Peirce 1930; ASTM D1388, option A), without internal friction.
///
/// The strip overhangs by twice the declared bending length, or nearly, and its length follows from the angle of the line from
/// edge to tip, `c = overhang * (cos(angle / 2) / (8 tan(angle)))^(1/3)`. The edge is half a spacing before the
/// last held particle, since the bend at that particle stands for half a spacing on each side.
pub fn cantilever(
    material: &Material,
    cut: Cut,
    spacing_m: f32,
) -> Result<Cantilever, MeasureError> {
    let frictionless = Material {
        crease_recovery_deg: 180.0,
        ..material.clone()
    };
    let pitch = if cut == Cut::Bias {
        spacing_m * std::f32::consts::FRAC_1_SQRT_2
    } else {
        spacing_m
    };
    let overhang = 2.0 * cut.of(material.bending_length_m);
    // Free rows, and half a spacing on both ends of them.
    let free = ((overhang / pitch).round() as usize)
        .saturating_sub(1)
        .max(2);
    let strip = Strip::cut(cut, free + 3, spacing_m)?;
    let mut cloth = Simulator::from_positions(&strip.mask, &strip.positions, &calm(&frictionless))?;
    cloth.hold(&strip.rows(|row| row < 3))?;
    settle(&mut cloth, 4.0)?;
    let points = cloth.positions();
    let [tip, before] = [free + 2, free + 1].map(|row| strip.mean(&points, row));
    let edge_m = 1.5 * f64::from(strip.pitch_m);
    let beyond = |axis: usize| tip[axis] + 0.5 * (tip[axis] - before[axis]);
    let angle_rad = (f64::from(HIGH_M) - beyond(2)).atan2(beyond(0) - edge_m);
    let overhang_m = (free + 1) as f64 * f64::from(strip.pitch_m);
    Ok(Cantilever {
        overhang_m,
        angle_rad,
        bending_length_m: overhang_m * ((0.5 * angle_rad).cos() / (8.0 * angle_rad.tan())).cbrt(),
    })
}

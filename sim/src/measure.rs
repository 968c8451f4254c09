//! What a textile laboratory would measure of a simulated cloth.
//!
//! In: a material and the distance between particles. Out: the numbers of the standards, to be compared with those
//! that the material declares. Each measurement cuts its own specimen, and takes nothing but positions from the
//! simulator. A particle stands for a square patch of cloth of one spacing a side, so that the cloth goes on for half a
//! spacing beyond the last one.

pub mod bounds;
mod sliding;
mod table;

pub use sliding::{limp, patch_on_sheet, self_friction, table_friction};
pub use table::{Reading, textile_table};

use crate::error::{SimError, StartError};
use crate::grid::{Grid, GridError, MAX_DIM};
use crate::mask::{Mask, MaskError};
use crate::material::{BIAS_LOAD_N_M, BIAS_STRIP_M, Directions, Material, THREAD_LOAD_N_M};
use crate::mesh;
use crate::params::Params;
use crate::simulator::{RestShortcut, Simulator};
use std::f64::consts::PI;

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

/// How finely a specimen is simulated. A number alone is the distance between particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Distance between particles, metres.
    pub spacing_m: f32,
    /// Fewest substeps of a step, as in [`Params::substeps`].
    pub substeps: u32,
}

impl From<f32> for Fineness {
    fn from(spacing_m: f32) -> Fineness {
        let Params { substeps, .. } = Params::default();
        Fineness {
            spacing_m,
            substeps,
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
                let wide = (BIAS_STRIP_M / (spacing_m * half) / 2.0).round() as isize;
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
fn calm(material: &Material, at: Fineness) -> Params {
    Params {
        damping_per_s: 12.0,
        substeps: at.substeps,
        material: Some(material.clone()),
        ..Params::default()
    }
}

/// Steps in which a specimen that has come to rest is slow.
const SLOW_STEPS: u32 = 10;

/// Steps until no particle has moved faster than 0.1 mm/s for some steps, at most for a time.
fn settle(cloth: &mut Simulator, most_secs: f32) -> Result<(), SimError> {
    cloth.set_rest_shortcut(RestShortcut::Skip);
    // One slow step may be where a swing turns.
    let mut slow = 0;
    for step in 0..(100.0 * most_secs) as u32 {
        cloth.step()?;
        let fastest = cloth
            .velocities()
            .iter()
            .flatten()
            .fold(0.0f32, |most, v| most.max(v.abs()));
        slow = if fastest < 1e-4 { slow + 1 } else { 0 };
        if step > 20 && slow >= SLOW_STEPS {
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

/// Returns the material without internal friction of bending.
fn frictionless(material: &Material) -> Material {
    Material {
        crease_recovery_deg: 180.0,
        ..material.clone()
    }
}

/// Measures the bending length on a cantilever (Peirce 1930; ASTM D1388, option A), without internal friction.
///
/// The strip overhangs by twice the declared bending length, or nearly, and its length follows from the angle of the line from
/// edge to tip, `c = overhang * (cos(angle / 2) / (8 tan(angle)))^(1/3)`. The edge is half a spacing before the
/// last held particle, since the bend at that particle stands for half a spacing on each side.
pub fn cantilever(
    material: &Material,
    cut: Cut,
    at: impl Into<Fineness>,
) -> Result<Cantilever, MeasureError> {
    let at = at.into();
    let spacing_m = at.spacing_m;
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
    let mut cloth = Simulator::from_positions(
        &strip.mask,
        &strip.positions,
        &calm(&frictionless(material), at),
    )?;
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

/// How both ends of a strip are clamped together to a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// Face to face and upwards, so that the loop hangs like a heart (Peirce 1930).
    Heart,
    /// End to end, so that the loop hangs like a ring.
    Ring,
}

impl Loop {
    /// Returns the angle of a clamped end to the horizontal, radians.
    pub fn clamp_rad(self) -> f64 {
        match self {
            Loop::Heart => std::f64::consts::FRAC_PI_2,
            Loop::Ring => 0.0,
        }
    }

    /// Returns the depth of a loop of about six bending lengths by the elastica, in bending lengths as `length` is.
    ///
    /// A line through the depths of 5.5 to 6.5 bending lengths, within 1 % of them (Plaut 2015).
    pub fn depth(self, length: f64) -> f64 {
        let [depth, slope] = match self {
            Loop::Heart => [1.366, 0.436],
            Loop::Ring => [2.192, 0.465],
        };
        depth + slope * (length - 6.0)
    }
}

/// Measures how far a loop of a strip along the warp hangs below its clamp, without internal friction, metres.
///
/// Returns the free length of the loop, which is `length_m` or nearly, and the depth.
pub fn hanging_loop(
    material: &Material,
    shape: Loop,
    length_m: f32,
    at: impl Into<Fineness>,
) -> Result<[f64; 2], MeasureError> {
    let at = at.into();
    let spacing_m = at.spacing_m;
    let rows = (length_m / spacing_m).round() as usize + 2;
    let strip = Strip::cut(Cut::Warp, rows, spacing_m)?;
    let (p, gap) = (f64::from(spacing_m), 1.2 * f64::from(material.gap_m()));
    let half = 0.5 * (rows - 2) as f64 * p;
    // Hardly above where it will hang: a stiff heart that begins higher may come to rest on its clamp.
    let direction = |share: f64| match shape {
        Loop::Heart => {
            let over = (share / 0.4).min(1.0);
            let under = ((share - 0.6) / 0.4).max(0.0);
            PI * (0.5 - over - 0.5 * under)
        }
        Loop::Ring => -PI * share,
    };
    let along = |s: f64| {
        const PIECES: usize = 64;
        let middles = (0..PIECES).map(|i| (i as f64 + 0.5) / PIECES as f64);
        let angles = middles.map(|middle| direction(middle * s / half));
        let sum = angles.fold([0.0, 0.0], |[x, z], angle| {
            [x + angle.cos(), z + angle.sin()]
        });
        sum.map(|sum| sum * s / PIECES as f64)
    };
    let end = along(half)[0];
    let place = |row: usize| {
        let s = (row as f64 - 0.5) * p;
        let (s, side) = if s <= half {
            (s, 1.0)
        } else {
            (2.0 * half - s, -1.0)
        };
        let share = 1.0 - s / half;
        if s < 0.75 * p {
            // Held: straight through the edge of the clamp.
            let (x, z) = (s * shape.clamp_rad().cos(), s * shape.clamp_rad().sin());
            let beside = if shape == Loop::Heart { 0.5 * gap } else { 0.0 };
            let below = if shape == Loop::Ring && side < 0.0 {
                gap
            } else {
                0.0
            };
            return [side * (x + beside), z - below];
        }
        let [x, z] = along(s);
        let below = if shape == Loop::Ring && side < 0.0 {
            gap * share
        } else {
            0.0
        };
        [
            side * (x - end * s / half + 0.5 * gap * share * shape.clamp_rad().sin()),
            z - below,
        ]
    };
    let mut positions = strip.positions.clone();
    for (point, &row) in positions.iter_mut().zip(&strip.row) {
        let [x, z] = place(row);
        *point = [x as f32, point[1], HIGH_M + z as f32];
    }
    let mut cloth =
        Simulator::from_positions(&strip.mask, &positions, &calm(&frictionless(material), at))?;
    cloth.hold(&strip.rows(|row| row < 2 || row + 2 >= rows))?;
    settle(&mut cloth, 4.0)?;
    let lowest = cloth
        .positions()
        .iter()
        .map(|p| p[2])
        .fold(f32::INFINITY, f32::min);
    Ok([2.0 * half, f64::from(HIGH_M - lowest)])
}

/// A strip that lies folded over on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Height of the upper layer's middle above the lower one's where the fold is highest, metres.
    pub height_m: f64,
    /// Distance between the layers where they lie flat, metres.
    pub gap_m: f64,
}

/// Returns the height of a free fold over a gap by the elastica, both in bending lengths, within 1 % for gaps of up to 0.3 (Plaut
/// 2015).
pub fn fold_height(gap: f64) -> f64 {
    0.906 + 0.128 * gap
}

/// Friction that holds the flap of a free fold.
const HOLDING_FRICTION: f32 = 0.6;

/// Measures a free fold of a strip along the warp, without internal friction and with a friction of at least 0.6 on the table and
/// itself, so that its flap stays.
pub fn free_fold(material: &Material, at: impl Into<Fineness>) -> Result<Fold, MeasureError> {
    let at = at.into();
    let spacing_m = at.spacing_m;
    let (p, c) = (
        f64::from(spacing_m),
        f64::from(material.bending_length_m.warp),
    );
    let gap = f64::from(material.gap_m());
    let radius = 0.5 * c;
    let arc = PI * radius;
    // The stiffest cloths have a shorter flap, so that the strip is a grid; five bending lengths would stay, too.
    let longest = MAX_DIM as f64 * p;
    let flap = (6.0 * c).min(0.5 * (longest - arc - 0.5 * c));
    let length = (2.0 * flap + 2.0 * c + arc).min(longest);
    let rows = (length / p).round() as usize;
    let strip = Strip::cut(Cut::Warp, rows, spacing_m)?;
    // With less friction between the layers the fold would push its flap away.
    let rough = Material {
        table_friction: material.table_friction.max(HOLDING_FRICTION),
        self_friction: material.self_friction.max(HOLDING_FRICTION),
        ..frictionless(material)
    };
    let params = calm(&rough, at);
    let low = f64::from(params.rest_height_m());
    let bottom = rows as f64 * p - arc - flap;
    let place = |row: usize| {
        let s = row as f64 * p;
        if s < bottom {
            [s, 0.0]
        } else if s < bottom + arc {
            let angle = (s - bottom) / radius;
            [bottom + radius * angle.sin(), radius * (1.0 - angle.cos())]
        } else {
            // The flap comes down to the gap within three bending lengths.
            let back = s - bottom - arc;
            let share = (back / (3.0 * c)).min(1.0);
            [bottom - back, 2.0 * radius + share * (gap - 2.0 * radius)]
        }
    };
    let mut positions = strip.positions.clone();
    for (point, &row) in positions.iter_mut().zip(&strip.row) {
        let [x, z] = place(row);
        *point = [x as f32, point[1], (low + z) as f32];
    }
    let mut cloth = Simulator::from_positions(&strip.mask, &positions, &params)?;
    settle(&mut cloth, 3.0)?;
    let points = cloth.positions();
    let highest = points.iter().map(|p| p[2]).fold(0.0f32, f32::max);
    // Well behind the fold, and off the flap's rim.
    let flat: Vec<f64> = (rows - (flap / p / 3.0) as usize..rows - 1)
        .map(|row| strip.mean(&points, row)[2] - low)
        .collect();
    Ok(Fold {
        height_m: f64::from(highest) - low,
        gap_m: flat.iter().sum::<f64>() / flat.len() as f64,
    })
}

/// Diameters of the disc and of the pedestal that it lies on, metres (Cusick 1968; ISO 9073-9).
const DISC_M: f32 = 0.3;
const PEDESTAL_M: f32 = 0.18;
/// Distance between the points at which the shadow of a disc is sampled, metres.
const SHADOW_M: f32 = 0.001;

/// Measures the drape coefficient: how much of the ring around the pedestal a disc of cloth covers, seen from above
/// (Cusick 1968), from 0 to 1.
pub fn drape_coefficient(
    material: &Material,
    at: impl Into<Fineness>,
) -> Result<f64, MeasureError> {
    let at = at.into();
    let spacing_m = at.spacing_m;
    let dim = (DISC_M / spacing_m).round() as usize + 1;
    let grid = Grid::new(dim, dim, spacing_m)?;
    let middle = (dim - 1) as f32 / 2.0;
    let aside = |x: f32, y: f32| ((x - middle).powi(2) + (y - middle).powi(2)).sqrt() * spacing_m;
    let cell = |ix: isize, iy: isize| {
        let inside = ix >= 0 && iy >= 0 && (ix as usize) < dim - 1 && (iy as usize) < dim - 1;
        inside && aside(ix as f32 + 0.5, iy as f32 + 0.5) < 0.5 * DISC_M
    };
    let mask = Mask::from_fn(grid, |ix, iy| {
        let (ix, iy) = (ix as isize, iy as isize);
        [(0, 0), (1, 0), (0, 1), (1, 1)]
            .iter()
            .any(|(x, y)| cell(ix - x, iy - y))
    })?;
    let params = calm(material, at);
    let mut positions = grid.flat_positions(&params);
    for (i, point) in positions.iter_mut().enumerate() {
        // Uneven by hundredths of a millimetre, or the disc would not know where to fold.
        point[2] = HIGH_M + 1e-5 * ((i * 7919) % 101) as f32;
    }
    let held: Vec<usize> = (0..dim * dim)
        .filter(|&i| {
            mask.has(i) && aside((i % dim) as f32, (i / dim) as f32) <= 0.5 * PEDESTAL_M + spacing_m
        })
        .collect();
    let mut cloth = Simulator::from_positions(&mask, &positions, &params)?;
    cloth.hold(&held)?;
    settle(&mut cloth, 3.0)?;
    let area = |points: &[[f32; 3]]| shadow_m2(&mask, points);
    let pedestal = std::f64::consts::PI * f64::from(0.5 * PEDESTAL_M).powi(2);
    Ok((area(&cloth.positions()) - pedestal) / (area(&positions) - pedestal))
}

/// Returns the area of the shadow of a cloth under light from straight above, square metres.
fn shadow_m2(mask: &Mask, points: &[[f32; 3]]) -> f64 {
    let reach = (DISC_M / SHADOW_M) as isize;
    let side = 2 * reach as usize + 1;
    let mut dark = vec![false; side * side];
    for corners in mesh::triangles(mask) {
        let [a, b, c] = corners.map(|i| [points[i][0] / SHADOW_M, points[i][1] / SHADOW_M]);
        let turn = |p: [f32; 2], q: [f32; 2], r: [f32; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let range = |axis: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]).ceil() as isize;
            let high = a[axis].max(b[axis]).max(c[axis]).floor() as isize;
            low.max(-reach)..=high.min(reach)
        };
        for y in range(1) {
            for x in range(0) {
                let p = [x as f32, y as f32];
                let turns = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
                let inside = turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0);
                if inside {
                    dark[(y + reach) as usize * side + (x + reach) as usize] = true;
                }
            }
        }
    }
    dark.iter().filter(|&&dark| dark).count() as f64 * f64::from(SHADOW_M).powi(2)
}

/// Where a fold is pressed flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crease {
    /// At one row of particles.
    Row,
    /// Between two rows.
    Between,
}

/// Measures the crease recovery angle (ISO 2313): a strip is pressed flat in a fold, one limb is let go, and the
/// angle between the limbs is read, degrees: 180 is flat.
///
/// As on the instrument, the free limb is not bent by its weight: there is no gravity.
pub fn crease_recovery_deg(
    material: &Material,
    cut: Cut,
    crease: Crease,
    at: impl Into<Fineness>,
) -> Result<f64, MeasureError> {
    let at = at.into();
    let spacing_m = at.spacing_m;
    let limb = ((0.02 / spacing_m).round() as usize).max(3);
    let rows = match crease {
        Crease::Row => 2 * limb + 1,
        Crease::Between => 2 * limb + 2,
    };
    let strip = Strip::cut(cut, rows, spacing_m)?;
    let gap = match crease {
        Crease::Row => material.gap_m(),
        Crease::Between => spacing_m.max(material.gap_m()),
    };
    let mut positions = strip.positions.clone();
    let last = limb as f32 * strip.pitch_m;
    for (point, &row) in positions.iter_mut().zip(&strip.row) {
        if row > limb {
            let beyond =
                (row - limb - usize::from(crease == Crease::Between)) as f32 * strip.pitch_m;
            *point = [last - beyond, point[1], HIGH_M + gap];
        }
    }
    let params = Params {
        gravity_m_s2: [0.0; 3],
        // It opens slowly: thrown open, the limb would bend elsewhere too.
        damping_per_s: 100.0,
        ..calm(material, at)
    };
    let mut cloth = Simulator::from_positions(&strip.mask, &positions, &params)?;
    cloth.hold(&strip.rows(|_| true))?;
    for _ in 0..5 {
        cloth.step()?;
    }
    cloth.hold(&strip.rows(|row| row < limb))?;
    settle(&mut cloth, 3.0)?;
    let points = cloth.positions();
    let [near, far] = [rows - limb, rows - 1].map(|row| strip.mean(&points, row));
    // The lower limb points along -X from the crease.
    let angle = (far[2] - near[2]).atan2(-(far[0] - near[0])).to_degrees();
    Ok(if angle < -90.0 { angle + 360.0 } else { angle })
}

/// Measures how much the cloth gives under the load of FAST, as a share of its length: along its threads under 98.1 N/m
/// (E100), along their diagonal under 4.9 N/m (EB5).
///
/// A sheet is held by one edge and drawn by its own weight: away from the edge, by at most ten times gravity, for threads; along the
/// edge, by at most gravity, for the diagonal, whose extension is a quarter of what shear of that load makes (FAST: 123 / EB5).
pub fn extension(
    material: &Material,
    cut: Cut,
    at: impl Into<Fineness>,
) -> Result<f64, MeasureError> {
    const LONG: usize = 32;
    // Wide, since cells at the sheet's sides, whose diagonals end there, give more.
    const WIDE: usize = 128;
    let at = at.into();
    // A sheared sheet has one cell less along the edge than particles to carry.
    let sheared = 0.25 * (WIDE - 1) as f64 / WIDE as f64;
    let (load_n_m, most_gravity_m_s2, most_gives) = match cut {
        Cut::Warp | Cut::Weft => (THREAD_LOAD_N_M, 98.0, 0.01),
        Cut::Bias => (BIAS_LOAD_N_M, 9.8, 0.05),
    };
    // A heavy or slack cloth is drawn less, so that it gives in proportion.
    let slack = cut.of(material.stretch).max(match cut {
        Cut::Warp | Cut::Weft => 0.0,
        Cut::Bias => material.least_bias_stretch(at.spacing_m),
    });
    let weight_kg_m = material.weight_kg_m2 * at.spacing_m * LONG as f32;
    let in_proportion = most_gives * load_n_m as f32 / (weight_kg_m * slack).max(1e-6);
    let drawn_m_s2 = in_proportion.min(most_gravity_m_s2);
    let ([dimx, dimy], gravity_m_s2, load_n_m) = match cut {
        Cut::Warp => ([LONG, 6], [drawn_m_s2, 0.0, 0.0], load_n_m),
        Cut::Weft => ([6, LONG], [0.0, -drawn_m_s2, 0.0], load_n_m),
        Cut::Bias => ([WIDE, 10], [drawn_m_s2, 0.0, 0.0], load_n_m * sheared),
    };
    let grid = Grid::new(dimx, dimy, at.spacing_m)?;
    let params = Params {
        gravity_m_s2,
        ..calm(&frictionless(material), at)
    };
    let mut start = grid.flat_positions(&params);
    for point in &mut start {
        point[2] = HIGH_M;
    }
    // By particle, its row from the held edge on.
    let (rows, row): (usize, fn(usize, usize) -> usize) = match cut {
        Cut::Warp => (dimx, |i, dimx| i % dimx),
        Cut::Weft | Cut::Bias => (dimy, |i, dimx| i / dimx),
    };
    let of_row = |wanted: usize| (0..dimx * dimy).filter(move |&i| row(i, dimx) == wanted);
    let mut cloth = Simulator::from_positions(grid, &start, &params)?;
    cloth.hold(&of_row(0).collect::<Vec<_>>())?;
    settle(&mut cloth, 4.0)?;
    let points = cloth.positions();
    let (axis, sign) = match cut {
        Cut::Warp | Cut::Bias => (0, 1.0),
        Cut::Weft => (1, -1.0),
    };
    let moved = |wanted: usize| {
        let sum: f64 = of_row(wanted)
            .map(|i| sign * f64::from(points[i][axis] - start[i][axis]))
            .sum();
        sum * rows as f64 / (dimx * dimy) as f64
    };
    let spacing_m = f64::from(at.spacing_m);
    // Next to what is held a cell gives more than others.
    let gives = (moved(rows - 1) - moved(1)) / spacing_m;
    // The weight of all rows beyond each pair but the first.
    let rows_beyond = ((rows - 1) * (rows - 2) / 2) as f64;
    let weight_n_m = f64::from(material.weight_kg_m2 * drawn_m_s2) * spacing_m * rows_beyond;
    Ok(gives / weight_n_m * load_n_m)
}

/// Height of a tumbling cloth, metres: above the table's reach, and no higher, since larger positions are rounded more.
const MIDDLE_M: f32 = 0.1;

/// Measures by which share the momentum of a cloth changes that tumbles and bends for 0.4 s without weight: the greater of the
/// changes of linear and angular momentum.
pub fn momentum_change(material: &Material, at: impl Into<Fineness>) -> Result<f64, MeasureError> {
    let at = at.into();
    let grid = Grid::new(12, 12, at.spacing_m)?;
    let params = Params {
        gravity_m_s2: [0.0; 3],
        damping_per_s: 0.0,
        substeps: at.substeps,
        material: Some(material.clone()),
        ..Params::default()
    };
    let mut start = grid.flat_positions(&params);
    for point in &mut start {
        point[2] = MIDDLE_M;
    }
    let mut cloth = Simulator::from_positions(grid, &start, &params)?;
    // It turns about X and is bent meanwhile.
    let spin: Vec<[f32; 3]> = start
        .iter()
        .map(|p| [0.1, 0.0, 4.0 * p[1] + 60.0 * p[0] * p[0]])
        .collect();
    cloth.set_velocities(&spin)?;
    let momenta = |cloth: &Simulator| {
        let mut sums = [[0.0f64; 3]; 2];
        for (p, v) in cloth.positions().iter().zip(&cloth.velocities()) {
            let (p, v) = (
                [p[0], p[1], p[2] - MIDDLE_M].map(f64::from),
                v.map(f64::from),
            );
            for axis in 0..3 {
                let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
                sums[0][axis] += v[axis];
                sums[1][axis] += p[next] * v[last] - p[last] * v[next];
            }
        }
        sums
    };
    let before = momenta(&cloth);
    for _ in 0..40 {
        cloth.step()?;
    }
    let length = |v: [f64; 3]| v.map(|value| value * value).iter().sum::<f64>().sqrt();
    let changes = before.iter().zip(momenta(&cloth)).map(|(before, after)| {
        length([0, 1, 2].map(|axis| after[axis] - before[axis])) / length(*before)
    });
    Ok(changes.fold(0.0, f64::max))
}

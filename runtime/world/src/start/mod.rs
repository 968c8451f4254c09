//! Where the cloth lies when a rollout begins.
//!
//! In: a program's cloth, a seed, or a `.npy` file whose frame and grid somebody states. Out: a
//! [`Start`] in the world frame, with its count and numbers checked. Whether the shape is physically
//! possible is the world's to judge.

mod file;
mod outline;

pub use file::{Grid, StartError, StartFrame, Up};
pub use outline::Outline;

use fab_base::chance::Chance;
use fab_program::Cloth;
use sha2::{Digest, Sha256};

/// Height of a resting cloth's particles above the table, metres (protocol, section 1).
pub const RESTING_HEIGHT_M: f64 = 0.005;

/// A cloth's particles at the beginning of a rollout.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// What it is called in journals: `flat`, `seed 7`, `crumpled, seed 7`, or the file's name.
    pub name: String,
    /// The seed that chose it, where one did.
    pub seed: Option<u64>,
    /// The particle grid.
    pub grid: Grid,
    /// Which particles of the grid there are; all of them where there is no outline.
    pub outline: Option<Outline>,
    /// `[dimy * dimx]` positions, index `iy * dimx + ix`, world frame, metres. Those of missing particles mean nothing.
    pub positions: Vec<[f32; 3]>,
}

impl Start {
    /// Lays the task's cloth flat on the table's centre, its edges along the axes.
    pub fn flat(cloth: &Cloth) -> Start {
        Start::turned("flat".to_owned(), None, cloth, 0.0)
    }

    /// Lays the task's cloth flat, turned by an angle that the seed chooses between -45 and 45 degrees.
    ///
    /// The range is that of the paper's start generator (protocol, section 6).
    pub fn seeded(cloth: &Cloth, seed: u64) -> Start {
        let angle_rad = (Chance::seeded(seed).fraction() - 0.5) * std::f64::consts::FRAC_PI_2;
        Start::turned(format!("seed {seed}"), Some(seed), cloth, angle_rad)
    }

    /// Lays the task's cloth flat, turned counter-clockwise as seen from above.
    pub fn turned_by(cloth: &Cloth, angle_rad: f64) -> Start {
        let name = format!("turned by {:.0} degrees", angle_rad.to_degrees());
        Start::turned(name, None, cloth, angle_rad)
    }

    /// Names this cloth as a world has crumpled it by a seed; see [`crate::World::crumple`].
    ///
    /// - `positions`: `[dimy * dimx]`, index `iy * dimx + ix`, world frame, metres.
    pub fn crumpled(&self, seed: u64, positions: Vec<[f32; 3]>) -> Start {
        Start {
            name: format!("crumpled, seed {seed}"),
            seed: Some(seed),
            grid: self.grid,
            outline: self.outline.clone(),
            positions,
        }
    }

    /// Turns the cloth about the table's centre, counter-clockwise as seen from above, and then shifts it.
    ///
    /// - `shift_m`: along the world's x and y.
    pub fn moved(self, turn_rad: f64, shift_m: [f64; 2]) -> Start {
        // Rounding would change the digest of a start that stays where it is.
        if turn_rad == 0.0 && shift_m == [0.0; 2] {
            return self;
        }
        let (sin, cos) = turn_rad.sin_cos();
        let positions = self.positions.iter().map(|&[x, y, z]| {
            let (x, y) = (f64::from(x), f64::from(y));
            let turned = [cos * x - sin * y, sin * x + cos * y];
            [
                (turned[0] + shift_m[0]) as f32,
                (turned[1] + shift_m[1]) as f32,
                z,
            ]
        });
        Start {
            name: format!("{}, moved", self.name),
            positions: positions.collect(),
            ..self
        }
    }

    fn turned(name: String, seed: Option<u64>, cloth: &Cloth, angle_rad: f64) -> Start {
        let grid = Grid {
            dimx: cloth.dimx,
            dimy: cloth.dimy,
            spacing_m: cloth.spacing_m,
        };
        let (sin, cos) = angle_rad.sin_cos();
        let mut positions = Vec::with_capacity((grid.dimx * grid.dimy) as usize);
        for iy in 0..grid.dimy {
            for ix in 0..grid.dimx {
                let right = (f64::from(ix) - f64::from(grid.dimx - 1) / 2.0) * grid.spacing_m;
                let back = (f64::from(grid.dimy - 1) / 2.0 - f64::from(iy)) * grid.spacing_m;
                positions.push([
                    (cos * right - sin * back) as f32,
                    (sin * right + cos * back) as f32,
                    cloth.rest_height_m() as f32,
                ]);
            }
        }
        Start {
            name,
            seed,
            grid,
            outline: None,
            positions,
        }
    }

    /// Reads a start from a `.npy` file of shape `[dimx * dimy, 3]`, metres, or from the last state in a run's folder.
    ///
    /// Frame and grid come from `stated`, else from `NAME.json` beside the file, else from the run or from the
    /// `manifest.json` of a recorded data set above it; they are never guessed. `NAME.json` may hold an outline;
    /// it is not read where the frame is stated.
    pub fn load(path: &std::path::Path, stated: Option<StartFrame>) -> Result<Start, StartError> {
        file::load(path, stated)
    }

    /// Describes its positions as [`Start::load`] reads it from `NAME.json` beside them, JSON.
    pub fn description(&self) -> Vec<u8> {
        let description = file::Description {
            frame: StartFrame {
                grid: self.grid,
                up: Up::Z,
            },
            outline: self.outline.clone(),
        };
        serde_json::to_vec_pretty(&description).expect("a grid has finite numbers")
    }

    /// Returns the start's identity: SHA-256 over grid, positions, and outline where there is one, hex.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.grid.dimx.to_le_bytes());
        hash.update(self.grid.dimy.to_le_bytes());
        hash.update(self.grid.spacing_m.to_le_bytes());
        for coordinate in self.positions.iter().flatten() {
            hash.update(coordinate.to_le_bytes());
        }
        if let Some(outline) = &self.outline {
            hash.update(outline.text());
        }
        fab_base::digest::hex(&hash.finalize())
    }

    /// Returns the middle of the cloth's bounding box on the table, metres.
    pub fn center_m(&self) -> [f64; 2] {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for position in &self.positions {
            for axis in 0..2 {
                low[axis] = low[axis].min(f64::from(position[axis]));
                high[axis] = high[axis].max(f64::from(position[axis]));
            }
        }
        [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0]
    }
}

#[cfg(test)]
#[path = "tests/start.rs"]
mod tests;

//! Reads recorded particle positions from `.npy` files.
//!
//! In: a path, and optionally the grid and the up axis as stated by the user. Out: a [`Start`] in the world frame.
//! Files are bounded before they are read.

use super::{Outline, Start};
use fab_base::{files, npy};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The largest file accepted, bytes: far above any grid that the simulator accepts.
const MAX_BYTES: u64 = 64 << 20;
/// Between which shares of their distance in the flat cloth neighbours mostly lie apart. In 143 recorded states, flat,
/// folded and crumpled, the mean is 1.00 to 1.02.
const SCALE: [f64; 2] = [0.85, 1.15];
/// The name of a run's start, `.npy` for the positions and `.json` for their description.
const RUN_START: &str = "start";
/// The name of the positions after a step, in the step's folder.
const RUN_STATE: &str = "positions.npy";
/// How many folders above a recorded start are searched for the manifest that describes it.
const MANIFEST_LEVELS: usize = 5;

/// A rectangular particle grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Particles along the cloth's own x, at least 2.
    pub dimx: u32,
    /// Particles along the cloth's other side, at least 2.
    pub dimy: u32,
    /// Distance between neighbours in the flat cloth, metres.
    pub spacing_m: f64,
}

/// Which axis of a file points away from the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Up {
    /// The second, as PyFleX records; world = (x, -z, y), a rotation.
    Y,
    /// The third, as in the world frame.
    Z,
}

/// How the numbers in a file are to be interpreted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartFrame {
    /// The particle grid.
    #[serde(flatten)]
    pub grid: Grid,
    /// The axis that points up.
    pub up: Up,
}

/// What a file beside the positions says about them.
#[derive(Serialize, Deserialize)]
pub(super) struct Description {
    #[serde(flatten)]
    pub frame: StartFrame,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outline: Option<Outline>,
}

impl From<StartFrame> for Description {
    fn from(frame: StartFrame) -> Description {
        Description {
            frame,
            outline: None,
        }
    }
}

/// Why a start file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The file cannot be opened or read.
    #[error("cannot read the start `{path}`: {why}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        why: String,
    },
    /// The file is not a `.npy` file of floating-point numbers.
    #[error(
        "the start `{path}` is not a usable .npy file: {why}; expected float32 or float64 of shape (particles, 3), or (particles, 4) with the inverse mass"
    )]
    NotPositions {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The array has another number of particles than the grid.
    #[error(
        "the start `{path}` has {found} particles; a grid of {dimx} by {dimy} has {}",
        u64::from(*dimx) * u64::from(*dimy)
    )]
    Count {
        /// The file.
        path: PathBuf,
        /// The number of particles found.
        found: usize,
        /// Particles along the cloth's own x that are expected.
        dimx: u32,
        /// Particles along its other side that are expected.
        dimy: u32,
    },
    /// Neighbours lie together or apart as in another unit, or on one point.
    #[error(
        "neighbouring particles of the start `{path}` mostly lie {:.2} mm apart, and {:.2} mm in the flat cloth: the positions are at another scale, or of another grid",
        usual_m * 1000.0,
        rest_m * 1000.0
    )]
    Scale {
        /// The file.
        path: PathBuf,
        /// Median distance of neighbours, metres.
        usual_m: f64,
        /// Their distance in the flat cloth, metres.
        rest_m: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "the start `{path}` has the coordinate {value} at particle {particle}; every coordinate must be a finite number of metres"
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Index of the particle.
        particle: usize,
        /// The value found.
        value: f64,
    },
    /// Nothing states the up axis or the arrangement of the particles.
    #[error(
        "nothing says how the start `{path}` is arranged: write `{beside}` with dimx, dimy, spacing_m and up (\"y\" or \"z\"), or give `--dims 55x44 --up y`"
    )]
    FrameUnknown {
        /// The file.
        path: PathBuf,
        /// The description file that is looked for first.
        beside: PathBuf,
    },
    /// The file that describes the start cannot be understood.
    #[error("the description `{path}` of the start is wrong: {why}")]
    Description {
        /// The description file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
}

pub(super) fn load(path: &Path, stated: Option<StartFrame>) -> Result<Start, StartError> {
    let path = &state_in(path)?;
    let read = read_positions(path)?;
    let Description { frame, outline } = match stated {
        Some(frame) => frame.into(),
        None => find_description(path)?,
    };
    let grid = frame.grid;
    let wanted = u64::from(grid.dimx) * u64::from(grid.dimy);
    if read.len() as u64 != wanted {
        return Err(StartError::Count {
            path: path.to_owned(),
            found: read.len(),
            dimx: grid.dimx,
            dimy: grid.dimy,
        });
    }
    let mut numbers = read.iter().flatten();
    if let Some(at) = numbers.position(|value| !value.is_finite()) {
        return Err(StartError::NotFinite {
            path: path.to_owned(),
            particle: at / 3,
            value: read[at / 3][at % 3],
        });
    }
    let usual_m = usual_spacing_m(&read, &grid, outline.as_ref());
    let [least, most] = SCALE;
    if usual_m.is_some_and(|usual_m| !(least..=most).contains(&(usual_m / grid.spacing_m))) {
        return Err(StartError::Scale {
            path: path.to_owned(),
            usual_m: usual_m.unwrap_or_default(),
            rest_m: grid.spacing_m,
        });
    }
    let world = read.into_iter().map(|[x, y, z]| match frame.up {
        Up::Y => [x as f32, -z as f32, y as f32],
        Up::Z => [x as f32, y as f32, z as f32],
    });
    Ok(Start {
        name: path.display().to_string(),
        seed: None,
        grid,
        outline,
        positions: world.collect(),
    })
}

/// Returns the median distance of neighbours along the grid's two sides, metres; `None` without neighbours.
fn usual_spacing_m(read: &[[f64; 3]], grid: &Grid, outline: Option<&Outline>) -> Option<f64> {
    let dimx = grid.dimx as usize;
    let has = |index: &usize| outline.is_none_or(|outline| outline.has(grid, *index));
    let mut distances = Vec::new();
    for (index, point) in read.iter().enumerate().filter(|(index, _)| has(index)) {
        let right = (index % dimx + 1 < dimx).then_some(index + 1);
        let front = (index + dimx < read.len()).then_some(index + dimx);
        for other in [right, front].into_iter().flatten().filter(has) {
            let off = [0, 1, 2].map(|axis| (point[axis] - read[other][axis]).powi(2));
            distances.push(off.iter().sum::<f64>().sqrt());
        }
    }
    // A few particles that are far away are for the world to name.
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}

/// Returns the file of a run's last state, if the path is the run's folder.
fn state_in(path: &Path) -> Result<PathBuf, StartError> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let unreadable = |why: String| StartError::Unreadable {
        path: path.to_owned(),
        why,
    };
    let steps = (1_u32..).map(|step| path.join(format!("step_{step}")));
    match steps.take_while(|step| step.is_dir()).last() {
        Some(last) if last.join(RUN_STATE).is_file() => Ok(last.join(RUN_STATE)),
        Some(last) => Err(unreadable(format!(
            "`{}` holds no `{RUN_STATE}`: the world of that run does not know its particles",
            last.display()
        ))),
        None if path.join(RUN_START).with_extension("npy").is_file() => {
            Ok(path.join(RUN_START).with_extension("npy"))
        }
        None => Err(unreadable(
            "it is a folder, and holds no run of `fabc run`; expected its folder, or a .npy file"
                .to_owned(),
        )),
    }
}

fn read_positions(path: &Path) -> Result<Vec<[f64; 3]>, StartError> {
    let bytes = files::read(path, MAX_BYTES).map_err(|why| StartError::Unreadable {
        path: path.to_owned(),
        why,
    })?;
    npy::decode_positions(&bytes).map_err(|why| StartError::NotPositions {
        path: path.to_owned(),
        why,
    })
}

fn find_description(path: &Path) -> Result<Description, StartError> {
    let beside = path.with_extension("json");
    // All states of a run are of the cloth that it began with.
    let is_state = path.file_name().is_some_and(|name| name == RUN_STATE);
    let run = path.ancestors().nth(2).filter(|_| is_state);
    let of_run = run.map(|run| run.join(RUN_START).with_extension("json"));
    let file = { [Some(beside.clone()), of_run].into_iter().flatten() }.find(|it| it.is_file());
    if let Some(file) = file {
        let wrong = |why: String| StartError::Description {
            path: file.clone(),
            why,
        };
        let described: Description =
            serde_json::from_value(read_json(&file)?).map_err(|error| wrong(error.to_string()))?;
        check_grid(described.frame, &file)?;
        if let Some(outline) = &described.outline {
            outline.check(&described.frame.grid).map_err(wrong)?;
        }
        return Ok(described);
    }
    let mut folder = path.parent().map(Path::to_owned);
    for _ in 0..MANIFEST_LEVELS {
        let Some(here) = folder else { break };
        let manifest = here.join("manifest.json");
        if manifest.is_file() {
            return frame_in_manifest(&manifest, path).map(Description::from);
        }
        folder = here.parent().map(Path::to_owned);
    }
    Err(StartError::FrameUnknown {
        path: path.to_owned(),
        beside,
    })
}

/// Finds the entry for this file in a recorded data set. Its paths are relative to the manifest's grandparent folder;
/// recorded data is y-up with 6.25 mm spacing.
fn frame_in_manifest(manifest: &Path, start: &Path) -> Result<StartFrame, StartError> {
    let wrong = |why: String| StartError::Description {
        path: manifest.to_owned(),
        why,
    };
    let value = read_json(manifest)?;
    let root = manifest
        .parent()
        .and_then(Path::parent)
        .unwrap_or(Path::new(""));
    let target = start
        .canonicalize()
        .map_err(|error| wrong(error.to_string()))?;
    let entries = value
        .get("entries")
        .or_else(|| value.get("states"))
        .and_then(|entries| entries.as_array());
    for entry in entries.into_iter().flatten() {
        let text = |key: &str| entry.get(key).and_then(|value| value.as_str());
        let candidate = match (text("dir"), text("pos")) {
            (Some(folder), _) => root
                .join(folder)
                .join(target.file_name().unwrap_or_default()),
            (None, Some(file)) => root.join(file),
            (None, None) => continue,
        };
        if candidate
            .canonicalize()
            .is_ok_and(|candidate| candidate == target)
        {
            let number = |key: &str| {
                entry
                    .get(key)
                    .or_else(|| value.get(key))
                    .and_then(|value| value.as_f64())
            };
            let count = |key: &str| u32::try_from(entry.get(key)?.as_u64()?).ok();
            let (Some(dimx), Some(dimy), Some(spacing_m)) =
                (count("dimx"), count("dimy"), number("spacing_m"))
            else {
                let why =
                    "the start's entry lacks dimx, dimy or spacing_m, or one of them is not valid";
                return Err(wrong(why.to_owned()));
            };
            let grid = Grid {
                dimx,
                dimy,
                spacing_m,
            };
            return check_grid(StartFrame { grid, up: Up::Y }, manifest);
        }
    }
    Err(wrong(format!("it has no entry for `{}`", start.display())))
}

fn check_grid(frame: StartFrame, described_in: &Path) -> Result<StartFrame, StartError> {
    let Grid {
        dimx,
        dimy,
        spacing_m,
    } = frame.grid;
    if dimx < 2 || dimy < 2 || !(spacing_m.is_finite() && spacing_m > 0.0) {
        return Err(StartError::Description {
            path: described_in.to_owned(),
            why: format!(
                "a grid of {dimx} by {dimy} particles {spacing_m} m apart; both counts must be at least 2 and the spacing above 0"
            ),
        });
    }
    Ok(frame)
}

fn read_json(path: &Path) -> Result<serde_json::Value, StartError> {
    files::read_json(path, MAX_BYTES).map_err(|why| StartError::Description {
        path: path.to_owned(),
        why,
    })
}

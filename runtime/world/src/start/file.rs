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
    /// Its contents are no cloth on a table.
    #[error("the start `{path}` {why}")]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what would be right; completes the sentence.
        why: String,
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
    let unreadable = |why: String| StartError::Unreadable {
        path: path.to_owned(),
        why,
    };
    let unusable = |why: String| StartError::Unusable {
        path: path.to_owned(),
        why,
    };
    let bytes = files::read(path, MAX_BYTES).map_err(unreadable)?;
    let read = npy::decode_positions(&bytes).map_err(|why| {
        unusable(format!(
            "is not a usable .npy file: {why}; expected float32 or float64 of shape (particles, 3), or (particles, 4) with the inverse mass"
        ))
    })?;
    let Description { frame, outline } = match stated {
        Some(frame) => Description {
            frame,
            outline: None,
        },
        None => find_description(path)?,
    };
    let grid = frame.grid;
    let (dimx, dimy) = (grid.dimx, grid.dimy);
    let wanted = u64::from(dimx) * u64::from(dimy);
    if read.len() as u64 != wanted {
        let found = read.len();
        return Err(unusable(format!(
            "has {found} particles; a grid of {dimx} by {dimy} has {wanted}"
        )));
    }
    let mut numbers = read.iter().flatten();
    if let Some(at) = numbers.position(|value| !value.is_finite()) {
        let (particle, value) = (at / 3, read[at / 3][at % 3]);
        return Err(unusable(format!(
            "has the coordinate {value} at particle {particle}; every coordinate must be a finite number of metres"
        )));
    }
    if let Some(usual_m) = usual_spacing_m(&read, &grid, outline.as_ref())
        && !(SCALE[0]..=SCALE[1]).contains(&(usual_m / grid.spacing_m))
    {
        let [usual_mm, rest_mm] = [usual_m, grid.spacing_m].map(|metres| metres * 1000.0);
        return Err(unusable(format!(
            "is at another scale, or of another grid: its neighbouring particles mostly lie {usual_mm:.2} mm apart, and {rest_mm:.2} mm in the flat cloth"
        )));
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
        let described: Description = files::read_json(&file, MAX_BYTES).map_err(wrong)?;
        check_grid(&described.frame.grid).map_err(wrong)?;
        if let Some(outline) = &described.outline {
            outline.check(&described.frame.grid).map_err(wrong)?;
        }
        return Ok(described);
    }
    let above = path.ancestors().skip(1).take(MANIFEST_LEVELS);
    let mut manifests = above.map(|folder| folder.join("manifest.json"));
    if let Some(manifest) = manifests.find(|manifest| manifest.is_file()) {
        let frame = frame_in_manifest(&manifest, path);
        let frame = frame.map_err(|why| StartError::Description {
            path: manifest,
            why,
        })?;
        return Ok(Description {
            frame,
            outline: None,
        });
    }
    Err(StartError::FrameUnknown {
        path: path.to_owned(),
        beside,
    })
}

/// The states of a recorded data set.
#[derive(Deserialize)]
struct Manifest {
    #[serde(alias = "states")]
    entries: Vec<RecordedState>,
    spacing_m: Option<f64>,
}

/// A recorded state: the folder of its files, or the file of its positions.
#[derive(Deserialize)]
struct RecordedState {
    dir: Option<PathBuf>,
    pos: Option<PathBuf>,
    dimx: u32,
    dimy: u32,
    spacing_m: Option<f64>,
}

/// Finds the entry for this file in a recorded data set. Its paths are relative to the manifest's grandparent folder;
/// recorded data is y-up.
fn frame_in_manifest(manifest: &Path, start: &Path) -> Result<StartFrame, String> {
    let listed: Manifest = files::read_json(manifest, MAX_BYTES)?;
    let root = manifest.ancestors().nth(2).unwrap_or(Path::new(""));
    let target = start.canonicalize().map_err(|error| error.to_string())?;
    let file = target.file_name().unwrap_or_default();
    let is_target = |entry: &&RecordedState| {
        let path = match (&entry.dir, &entry.pos) {
            (Some(folder), _) => root.join(folder).join(file),
            (None, Some(file)) => root.join(file),
            (None, None) => return false,
        };
        path.canonicalize().is_ok_and(|path| path == target)
    };
    let Some(entry) = listed.entries.iter().find(is_target) else {
        return Err(format!("it has no entry for `{}`", start.display()));
    };
    let spacing_m = entry.spacing_m.or(listed.spacing_m);
    let grid = Grid {
        dimx: entry.dimx,
        dimy: entry.dimy,
        spacing_m: spacing_m.ok_or("the start's entry lacks `spacing_m`")?,
    };
    check_grid(&grid)?;
    Ok(StartFrame { grid, up: Up::Y })
}

fn check_grid(grid: &Grid) -> Result<(), String> {
    let Grid {
        dimx,
        dimy,
        spacing_m,
    } = grid;
    if *dimx >= 2 && *dimy >= 2 && spacing_m.is_finite() && *spacing_m > 0.0 {
        return Ok(());
    }
    Err(format!(
        "a grid of {dimx} by {dimy} particles {spacing_m} m apart; both counts must be at least 2 and the spacing above 0"
    ))
}

//! Recorded demonstrations of folds, as listed in a manifest.
//!
//! In: a folder with `manifest.json`; the manifest's paths are relative to the parent of that folder. Out: actions and
//! positions in the world frame. Recorded points are y-up: world = (x, -z, y). All input is untrusted until checked;
//! nothing outside the folder is read.

use crate::exit::Failure;
use crate::sources;
use fab_sim::{Params, Simulator};
use fab_world::start::{Grid, Start, StartFrame, Up};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// The longest name of a task, bytes.
const MAX_NAME: usize = 64;

/// One recorded demonstration; its positions stay on disk until needed.
pub struct Demonstration {
    /// The task's name in the recorded data.
    pub task: String,
    /// Its number within the task.
    pub id: u64,
    /// The cloth.
    pub grid: fab_sim::Grid,
    /// The picks and places, in order.
    pub picks: Vec<Pick>,
    frame: StartFrame,
    start: PathBuf,
    end: PathBuf,
}

/// One recorded pick and place.
pub struct Pick {
    /// Pick point, table coordinates, world frame, metres.
    pub pick: [f32; 2],
    /// Place point, likewise.
    pub place: [f32; 2],
    /// Index of the held particle.
    pub particle: usize,
}

/// Cloth states: `[particles]` points in grid order, world frame, metres.
pub struct Positions {
    /// Before the first pick.
    pub start: Vec<[f32; 3]>,
    /// After the last place.
    pub end: Vec<[f32; 3]>,
}

#[derive(Deserialize)]
struct Manifest {
    entries: Vec<serde_json::Value>,
}

#[derive(Deserialize)]
struct Entry {
    task: String,
    id: u64,
    dir: PathBuf,
    dimx: u32,
    dimy: u32,
    spacing_m: f64,
    steps: Vec<Step>,
}

#[derive(Deserialize)]
struct Step {
    pick_world_m: [f64; 3],
    place_world_m: [f64; 3],
    pick_keypoint: usize,
}

/// Reads the manifest, finds the files of every entry, and selects by task and by ids.
///
/// Fails on the first error and names its entry; [`Demonstration::positions`] checks the positions.
pub fn read(
    folder: &Path,
    task: Option<&str>,
    ids: Option<&[u64]>,
) -> Result<Vec<Demonstration>, Failure> {
    let path = folder.join("manifest.json");
    let shown = path.display();
    let wrong =
        |why: String| Failure::environment(format!("the manifest `{shown}` is wrong: {why}"));
    let text = sources::read_text(&path).map_err(|why| {
        Failure::environment(format!(
            "cannot read `{shown}`: {why}; expected a folder of recorded demonstrations with a manifest.json"
        ))
    })?;
    let manifest: Manifest =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if manifest.entries.is_empty() {
        return Err(wrong("its `entries` are empty".to_owned()));
    }
    let real = fs::canonicalize(folder).map_err(|error| wrong(error.to_string()))?;
    let mut found = Vec::new();
    for (number, value) in manifest.entries.into_iter().enumerate() {
        let entry = serde_json::from_value(value).map_err(|error| error.to_string());
        let read = entry.and_then(|entry| demonstration(entry, &real));
        let at = |why| wrong(format!("entry {number} (counted from 0): {why}"));
        found.push(read.map_err(at)?);
    }
    if let Some(task) = task {
        let there = listed(found.iter().map(|it| it.task.clone()));
        found.retain(|it| it.task == task);
        if found.is_empty() {
            return Err(Failure::usage(format!(
                "`--task {task}`: there is no such task; there are {there}"
            )));
        }
    }
    if let Some(ids) = ids {
        if let Some(absent) = ids.iter().find(|id| found.iter().all(|it| it.id != **id)) {
            return Err(Failure::usage(format!(
                "no demonstration has the id {absent}; there are {}",
                listed(found.iter().map(|it| it.id))
            )));
        }
        found.retain(|it| ids.contains(&it.id));
    }
    Ok(found)
}

/// Lists the available values for a message, sorted and without duplicates; a very long list is cut.
pub fn listed<T: Ord + fmt::Display>(values: impl Iterator<Item = T>) -> String {
    const MOST: usize = 50;
    let values: BTreeSet<T> = values.collect();
    let mut names: Vec<String> = values.iter().take(MOST).map(T::to_string).collect();
    if values.len() > MOST {
        names.push(format!("and {} more", values.len() - MOST));
    }
    names.join(", ")
}

fn demonstration(entry: Entry, folder: &Path) -> Result<Demonstration, String> {
    let grid = fab_sim::Grid::new(
        entry.dimx as usize,
        entry.dimy as usize,
        entry.spacing_m as f32,
    )
    .map_err(|error| error.to_string())?;
    // Names are printed, and a terminal would interpret control characters.
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    if !(1..=MAX_NAME).contains(&entry.task.len()) || !entry.task.chars().all(plain) {
        return Err(format!(
            "`task` {:?} is not a name; write 1 to {MAX_NAME} letters, digits, `_`, `-` or `.`",
            entry.task.chars().take(MAX_NAME).collect::<String>()
        ));
    }
    if entry.steps.is_empty() {
        return Err("it has no `steps`".to_owned());
    }
    let keypoints = keypoints(grid.dimx, grid.dimy);
    let on_table = |[x, _, z]: [f64; 3]| [x as f32, -z as f32];
    let picks = entry.steps.iter().map(|step| {
        let particle = keypoints.get(step.pick_keypoint).copied();
        Ok(Pick {
            pick: on_table(step.pick_world_m),
            place: on_table(step.place_world_m),
            particle: particle.ok_or_else(|| {
                let number = step.pick_keypoint;
                format!(
                    "`pick_keypoint` {number} is not from 0 to {}",
                    keypoints.len() - 1
                )
            })?,
        })
    });
    Ok(Demonstration {
        picks: picks.collect::<Result<_, String>>()?,
        frame: StartFrame {
            grid: Grid {
                dimx: entry.dimx,
                dimy: entry.dimy,
                spacing_m: entry.spacing_m,
            },
            up: Up::Y,
        },
        start: file_of(&entry, "init_pos.npy", folder)?,
        end: file_of(&entry, "final_pos.npy", folder)?,
        task: entry.task,
        id: entry.id,
        grid,
    })
}

/// Returns the particles at the four corners and at the middles of the four edges, in the recorded data's order.
fn keypoints(dimx: usize, dimy: usize) -> [usize; 8] {
    let (middle_x, middle_y) = ((dimx - 1) / 2, (dimy - 1) / 2);
    [
        0,
        dimx * (dimy - 1),
        dimx - 1,
        dimx * dimy - 1,
        middle_y * dimx,
        middle_x,
        dimx * (dimy - 1) + middle_x,
        middle_y * dimx + dimx - 1,
    ]
}

/// Finds a file of an entry and returns its real path below `folder`, which must be a real path too.
fn file_of(entry: &Entry, name: &str, folder: &Path) -> Result<PathBuf, String> {
    let above = folder.parent().unwrap_or(folder);
    let path = entry.dir.join(name);
    let shown = path.display();
    let real = fs::canonicalize(above.join(&path))
        .map_err(|error| format!("cannot find `{shown}` below `{}`: {error}", above.display()))?;
    if !real.starts_with(folder) {
        return Err(format!(
            "`{shown}` leads out of `{}`; right would be a path below it",
            folder.display()
        ));
    }
    Ok(real)
}

impl Demonstration {
    /// Reads and checks the positions before and after.
    pub fn positions(&self) -> Result<Positions, Failure> {
        let load = |path: &Path| Start::load(path, Some(self.frame)).map_err(Failure::environment);
        Ok(Positions {
            start: load(&self.start)?.positions,
            end: load(&self.end)?.positions,
        })
    }

    /// Lays the cloth at recorded positions.
    pub fn lay(&self, start: &[[f32; 3]], params: &Params) -> Result<Simulator, Failure> {
        Simulator::from_positions(self.grid, start, params).map_err(|error| {
            Failure::environment(format!("the start of {self} is no cloth's: {error}"))
        })
    }
}

impl fmt::Display for Demonstration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.task, self.id)
    }
}

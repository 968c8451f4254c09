//! Recorded demonstrations of folds, as listed in a manifest.
//!
//! In: a folder with `manifest.json`; the manifest's paths are relative to the parent of that folder. Out: actions and
//! positions in the world frame. Recorded points are y-up: world = (x, -z, y).

use crate::exit::Failure;
use crate::sources;
use fab_sim::{Params, Simulator};
use fab_world::start::{Grid, Start, StartFrame, Up};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

/// One recorded demonstration; its positions stay on disk until needed.
pub struct Demonstration {
    /// The task's name in the recorded data.
    pub task: String,
    /// Its number within the task.
    pub id: u64,
    /// The picks and places, in order.
    pub picks: Vec<Pick>,
    grid: fab_sim::Grid,
    frame: StartFrame,
    folder: PathBuf,
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

/// Reads the manifest, and selects by task and by ids.
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
    let mut found = Vec::new();
    for (number, value) in manifest.entries.into_iter().enumerate() {
        let entry = serde_json::from_value(value).map_err(|error| error.to_string());
        let read = entry.and_then(|entry| demonstration(entry, folder));
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
    let (dimx, dimy, spacing_m) = (entry.dimx, entry.dimy, entry.spacing_m);
    let grid = fab_sim::Grid::new(dimx as usize, dimy as usize, spacing_m as f32)
        .map_err(|error| error.to_string())?;
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
                format!("`pick_keypoint` {number} is not from 0 to 7")
            })?,
        })
    });
    let declared = Grid {
        dimx,
        dimy,
        spacing_m,
    };
    Ok(Demonstration {
        picks: picks.collect::<Result<_, String>>()?,
        frame: StartFrame {
            grid: declared,
            up: Up::Y,
        },
        folder: folder.join("..").join(&entry.dir),
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

impl Demonstration {
    /// Reads and checks the positions before and after.
    pub fn positions(&self) -> Result<Positions, Failure> {
        let load = |name| Start::load(&self.folder.join(name), Some(self.frame));
        Ok(Positions {
            start: load("init_pos.npy")?.positions,
            end: load("final_pos.npy")?.positions,
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

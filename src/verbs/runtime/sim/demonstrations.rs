//! Recorded demonstrations of folds, as listed in a manifest.
//!
//! In: a folder with `manifest.json`; the manifest's paths are relative to the parent of that folder. Out: actions and
//! positions in the world frame. Recorded points are y-up: world = (x, -z, y).

use crate::exit::Failure;
use fab_base::files;
use fab_base::wording::quoted;
use fab_sim::{Grid, Params, Simulator};
use fab_world::start::{self, Start, StartFrame, Up};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// The largest manifest accepted, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// One recorded demonstration; its positions stay on disk until needed.
pub struct Demonstration {
    /// The task's name in the recorded data.
    pub task: String,
    /// Its number within the task.
    pub id: u64,
    /// The picks and places, in order.
    pub picks: Vec<Pick>,
    grid: Grid,
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

#[derive(Deserialize)]
struct Manifest {
    entries: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    task: String,
    id: u64,
    dir: PathBuf,
    #[serde(flatten)]
    grid: start::Grid,
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
/// [`Demonstration::laid`] reads and checks the positions.
pub fn read(
    folder: &Path,
    task: Option<&str>,
    ids: Option<&[u64]>,
) -> Result<Vec<Demonstration>, Failure> {
    let path = folder.join("manifest.json");
    let wrong = |why: String| {
        Failure::environment(format!(
            "`{}` lists no recorded demonstrations: {why}",
            path.display()
        ))
    };
    let manifest: Manifest = files::read_json(&path, MAX_BYTES).map_err(wrong)?;
    let read = { manifest.entries.into_iter() }.map(|entry| demonstration(entry, folder));
    let all: Vec<Demonstration> = read.collect::<Result<_, String>>().map_err(wrong)?;
    let tasks: BTreeSet<String> = all.iter().map(|it| it.task.clone()).collect();
    let is_wanted = |it: &Demonstration| {
        task.is_none_or(|task| task == it.task) && ids.is_none_or(|ids| ids.contains(&it.id))
    };
    let found: Vec<Demonstration> = all.into_iter().filter(is_wanted).collect();
    if found.is_empty() {
        let tasks = quoted(tasks);
        return Err(Failure::usage(format!(
            "no demonstration has that task and id; there are those of {tasks}"
        )));
    }
    Ok(found)
}

fn demonstration(entry: Entry, folder: &Path) -> Result<Demonstration, String> {
    let (dimx, dimy) = (entry.grid.dimx as usize, entry.grid.dimy as usize);
    let grid = Grid::new(dimx, dimy, entry.grid.spacing_m as f32)
        .map_err(|error| format!("`{}` {}: {error}", entry.task, entry.id))?;
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
    Ok(Demonstration {
        picks: picks.collect::<Result<_, String>>()?,
        frame: StartFrame {
            grid: entry.grid,
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
    /// Lays the cloth as it lay before the first pick; returns it, and its `[particles]` positions after the last place,
    /// world frame, metres.
    pub fn laid(&self, params: &Params) -> Result<(Simulator, Vec<[f32; 3]>), Failure> {
        let load = |name| Start::load(&self.folder.join(name), Some(self.frame));
        let (start, end) = (load("init_pos.npy")?, load("final_pos.npy")?);
        let cloth = Simulator::from_positions(self.grid, &start.positions, params);
        let cloth = cloth.map_err(|error| self.failure(error))?;
        Ok((cloth, end.positions))
    }

    /// Returns an error in simulating this demonstration.
    pub fn failure(&self, error: impl Display) -> Failure {
        Failure::environment(format!("`{}` {}: {error}", self.task, self.id))
    }
}

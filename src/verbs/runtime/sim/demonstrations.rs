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

/// How many points of a cloth are picked: its corners, and the middles of its edges.
const KEYPOINTS: usize = 8;

#[derive(Deserialize)]
struct Manifest {
    entries: Vec<Demonstration>,
}

/// One recorded demonstration; its positions stay on disk until needed.
#[derive(Deserialize)]
pub struct Demonstration {
    /// The task's name in the recorded data.
    pub task: String,
    /// Its number within the task.
    pub id: u64,
    pub steps: Vec<Step>,
    dir: PathBuf,
    #[serde(flatten)]
    grid: start::Grid,
}

#[derive(Deserialize)]
pub struct Step {
    pick_world_m: [f64; 3],
    place_world_m: [f64; 3],
    pick_keypoint: usize,
}

impl Step {
    /// Returns where it picks and places, table coordinates, world frame, metres.
    pub fn ends_m(&self) -> [[f32; 2]; 2] {
        [self.pick_world_m, self.place_world_m].map(|[x, _, z]| [x as f32, -z as f32])
    }
}

/// Reads the manifest, and selects by task and by ids.
pub fn read(
    folder: &Path,
    task: Option<&str>,
    ids: Option<&[u64]>,
) -> Result<Vec<Demonstration>, Failure> {
    let path = folder.join("manifest.json");
    let wrong = |why: String| {
        let path = path.display();
        Failure::environment(format!("`{path}` lists no recorded demonstrations: {why}"))
    };
    let manifest: Manifest = files::read_json(&path, MAX_BYTES).map_err(wrong)?;
    let mut selected = manifest.entries;
    if selected.is_empty() {
        return Err(wrong("its `entries` are empty".to_owned()));
    }
    selected.iter().try_for_each(Demonstration::check)?;
    let tasks: BTreeSet<String> = selected.iter().map(|it| it.task.clone()).collect();
    selected.retain(|it| task.is_none_or(|task| task == it.task));
    let is_absent = |id: &&u64| selected.iter().all(|it| it.id != **id);
    let absent = quoted(ids.unwrap_or_default().iter().filter(is_absent));
    if selected.is_empty() {
        return Err(Failure::usage(format!(
            "no demonstration has that task; there are those of {}",
            quoted(tasks)
        )));
    }
    if !absent.is_empty() {
        return Err(Failure::usage(format!(
            "no demonstration of {} has these ids: {absent}",
            task.unwrap_or("any task")
        )));
    }
    selected.retain(|it| ids.is_none_or(|ids| ids.contains(&it.id)));
    for demonstration in &mut selected {
        demonstration.dir = folder.join("..").join(&demonstration.dir);
    }
    Ok(selected)
}

impl Demonstration {
    /// Checks that it has steps, each from a known point.
    fn check(&self) -> Result<(), Failure> {
        if self.steps.is_empty() {
            return Err(self.failure("it has no `steps`"));
        }
        match self.steps.iter().find(|it| it.pick_keypoint >= KEYPOINTS) {
            Some(Step { pick_keypoint, .. }) => Err(self.failure(format!(
                "`pick_keypoint` {pick_keypoint} is not from 0 to {}",
                KEYPOINTS - 1
            ))),
            None => Ok(()),
        }
    }

    /// Lays the cloth as it lay before the first pick; returns it, and its positions after the last place, world frame, metres.
    pub fn laid(&self, params: &Params) -> Result<(Simulator, Vec<[f32; 3]>), Failure> {
        let (dimx, dimy) = (self.grid.dimx as usize, self.grid.dimy as usize);
        let grid = Grid::new(dimx, dimy, self.grid.spacing_m as f32);
        let grid = grid.map_err(|error| self.failure(error))?;
        let frame = StartFrame {
            grid: self.grid,
            up: Up::Y,
        };
        let load = |name| Start::load(&self.dir.join(name), Some(frame));
        let (start, end) = (load("init_pos.npy")?, load("final_pos.npy")?);
        let cloth = Simulator::from_positions(grid, &start.positions, params);
        let cloth = cloth.map_err(|error| self.failure(error))?;
        Ok((cloth, end.positions))
    }

    /// Returns the particle that a step held: at a corner or at the middle of an edge, in the recorded data's order.
    pub fn held(&self, step: &Step) -> usize {
        let (dimx, dimy) = (self.grid.dimx as usize, self.grid.dimy as usize);
        let (middle_x, middle_y) = ((dimx - 1) / 2, (dimy - 1) / 2);
        let keypoints: [usize; KEYPOINTS] = [
            0,
            dimx * (dimy - 1),
            dimx - 1,
            dimx * dimy - 1,
            middle_y * dimx,
            middle_x,
            dimx * (dimy - 1) + middle_x,
            middle_y * dimx + dimx - 1,
        ];
        keypoints[step.pick_keypoint]
    }

    pub fn failure(&self, error: impl Display) -> Failure {
        Failure::environment(format!("`{}` {}: {error}", self.task, self.id))
    }
}

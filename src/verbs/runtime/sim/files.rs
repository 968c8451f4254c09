//! The files that the `sim` verbs read and write: states in; pictures, positions and meshes out.

use super::SPACING_M;
use crate::exit::Failure;
use crate::sources;
use crate::verbs::runtime::setting;
use crate::verbs::runtime::setting::FrameArguments;
use clap::Args;
use clap::ValueHint;
use fab_sim::Mask;
use fab_world::start::{Grid, Outline, Start, StartFrame, Up};
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;

/// A file of particle positions, its frame and outline.
#[derive(Args)]
pub struct StateArguments {
    /// Particle positions.
    #[arg(value_name = "STATE.npy", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    #[command(flatten)]
    pub frame: FrameArguments,
    /// Which particles of the grid exist: rows of `#` and `.`, seen from above; default: as described, else all.
    #[arg(long, value_name = "FILE.txt", value_hint = ValueHint::FilePath)]
    pub outline: Option<PathBuf>,
}

/// Particle positions in the world frame, and their grid.
pub struct ClothState {
    /// `[dimy * dimx]` positions, index `iy * dimx + ix`, world frame, metres.
    pub positions: Vec<[f32; 3]>,
    /// Which particles exist; its grid is within the simulator's bounds.
    pub mask: Mask,
    /// The grid as the file states it.
    pub grid: Grid,
}

/// Reads a state like `fabc run --start`; frame and grid must be stated and are never guessed.
pub fn read_state(arguments: &StateArguments) -> Result<ClothState, Failure> {
    let stated = setting::stated_frame(&arguments.frame, SPACING_M)?;
    let path = &arguments.file;
    let start = Start::load(path, stated).map_err(Failure::environment)?;
    let Grid {
        dimx,
        dimy,
        spacing_m,
    } = start.grid;
    let grid = fab_sim::Grid::new(dimx as usize, dimy as usize, spacing_m as f32)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", path.display())))?;
    let described = match &start.outline {
        Some(outline) => Some(described_outline(outline, grid, path)?),
        None => None,
    };
    let mask = match (&arguments.outline, described) {
        (Some(outline), described) => stated_outline(outline, grid, path, described)?,
        (None, Some(described)) => described,
        (None, None) => Mask::full(grid),
    };
    Ok(ClothState {
        positions: start.positions,
        mask,
        grid: start.grid,
    })
}

/// Reads an outline from a file; the grid has the size of the outline.
pub fn read_outline(path: &Path, spacing_m: f32) -> Result<Mask, Failure> {
    let wrong = |why: String| wrong_outline(path, &why);
    let text = sources::read_text(path).map_err(wrong)?;
    Mask::parse(&text, spacing_m).map_err(|error| wrong(error.to_string()))
}

fn wrong_outline(path: &Path, why: &str) -> Failure {
    Failure::environment(format!("the outline `{}`: {why}", path.display()))
}

/// Returns the outline in a state's description.
fn described_outline(
    outline: &Outline,
    grid: fab_sim::Grid,
    state: &Path,
) -> Result<Mask, Failure> {
    Mask::parse(&outline.text(), grid.spacing_m)
        .map_err(|error| error.to_string())
        .and_then(|mask| fits(mask, grid, state))
        .map_err(|why| {
            let state = state.display();
            Failure::environment(format!("the description of `{state}`: {why}"))
        })
}

/// Reads the outline that the command line names for a state; it must not contradict the description.
fn stated_outline(
    path: &Path,
    grid: fab_sim::Grid,
    state: &Path,
    described: Option<Mask>,
) -> Result<Mask, Failure> {
    let mask = fits(read_outline(path, grid.spacing_m)?, grid, state)
        .map_err(|why| wrong_outline(path, &why))?;
    match described {
        Some(described) if described != mask => Err(Failure::usage(format!(
            "`--outline {}` has {} particles, and the description of `{}` an outline of {} or of others; \
             leave `--outline` out",
            path.display(),
            mask.count(),
            state.display(),
            described.count()
        ))),
        _ => Ok(mask),
    }
}

/// Checks that an outline fits a state's grid.
fn fits(mask: Mask, grid: fab_sim::Grid, state: &Path) -> Result<Mask, String> {
    if mask.grid() == grid {
        return Ok(mask);
    }
    let [found, wanted] = [mask.grid(), grid].map(size);
    Err(format!(
        "it has {found}; right would be {wanted}, as the grid of `{}`",
        state.display()
    ))
}

/// Describes the size of a grid.
pub fn size(grid: fab_sim::Grid) -> String {
    format!("{} columns and {} rows", grid.dimx, grid.dimy)
}

/// Rejects an output that would overwrite the input.
pub fn not_onto_itself(input: &Path, output: &Path) -> Result<(), Failure> {
    let same = match (input.canonicalize(), output.canonicalize()) {
        (Ok(input), Ok(output)) => input == output,
        _ => false,
    };
    if same {
        return Err(Failure::usage(format!(
            "`-o {}` is the file that is read; name another one",
            output.display()
        )));
    }
    Ok(())
}

/// Describes positions in the world frame in the format of a start's description, with the verb that wrote them.
pub fn description(grid: &Grid, mask: &Mask, made_by: &str) -> Value {
    let frame = StartFrame {
        grid: *grid,
        up: Up::Z,
    };
    let mut value =
        serde_json::to_value(frame).expect("a frame has string keys and finite numbers");
    if let Some(outline) = outline_of(mask) {
        value["outline"] = json!(outline);
    }
    value["made_by"] = made_by.into();
    value
}

/// Returns the outline of a cloth with missing particles; `None` for a complete cloth.
pub fn outline_of(mask: &Mask) -> Option<Outline> {
    (!mask.is_full()).then(|| Outline::new(&mask.to_string()))
}

/// Returns whether a description was written by the named verb, which then may replace it.
pub fn is_made_by(made_by: &str, description: &Path) -> bool {
    let bytes = sources::read_bounded(description).unwrap_or_default();
    serde_json::from_slice::<Value>(&bytes).is_ok_and(|value| value["made_by"] == made_by)
}

/// Returns a JSON document as the bytes of a file.
pub fn json_bytes(value: &Value) -> Vec<u8> {
    let text = serde_json::to_string_pretty(value).expect("a JSON value can be written");
    (text + "\n").into_bytes()
}

//! The files that the `sim` verbs read and write: states and outlines in; positions with a description out.

use super::SPACING_M;
use crate::exit::Failure;
use crate::io::write_file;
use crate::sources;
use crate::verbs::runtime::setting::{self, FrameArguments};
use clap::{Args, ValueHint};
use fab_base::npy;
use fab_sim::Mask;
use fab_world::start::{Grid, Outline, Start, StartFrame, Up};
use serde::Serialize;
use serde_json::Value;
use std::path::{Path, PathBuf};

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
    let start = Start::load(path, stated)?;
    let Grid {
        dimx,
        dimy,
        spacing_m,
    } = start.grid;
    let grid = fab_sim::Grid::new(dimx as usize, dimy as usize, spacing_m as f32)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", path.display())))?;
    let described = start.outline.map(|outline| {
        let mask = Mask::parse(&outline.text(), grid.spacing_m).map_err(|error| error.to_string());
        mask.and_then(|mask| fits(mask, grid, path)).map_err(|why| {
            Failure::environment(format!("the description of `{}`: {why}", path.display()))
        })
    });
    let described = described.transpose()?;
    let mask = match &arguments.outline {
        None => described.unwrap_or_else(|| Mask::full(grid)),
        Some(outline) => {
            let mask = fits(read_outline(outline, grid.spacing_m)?, grid, path)
                .map_err(|why| wrong_outline(outline, &why))?;
            if described.is_some_and(|described| described != mask) {
                return Err(Failure::usage(format!(
                    "`--outline {}` differs from the outline in the description of `{}`; leave `--outline` out",
                    outline.display(),
                    path.display()
                )));
            }
            mask
        }
    };
    Ok(ClothState {
        positions: start.positions,
        mask,
        grid: start.grid,
    })
}

/// Reads an outline from a file; the grid has the size of the outline.
pub fn read_outline(path: &Path, spacing_m: f32) -> Result<Mask, Failure> {
    let text = sources::read_text(path).map_err(|why| wrong_outline(path, &why))?;
    Mask::parse(&text, spacing_m).map_err(|error| wrong_outline(path, &error.to_string()))
}

fn wrong_outline(path: &Path, why: &str) -> Failure {
    Failure::environment(format!("the outline `{}`: {why}", path.display()))
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
    let real = |path: &Path| path.canonicalize().ok();
    match real(input).zip(real(output)) {
        Some((input, there)) if input == there => Err(Failure::usage(format!(
            "`-o {}` is the file that is read; name another one",
            output.display()
        ))),
        _ => Ok(()),
    }
}

/// What stands beside positions in the world frame: a start's description, and the verb that wrote it.
#[derive(Serialize)]
pub struct Description<T> {
    #[serde(flatten)]
    frame: StartFrame,
    #[serde(skip_serializing_if = "Option::is_none")]
    outline: Option<Outline>,
    made_by: &'static str,
    #[serde(flatten)]
    more: T,
}

impl<T: Serialize> Description<T> {
    /// Describes a cloth; `more` has fields that no reader of a start needs.
    pub fn of(grid: &Grid, mask: &Mask, made_by: &'static str, more: T) -> Description<T> {
        Description {
            frame: StartFrame {
                grid: *grid,
                up: Up::Z,
            },
            outline: outline_of(mask),
            made_by,
            more,
        }
    }
}

/// Returns the outline of a cloth with missing particles; `None` for a complete cloth.
pub fn outline_of(mask: &Mask) -> Option<Outline> {
    (!mask.is_full()).then(|| Outline::new(&mask.to_string()))
}

/// Refuses positions whose description is there and was not written by the named verb.
pub fn check_replaceable(path: &Path, made_by: &str) -> Result<(), Failure> {
    let beside = path.with_extension("json");
    let bytes = sources::read_bounded(&beside).unwrap_or_default();
    if serde_json::from_slice::<Value>(&bytes).is_ok_and(|value| value["made_by"] == made_by) {
        return Ok(());
    }
    let is_there = |path: &&Path| path.symlink_metadata().is_ok();
    match [beside.as_path(), path].iter().find(|path| is_there(path)) {
        Some(there) => Err(Failure::environment(format!(
            "`{}` is there already and was not written by `{made_by}`; choose another `-o`",
            there.display()
        ))),
        None => Ok(()),
    }
}

/// Writes positions and their description; returns the path of the description.
pub fn write_positions(
    path: &Path,
    positions: &[[f32; 3]],
    description: &impl Serialize,
) -> Result<PathBuf, Failure> {
    let beside = path.with_extension("json");
    let text = serde_json::to_string_pretty(description).expect("a description can be written");
    // The description comes first: positions without it would block the next call.
    write_file(&beside, format!("{text}\n").as_bytes())?;
    write_file(path, &npy::encode(positions))?;
    Ok(beside)
}

//! The files that the verbs read and write: states in, pictures, positions and meshes out.

use super::SPACING_M;
use crate::cli::sim::StateArguments;
use crate::exit::Failure;
use crate::{setting, sources};
use runtime::start::{Grid, Start, StartFrame, Up};
use runtime::store;
use serde_json::Value;
use sim::Mask;
use std::path::Path;

/// Particle positions in the world frame, and their cloth.
pub struct State {
    /// `[dimy * dimx]` positions, index `iy * dimx + ix`, world frame, metres.
    pub positions: Vec<[f32; 3]>,
    /// Which particles there are; its grid is within the simulator's bounds.
    pub mask: Mask,
    /// The grid as the file states it.
    pub grid: Grid,
}

/// Reads a state as `fabc run --start` reads one; frame and grid are stated somewhere, never guessed.
pub fn read_state(arguments: &StateArguments) -> Result<State, Failure> {
    let stated = setting::stated_frame(&arguments.frame, SPACING_M)?;
    let path = &arguments.file;
    let start = Start::load(path, stated).map_err(Failure::environment)?;
    let Grid {
        dimx,
        dimy,
        spacing_m,
    } = start.grid;
    let grid = sim::Grid::new(dimx as usize, dimy as usize, spacing_m as f32)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", path.display())))?;
    let mask = match &arguments.outline {
        Some(outline) => read_outline(outline, grid, path)?,
        None => Mask::full(grid),
    };
    Ok(State {
        positions: start.positions,
        mask,
        grid: start.grid,
    })
}

/// Reads which particles of a state's grid there are.
fn read_outline(path: &Path, grid: sim::Grid, state: &Path) -> Result<Mask, Failure> {
    let shown = path.display();
    let wrong = |why: String| Failure::environment(format!("the outline `{shown}`: {why}"));
    let bytes = sources::read_bounded(path).map_err(wrong)?;
    let text = String::from_utf8(bytes).map_err(|_| wrong("it is not UTF-8 text".to_owned()))?;
    let mask = Mask::parse(&text, grid.spacing_m).map_err(|error| wrong(error.to_string()))?;
    if mask.grid() != grid {
        let [found, wanted] =
            [mask.grid(), grid].map(|it| format!("{} columns and {} rows", it.dimx, it.dimy));
        return Err(wrong(format!(
            "it has {found}; right would be {wanted}, as the grid of `{}`",
            state.display()
        )));
    }
    Ok(mask)
}

/// Refuses to write over the file that is read.
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

/// Tells whether a file name ends in `.ENDING`, in whatever case.
pub fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// Writes a file whole.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    store::write_whole(path, bytes).map_err(|error| {
        Failure::environment(format!("cannot write `{}`: {error}", path.display()))
    })
}

/// Describes positions in the world frame, as a start's description says it, and which verb wrote it.
pub fn description(grid: &Grid, made_by: &str) -> Value {
    let frame = StartFrame {
        grid: *grid,
        up: Up::Z,
    };
    let mut value =
        serde_json::to_value(frame).expect("a frame has string keys and finite numbers");
    value["made_by"] = made_by.into();
    value
}

/// Tells whether a description was written by the verb of that name, which then may replace it.
pub fn is_made_by(made_by: &str, description: &Path) -> bool {
    let bytes = sources::read_bounded(description).unwrap_or_default();
    serde_json::from_slice::<Value>(&bytes).is_ok_and(|value| value["made_by"] == made_by)
}

/// Returns a JSON document as the bytes of a file.
pub fn json_bytes(value: &Value) -> Vec<u8> {
    let text = serde_json::to_string_pretty(value).expect("a JSON value can be written");
    (text + "\n").into_bytes()
}

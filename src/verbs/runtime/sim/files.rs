//! The cloth states that the `sim` verbs read and write: positions, with a description beside them.

use super::SPACING_M;
use crate::exit::Failure;
use crate::io::write_file;
use crate::verbs::runtime::setting::{self, FrameArguments};
use clap::{Args, ValueHint};
use fab_base::{files, npy};
use fab_sim::Mask;
use fab_world::simulated;
use fab_world::start::{Start, StartFrame};
use std::path::{Path, PathBuf};

const MAX_BYTES: u64 = 1 << 20;

/// A file of particle positions, and its frame.
#[derive(Args)]
pub struct StateArguments {
    /// Particle positions.
    #[arg(value_name = "STATE.npy", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    #[command(flatten)]
    pub frame: FrameArguments,
}

/// Reads a state like `fabc run --start`, and which of its particles exist.
pub fn read_state(path: &Path, frame: &FrameArguments) -> Result<(Start, Mask), Failure> {
    let start = Start::load(path, setting::stated_frame(frame, SPACING_M)?)?;
    let mask = simulated::mask(&start)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", path.display())))?;
    Ok((start, mask))
}

/// Returns the path of the description beside positions; refuses another file in its place.
pub fn description_of(path: &Path) -> Result<PathBuf, Failure> {
    let beside = path.with_extension("json");
    if beside.symlink_metadata().is_ok() {
        files::read_json::<StartFrame>(&beside, MAX_BYTES).map_err(|why| {
            Failure::environment(format!(
                "`{}` is there and describes no positions: {why}; choose another `-o`",
                beside.display()
            ))
        })?;
    }
    Ok(beside)
}

/// Writes positions and their description; returns the path of the description.
pub fn write_state(path: &Path, state: &Start) -> Result<PathBuf, Failure> {
    let beside = description_of(path)?;
    write_file(&beside, &state.description())?;
    write_file(path, &npy::encode(&state.positions))?;
    Ok(beside)
}

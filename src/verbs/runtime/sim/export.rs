//! `fabc sim export`: writes positions or a mesh for other programs, in the world frame.

use super::files::{self, ClothState};
use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::sim::files::StateArguments;
use clap::Args;
use clap::ValueHint;
use fab_base::files::ends_in;
use fab_base::npy;
use fab_sim::Params;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Arguments of `sim export`.
#[derive(Args)]
pub struct ExportArguments {
    #[command(flatten)]
    pub state: StateArguments,
    /// Positions with a description beside them (.npy), or a mesh (.obj).
    #[arg(short = 'o', long = "out", value_name = "FILE.npy|FILE.obj", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Marks a description as written by this verb, so that a later call may replace it.
const MADE_BY: &str = "fabc sim export";

/// Writes positions, and lists the files.
pub fn run(arguments: &ExportArguments, io: &Io) -> Result<Exit, Failure> {
    let write = writer(&arguments.out)?;
    let state = files::read_state(&arguments.state)?;
    files::not_onto_itself(&arguments.state.file, &arguments.out)?;
    let written = write(&state, &arguments.out)?;
    let names: Vec<String> = written.iter().map(|it| it.display().to_string()).collect();
    io.report(
        arguments.json,
        || {
            json!({
                "params": Params::default().hash(),
                "files": names,
                "particles": state.mask.count(),
            })
        },
        || names.join("\n"),
    );
    Ok(Exit::Done)
}

/// Writes a state to a file, along with any file that belongs to it.
type Writer = fn(&ClothState, &Path) -> Result<Vec<PathBuf>, Failure>;

/// Chooses the format by the output's extension.
fn writer(path: &Path) -> Result<Writer, Failure> {
    if ends_in(path, "npy") {
        return Ok(positions);
    }
    if ends_in(path, "obj") {
        return Ok(mesh);
    }
    Err(Failure::usage(format!(
        "`-o {}` has no known ending; write `.npy` for positions, `.obj` for a mesh",
        path.display()
    )))
}

/// Writes positions, and beside them the description that makes them usable as a start.
fn positions(state: &ClothState, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let beside = path.with_extension("json");
    if beside.symlink_metadata().is_ok() && !files::is_made_by(MADE_BY, &beside) {
        return Err(Failure::environment(format!(
            "`{}` is there already and was not written by `{MADE_BY}`; name another file than `{}`",
            beside.display(),
            path.display()
        )));
    }
    let description = files::description(&state.grid, &state.mask, MADE_BY);
    write_file(path, &npy::encode(&state.positions))?;
    write_file(&beside, &files::json_bytes(&description))?;
    Ok(vec![path.to_owned(), beside])
}

/// Writes the cloth's triangles as a Wavefront file.
fn mesh(state: &ClothState, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let text = fab_sim::mesh::obj(&state.mask, &state.positions).map_err(Failure::environment)?;
    write_file(path, text.as_bytes())?;
    Ok(vec![path.to_owned()])
}

//! `fabc sim export`: writes positions or a mesh for other programs, in the world frame.

use super::files::{self, StateArguments};
use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use clap::{Args, ValueHint};
use fab_base::files::ends_in;
use fab_sim::{Params, mesh};
use serde_json::json;
use std::path::PathBuf;

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

pub fn run(arguments: &ExportArguments, io: &Io) -> Result<Exit, Failure> {
    let (path, input) = (&arguments.out, &arguments.state.file);
    let is_mesh = ends_in(path, "obj");
    if !is_mesh && !ends_in(path, "npy") {
        return Err(Failure::usage(format!(
            "`-o {}` has no known ending; write `.npy` for positions, `.obj` for a mesh",
            path.display()
        )));
    }
    let (state, mask) = files::read_state(input, &arguments.state.frame)?;
    let mut written = vec![path.clone()];
    if is_mesh {
        write_file(path, mesh::obj(&mask, &state.positions)?.as_bytes())?;
    } else {
        // Positions in another frame would be misread where they were recorded.
        if path.canonicalize().ok() == Some(input.canonicalize()?) {
            return Err(Failure::usage(format!(
                "`-o {}` is the file that is read; name another one",
                path.display()
            )));
        }
        written.push(files::write_state(path, &state)?);
    }
    let (params, particles) = (Params::default().hash(), mask.count());
    let document = json!({ "params": params, "files": written, "particles": particles });
    io.either(arguments.json, &document, || {
        let files = written.iter().map(|file| file.display().to_string());
        files.collect::<Vec<_>>().join("\n")
    });
    Ok(Exit::Done)
}

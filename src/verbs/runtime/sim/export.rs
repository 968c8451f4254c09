//! `fabc sim export`: writes positions or a mesh for other programs, in the world frame.

use super::files::{self, StateArguments};
use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::report::Report;
use clap::{Args, ValueHint};
use fab_base::files::ends_in;
use fab_sim::{Params, mesh};
use serde::Serialize;
use std::path::PathBuf;

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

/// The files that were written.
#[derive(Serialize)]
struct Exported {
    params: String,
    files: Vec<String>,
    particles: usize,
}

/// Writes positions, and lists the files.
pub fn run(arguments: &ExportArguments, io: &Io) -> Result<Exit, Failure> {
    let path = &arguments.out;
    let is_mesh = ends_in(path, "obj");
    if !is_mesh && !ends_in(path, "npy") {
        return Err(Failure::usage(format!(
            "`-o {}` has no known ending; write `.npy` for positions, `.obj` for a mesh",
            path.display()
        )));
    }
    let state = files::read_state(&arguments.state)?;
    files::not_onto_itself(&arguments.state.file, path)?;
    let mut written = vec![path.clone()];
    if is_mesh {
        let text = mesh::obj(&state.mask, &state.positions)?;
        write_file(path, text.as_bytes())?;
    } else {
        files::check_replaceable(path, MADE_BY)?;
        let description = files::Description::of(&state.grid, &state.mask, MADE_BY, ());
        written.push(files::write_positions(
            path,
            &state.positions,
            &description,
        )?);
    }
    let exported = Exported {
        params: Params::default().hash(),
        files: written.iter().map(|it| it.display().to_string()).collect(),
        particles: state.mask.count(),
    };
    io.result(arguments.json, &exported);
    Ok(Exit::Done)
}

impl Report for Exported {
    fn text(&self) -> String {
        self.files.join("\n")
    }
}

//! `fabc manual`: the manual pages of this command line, for packages.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use clap::{Args, ValueHint};
use std::path::PathBuf;

#[derive(Args)]
pub struct ManualArguments {
    /// The folder that gets the pages, `fabc.1` and one for each verb.
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: PathBuf,
}

pub fn run(arguments: &ManualArguments, io: &Io) -> Result<Exit, Failure> {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(crate::command(), folder))
        .map_err(|error| {
            Failure::environment(format!(
                "cannot write manual pages into `{}`: {error}",
                folder.display()
            ))
        })?;
    io.data(&folder.join("fabc.1").display().to_string());
    Ok(Exit::Done)
}

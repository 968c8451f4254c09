//! `fabc explain`: what diagnostics mean and what to do.

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use clap::Args;
use fab_compiler::diag::Code;
use fab_compiler::explain;
use std::path::Path;
use std::path::PathBuf;

/// Arguments of `explain`.
#[derive(Args)]
pub struct ExplainArguments {
    /// The code of a message, such as F0203; default: list all codes.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
    /// Write a page of Markdown for each code, and `index.md`, into this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "code")]
    pub pages: Option<PathBuf>,
}

/// Prints the explanation of one code or the list of all, or writes the pages of all.
pub fn run(arguments: &ExplainArguments, io: &Io) -> Result<Exit, Failure> {
    match (&arguments.code, &arguments.pages) {
        (Some(code), _) => io.data(explain::to_text(known(code)?).trim_end()),
        (None, Some(folder)) => write_pages(folder, io)?,
        (None, None) => io.data(explain::list().trim_end()),
    }
    Ok(Exit::Done)
}

fn known(code: &str) -> Result<Code, Failure> {
    Code::parse(code).ok_or_else(|| {
        Failure::usage(format!(
            "there is no diagnostic `{code}`; every diagnostic prints its code, such as `F0203`"
        ))
    })
}

fn write_pages(folder: &Path, io: &Io) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
    for (name, text) in explain::pages() {
        let path = folder.join(name);
        write_file(&path, text.as_bytes())?;
        io.data(&path.display().to_string());
    }
    Ok(())
}

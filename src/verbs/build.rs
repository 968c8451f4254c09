//! `fabc build`: writes tasks as files that other systems use without this command.

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::sources;
use clap::{Args, ValueEnum, ValueHint};
use fab_emit::Target;
use serde_json::json;
use std::fs;
use std::path::PathBuf;

#[derive(Args)]
pub struct BuildArguments {
    /// The file that declares the tasks, or the name of a shipped task.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: String,
    /// The folder that gets one folder per task.
    #[arg(short = 'o', long = "out", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,
    /// Only this task.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// What is written beside the prompts and the schema.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "program")]
    pub emit: Vec<EmitArgument>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// What `build` writes beside the prompts and the schema.
#[derive(Clone, Copy, ValueEnum)]
pub enum EmitArgument {
    /// program.json: the whole task as data, and the list of the other files.
    Program,
    /// verifier.rs: the checks as a Rust module without dependencies.
    Rust,
    /// verifier.py: the checks as a Python module without dependencies.
    Python,
}

pub fn run(arguments: &BuildArguments, io: &Io) -> Result<Exit, Failure> {
    let programs = sources::compile_tasks(&arguments.file, arguments.task.as_deref(), None, io)?;
    let targets = arguments.emit.iter().map(|it| match it {
        EmitArgument::Program => Target::Program,
        EmitArgument::Rust => Target::Rust,
        EmitArgument::Python => Target::Python,
    });
    let artifacts = fab_emit::emit(&programs, &targets.collect::<Vec<_>>())
        .map_err(|error| Failure::author(error.to_string(), json!([])))?;
    let mut files = Vec::new();
    for artifact in artifacts {
        let path = arguments.out.join(&artifact.path);
        let above = path.parent().unwrap_or(&arguments.out);
        // The message names the file, not its folder.
        fs::create_dir_all(above).map_err(|error| Failure::unwritable(&path, error))?;
        write_file(&path, artifact.text.as_bytes())?;
        files.push(path.display().to_string());
    }
    let document = json!({ "files": files });
    io.either(arguments.json, &document, || files.join("\n"));
    Ok(Exit::Done)
}

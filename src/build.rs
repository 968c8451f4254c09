//! `fabc build`: writes tasks as files that other systems use without this command.

use crate::cli::{BuildArguments, EmitArgument};
use crate::exit::{Exit, Failure};
use crate::{output, sources};
use fab_base::files;
use fab_emit::{self, Artifact, Target};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes every artefact whole, and lists the files.
pub fn run(arguments: &BuildArguments) -> Result<Exit, Failure> {
    let programs = sources::compile_tasks(&arguments.file, arguments.task.as_deref())?;
    let targets: Vec<Target> = arguments.emit.iter().map(|it| target(*it)).collect();
    let artifacts = fab_emit::emit(&programs, &targets)
        .map_err(|error| Failure::author(error.to_string(), json!([])))?;
    let mut files = Vec::with_capacity(artifacts.len());
    for artifact in &artifacts {
        files.push(write(&arguments.out, artifact)?);
    }
    let names: Vec<String> = files.iter().map(|it| it.display().to_string()).collect();
    if arguments.json {
        output::json(&json!({ "files": names }));
    } else {
        output::data(&names.join("\n"));
    }
    Ok(Exit::Done)
}

fn target(argument: EmitArgument) -> Target {
    match argument {
        EmitArgument::Program => Target::Program,
        EmitArgument::Rust => Target::Rust,
        EmitArgument::Python => Target::Python,
    }
}

/// Writes one file and the folders above it; returns its path.
fn write(folder: &Path, artifact: &Artifact) -> Result<PathBuf, Failure> {
    let path = folder.join(&artifact.path);
    let above = path.parent().unwrap_or(folder);
    let written = fs::create_dir_all(above)
        .and_then(|()| files::write_whole(&path, artifact.text.as_bytes()));
    match written {
        Ok(()) => Ok(path),
        Err(error) => Err(Failure::environment(format!(
            "cannot write `{}`: {error}",
            path.display()
        ))),
    }
}

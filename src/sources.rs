//! Reads `.fab` files from disk and compiles them.

use crate::cli::TaskArguments;
use crate::exit::Failure;
use crate::output;
use compiler::program::Program;
use compiler::{Compiled, LoadError, Loader, diag};
use serde_json::json;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// The largest source file that is read.
const MAX_BYTES: u64 = 1 << 20;

/// Gives the compiler files from disk, by their paths.
pub struct Disk;

impl Loader for Disk {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let wrong = |message: String| LoadError { message };
        let bytes = read_bounded(Path::new(name))
            .map_err(|why| wrong(format!("cannot read `{name}`: {why}")))?;
        String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            wrong(format!(
                "cannot read `{name}`: it is not UTF-8 text, byte {at} does not belong there"
            ))
        })
    }
}

/// Reads a regular file of at most [`MAX_BYTES`]; says why where that is not to be had.
pub fn read_bounded(path: &Path) -> Result<Vec<u8>, String> {
    let information = fs::metadata(path).map_err(|error| error.to_string())?;
    if information.is_dir() {
        return Err("it is a directory, and a file is wanted".to_owned());
    }
    // A device or a pipe has no length to ask for and may have no end.
    if !information.is_file() {
        return Err("it is no regular file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| error.to_string())?;
    let read = file.take(MAX_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("it is longer than {MAX_BYTES} bytes"));
    }
    Ok(bytes)
}

/// Compiles a file.
pub fn compile(file: &str) -> Result<Compiled, Failure> {
    compiler::compile(file, &Disk).map_err(|error| Failure::environment(error.message))
}

/// Compiles a file and returns the task to work on, after showing what is wrong with the file.
///
/// A task has to be named where the file declares several; without a variant it is the task itself.
pub fn compile_task(wanted: &TaskArguments) -> Result<Program, Failure> {
    let file = &wanted.file;
    let compiled = compile(file)?;
    if !compiled.diagnostics.is_empty() {
        output::talk(
            diag::to_text(
                &compiled.diagnostics,
                &compiled.sources,
                output::talk_color(),
            )
            .trim_end(),
        );
    }
    if compiled.has_errors() {
        let diagnostics = diag::to_json(&compiled.diagnostics, &compiled.sources);
        return Err(Failure::author(
            format!("`{file}` cannot be compiled"),
            diagnostics,
        ));
    }
    let (tasks, variants): (Vec<Program>, Vec<Program>) = compiled
        .programs
        .into_iter()
        .partition(|program| program.variant.is_none());
    let names = quoted(tasks.iter().map(|program| program.task.as_str()));
    let chosen = match (&wanted.task, tasks.len()) {
        (Some(task), _) => tasks
            .into_iter()
            .find(|program| program.task == *task)
            .ok_or_else(|| {
                Failure::usage(format!(
                    "`{file}` declares no runnable task `{task}`; it declares {names}"
                ))
            }),
        (None, 0) => Err(Failure::author(
            format!(
                "`{file}` declares no task that can run: one needs at least a cloth, a camera, actions, stages, and subgoals or a horizon, its own or from the task it extends"
            ),
            json!([]),
        )),
        (None, 1) => tasks
            .into_iter()
            .next()
            .ok_or_else(|| Failure::usage(format!("`{file}` declares no task"))),
        (None, _) => Err(Failure::usage(format!(
            "`{file}` declares several tasks; choose one with `--task`: {names}"
        ))),
    }?;
    let Some(variant) = &wanted.variant else {
        return Ok(chosen);
    };
    let own: Vec<Program> = variants
        .into_iter()
        .filter(|program| program.task == chosen.task)
        .collect();
    let names = quoted(own.iter().filter_map(|program| program.variant.as_deref()));
    own.into_iter()
        .find(|program| program.variant.as_ref() == Some(variant))
        .ok_or_else(|| {
            let there = if names.is_empty() {
                "it has none".to_owned()
            } else {
                format!("it has {names}")
            };
            Failure::usage(format!(
                "`{}` has no variant `{variant}`; {there}",
                chosen.task
            ))
        })
}

fn quoted<'n>(names: impl Iterator<Item = &'n str>) -> String {
    names
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(", ")
}

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

/// Compiles a file and returns its tasks with their variants, or those of the one that is wanted; at least one.
pub fn compile_tasks(file: &str, wanted: Option<&str>) -> Result<Vec<Program>, Failure> {
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
    let mut programs = compiled.programs;
    if programs.is_empty() {
        return Err(Failure::author(
            format!(
                "`{file}` declares no task that can run: one needs at least a cloth, a camera, actions, stages, and subgoals or a horizon, its own or from the task it extends"
            ),
            json!([]),
        ));
    }
    if let Some(wanted) = wanted {
        let names = quoted(tasks(&programs).map(|program| program.task.as_str()));
        programs.retain(|program| program.task == wanted);
        if programs.is_empty() {
            return Err(Failure::usage(format!(
                "`{file}` declares no runnable task `{wanted}`; it declares {names}"
            )));
        }
    }
    Ok(programs)
}

/// Compiles a file and returns the task to work on, after showing what is wrong with the file.
///
/// A task has to be named where the file declares several; without a variant it is the task itself.
pub fn compile_task(wanted: &TaskArguments) -> Result<Program, Failure> {
    let programs = compile_tasks(&wanted.file, wanted.task.as_deref())?;
    if tasks(&programs).count() > 1 {
        return Err(Failure::usage(format!(
            "`{}` declares several tasks; choose one with `--task`: {}",
            wanted.file,
            quoted(tasks(&programs).map(|program| program.task.as_str()))
        )));
    }
    let variants = quoted(programs.iter().filter_map(|it| it.variant.as_deref()));
    let mut programs = programs.into_iter();
    programs
        .find(|program| program.variant == wanted.variant)
        .ok_or_else(|| {
            let there = if variants.is_empty() {
                "there is none".to_owned()
            } else {
                format!("there is {variants}")
            };
            Failure::usage(format!(
                "`{}` has no variant `{}`; {there}",
                wanted.file,
                wanted.variant.as_deref().unwrap_or_default()
            ))
        })
}

fn tasks(programs: &[Program]) -> impl Iterator<Item = &Program> {
    programs.iter().filter(|program| program.variant.is_none())
}

fn quoted<'n>(names: impl Iterator<Item = &'n str>) -> String {
    names
        .map(|name| format!("`{name}`"))
        .collect::<Vec<_>>()
        .join(", ")
}

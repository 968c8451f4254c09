//! Reads `.fab` files from disk and compiles them.

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
/// `wanted` is needed where the file declares several tasks.
pub fn compile_task(file: &str, wanted: Option<&str>) -> Result<Program, Failure> {
    let mut programs = compile_tasks(file, wanted)?;
    if programs.len() > 1 {
        return Err(Failure::usage(format!(
            "`{file}` declares several tasks; choose one with `--task`: {}",
            titles(&programs)
        )));
    }
    Ok(programs.swap_remove(0))
}

/// Compiles a file and returns its tasks, or the one that is wanted with all its variants; at least one.
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
    if programs.is_empty() && wanted.is_none() {
        return Err(Failure::author(
            format!(
                "`{file}` declares no task that can run: one needs at least a cloth, subgoals, actions and stages, its own or from the task it extends"
            ),
            json!([]),
        ));
    }
    if let Some(wanted) = wanted {
        let declared = titles(&programs);
        programs.retain(|program| program.task == wanted);
        if programs.is_empty() {
            return Err(Failure::usage(format!(
                "`{file}` declares no runnable task `{wanted}`; it declares {declared}"
            )));
        }
    }
    Ok(programs)
}

fn titles(programs: &[Program]) -> String {
    let titles: Vec<String> = programs
        .iter()
        .map(|program| format!("`{}`", program.title()))
        .collect();
    titles.join(", ")
}

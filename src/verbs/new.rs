//! `fabc new`: writes a commented task that runs at once with the libraries that it uses, or the shipped libraries alone.
//!
//! In: a name, and pictures if a fold is drafted from them. Out: files, which were compiled before any was written, and
//! the next steps. `fab_agent::draft` finds what the pictures show.

mod names;
#[cfg_attr(feature = "runtime", path = "new/with_simulator.rs")]
#[cfg_attr(not(feature = "runtime"), path = "new/without_simulator.rs")]
pub mod simulator;
pub mod staging;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::shipped;
use crate::sources;
use clap::{Args, Subcommand, ValueHint};
use fab_compiler::{LoadError, Loader};
use fab_program::Program;
use serde_json::json;
use staging::Staging;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Arguments of `new`.
#[derive(Args)]
pub struct NewArguments {
    /// What to begin.
    #[command(subcommand)]
    pub what: NewVerb,
}

/// What to begin.
#[derive(Subcommand)]
pub enum NewVerb {
    /// Writes a folding task that runs at once, with comments that say how to change it.
    Fold(NewFoldArguments),
    /// Writes a smoothing task that runs at once, with comments that say how to change it.
    Smoothing(NewTaskArguments),
    /// Copies the shipped libraries, and shipped tasks to extend, beside your own tasks.
    Library(LibraryArguments),
}

/// Arguments of `new library`.
#[derive(Args)]
pub struct LibraryArguments {
    /// Shipped tasks that are copied too, with their pictures and demonstrations.
    #[arg(value_name = "TASK")]
    pub tasks: Vec<String>,
    /// The folder that gets `lib` and the tasks; default: the current one.
    #[arg(long = "in", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `new fold`.
#[derive(Args)]
pub struct NewFoldArguments {
    #[command(flatten)]
    pub task: NewTaskArguments,
    #[command(flatten)]
    pub pictures: simulator::PictureArguments,
}

/// Where a new task goes.
#[derive(Args)]
pub struct NewTaskArguments {
    /// The task's name: letters, digits and `_`; the file is NAME.fab.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The folder that gets the file; default: the current one.
    #[arg(long = "in", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// A shipped library file, as its path relative to the task.
type Library = &'static str;

const FOLDING: Library = "lib/folding.fab";
const SMOOTHING: Library = "lib/smoothing.fab";

/// A task that is not written yet.
pub struct Draft {
    /// The text of its file.
    text: String,
    /// The library that it uses.
    library: Library,
    /// The user's pictures to copy beside it, with their paths there.
    pictures: Vec<(PathBuf, Vec<u8>)>,
    /// What had to be guessed.
    guesses: Vec<String>,
    /// Next steps for the user, in order.
    next: Vec<String>,
}

/// Writes the task, and prints the next steps.
pub fn run(arguments: &NewArguments, io: &Io) -> Result<Exit, Failure> {
    match &arguments.what {
        NewVerb::Fold(arguments) => fold(arguments, io),
        NewVerb::Smoothing(arguments) => {
            let draft = Draft::of(include_str!("new/smoothing.fab"), SMOOTHING, arguments);
            begin(arguments, draft, io)
        }
        NewVerb::Library(arguments) => library(arguments, io),
    }
}

/// Copies what is not there yet; a file of another content stays as it is, and is named.
fn library(arguments: &LibraryArguments, io: &Io) -> Result<Exit, Failure> {
    let folder = arguments.folder.clone().unwrap_or_default();
    let mut wanted: Vec<(&str, &[u8])> = shipped::libraries().collect();
    let tasks: BTreeSet<&String> = arguments.tasks.iter().collect();
    for task in tasks {
        wanted.extend(shipped::task_files(task)?);
    }
    let unwritable = |error: std::io::Error| {
        let folder = shown(&folder);
        Failure::environment(format!(
            "nothing is written, since `{folder}` takes no files: {error}"
        ))
    };
    let mut staging = Staging::begin(&folder, "library").map_err(unwritable)?;
    let (mut written, mut kept) = (Vec::new(), Vec::new());
    for (path, bytes) in wanted {
        let place = folder.join(path);
        if place.symlink_metadata().is_err() {
            staging.write(Path::new(path), bytes).map_err(unwritable)?;
            written.push(shown(&place));
        } else if !std::fs::read(&place).is_ok_and(|present| present == bytes) {
            kept.push(shown(&place));
        }
    }
    staging.commit().map_err(unwritable)?;
    if arguments.json {
        io.json(&json!({ "files": written, "kept": kept }));
        return Ok(Exit::Done);
    }
    for place in kept {
        io.talk(&format!(
            "note: `{place}` differs from the shipped version, and stays as it is"
        ));
    }
    match written.is_empty() {
        true => io.talk("nothing is missing"),
        false => io.data(&written.join("\n")),
    }
    Ok(Exit::Done)
}

fn fold(arguments: &NewFoldArguments, io: &Io) -> Result<Exit, Failure> {
    let task = &arguments.task;
    // Checked before looking at the pictures, which takes a while.
    check_place(task)?;
    let draft = match simulator::draft(arguments, io)? {
        Some(draft) => draft,
        None => Draft::of(include_str!("new/fold.fab"), FOLDING, task),
    };
    begin(task, draft, io)
}

impl Draft {
    /// Fills the task's name into a template.
    fn of(template: &str, library: Library, arguments: &NewTaskArguments) -> Draft {
        let file = shown(&file_of(arguments));
        Draft {
            text: template.replace("@NAME@", &arguments.name),
            library,
            pictures: Vec::new(),
            guesses: Vec::new(),
            next: simulator::NEXT
                .map(|verb| format!("fabc {verb} {file}"))
                .to_vec(),
        }
    }
}

/// Compiles the draft, draws its pictures, and writes everything.
fn begin(arguments: &NewTaskArguments, draft: Draft, io: &Io) -> Result<Exit, Failure> {
    check_place(arguments)?;
    let folder = folder_of(arguments);
    let path = draft.library;
    let shipped = shipped::text(path);
    let present = present_library(&folder, path)?;
    let library = present.as_deref().unwrap_or(shipped);
    let program = compile(arguments, &draft, library, io)?;
    let drawn = simulator::Drawn::of(&program, io)?;
    let unwritable = |error: std::io::Error| {
        Failure::environment(format!(
            "nothing is written, since `{}` takes no files: {error}",
            shown(&folder)
        ))
    };
    let mut staging = Staging::begin(&folder, &arguments.name).map_err(unwritable)?;
    let mut files = Vec::new();
    match present {
        Some(text) if text != shipped => io.talk(&format!(
            "note: `{}` differs from the shipped version; the new task uses your version",
            shown(&folder.join(path))
        )),
        Some(_) => {}
        None => {
            let written = staging.write(Path::new(path), shipped.as_bytes());
            written.map_err(unwritable)?;
            files.push(PathBuf::from(path));
        }
    }
    for (path, _) in &draft.pictures {
        let place = folder.join(path);
        if place.symlink_metadata().is_ok() {
            return Err(Failure::environment(format!(
                "`{}` already exists; choose another name, or remove it",
                shown(&place)
            )));
        }
    }
    for (path, bytes) in &draft.pictures {
        staging.write(path, bytes).map_err(unwritable)?;
        files.push(path.clone());
    }
    files.extend(drawn.stage(&program, &mut staging)?);
    let file = PathBuf::from(format!("{}.fab", arguments.name));
    let written = staging.write(&file, draft.text.as_bytes());
    written.map_err(unwritable)?;
    files.insert(0, file);
    staging.commit().map_err(unwritable)?;
    let files = files.iter().map(|file| shown(&folder.join(file)));
    report(arguments, files.collect(), &draft, io);
    Ok(Exit::Done)
}

/// Rejects invalid names and existing files before any work is done.
fn check_place(arguments: &NewTaskArguments) -> Result<(), Failure> {
    names::check(&arguments.name)?;
    let folder = folder_of(arguments);
    if folder.is_file() {
        return Err(Failure::environment(format!(
            "`{}` is a file; --in takes a folder",
            shown(&folder)
        )));
    }
    for ending in ["fab", "subgoals"] {
        let place = folder_of(arguments).join(format!("{}.{ending}", arguments.name));
        if place.symlink_metadata().is_ok() {
            return Err(Failure::environment(format!(
                "`{}` already exists; choose another name, or another folder with `--in DIR`",
                shown(&place)
            )));
        }
    }
    Ok(())
}

/// Returns the text of the library if the folder already has it.
fn present_library(folder: &Path, path: &str) -> Result<Option<String>, Failure> {
    let place = folder.join(path);
    if place.symlink_metadata().is_err() {
        return Ok(None);
    }
    let wrong = |why: String| {
        Failure::environment(format!(
            "the new task needs `{}`, and it cannot be used: {why}; choose another folder with `--in DIR`",
            shown(&place)
        ))
    };
    let real = sources::inside(folder, &place).map_err(wrong)?;
    sources::read_text(&real).map(Some).map_err(wrong)
}

/// A loader that finds the draft as if it were already written.
struct DraftOverDisk<'d>(BTreeMap<&'d str, &'d str>);

impl Loader for DraftOverDisk<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let text = self.0.get(name).ok_or_else(|| LoadError {
            message: format!("cannot read `{name}`: it is not part of the new task"),
        })?;
        Ok((*text).to_owned())
    }
}

fn compile(
    arguments: &NewTaskArguments,
    draft: &Draft,
    library: &str,
    io: &Io,
) -> Result<Program, Failure> {
    let entry = format!("{}.fab", arguments.name);
    let files = DraftOverDisk(BTreeMap::from([
        (entry.as_str(), draft.text.as_str()),
        (draft.library, library),
    ]));
    let mut compiled = fab_compiler::compile(&entry, &files).map_err(Failure::environment)?;
    if compiled.has_errors() || compiled.programs.is_empty() {
        let path = draft.library;
        // Every name that the language allows compiles, except names that the library uses for its own tasks.
        if library == shipped::text(path) {
            let name = &arguments.name;
            return Err(Failure::usage(format!(
                "`{name}` cannot name a task: `{path}` has one of this name; `my_{name}` would be right"
            )));
        }
        io.painted_talk(&sources::findings(&compiled, io.talk_color()));
        return Err(Failure::environment(format!(
            "nothing is written, since the new task would not compile with `{path}`, which is not as fabc ships it; \
             choose another folder with `--in DIR`"
        )));
    }
    Ok(compiled.programs.swap_remove(0))
}

fn report(arguments: &NewTaskArguments, files: Vec<String>, draft: &Draft, io: &Io) {
    if arguments.json {
        io.json(&json!({ "files": files, "guesses": draft.guesses, "next": draft.next }));
        return;
    }
    for guess in &draft.guesses {
        io.talk(&format!("guessed: {guess}"));
    }
    io.data(&files.join("\n"));
    let next = draft.next.iter().map(|command| format!("\n  {command}"));
    io.talk(&format!("next:{}", next.collect::<String>()));
}

fn folder_of(arguments: &NewTaskArguments) -> PathBuf {
    arguments.folder.clone().unwrap_or_default()
}

fn file_of(arguments: &NewTaskArguments) -> PathBuf {
    folder_of(arguments).join(format!("{}.fab", arguments.name))
}

fn shown(path: &Path) -> String {
    match path.as_os_str().is_empty() {
        true => ".".to_owned(),
        false => path.display().to_string(),
    }
}

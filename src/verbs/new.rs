//! `fabc new`: writes a commented task that runs at once with the libraries that it uses, or the shipped libraries alone.
//!
//! In: a name, and pictures if a fold is drafted from them. Out: files, which were compiled before any was written, and
//! the next steps. `fab_agent::draft` finds what the pictures show.

#[cfg(feature = "runtime")]
pub mod simulator;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::report::Report;
use crate::shipped;
use crate::sources;
use clap::{Args, Subcommand, ValueHint};
use fab_compiler::{LoadError, Loader};
use fab_program::Program;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
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
    #[cfg(feature = "runtime")]
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

impl NewTaskArguments {
    fn folder(&self) -> PathBuf {
        self.folder.clone().unwrap_or_default()
    }

    fn file(&self) -> PathBuf {
        self.folder().join(format!("{}.fab", self.name))
    }
}

/// A shipped library file, as its path relative to the task.
type Library = &'static str;

const FOLDING: Library = "lib/folding.fab";
const SMOOTHING: Library = "lib/smoothing.fab";

/// What a comment begins with that says what had to be guessed; such comments are printed, too.
const GUESSED: &str = "# guessed: ";

/// The verbs to suggest next.
const NEXT: [&str; 3] = if cfg!(feature = "runtime") {
    ["render", "test", "run"]
} else {
    ["check", "render", "test"]
};

/// A task that is not written yet.
pub struct Draft {
    /// The text of its file.
    text: String,
    /// The library that it uses.
    library: Library,
    /// The user's pictures to copy beside it, with their paths there.
    pictures: Vec<(PathBuf, Vec<u8>)>,
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
    let mut wanted: Vec<_> = shipped::libraries().collect();
    let tasks: BTreeSet<&String> = arguments.tasks.iter().collect();
    for task in tasks {
        wanted.extend(shipped::task_files(task)?);
    }
    let mut copied = Copied::default();
    for (path, bytes) in wanted {
        copied.add(folder.join(path), bytes, io)?;
    }
    if copied.files.is_empty() {
        io.talk("nothing is missing");
    }
    io.result(arguments.json, &copied);
    Ok(Exit::Done)
}

/// The copied files, and those that were there with another content.
#[derive(Default, Serialize)]
struct Copied {
    files: Vec<String>,
    kept: Vec<String>,
}

impl Copied {
    /// Writes a shipped file unless it is there; one of another content stays as it is, and is named.
    fn add(&mut self, place: PathBuf, bytes: &[u8], io: &Io) -> Result<(), Failure> {
        let name = shown(&place);
        if place.symlink_metadata().is_err() {
            write(&place, bytes)?;
            self.files.push(name);
        } else if !fs::read(&place).is_ok_and(|present| present == bytes) {
            io.talk(&format!(
                "note: `{name}` differs from the shipped version, and stays as it is"
            ));
            self.kept.push(name);
        }
        Ok(())
    }
}

impl Report for Copied {
    fn text(&self) -> String {
        self.files.join("\n")
    }
}

fn fold(arguments: &NewFoldArguments, io: &Io) -> Result<Exit, Failure> {
    let task = &arguments.task;
    #[cfg(feature = "runtime")]
    if !arguments.pictures.from_images.is_empty() {
        // Checked before looking at the pictures, which takes a while.
        check_place(task)?;
        return begin(task, simulator::draft(arguments, io)?, io);
    }
    let draft = Draft::of(include_str!("new/fold.fab"), FOLDING, task);
    begin(task, draft, io)
}

impl Draft {
    /// Fills the task's name into a template.
    fn of(template: &str, library: Library, arguments: &NewTaskArguments) -> Draft {
        let file = shown(&arguments.file());
        Draft {
            text: template.replace("@NAME@", &arguments.name),
            library,
            pictures: Vec::new(),
            next: NEXT.map(|verb| format!("fabc {verb} {file}")).to_vec(),
        }
    }

    /// Returns what had to be guessed, as its comments say.
    fn guesses(&self) -> Vec<&str> {
        let lines = self.text.lines();
        let guesses = lines.filter_map(|line| line.trim_start().strip_prefix(GUESSED));
        guesses.collect()
    }
}

/// Compiles the draft, draws its pictures, and writes everything, file by file.
fn begin(arguments: &NewTaskArguments, draft: Draft, io: &Io) -> Result<Exit, Failure> {
    check_place(arguments)?;
    let folder = arguments.folder();
    let library = folder.join(draft.library);
    let shipped = shipped::text(draft.library);
    let present = present_library(&library)?;
    let program = compile(arguments, &draft, present.as_deref().unwrap_or(shipped), io)?;
    #[cfg(feature = "runtime")]
    let drawn = simulator::demonstrated(&program, io)?;
    #[cfg(not(feature = "runtime"))]
    if program.subgoals.is_some() {
        io.talk("note: no subgoal pictures are drawn, since this build of fabc has no simulator");
    }
    for (path, _) in &draft.pictures {
        refuse_if_there(&folder.join(path), "choose another name, or remove it")?;
    }
    let mut copied = Copied::default();
    copied.add(library, shipped.as_bytes(), io)?;
    let mut files = vec![shown(&arguments.file())];
    files.extend(copied.files);
    for (path, bytes) in &draft.pictures {
        let place = folder.join(path);
        write(&place, bytes)?;
        files.push(shown(&place));
    }
    #[cfg(feature = "runtime")]
    if let Some((drawn, parameters)) = drawn {
        let drawn = drawn.pin(&program, &folder, &parameters)?;
        files.extend(drawn.iter().map(|file| shown(file)));
    }
    // Last, so that there is no task without what it uses.
    write(&arguments.file(), draft.text.as_bytes())?;
    let begun = Begun {
        files,
        guesses: draft.guesses(),
        next: &draft.next,
    };
    io.result(arguments.json, &begun);
    if !arguments.json {
        for guess in begun.guesses {
            io.talk(&format!("guessed: {guess}"));
        }
        io.talk(&format!("next:\n  {}", draft.next.join("\n  ")));
    }
    Ok(Exit::Done)
}

/// The files of a new task.
#[derive(Serialize)]
struct Begun<'d> {
    files: Vec<String>,
    guesses: Vec<&'d str>,
    next: &'d [String],
}

impl Report for Begun<'_> {
    fn text(&self) -> String {
        self.files.join("\n")
    }
}

/// Writes a file and the folders above it.
fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|error| Failure::unwritable(folder, error))?;
    }
    write_file(path, bytes)
}

/// Rejects invalid names and existing files before any work is done.
fn check_place(arguments: &NewTaskArguments) -> Result<(), Failure> {
    check_name(&arguments.name)?;
    let folder = arguments.folder();
    for ending in ["fab", "subgoals"] {
        refuse_if_there(
            &folder.join(format!("{}.{ending}", arguments.name)),
            "choose another name, or another folder with `--in DIR`",
        )?;
    }
    Ok(())
}

fn check_name(name: &str) -> Result<(), Failure> {
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let begins_with_digit = name.starts_with(|first: char| first.is_ascii_digit());
    let why = if fab_compiler::is_keyword(name) {
        "the language uses this word itself"
    } else if name.is_empty() || begins_with_digit || !name.chars().all(is_part) {
        "one begins with a letter or `_`, and continues with letters, digits and `_`, without accents"
    } else if name.len() > 190 {
        // A word has at most 200 letters, and `NAME_folds` is one too.
        "a name has at most 190 letters"
    } else {
        return Ok(());
    };
    let name = name.escape_debug();
    Err(Failure::usage(format!(
        "`{name}` cannot name a task: {why}"
    )))
}

fn refuse_if_there(place: &Path, advice: &str) -> Result<(), Failure> {
    if place.symlink_metadata().is_err() {
        return Ok(());
    }
    let place = shown(place);
    Err(Failure::environment(format!(
        "`{place}` already exists; {advice}"
    )))
}

/// Returns the text of the library if the folder already has it.
fn present_library(place: &Path) -> Result<Option<String>, Failure> {
    if place.symlink_metadata().is_err() {
        return Ok(None);
    }
    sources::read_text(place).map(Some).map_err(|why| {
        Failure::environment(format!(
            "the new task needs `{}`, and it cannot be used: {why}; choose another folder with `--in DIR`",
            shown(place)
        ))
    })
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
    let mut compiled = fab_compiler::compile(&entry, &files)?;
    if compiled.has_errors() || compiled.programs.is_empty() {
        let path = draft.library;
        // Every name that the language allows compiles, except names that the library uses for its own tasks.
        if library == shipped::text(path) {
            let name = &arguments.name;
            return Err(Failure::usage(format!(
                "`{name}` cannot name a task: `{path}` has one of this name"
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

fn shown(path: &Path) -> String {
    if path.as_os_str().is_empty() {
        ".".to_owned()
    } else {
        path.display().to_string()
    }
}

//! `fabc new`: writes a commented task that runs at once with the libraries that it uses, or the shipped libraries alone.
//!
//! In: a name, and pictures if a fold is drafted from them. Out: files, which were compiled before any was written, and
//! the next steps. `fab_agent::draft` finds what the pictures show.

#[cfg(feature = "runtime")]
pub mod simulator;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::shipped;
use crate::sources::{self, Texts};
use clap::{Args, Subcommand, ValueHint};
use fab_program::Program;
use serde::Serialize;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

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

/// The shipped libraries that new tasks use, relative to the task.
const FOLDING: &str = "lib/folding.fab";
const SMOOTHING: &str = "lib/smoothing.fab";

/// What a comment begins with that says what had to be guessed; such comments are printed, too.
const GUESSED: &str = "# guessed: ";

const NEXT: [&str; 3] = if cfg!(feature = "runtime") {
    ["render", "test", "run"]
} else {
    ["check", "render", "test"]
};

/// A task that is not written yet.
pub struct Draft {
    text: String,
    library: &'static str,
    /// The user's pictures to copy beside it, with their paths there.
    pictures: Vec<(PathBuf, Vec<u8>)>,
    next: Vec<String>,
}

pub fn run(verb: &NewVerb, io: &Io) -> Result<Exit, Failure> {
    let (task, draft) = match verb {
        NewVerb::Library(arguments) => return library(arguments, io),
        NewVerb::Smoothing(task) => (
            task,
            Draft::of(include_str!("new/smoothing.fab"), SMOOTHING, task),
        ),
        #[cfg(feature = "runtime")]
        NewVerb::Fold(arguments) if !arguments.pictures.from_images.is_empty() => {
            // Checked before looking at the pictures, which takes a while.
            check_place(&arguments.task)?;
            (&arguments.task, simulator::draft(arguments, io)?)
        }
        NewVerb::Fold(NewFoldArguments { task, .. }) => {
            (task, Draft::of(include_str!("new/fold.fab"), FOLDING, task))
        }
    };
    begin(task, draft, io)
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
    io.either(arguments.json, &copied, || copied.files.join("\n"));
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

impl Draft {
    fn of(template: &str, library: &'static str, arguments: &NewTaskArguments) -> Draft {
        let file = shown(&arguments.file());
        Draft {
            text: template.replace("@NAME@", &arguments.name),
            library,
            pictures: Vec::new(),
            next: NEXT.map(|verb| format!("fabc {verb} {file}")).to_vec(),
        }
    }
}

/// Compiles the draft, draws its pictures, and writes everything, file by file.
fn begin(arguments: &NewTaskArguments, draft: Draft, io: &Io) -> Result<Exit, Failure> {
    check_place(arguments)?;
    let folder = arguments.folder();
    let library = folder.join(draft.library);
    let shipped = shipped::text(draft.library);
    let present = match library.symlink_metadata() {
        Err(_) => shipped.to_owned(),
        Ok(_) => sources::read_text(&library).map_err(|why| {
            Failure::environment(format!(
                "the new task needs `{}`, and it cannot be used: {why}; choose another folder with `--in DIR`",
                shown(&library)
            ))
        })?,
    };
    let program = compile(arguments, &draft, &present, io)?;
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
    let lines = draft.text.lines();
    let guesses = lines.filter_map(|line| line.trim_start().strip_prefix(GUESSED));
    let (guesses, next) = (guesses.collect::<Vec<_>>(), &draft.next);
    let document = json!({ "files": files, "guesses": guesses, "next": next });
    io.either(arguments.json, &document, || files.join("\n"));
    if !arguments.json {
        for guess in guesses {
            io.talk(&format!("guessed: {guess}"));
        }
        io.talk(&format!("next:\n  {}", next.join("\n  ")));
    }
    Ok(Exit::Done)
}

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
    let advice = "choose another name, or another folder with `--in DIR`";
    for ending in ["fab", "subgoals"] {
        refuse_if_there(&folder.join(format!("{}.{ending}", arguments.name)), advice)?;
    }
    Ok(())
}

fn check_name(name: &str) -> Result<(), Failure> {
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let begins_with_digit = name.starts_with(|first: char| first.is_ascii_digit());
    let is_word = !begins_with_digit && name.chars().all(is_part);
    // A word has at most 200 letters, and `NAME_folds` is one too.
    if is_word && (1..=190).contains(&name.len()) && !fab_compiler::is_keyword(name) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "`{}` cannot name a task: a name begins with a letter or `_`, continues with letters, digits and `_`, without \
         accents, up to 190 of them, and is no word of the language",
        name.escape_debug()
    )))
}

fn refuse_if_there(place: &Path, advice: &str) -> Result<(), Failure> {
    if place.symlink_metadata().is_err() {
        return Ok(());
    }
    let why = format!("`{}` already exists; {advice}", shown(place));
    Err(Failure::environment(why))
}

fn compile(
    arguments: &NewTaskArguments,
    draft: &Draft,
    library: &str,
    io: &Io,
) -> Result<Program, Failure> {
    let entry = format!("{}.fab", arguments.name);
    let files = Texts(BTreeMap::from([
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

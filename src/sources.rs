//! Reads `.fab` files from disk and compiles them.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use clap::{Args, ValueHint};
use fab_base::kinds::without_mark;
use fab_base::wording::quoted;
use fab_base::{files, npy};
use fab_compiler::{Compiled, Listed, LoadError, Loader, Wanted, diag};
#[cfg(feature = "runtime")]
use fab_program::Material;
use fab_program::{PINS_FILE, Program, Trial, pins_folder};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

#[derive(Args, Clone, Debug, Serialize, Deserialize)]
pub struct TaskArguments {
    /// The file that declares the task, or the name of a shipped task.
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: String,
    /// The task, where the file declares several.
    #[arg(long, value_name = "NAME")]
    pub task: Option<String>,
    /// The variant of the task; default: the task itself.
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
}

/// The largest source file that is read, bytes.
const MAX_BYTES: u64 = 1 << 22;

/// Loads one file from disk, which may be a link to elsewhere, and files that are really in its folder or in `lib` beside it.
pub struct Disk {
    entry: String,
    folder: PathBuf,
}

impl Disk {
    /// Makes the loader for compiling `entry`, a path as the user wrote it.
    pub fn beside(entry: &str) -> Disk {
        Disk {
            entry: entry.to_owned(),
            folder: folder_of(entry),
        }
    }
}

/// A loader of texts that are in no file, by name.
pub struct Texts<'t>(pub BTreeMap<&'t str, &'t str>);

impl Loader for Texts<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let text = self.0.get(name).ok_or_else(|| LoadError {
            message: format!("cannot read `{name}`: there is no text of this name"),
        })?;
        Ok((*text).to_owned())
    }
}

impl Loader for Disk {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let path = Path::new(name);
        let found = if name == self.entry {
            Ok(path.to_owned())
        } else {
            inside_or_library(&self.folder, path)
        };
        let bytes = found.and_then(|path| read_bounded(&path)).map_err(|why| {
            let nearby = match similar_file(path) {
                Some(meant) => format!("; did you mean `{meant}`?"),
                None => shipped::library_hint(path).unwrap_or_default(),
            };
            format!("{why}{nearby}")
        });
        bytes.and_then(files::text).map_err(|why| LoadError {
            message: format!("cannot read `{name}`: {why}"),
        })
    }
}

fn similar_file(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    if path.exists() {
        return None;
    }
    let here = Path::new(".").join(path.parent()?);
    let files = std::fs::read_dir(here).into_iter().flatten().flatten();
    let files = files.filter_map(|file| file.file_name().into_string().ok());
    let files: BTreeSet<String> = files.filter(|file| file.ends_with(".fab")).collect();
    diag::nearest(name, files.iter().map(String::as_str)).map(str::to_owned)
}

/// The largest file that a check looks into, bytes; as much as a start may have.
const MAX_LOOKED_AT: u64 = 64 << 20;

/// A loader that also looks into the files that tasks name, for `fabc check` alone, and remembers what was asked for.
struct Looking {
    disk: Disk,
    /// What was found, because each task that inherits a file asks again.
    found: RefCell<BTreeMap<(String, Wanted), Listed>>,
    /// The files that were asked for, including missing ones.
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl Looking {
    fn beside(file: &str) -> Looking {
        Looking {
            disk: Disk::beside(file),
            found: RefCell::default(),
            asked: RefCell::default(),
        }
    }

    /// Returns a path as seen from the working folder.
    fn ask(&self, path: impl AsRef<Path>) -> PathBuf {
        let path = self.disk.folder.join(path);
        self.asked.borrow_mut().insert(path.clone());
        path
    }
}

impl Loader for Looking {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        self.asked.borrow_mut().insert(name.into());
        self.disk.load(name)
    }

    fn look(&self, path: &str, wanted: Wanted) -> Listed {
        let file = self.ask(path);
        let mut found = self.found.borrow_mut();
        let found = found.entry((path.to_owned(), wanted)).or_insert_with(|| {
            let seen = listed(&self.disk.folder, &file, wanted);
            seen.unwrap_or_else(Listed::Nothing)
        });
        found.clone()
    }

    fn trial(&self, title: &str) -> Option<Trial> {
        self.ask(Path::new(&pins_folder(title)).join(PINS_FILE));
        pinned_trial(&self.disk.folder, title)
    }

    #[cfg(feature = "runtime")]
    fn refuses_cloth(&self, material: &Material, spacing_m: f64) -> Option<String> {
        let checked = fab_world::material(material).check(spacing_m as f32);
        checked.err().map(|error| error.to_string())
    }
}

#[derive(Deserialize)]
struct Tried {
    tried: Option<Trial>,
}

/// Returns what `fabc subgoals` found of a task's demonstration, if there is a file that can be read.
pub fn pinned_trial(folder: &Path, title: &str) -> Option<Trial> {
    let path = folder.join(pins_folder(title)).join(PINS_FILE);
    let path = inside(folder, &path).ok()?;
    files::read_json::<Tried>(&path, MAX_BYTES).ok()?.tried
}

/// Reads the file at a path in a folder as the kind of file that is wanted; says what it found.
fn listed(folder: &Path, path: &Path, wanted: Wanted) -> Result<Listed, String> {
    let bytes = files::read(&inside(folder, path)?, MAX_LOOKED_AT)?;
    match wanted {
        Wanted::CameraPicture | Wanted::Picture => picture(path, &bytes),
        Wanted::Positions => {
            let positions = npy::decode_positions(&bytes)?;
            if !positions.iter().flatten().all(|number| number.is_finite()) {
                return Err("a coordinate in it is not a number".to_owned());
            }
            Ok(Listed::Other)
        }
        Wanted::Demonstrations => are_json_lines(&bytes).map(|()| Listed::Other),
    }
}

/// Opens a picture as a rollout will.
#[cfg(feature = "runtime")]
fn picture(path: &Path, bytes: &[u8]) -> Result<Listed, String> {
    let named = format!("`{}`", path.display());
    let opened = fab_picture::png::opened(bytes, path);
    let opened = opened.map_err(|error| error.to_string().replacen(&named, "it", 1))?;
    let (width, height) = opened.dimensions();
    Ok(Listed::Picture { width, height })
}

/// The authoring tool opens no pictures.
#[cfg(not(feature = "runtime"))]
fn picture(_: &Path, _: &[u8]) -> Result<Listed, String> {
    Ok(Listed::Unknown)
}

/// Checks that bytes are lines with a JSON object each, the first of which states the format.
fn are_json_lines(bytes: &[u8]) -> Result<(), String> {
    let text = files::text(without_mark(bytes).to_vec())?;
    let mut states_format = false;
    let lines = (1..).zip(text.lines());
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let object: serde_json::Map<String, serde_json::Value> = serde_json::from_str(line)
            .map_err(|error| format!("line {number} is no JSON object: {error}"))?;
        states_format |= number == 1 && object.contains_key("format");
    }
    let fault = (!states_format).then(|| "its first line does not state a `format`".to_owned());
    fault.map_or(Ok(()), Err)
}

/// Compiles a file, and looks for the files that its tasks name.
pub fn compile_looking(file: &str) -> Result<Compiled, Failure> {
    Ok(fab_compiler::compile(file, &Looking::beside(file))?)
}

/// Returns a file of tasks and all files that it uses, including missing ones.
pub fn used_files(file: &str) -> BTreeSet<PathBuf> {
    let loader = Looking::beside(file);
    // What is wrong is for a verb to report.
    let _ = fab_compiler::compile(file, &loader);
    loader.asked.into_inner()
}

pub fn folder_of(file: &str) -> PathBuf {
    let folder = Path::new(file).parent();
    folder.map(Path::to_owned).unwrap_or_default()
}

/// Returns the real path of a file, links resolved; the error says why it is not inside `folder` (empty: the current one).
pub fn inside(folder: &Path, path: &Path) -> Result<PathBuf, String> {
    let real = |path: &Path| path.canonicalize().map_err(|error| error.to_string());
    let (folder, real) = (real(&Path::new(".").join(folder))?, real(path)?);
    if real.starts_with(&folder) {
        return Ok(real);
    }
    Err(format!(
        "it is at `{}`, outside the first file's folder `{}`",
        real.display(),
        folder.display()
    ))
}

/// Returns the real path of a file in `folder`, or in the folder `lib` beside it; the error says why it is elsewhere.
fn inside_or_library(folder: &Path, path: &Path) -> Result<PathBuf, String> {
    let found = inside(folder, path);
    if found.is_ok() {
        return found;
    }
    let above = folder.join("..");
    inside(&above.join("lib"), path).or(found)
}

/// Reads a text that people may have written, without its byte-order mark; the error says why it cannot.
pub fn read_text(path: &Path) -> Result<String, String> {
    files::read_text(path, MAX_BYTES)
}

/// Reads a regular file of at most [`MAX_BYTES`]; the error says why it cannot.
pub fn read_bounded(path: &Path) -> Result<Vec<u8>, String> {
    files::read(path, MAX_BYTES)
}

pub fn compile(file: &str) -> Result<Compiled, Failure> {
    Ok(fab_compiler::compile(file, &Disk::beside(file))?)
}

/// Formats diagnostics for people, and says how many are left out.
pub fn findings(compiled: &Compiled, color: diag::Color) -> String {
    let text = diag::to_text(&compiled.diagnostics, &compiled.sources, color);
    match compiled.left_out {
        0 => text.trim_end().to_owned(),
        count => format!("{}\n\n… and {count} beyond these", text.trim_end()),
    }
}

/// Compiles a file, again if for a cloth of another grid; returns its tasks with their variants, or only the `wanted` task.
pub fn compile_tasks(
    file: &str,
    wanted: Option<&str>,
    grid: Option<[u32; 2]>,
    io: &Io,
) -> Result<Vec<Program>, Failure> {
    let compiled = fab_compiler::compile_for(file, &Disk::beside(file), grid)?;
    // The warnings were shown when the file was compiled for its own cloth.
    let has_news = grid.is_none() && !compiled.diagnostics.is_empty();
    if has_news || compiled.has_errors() {
        io.painted_talk(&findings(&compiled, io.talk_color()));
    }
    if compiled.has_errors() {
        let diagnostics = diag::to_json(&compiled.diagnostics, &compiled.sources);
        let why = format!("`{file}` cannot be compiled");
        return Err(Failure::author(why, diagnostics));
    }
    let mut programs = compiled.programs;
    if programs.is_empty() {
        let why = format!(
            "`{file}` declares no task that can run: one needs at least a cloth, a camera, actions, stages, and subgoals or a horizon, its own or from the task it extends"
        );
        return Err(Failure::author(why, json!([])));
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

/// Compiles a file, shows its diagnostics, and returns the task to work on; it must be named if the file declares several.
pub fn compile_task(wanted: &TaskArguments, io: &Io) -> Result<Program, Failure> {
    let programs = compile_tasks(&wanted.file, wanted.task.as_deref(), None, io)?;
    chosen(programs, wanted)
}

/// Returns the task that is meant.
pub fn chosen(mut programs: Vec<Program>, wanted: &TaskArguments) -> Result<Program, Failure> {
    if tasks(&programs).count() > 1 {
        return Err(Failure::usage(format!(
            "`{}` declares several tasks; choose one with `--task`: {}",
            wanted.file,
            quoted(tasks(&programs).map(|program| program.task.as_str()))
        )));
    }
    let mut variants = programs.iter().map(|program| &program.variant);
    match variants.position(|variant| *variant == wanted.variant) {
        Some(at) => Ok(programs.swap_remove(at)),
        None => {
            let variant = wanted.variant.as_deref().unwrap_or_default();
            Err(Failure::usage(no_variant(&wanted.file, variant, &programs)))
        }
    }
}

/// Says which variants a file has, in place of one that it has not.
pub fn no_variant(file: &str, variant: &str, programs: &[Program]) -> String {
    let names = quoted(programs.iter().filter_map(|it| it.variant.as_deref()));
    let names = if names.is_empty() { "none" } else { &names };
    format!("`{file}` has no variant `{variant}`; there is {names}")
}

fn tasks(programs: &[Program]) -> impl Iterator<Item = &Program> {
    programs.iter().filter(|program| program.variant.is_none())
}

#[cfg(all(test, unix))]
mod tests;

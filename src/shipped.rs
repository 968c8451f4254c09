//! Finds tasks by name: `double_straight` means `double_straight.fab`, in one of several places.
//!
//! In: a word from the command line. Out: the path of a file. The search goes from the nearest place to the farthest:
//! the working folder, the folder named by `FABC_TASKS`, the installation's folder beside the program, and last the
//! tasks embedded in the program. Embedded tasks are written to the user's cache, in a folder named by the hash of
//! their contents, so that all other code reads them as files.

use crate::exit::Failure;
use crate::io::Io;
use fab_base::cache::Cache;
use fab_base::files;
use fab_base::wording::quoted;
use fab_compiler::diag::nearest;
use rust_embed::Embed;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The embedded tasks, with their libraries, pinned subgoal pictures and demonstrations; without snapshots, suites, tasks
/// that need an arm, the paper's folds of measured cloths, and tasks that rehearse. `include` in `Cargo.toml` says what
/// the package holds of them.
#[derive(Embed)]
#[folder = "tasks/"]
#[exclude = "snapshots/*"]
#[exclude = "suites/*"]
#[exclude = "real/*"]
#[exclude = "textiles/*"]
#[exclude = "rehearsed/*"]
#[exclude = "lib/rehearsed.fab"]
struct Embedded;

/// Each embedded file's path relative to `tasks/`, and its bytes.
static FILES: LazyLock<BTreeMap<Cow<'static, str>, Cow<'static, [u8]>>> = LazyLock::new(|| {
    let files = Embedded::iter();
    files
        .filter_map(|path| Some((path.clone(), Embedded::get(&path)?.data)))
        .collect()
});

/// A path relative to `tasks/`, and the bytes there.
type File = (&'static str, &'static [u8]);

/// Where an installation keeps the shipped tasks, relative to the parent of the program's folder.
const INSTALLED: &str = "share/fabc/tasks";

const VARIABLE: &str = "FABC_TASKS";

/// Returns the file that a word names; a word that cannot be a task name is returned unchanged.
pub fn find(word: &str, io: &Io) -> Result<String, Failure> {
    find_beside(Path::new(""), word, io)
}

/// Returns the file that a word in a file of `folder` names; that folder is searched instead of the working folder.
pub fn find_beside(folder: &Path, word: &str, io: &Io) -> Result<String, Failure> {
    let own = folder.join(word);
    let is_plain = |letter: char| letter.is_alphanumeric() || letter == '_';
    let is_name = !word.is_empty() && word.chars().all(is_plain);
    if !is_name || (own.exists() && !own.is_dir()) {
        return Ok(own.display().to_string());
    }
    let name = format!("{word}.fab");
    let found = |path: &Path, whose: &str| {
        let path = path.display().to_string();
        io.talk(&format!("task: {word}, {whose} ({path})"));
        path
    };
    let beside = own.with_extension("fab");
    if beside.is_file() {
        return Ok(found(&beside, "a file of this folder"));
    }
    let named = io.variable(VARIABLE).filter(|value| !value.is_empty());
    let places = [
        (named.map(PathBuf::from), "of FABC_TASKS"),
        (installed(), "shipped with fabc"),
    ];
    for (folder, whose) in places {
        let path = folder.map(|folder| folder.join(&name));
        if let Some(path) = path.filter(|path| path.is_file()) {
            return Ok(found(&path, whose));
        }
    }
    if FILES.contains_key(name.as_str()) {
        return Ok(found(&unpacked(io)?.join(&name), "shipped with fabc"));
    }
    let why = format!("there is no file `{name}`, and {}", not_shipped(word));
    Err(Failure::environment(why))
}

/// Writes the embedded tasks again if a path is among them and the cache was emptied.
pub fn restore(file: &str, io: &Io) -> Result<(), Failure> {
    match embedded_folder(io) {
        Some(folder) if Path::new(file).starts_with(&folder) => unpacked(io).map(drop),
        _ => Ok(()),
    }
}

/// Returns whether a file is a shipped one, which a new version of fabc replaces.
pub fn is_shipped(file: &str, io: &Io) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    let Some(file) = real(Path::new(file)) else {
        return false;
    };
    let mut folders = [embedded_folder(io), installed()].into_iter().flatten();
    folders.any(|folder| real(&folder).is_some_and(|folder| file.starts_with(folder)))
}

/// Fails if a file is a shipped one: files written beside it would be lost.
pub fn check_own(file: &str, io: &Io) -> Result<(), Failure> {
    if !is_shipped(file, io) {
        return Ok(());
    }
    let folder = Path::new(file).parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).display();
    Err(Failure::environment(format!(
        "`{file}` is shipped with fabc, and fabc writes nothing into its folder; work on a copy: `cp -r {folder} my_tasks`"
    )))
}

/// Returns the text of an embedded file, by its path relative to the tasks folder.
pub fn text(path: &str) -> &'static str {
    let bytes = FILES.get(path);
    let bytes = bytes.expect("every file that the program itself uses is embedded");
    std::str::from_utf8(bytes).expect("a shipped source is UTF-8")
}

/// Returns the embedded libraries, with their paths relative to the tasks.
pub fn libraries() -> impl Iterator<Item = File> {
    of_shipped(|path| path.starts_with("lib/"))
}

fn of_shipped(is_meant: impl Fn(&str) -> bool) -> impl Iterator<Item = File> {
    let files = FILES.iter().map(|(path, bytes)| (&**path, &**bytes));
    files.filter(move |(path, _)| is_meant(path))
}

/// Returns how to get a file that is missing and shipped, as the end of a sentence.
pub fn library_hint(missing: &Path) -> Option<String> {
    if missing.exists() {
        return None;
    }
    let (path, _) = libraries().find(|(path, _)| missing.ends_with(path))?;
    Some(format!(
        "; fabc ships `{path}`, and `fabc new library` copies it beside your task"
    ))
}

/// Returns the files of an embedded task: its source, its pictures, and its demonstrations.
pub fn task_files(word: &str) -> Result<impl Iterator<Item = File>, Failure> {
    if !names().any(|name| name == word) {
        return Err(Failure::environment(not_shipped(word)));
    }
    let own = [format!("{word}.fab"), format!("demos/{word}.jsonl")];
    let pictures = format!("{word}.subgoals/");
    Ok(of_shipped(move |path| {
        own.iter().any(|own| own == path) || path.starts_with(&pictures)
    }))
}

fn not_shipped(word: &str) -> String {
    let meant = match nearest(word, names()) {
        Some(meant) => format!("did you mean `{meant}`? It ships"),
        None => "it ships".to_owned(),
    };
    let all = quoted(names());
    format!("fabc ships no task `{word}`; {meant} {all}")
}

fn names() -> impl Iterator<Item = &'static str> {
    of_shipped(|path| !path.contains('/')).filter_map(|(path, _)| path.strip_suffix(".fab"))
}

/// Returns where an installation would keep the tasks, whether or not the folder exists.
fn installed() -> Option<PathBuf> {
    // The PATH may hold a link to the program, so resolve it to find the installation.
    let program = std::env::current_exe().ok()?.canonicalize().ok()?;
    Some(program.parent()?.parent()?.join(INSTALLED))
}

/// Returns the folder to which the embedded tasks are written.
fn embedded_folder(io: &Io) -> Option<PathBuf> {
    let files = FILES.iter();
    let parts = files.flat_map(|(path, bytes)| [path.as_bytes(), &**bytes]);
    let hash = &Cache::key(parts)[..16];
    Some(io.cache_folder()?.join("tasks").join(hash))
}

/// Writes the embedded files that are missing or were changed; returns their folder.
fn unpacked(io: &Io) -> Result<PathBuf, Failure> {
    let absent =
        "the shipped tasks need a folder, and there is no cache folder; name one in FABC_CACHE_DIR";
    let folder = embedded_folder(io).ok_or_else(|| Failure::environment(absent))?;
    for (path, bytes) in FILES.iter() {
        let path = folder.join(&**path);
        if fs::read(&path).is_ok_and(|present| present == **bytes) {
            continue;
        }
        let above = path.parent().unwrap_or(&folder);
        let written = fs::create_dir_all(above).and_then(|()| files::write_whole(&path, bytes));
        written.map_err(|error| {
            Failure::environment(format!(
                "cannot write the shipped tasks into `{}`: {error}; name another cache folder in FABC_CACHE_DIR",
                folder.display()
            ))
        })?;
    }
    Ok(folder)
}

//! Applies the edits that are certain, and writes or shows the files that change.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use crate::sources::{self, Disk};
use fab_base::files;
use fab_base::wording::counted;
use fab_compiler::fix::{self, Fixed};
use fab_compiler::{Compiled, LoadError, Loader, diag};
use similar::TextDiff;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What is done with new texts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    /// The files are written.
    Write,
    /// The changes are shown as a unified diff.
    Show,
}

/// Fixes files until no certain edit remains in any; a file that cannot be read or written becomes its failure.
/// Returns the changes as a unified diff.
///
/// Other files that they use are not changed: they may belong to other tasks, whose author is not asking. The user is
/// told of each file that is not changed although it could be.
///
/// - `found`: the paths of the named files, or why there is none.
pub fn run(found: &mut [Result<String, Failure>], effect: Effect, io: &Io) -> String {
    let mut changes = Changes::default();
    // What a file needs may depend on one that is fixed after it. Such chains are not longer than the list.
    for _ in 0..=found.len() {
        let before = changes.count();
        for file in found.iter_mut() {
            if let Ok(name) = file
                && let Err(failure) = fix_one(name, &mut changes, io)
            {
                *file = Err(failure);
            }
        }
        if changes.count() == before {
            break;
        }
    }
    let mut diff = String::new();
    for (path, change) in &changes.0 {
        let name = &change.name;
        let count = counted(change.n_repaired, "change");
        match effect {
            Effect::Show => {
                diff += &change.diff();
                io.talk(&format!("{name}: {count}, not made"));
            }
            Effect::Write => match change.write(path) {
                Ok(()) => io.talk(&format!("{name}: {count}")),
                Err(error) => {
                    let failed = || Failure::environment(format!("cannot write `{name}`: {error}"));
                    for file in found.iter_mut().filter(|file| is_of(file, path)) {
                        *file = Err(failed());
                    }
                }
            },
        }
    }
    report_unchanged(found, &changes, io);
    diff
}

/// Tells the user which files could be changed, and why they are not.
fn report_unchanged(found: &[Result<String, Failure>], changes: &Changes, io: &Io) {
    let named: BTreeSet<PathBuf> = found.iter().flatten().filter_map(real).collect();
    let mut unchanged: BTreeMap<String, (&str, usize)> = BTreeMap::new();
    for file in found.iter().flatten() {
        let loader = changes.over(file);
        let Ok(mut compiled) = fab_compiler::compile(file, &loader) else {
            continue;
        };
        fix::demote(file, &loader, &mut compiled);
        for (name, count) in certain(&compiled) {
            let is_named = real(name).is_some_and(|path| named.contains(&path));
            if !is_named {
                unchanged.insert(name.to_owned(), ("it was not named", count));
            } else if is_read_only(Path::new(name)) {
                unchanged.insert(name.to_owned(), ("it is read-only", count));
            }
        }
    }
    for (name, (why, count)) in unchanged {
        let count = counted(count, "certain correction");
        io.talk(&format!(
            "{name}: not changed, because {why}; it has {count}"
        ));
    }
}

/// Fixes one file, on top of the changes so far, and adds its own.
fn fix_one(file: &str, changes: &mut Changes, io: &Io) -> Result<(), Failure> {
    let may_change = |name: &str| name == file && !is_read_only(Path::new(file));
    let failed = |error: LoadError| Failure::environment(error.message);
    let loader = changes.over(file);
    let before = loader.load(file).map_err(failed)?;
    let Fixed { files, .. } = fix::fix(file, &loader, &may_change).map_err(failed)?;
    for (name, fixed) in files {
        shipped::check_own(&name, io)?;
        let path = real(&name).ok_or_else(|| Failure::environment(format!("`{name}` is gone")))?;
        let change = changes.0.entry(path).or_insert_with(|| Change {
            name,
            before: before.clone(),
            after: String::new(),
            n_repaired: 0,
        });
        change.after = fixed.text;
        change.n_repaired += fixed.n_repaired;
    }
    Ok(())
}

/// What changes in one file.
struct Change {
    /// Its name on the command line.
    name: String,
    before: String,
    after: String,
    n_repaired: usize,
}

impl Change {
    fn diff(&self) -> String {
        let name = diag::visible(&self.name);
        TextDiff::from_lines(&self.before, &self.after)
            .unified_diff()
            .header(&name, &name)
            .to_string()
    }

    /// Writes the new text, unless somebody else has written the file meanwhile.
    fn write(&self, path: &Path) -> Result<(), String> {
        let found = fs::read(path).map_err(|error| error.to_string())?;
        // Another name of the same file may have been written already.
        if found == self.after.as_bytes() {
            return Ok(());
        }
        if found != self.before.as_bytes() {
            return Err("it has changed since it was read".to_owned());
        }
        files::rewrite(path, self.after.as_bytes()).map_err(|error| error.to_string())
    }
}

/// The changed files, by their real paths.
#[derive(Default)]
struct Changes(BTreeMap<PathBuf, Change>);

impl Changes {
    fn count(&self) -> usize {
        self.0.values().map(|change| change.n_repaired).sum()
    }

    /// Returns a loader for one entry that sees the changes.
    fn over(&self, entry: &str) -> Changed<'_> {
        Changed {
            changes: self,
            disk: Disk::beside(entry),
        }
    }
}

/// The files on disk, as they will be.
struct Changed<'a> {
    changes: &'a Changes,
    disk: Disk,
}

impl Loader for Changed<'_> {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        let text = self.disk.load(name)?;
        let change = real(name).and_then(|path| self.changes.0.get(&path));
        Ok(change.map_or(text, |change| change.after.clone()))
    }
}

fn is_of(file: &Result<String, Failure>, path: &Path) -> bool {
    file.as_ref().ok().and_then(real).as_deref() == Some(path)
}

fn real(path: impl AsRef<Path>) -> Option<PathBuf> {
    fs::canonicalize(path).ok()
}

/// Compiles a file, and calls an edit certain only if `--fix` would make it.
pub fn judged(file: &str) -> Result<(Compiled, Vec<String>), Failure> {
    let (mut compiled, notes) = sources::compile_looking(file)?;
    fix::demote(file, &Disk::beside(file), &mut compiled);
    Ok((compiled, notes))
}

/// Counts the findings with certain edits in each file.
fn certain(compiled: &Compiled) -> BTreeMap<&str, usize> {
    let mut counts = BTreeMap::new();
    for diagnostic in compiled.diagnostics.iter().filter(|it| it.is_certain()) {
        let name = compiled.sources.get(diagnostic.span.file).name.as_str();
        *counts.entry(name).or_default() += 1;
    }
    counts
}

/// Returns whether nobody, or not this user, may write a file.
///
/// A file is replaced by renaming, which would succeed anyway.
fn is_read_only(path: &Path) -> bool {
    let is_marked = fs::metadata(path).is_ok_and(|it| it.permissions().readonly());
    let is_refused = |kind| {
        matches!(
            kind,
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem
        )
    };
    let opened = OpenOptions::new().append(true).open(path);
    is_marked || opened.is_err_and(|error| is_refused(error.kind()))
}

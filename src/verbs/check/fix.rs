//! Applies the edits that are certain, and writes the files that change.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use crate::sources::{self, Disk};
use fab_base::files;
use fab_compiler::Compiled;
use fab_compiler::fix::{self, Fixed};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Fixes files until no certain edit remains in any; a file that cannot be read or written becomes its failure.
///
/// Other files that they use are not changed: they may belong to other tasks, whose author is not asking. The user is
/// told of each file that is not changed although it could be.
///
/// - `found`: the paths of the named files, or why there is none.
pub fn run(found: &mut [Result<String, Failure>], io: &Io) {
    let mut changes: BTreeMap<String, usize> = BTreeMap::new();
    // What a file needs may depend on one that is fixed after it. Such chains are not longer than the list.
    for _ in 0..=found.len() {
        let before: usize = changes.values().sum();
        for file in found.iter_mut() {
            if let Ok(name) = file
                && let Err(failure) = fix_one(name, &mut changes, io)
            {
                *file = Err(failure);
            }
        }
        if changes.values().sum::<usize>() == before {
            break;
        }
    }
    for (name, count) in &changes {
        io.talk(&format!("{name}: {}", counted(*count, "change")));
    }
    let named = found.iter().flatten().filter_map(real);
    let named: BTreeSet<PathBuf> = named.collect();
    let mut unchanged: BTreeMap<String, (&str, usize)> = BTreeMap::new();
    for file in found.iter().flatten() {
        let Ok(compiled) = judged(file) else {
            continue;
        };
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

/// Fixes and writes one file, and adds the number of its changes.
fn fix_one(file: &str, changes: &mut BTreeMap<String, usize>, io: &Io) -> Result<(), Failure> {
    let may_change = |name: &str| name == file && !is_read_only(Path::new(file));
    let Fixed { files, .. } = fix::fix(file, &Disk::beside(file), &may_change)
        .map_err(|error| Failure::environment(error.message))?;
    for (name, fixed) in files {
        shipped::check_own(&name, io)?;
        write(Path::new(&name), &fixed.text)
            .map_err(|error| Failure::environment(format!("cannot write `{name}`: {error}")))?;
        *changes.entry(name).or_default() += fixed.n_repaired;
    }
    Ok(())
}

fn real(path: impl AsRef<Path>) -> Option<PathBuf> {
    fs::canonicalize(path).ok()
}

/// Compiles a file, and calls an edit certain only if `--fix` would make it.
pub fn judged(file: &str) -> Result<Compiled, Failure> {
    let mut compiled = sources::compile_looking(file)?;
    fix::demote(file, &Disk::beside(file), &mut compiled);
    Ok(compiled)
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

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Returns whether nobody, or not this user, may write a file.
///
/// A file is replaced by renaming, which would succeed all the same.
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

/// Writes a file; keeps its links, symbolic and hard, and its permissions.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    let path = fs::canonicalize(path)?;
    let information = fs::metadata(&path)?;
    if has_other_names(&information) {
        // Renaming would leave the old text under the other names.
        let mut file = OpenOptions::new().write(true).open(&path)?;
        file.write_all(text.as_bytes())?;
        file.set_len(text.len() as u64)?;
        return file.sync_all();
    }
    files::write_whole(&path, text.as_bytes())?;
    fs::set_permissions(&path, information.permissions())
}

/// Returns whether a file has several hard links.
#[cfg(unix)]
fn has_other_names(information: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    information.nlink() > 1
}

/// Returns whether a file has several hard links; the standard library cannot tell here.
#[cfg(not(unix))]
fn has_other_names(_information: &fs::Metadata) -> bool {
    false
}

//! Applies the edits that are certain, and writes or shows the files that change.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use crate::sources::Disk;
use fab_base::files;
use fab_base::wording::counted;
use fab_compiler::fix::{self, FixedFile};
use fab_compiler::{Compiled, Loader, diag};
use similar::TextDiff;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Effect {
    Write,
    Show,
}

/// Fixes files; one that cannot be read or written becomes its failure. Returns the changes as a unified diff.
///
/// Files that they use are not changed: they may belong to other tasks, whose author is not asking. The user is told
/// of each file that is not changed although it could be.
pub fn run(found: &mut [Result<String, Failure>], effect: Effect, io: &Io) -> String {
    let mut diff = String::new();
    let named: Vec<String> = found.iter().flatten().cloned().collect();
    let mut unchanged: BTreeMap<String, String> = BTreeMap::new();
    for file in found.iter_mut() {
        if let Ok(name) = file {
            match fix_one(name, effect, io) {
                Ok((change, left)) => {
                    diff += &change;
                    unchanged.extend(reasons(&left, &named));
                }
                Err(failure) => *file = Err(failure),
            }
        }
    }
    for (name, why) in unchanged {
        io.talk(&format!("{name}: not changed, because {why}"));
    }
    diff
}

/// Fixes one file. Returns its change, and the compilation after it.
fn fix_one(name: &str, effect: Effect, io: &Io) -> Result<(String, Compiled), Failure> {
    let loader = Disk::beside(name);
    let may_change = |file: &str| file == name && !is_read_only(Path::new(name));
    let before = loader.load(name)?;
    let fixed = fix::fix(name, &loader, &may_change)?;
    let Some(FixedFile { text, n_repaired }) = fixed.files.get(name) else {
        return Ok((String::new(), fixed.compiled));
    };
    shipped::check_own(name, io)?;
    let count = counted(*n_repaired, "change");
    if effect == Effect::Show {
        io.talk(&format!("{name}: {count}, not made"));
    } else {
        files::rewrite(Path::new(name), text.as_bytes())
            .map_err(|error| Failure::unwritable(Path::new(name), error))?;
        io.talk(&format!("{name}: {count}"));
    }
    let shown = diag::visible(name);
    let diff = TextDiff::from_lines(&before, text);
    let diff = diff.unified_diff().header(&shown, &shown).to_string();
    Ok((diff, fixed.compiled))
}

/// Returns the files that keep certain edits, and why; the user has named some.
fn reasons(left: &Compiled, named: &[String]) -> BTreeMap<String, String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for diagnostic in left.diagnostics.iter().filter(|it| it.is_certain()) {
        let name = left.sources.get(diagnostic.span.file).name.as_str();
        *counts.entry(name).or_default() += 1;
    }
    let real = |name: &str| fs::canonicalize(name).ok();
    let is_named = |name: &str| named.iter().any(|it| real(it) == real(name));
    let reason = |(name, count): (&str, usize)| {
        let why = if !is_named(name) {
            "it was not named"
        } else if is_read_only(Path::new(name)) {
            "it is read-only"
        } else {
            return None;
        };
        let count = counted(count, "certain correction");
        Some((name.to_owned(), format!("{why}; it has {count}")))
    };
    counts.into_iter().filter_map(reason).collect()
}

/// Returns whether a file may not be written; it is replaced by renaming, which could succeed anyway.
fn is_read_only(path: &Path) -> bool {
    let is_marked = fs::metadata(path).is_ok_and(|it| it.permissions().readonly());
    is_marked || fs::OpenOptions::new().append(true).open(path).is_err()
}

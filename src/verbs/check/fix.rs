//! Applies the fixes that diagnostics are certain of.

use crate::exit::Failure;
use crate::io::Io;
use crate::shipped;
use crate::sources;
use fab_base::files;
use fab_compiler::diag::{Certainty, Diagnostic, Edit};
use fab_compiler::{Compiled, Span};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The most rounds: a fix may reveal another fault.
const MAX_ROUNDS: usize = 20;

/// Fixes a file and the files it uses until no certain fix remains; returns the last compilation.
pub fn run(file: &str, io: &Io) -> Result<Compiled, Failure> {
    let mut compiled = sources::compile_looking(file)?;
    let mut n_changes: BTreeMap<String, usize> = BTreeMap::new();
    for _ in 0..MAX_ROUNDS {
        let texts = repaired(&compiled);
        if texts.is_empty() {
            break;
        }
        shipped::check_own(file, io)?;
        for (name, (text, count)) in texts {
            write(Path::new(&name), &text)
                .map_err(|error| Failure::environment(format!("cannot write `{name}`: {error}")))?;
            *n_changes.entry(name).or_default() += count;
        }
        compiled = sources::compile_looking(file)?;
    }
    for (name, count) in &n_changes {
        let changes = if *count == 1 { "change" } else { "changes" };
        io.talk(&format!("{name}: {count} {changes}"));
    }
    Ok(compiled)
}

/// Returns each file that changes: its new text and the number of changes.
fn repaired(compiled: &Compiled) -> BTreeMap<String, (String, usize)> {
    let mut edits: Vec<&Edit> = Vec::new();
    for diagnostic in &compiled.diagnostics {
        let own = &diagnostic.edits;
        let overlaps = own
            .iter()
            .any(|edit| edits.iter().any(|made| meet(edit.span, made.span)));
        if is_certain(diagnostic) && !overlaps {
            edits.extend(own);
        }
    }
    // From the end, so that earlier positions stay valid.
    edits.sort_by_key(|edit| std::cmp::Reverse((edit.span.file, edit.span.start)));
    let mut texts: BTreeMap<String, (String, usize)> = BTreeMap::new();
    for edit in edits {
        let source = compiled.sources.get(edit.span.file);
        let (text, count) = texts
            .entry(source.name.clone())
            .or_insert_with(|| (source.text.clone(), 0));
        text.replace_range(edit.span.range(), &edit.replacement);
        *count += 1;
    }
    texts
}

fn is_certain(diagnostic: &Diagnostic) -> bool {
    let certain = |edit: &Edit| edit.certainty == Certainty::Certain;
    !diagnostic.edits.is_empty() && diagnostic.edits.iter().all(certain)
}

/// Returns whether two changes overlap or touch.
fn meet(a: Span, b: Span) -> bool {
    a.file == b.file && a.start <= b.end && b.start <= a.end
}

/// Writes a file atomically; keeps links and permissions.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    let path = fs::canonicalize(path)?;
    let permissions = fs::metadata(&path)?.permissions();
    files::write_whole(&path, text.as_bytes())?;
    fs::set_permissions(&path, permissions)
}

//! Collects findings, and proves that an error was reported.

use super::codes::{Code, Severity};
use super::diagnostic::Diagnostic;
use fab_grammar::{FileId, Span};
use std::collections::{BTreeMap, BTreeSet};

/// The most findings of each severity that are kept; the rest are only counted.
///
/// A file of a megabyte can have a hundred thousand. Nobody reads that many, and writing them takes longer than
/// finding them.
pub const MAX_FINDINGS: usize = 1000;

/// Proof that an error was reported; only a [`Report`] makes one.
///
/// A part that cannot be built because of an error is `Err(Reported)`, so no part is dropped without a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reported(());

/// Returns every part if all are right. Reads them all, so that each wrong one is reported.
pub(crate) fn every<T, E>(parts: impl Iterator<Item = Result<T, E>>) -> Result<Vec<T>, E> {
    let parts: Vec<Result<T, E>> = parts.collect();
    parts.into_iter().collect()
}

/// Collects findings, each only once.
#[derive(Debug, Default)]
pub(crate) struct Report {
    found: Vec<Diagnostic>,
    /// Location, code and message of each finding. Two findings that share all three count as one.
    seen: BTreeSet<(Span, Code, String)>,
    /// For each severity, the number of findings, and how many of them are kept.
    counts: BTreeMap<Severity, (usize, usize)>,
    /// The findings that stand for all of their kind about a name of a file.
    about: BTreeMap<(FileId, Code, String), usize>,
    /// The files with the main location of an error.
    files_with_errors: BTreeSet<FileId>,
}

impl Report {
    /// Adds an error once: each task that extends a task checks it again.
    pub(crate) fn error(&mut self, diagnostic: Diagnostic) -> Reported {
        debug_assert_eq!(diagnostic.severity, Severity::Error, "{diagnostic:?}");
        self.add(diagnostic);
        Reported(())
    }

    /// Adds a warning or a note.
    pub(crate) fn remark(&mut self, diagnostic: Diagnostic) {
        debug_assert_ne!(diagnostic.severity, Severity::Error, "{diagnostic:?}");
        self.add(diagnostic);
    }

    fn add(&mut self, diagnostic: Diagnostic) {
        let message = diagnostic.message.clone();
        let key = (diagnostic.span, diagnostic.code, message);
        if !self.seen.insert(key) {
            return;
        }
        let mut about = None;
        if let Some(name) = &diagnostic.about {
            let key = (diagnostic.span.file, diagnostic.code, name.clone());
            if let Some(first) = self.about.get(&key) {
                self.found[*first].also_about(diagnostic);
                return;
            }
            about = Some(key);
        }
        if diagnostic.severity == Severity::Error {
            self.files_with_errors.insert(diagnostic.span.file);
        }
        let (count, n_kept) = self.counts.entry(diagnostic.severity).or_default();
        *count += 1;
        if *n_kept < MAX_FINDINGS {
            *n_kept += 1;
            self.about.extend(about.map(|key| (key, self.found.len())));
            self.found.push(diagnostic);
        }
    }

    /// Counts further errors of a file, without their messages.
    pub(crate) fn count_further(&mut self, errors: usize, file: FileId) {
        if errors > 0 {
            self.counts.entry(Severity::Error).or_default().0 += errors;
            self.files_with_errors.insert(file);
        }
    }

    /// Returns the proof of an error if there is any.
    pub(crate) fn has_errors(&self) -> Result<(), Reported> {
        match self.counts.get(&Severity::Error) {
            Some((count, _)) if *count > 0 => Err(Reported(())),
            _ => Ok(()),
        }
    }

    /// Returns the proof of an error if the file has any.
    pub(crate) fn error_in(&self, file: FileId) -> Option<Reported> {
        self.files_with_errors
            .contains(&file)
            .then_some(Reported(()))
    }

    /// Returns how many findings are counted but not kept.
    pub(crate) fn left_out(&self) -> usize {
        self.counts
            .values()
            .map(|(count, n_kept)| count - n_kept)
            .sum()
    }

    /// Takes over another report's findings, and its count of those that were not kept.
    pub(crate) fn absorb(&mut self, other: Report) {
        for (severity, (count, n_kept)) in other.counts {
            self.counts.entry(severity).or_default().0 += count - n_kept;
        }
        self.files_with_errors.extend(other.files_with_errors);
        for diagnostic in other.found {
            self.add(diagnostic);
        }
    }

    /// Takes over another report's findings in one place, and drops the others.
    pub(crate) fn absorb_within(&mut self, place: Span, mut other: Report) {
        other.found.retain(|it| place.contains(it.span));
        other.files_with_errors.retain(|file| *file == place.file);
        self.absorb(other);
    }

    /// Returns whether there is a finding in a place.
    pub(crate) fn finds_within(&self, place: Span) -> bool {
        let mut found = self.found.iter();
        found.any(|it| place.contains(it.span))
    }

    /// Returns the findings by file and position.
    pub(crate) fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.found
            .sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        self.found
    }
}

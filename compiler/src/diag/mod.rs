//! What is wrong with a source, as data; text and JSON are made from it.
//!
//! A [`Diagnostic`] has a code, a main place, the values, other places where they matter, and what
//! would be right. The wording is here to be read by people; programs go by the code.

mod codes;
mod json;
mod suggest;
mod text;

pub use codes::{CODES, Code, CodeEntry, GROUPS};
pub use json::to_json;
pub use text::{Color, to_text};

pub use suggest::{among, nearest};

use crate::source::{FileId, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::hash::{DefaultHasher, Hash, Hasher};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The task cannot run.
    Error,
    /// It can run, but hardly as it is meant.
    Warning,
    /// Good to know.
    Note,
}

impl Severity {
    /// Returns the lower-case word.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        }
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Which kind of fault.
    pub code: Code,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, with which values: lower case, no full stop.
    pub message: String,
    /// The main place.
    pub span: Span,
    /// What the main place is marked with; may be empty.
    pub label: String,
    /// Other places that matter.
    pub labels: Vec<Label>,
    /// What would be right.
    pub help: Vec<String>,
    /// Changes that repair it; all of one certainty.
    pub edits: Vec<Edit>,
}

/// A second place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is there.
    pub text: String,
}

/// A change to a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What is replaced; empty: an insertion.
    pub span: Span,
    /// By what.
    pub replacement: String,
    /// Whether it is what the author meant.
    pub certainty: Certainty,
}

/// Whether a change is what the author meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// There is no other way to read it; `fabc check --fix` makes the change.
    Certain,
    /// It is the nearest name; only the author knows.
    Likely,
}

impl Diagnostic {
    /// Reports a fault with its code's own severity.
    pub(crate) fn new(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            severity: code.entry().severity,
            message: message.into(),
            span,
            label: String::new(),
            labels: Vec::new(),
            help: Vec::new(),
            edits: Vec::new(),
        }
    }

    /// Marks the main place with words.
    pub(crate) fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.label = text.into();
        self
    }

    /// Adds a second place.
    pub(crate) fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Adds what would be right.
    pub(crate) fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help.push(text.into());
        self
    }

    /// Adds a change that certainly repairs it.
    pub(crate) fn edit(self, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.with_edit(span, replacement.into(), Certainty::Certain)
    }

    /// Adds a change to the nearest name, and says so.
    pub(crate) fn meant(self, span: Span, meant: &str) -> Diagnostic {
        self.help(format!("did you mean `{meant}`?")).with_edit(
            span,
            meant.to_owned(),
            Certainty::Likely,
        )
    }

    /// Adds a change that probably repairs it, but may not be all that is needed.
    pub(crate) fn likely(self, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.with_edit(span, replacement.into(), Certainty::Likely)
    }

    fn with_edit(mut self, span: Span, replacement: String, certainty: Certainty) -> Diagnostic {
        self.edits.push(Edit {
            span,
            replacement,
            certainty,
        });
        self
    }
}

/// The most findings of each severity that are kept; the rest is counted.
///
/// A file of a megabyte can hold a hundred thousand, which nobody reads and which take longer to write than to find.
pub const MAX_FINDINGS: usize = 1000;

/// Collects findings, each once.
#[derive(Debug, Default)]
pub(crate) struct Report {
    found: Vec<Diagnostic>,
    /// Place, code and digest of the message of each; a finding whose digest coincides is much the same one.
    known: BTreeSet<(Span, Code, u64)>,
    /// For each severity how many findings there are, and how many of them are kept.
    counts: BTreeMap<Severity, (usize, usize)>,
    files_with_errors: BTreeSet<FileId>,
}

impl Report {
    /// Adds a finding, unless the same one is known: a task is checked again in each task that extends it.
    pub(crate) fn push(&mut self, diagnostic: Diagnostic) {
        // Made by `new`, the hasher has no chance in it.
        let mut digest = DefaultHasher::new();
        diagnostic.message.hash(&mut digest);
        let key = (diagnostic.span, diagnostic.code, digest.finish());
        if !self.known.insert(key) {
            return;
        }
        if diagnostic.severity == Severity::Error {
            self.files_with_errors.insert(diagnostic.span.file);
        }
        let (count, kept) = self.counts.entry(diagnostic.severity).or_default();
        *count += 1;
        if *kept < MAX_FINDINGS {
            *kept += 1;
            self.found.push(diagnostic);
        }
    }

    /// Counts errors of a file that are not put into words.
    pub(crate) fn pass_over(&mut self, errors: usize, file: FileId) {
        if errors > 0 {
            self.counts.entry(Severity::Error).or_default().0 += errors;
            self.files_with_errors.insert(file);
        }
    }

    /// Returns how many errors there are so far.
    pub(crate) fn errors(&self) -> usize {
        self.counts
            .get(&Severity::Error)
            .map_or(0, |(count, _)| *count)
    }

    /// Returns how many findings are counted and not kept.
    pub(crate) fn left_out(&self) -> usize {
        self.counts.values().map(|(count, kept)| count - kept).sum()
    }

    /// Takes over another report's findings; one that it only counted counts anew.
    pub(crate) fn absorb(&mut self, other: Report) {
        for (severity, (count, kept)) in other.counts {
            self.counts.entry(severity).or_default().0 += count - kept;
        }
        for diagnostic in other.found {
            self.push(diagnostic);
        }
    }

    /// Returns the files in which an error's main place lies.
    pub(crate) fn files_with_errors(&self) -> BTreeSet<FileId> {
        self.files_with_errors.clone()
    }

    /// Returns the findings by file and place.
    pub(crate) fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.found
            .sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code));
        self.found
    }
}

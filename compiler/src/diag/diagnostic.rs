//! One finding, as data.

use super::codes::{Code, Severity};
use fab_grammar::Span;
use fab_program::invisible::visible;
use fab_program::nearest::{among, nearest};

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind of fault.
    pub code: Code,
    /// How serious it is.
    pub severity: Severity,
    /// What is wrong, with the values: lower case, no full stop.
    pub message: String,
    /// The main location.
    pub span: Span,
    /// The label at the main location; may be empty.
    pub label: String,
    /// Other locations that matter.
    pub labels: Vec<Label>,
    /// What would be right.
    pub help: Vec<String>,
    /// Changes that repair it, all equally certain.
    pub edits: Vec<Edit>,
    /// The name that it is about, if one finding shall stand for all of one kind about one name in a file.
    pub(crate) about: Option<String>,
}

/// A secondary location.
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
    /// What is replaced; an empty span inserts.
    pub span: Span,
    /// The new text.
    pub replacement: String,
    /// Whether the author meant it.
    pub certainty: Certainty,
}

/// Whether the author meant a change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certainty {
    /// The source can only mean this; `fabc check --fix` makes the change.
    Certain,
    /// A guess, such as the nearest name; only the author can decide.
    Likely,
}

impl Diagnostic {
    /// Returns whether it has edits, and all are certain.
    pub fn is_certain(&self) -> bool {
        let certain = |edit: &Edit| edit.certainty == Certainty::Certain;
        !self.edits.is_empty() && self.edits.iter().all(certain)
    }

    /// Makes a diagnostic with the severity of its code.
    pub(crate) fn new(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            severity: code.entry().severity,
            // A message quotes the file, and a file may hold characters that a terminal acts on.
            message: visible(&message.into()).into_owned(),
            span,
            label: String::new(),
            labels: Vec::new(),
            help: Vec::new(),
            edits: Vec::new(),
            about: None,
        }
    }

    /// Sets the label at the main location.
    pub(crate) fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.label = visible(&text.into()).into_owned();
        self
    }

    /// States that one finding stands for all of its kind about a name in a file.
    pub(crate) fn about(mut self, name: &str) -> Diagnostic {
        self.about = Some(name.to_owned());
        self
    }

    /// Moves it to the place that causes it; what would repair the first place no longer counts.
    pub(crate) fn caused_at(mut self, place: Span) -> Diagnostic {
        let span = std::mem::replace(&mut self.span, place);
        self.edits.clear();
        self.help.clear();
        self.also(span, "found here")
    }

    /// Takes another finding about the same name: the first place in the file is the main location.
    pub(super) fn also_about(&mut self, mut other: Diagnostic) {
        const MOST: usize = 8;
        if other.span < self.span {
            std::mem::swap(self, &mut other);
            self.labels.append(&mut other.labels);
        }
        if self.labels.len() < MOST {
            self.labels.push(Label {
                span: other.span,
                text: "here too".to_owned(),
            });
        }
    }

    /// Adds a secondary location.
    pub(crate) fn also(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            span,
            text: visible(&text.into()).into_owned(),
        });
        self
    }

    /// Adds advice.
    pub(crate) fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help.push(visible(&text.into()).into_owned());
        self
    }

    /// Adds a change that certainly repairs it, and does nothing else.
    pub(crate) fn edit(self, span: Span, replacement: impl Into<String>) -> Diagnostic {
        self.with_edit(span, replacement.into(), Certainty::Certain)
    }

    /// Adds a change to the nearest name, and asks whether that was meant.
    pub(crate) fn meant(self, span: Span, meant: &str) -> Diagnostic {
        self.help(format!("did you mean `{meant}`?")).with_edit(
            span,
            meant.to_owned(),
            Certainty::Likely,
        )
    }

    /// Offers the candidate nearest to the word that it is about, or lists all; `none` is the help if there are none.
    pub(crate) fn suggest<'c>(
        self,
        word: &str,
        candidates: impl IntoIterator<Item = &'c str>,
        none: &str,
    ) -> Diagnostic {
        let candidates: Vec<&str> = candidates.into_iter().collect();
        let span = self.span;
        match nearest(word, candidates.iter().copied()) {
            Some(meant) => self.meant(span, meant),
            None if candidates.is_empty() => self.help(none),
            None => self.help(format!("there is {}", among(candidates))),
        }
    }

    /// Adds a change that probably repairs it; other changes may be needed too.
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

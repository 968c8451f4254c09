//! Diagnostics for people, in the look of rustc.

use super::{Diagnostic, Severity};
use crate::source::{FileId, Sources, Span, line_and_column};
use annotate_snippets::{Annotation, AnnotationKind, Level, Renderer, Snippet};

/// The most findings that are written out; the rest is counted.
const MOST: usize = 100;

/// Whether the text carries colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// Bare text.
    Plain,
    /// ANSI escape sequences.
    Ansi,
}

/// Writes diagnostics with the lines of the source that they are about.
pub fn to_text(diagnostics: &[Diagnostic], sources: &Sources, color: Color) -> String {
    let renderer = match color {
        Color::Plain => Renderer::plain(),
        Color::Ansi => Renderer::styled(),
    };
    let mut texts: Vec<String> = diagnostics
        .iter()
        .take(MOST)
        .map(|diagnostic| write(diagnostic, sources, &renderer))
        .collect();
    if diagnostics.len() > MOST {
        texts.push(format!("… and {} more", diagnostics.len() - MOST));
    }
    let mut text = texts.join("\n\n");
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

fn write(diagnostic: &Diagnostic, sources: &Sources, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = level
        .primary_title(diagnostic.message.as_str())
        .id(diagnostic.code.as_str())
        .elements(
            files(diagnostic)
                .into_iter()
                .map(|file| snippet(diagnostic, file, sources)),
        );
    for help in &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    renderer.render(&[group]).trim_end().to_owned()
}

/// Returns the files that a diagnostic points at, the main one first.
fn files(diagnostic: &Diagnostic) -> Vec<FileId> {
    let mut files = vec![diagnostic.span.file];
    for label in &diagnostic.labels {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    files
}

fn snippet<'d>(
    diagnostic: &'d Diagnostic,
    file: FileId,
    sources: &'d Sources,
) -> Snippet<'d, Annotation<'d>> {
    let source = sources.get(file);
    let main = (
        diagnostic.span,
        diagnostic.label.as_str(),
        AnnotationKind::Primary,
    );
    let others = diagnostic
        .labels
        .iter()
        .map(|label| (label.span, label.text.as_str(), AnnotationKind::Context));
    let marks: Vec<(Span, &str, AnnotationKind)> = std::iter::once(main)
        .chain(others)
        .filter(|(span, ..)| span.file == file)
        .collect();
    let first = marks.iter().map(|(span, ..)| span.start).min().unwrap_or(0);
    let last = marks.iter().map(|(span, ..)| span.end).max().unwrap_or(0);
    // Only the lines in question: a large file must not be searched again for each finding.
    let start = source.text[..first].rfind('\n').map_or(0, |at| at + 1);
    let end = source.text[last..]
        .find('\n')
        .map_or(source.text.len(), |length| last + length);
    let annotations = marks.into_iter().map(|(span, text, kind)| {
        let annotation = kind.span(span.start - start..span.end - start);
        if text.is_empty() {
            annotation
        } else {
            annotation.label(text)
        }
    });
    Snippet::source(&source.text[start..end])
        .path(source.name.as_str())
        .line_start(line_and_column(&source.text, start).0)
        .annotations(annotations)
}

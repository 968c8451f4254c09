//! Diagnostics as text, formatted like rustc's.

use super::codes::Severity;
use super::diagnostic::Diagnostic;
use annotate_snippets::{Annotation, AnnotationKind, Level, Renderer, Snippet};
use fab_grammar::{FileId, Source, Sources, Span};
use fab_program::invisible::escaped_where;
use std::borrow::Cow;

/// The most findings that are written; the rest are counted.
const MOST: usize = 100;

/// The most bytes of source shown for one finding.
const MOST_BYTES: usize = 4096;

/// Bytes shown on each side of a location in a line that is too long to show whole.
const AROUND: usize = 40;

/// Whether the text is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// Bare text.
    Plain,
    /// ANSI escape sequences.
    Ansi,
}

/// Writes diagnostics with their source lines.
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
    let excerpts = files(diagnostic).into_iter();
    let excerpts = excerpts.map(|file| excerpt(diagnostic, sources.get(file), file));
    let help = diagnostic.help.iter().map(|help| Level::HELP.message(help));
    let group = level
        .primary_title(&diagnostic.message)
        .id(diagnostic.code.as_str())
        .elements(excerpts)
        .elements(help);
    renderer.render(&[group]).trim_end().to_owned()
}

/// Returns the files with a diagnostic's locations, the main one first.
fn files(diagnostic: &Diagnostic) -> Vec<FileId> {
    let mut files = vec![diagnostic.span.file];
    for label in &diagnostic.labels {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    files
}

/// Shows the locations of a diagnostic in one file.
fn excerpt<'d>(
    diagnostic: &'d Diagnostic,
    source: &'d Source,
    file: FileId,
) -> Snippet<'d, Annotation<'d>> {
    let label = diagnostic.label.as_str();
    let main = (diagnostic.span, label, AnnotationKind::Primary);
    let others = diagnostic.labels.iter();
    let others = others.map(|it| (it.span, it.text.as_str(), AnnotationKind::Context));
    let marks = std::iter::once(main).chain(others);
    let mut marks: Vec<(Span, &str, AnnotationKind)> =
        marks.filter(|(span, ..)| span.file == file).collect();
    let first = marks.iter().map(|(span, ..)| span.start).min();
    let last = marks.iter().map(|(span, ..)| span.end).max();
    // Only these lines: a large file must not be searched again for each finding.
    let text = source.text.as_str();
    let mut start = line_start(text, first.unwrap_or(0));
    let mut end = line_end(text, last.unwrap_or(0));
    // Too far apart, or in too long a line: only the first one, with what stands around it.
    if end - start > MOST_BYTES
        && let Some((span, ..)) = marks.first_mut()
    {
        span.end = text.floor_char_boundary(span.end.min(span.start + MOST_BYTES));
        let from = text.floor_char_boundary(span.start.saturating_sub(AROUND));
        start = line_start(text, span.start).max(from);
        end = line_end(text, span.end).min(text.floor_char_boundary(span.end + AROUND));
        marks.truncate(1);
    }
    let shown = &text[start..end];
    // Where a byte is in the text that is shown.
    let place = |byte: usize| escaped(&shown[..(byte - start).min(shown.len())]).len();
    let annotations = marks.iter().map(|(span, text, kind)| {
        let annotation = kind.span(place(span.start)..place(span.end));
        if text.is_empty() {
            annotation
        } else {
            annotation.label(*text)
        }
    });
    Snippet::source(escaped(shown))
        .path(source.name.as_str())
        .line_start(source.line_and_column(start).0)
        .annotations(annotations)
}

/// Escapes the control characters that the renderer passes on.
fn escaped(text: &str) -> Cow<'_, str> {
    escaped_where(text, |letter| matches!(letter, '\u{80}'..='\u{9f}'))
}

/// Returns the beginning of a byte's line.
fn line_start(text: &str, byte: usize) -> usize {
    text[..byte].rfind('\n').map_or(0, |end| end + 1)
}

/// Returns the end of a byte's line, without its line break.
fn line_end(text: &str, byte: usize) -> usize {
    let rest = text[byte..].split('\n').next().unwrap_or_default();
    byte + rest.strip_suffix('\r').unwrap_or(rest).len()
}

//! Diagnostics as text, formatted like rustc's.

use super::codes::Severity;
use super::diagnostic::Diagnostic;
use annotate_snippets::{Annotation, AnnotationKind, Element, Level, Origin, Renderer, Snippet};
use fab_grammar::{FileId, Source, Sources, Span};
use fab_program::invisible::{escaped_where, visible};
use std::borrow::Cow;
use std::ops::Range;

/// The most findings that are written; the rest are counted.
const MOST: usize = 100;

/// The most bytes of source shown for one finding. Beyond that, each location is shown separately.
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
    // A message quotes the file, which may have characters that act on a terminal.
    let message = visible(&diagnostic.message);
    let help: Vec<Cow<'_, str>> = diagnostic.help.iter().map(|help| visible(help)).collect();
    let mut group = level
        .primary_title(message.as_ref())
        .id(diagnostic.code.as_str())
        .elements(
            files(diagnostic)
                .into_iter()
                .flat_map(|file| excerpt(diagnostic, file, sources)),
        );
    for help in &help {
        group = group.element(Level::HELP.message(help.as_ref()));
    }
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
fn excerpt<'d>(diagnostic: &'d Diagnostic, file: FileId, sources: &'d Sources) -> Vec<Element<'d>> {
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
    // Only these lines: a large file must not be searched again for each finding.
    let start = line_start(&source.text, first);
    let end = line_end(&source.text, last);
    if let (Some(start), Some(end)) = (start, end)
        && end - start <= MOST_BYTES
    {
        let snippet = snippet(source, start..end, &marks).path(source.name.as_str());
        return vec![snippet.into()];
    }
    marks.iter().flat_map(|mark| apart(source, mark)).collect()
}

/// Shows one location separately, because its line is too long or the other locations are far away.
fn apart<'d>(source: &'d Source, mark: &(Span, &'d str, AnnotationKind)) -> Vec<Element<'d>> {
    let (span, label, kind) = *mark;
    let (line, column) = source.line_and_column(span.start);
    let text = source.text.as_str();
    let start = line_start(text, span.start)
        .unwrap_or_else(|| text.floor_char_boundary(span.start.saturating_sub(AROUND)));
    let line_end = line_end(text, span.start)
        .unwrap_or_else(|| text.floor_char_boundary(span.start + MOST_BYTES));
    let excerpt = Span {
        end: span.end.min(line_end).max(span.start),
        ..span
    };
    let end = text.floor_char_boundary(line_end.min(excerpt.end + AROUND));
    // The snippet may begin in the middle of a line, so the position cannot be counted from it.
    vec![
        Origin::path(source.name.as_str())
            .line(line)
            .char_column(column)
            .into(),
        snippet(source, start..end, &[(excerpt, label, kind)]).into(),
    ]
}

fn snippet<'d>(
    source: &'d Source,
    excerpt: Range<usize>,
    marks: &[(Span, &'d str, AnnotationKind)],
) -> Snippet<'d, Annotation<'d>> {
    let line = &source.text[excerpt.clone()];
    // Where a byte is in the text that is shown.
    let place = |byte: usize| match line.get(..byte - excerpt.start) {
        Some(before) => escaped(before).len(),
        None => byte - excerpt.start,
    };
    let annotations = marks.iter().map(|(span, text, kind)| {
        let annotation = kind.span(place(span.start)..place(span.end));
        if text.is_empty() {
            annotation
        } else {
            annotation.label(*text)
        }
    });
    Snippet::source(escaped(line))
        .line_start(source.line_and_column(excerpt.start).0)
        .annotations(annotations)
}

/// Escapes the control characters that the renderer passes on.
fn escaped(text: &str) -> Cow<'_, str> {
    escaped_where(text, |letter| matches!(letter, '\u{80}'..='\u{9f}'))
}

/// Returns the beginning of a byte's line; `None` if it is far away.
fn line_start(text: &str, byte: usize) -> Option<usize> {
    let far = byte.saturating_sub(MOST_BYTES);
    let found = text.as_bytes()[far..byte]
        .iter()
        .rposition(|byte| *byte == b'\n');
    found
        .map(|at| far + at + 1)
        .or_else(|| (far == 0).then_some(0))
}

/// Returns the end of a byte's line; `None` if it is far away.
fn line_end(text: &str, byte: usize) -> Option<usize> {
    let far = (byte + MOST_BYTES).min(text.len());
    let found = text.as_bytes()[byte..far]
        .iter()
        .position(|byte| *byte == b'\n');
    let end = found
        .map(|at| byte + at)
        .or_else(|| (far == text.len()).then_some(far))?;
    // A carriage return belongs to the line break.
    let is_cut = end > byte && text[byte..end].ends_with('\r');
    Some(end - usize::from(is_cut))
}

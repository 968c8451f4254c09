//! Diagnostics for tools and editors. The command line's contract fixes the fields.

use super::diagnostic::{Certainty, Diagnostic};
use fab_grammar::{Source, Sources, Span};
use serde_json::{Value, json};

/// Writes diagnostics as an array of objects `code, severity, message, file, start, end, labels, help, edits`.
///
/// `start` and `end` are `{byte, line, column}`: bytes from 0, lines and columns (characters) from 1.
pub fn to_json(diagnostics: &[Diagnostic], sources: &Sources) -> Value {
    diagnostics
        .iter()
        .map(|diagnostic| object(diagnostic, sources))
        .collect()
}

fn object(diagnostic: &Diagnostic, sources: &Sources) -> Value {
    let main = (diagnostic.span, &diagnostic.label);
    let others = { diagnostic.labels.iter() }.map(|label| (label.span, &label.text));
    let labels = std::iter::once(main).chain(others);
    let labels: Vec<Value> = labels
        .filter(|(_, text)| !text.is_empty())
        .map(|(span, text)| with_place(span, sources, "text", text))
        .collect();
    let edits: Vec<Value> = diagnostic
        .edits
        .iter()
        .map(|edit| {
            let mut object = with_place(edit.span, sources, "replacement", &edit.replacement);
            object["certain"] = json!(edit.certainty == Certainty::Certain);
            object
        })
        .collect();
    let source = sources.get(diagnostic.span.file);
    json!({
        "code": diagnostic.code.as_str(),
        "severity": diagnostic.severity.as_str(),
        "message": diagnostic.message,
        "file": source.name,
        "start": position(source, diagnostic.span.start),
        "end": position(source, diagnostic.span.end),
        "labels": labels,
        "help": diagnostic.help,
        "edits": edits,
    })
}

fn with_place(span: Span, sources: &Sources, key: &str, text: &str) -> Value {
    let source = sources.get(span.file);
    json!({
        "file": source.name,
        "start": position(source, span.start),
        "end": position(source, span.end),
        key: text,
    })
}

fn position(source: &Source, byte: usize) -> Value {
    let (line, column) = source.line_and_column(byte);
    json!({ "byte": byte, "line": line, "column": column })
}

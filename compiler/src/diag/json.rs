//! Diagnostics for tools and editors. The command line's contract fixes the fields.

use super::diagnostic::{Certainty, Diagnostic};
use fab_grammar::{Source, Sources, Span};
use serde_json::{Map, Value, json};

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
    let mut labels = Vec::with_capacity(diagnostic.labels.len() + 1);
    if !diagnostic.label.is_empty() {
        labels.push(with_place(
            diagnostic.span,
            sources,
            "text",
            &diagnostic.label,
        ));
    }
    labels.extend(
        diagnostic
            .labels
            .iter()
            .map(|label| with_place(label.span, sources, "text", &label.text)),
    );
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
    let mut object = Map::new();
    object.insert("file".to_owned(), json!(source.name));
    object.insert("start".to_owned(), position(source, span.start));
    object.insert("end".to_owned(), position(source, span.end));
    object.insert(key.to_owned(), json!(text));
    Value::Object(object)
}

fn position(source: &Source, byte: usize) -> Value {
    let (line, column) = source.line_and_column(byte);
    json!({ "byte": byte, "line": line, "column": column })
}

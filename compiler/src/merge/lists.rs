//! Statements that may appear only once, and names that may be declared only once.

use crate::diag::{Code, Diagnostic, Report, Reported};
use fab_grammar::Span;
use fab_grammar::ast::Name;
use std::collections::BTreeMap;

/// Returns the first statement, and reports any others.
pub(crate) fn once<T: Copy>(
    list: impl IntoIterator<Item = T>,
    what: &str,
    span: impl Fn(T) -> Span,
    report: &mut Report,
) -> Option<T> {
    let mut list = list.into_iter();
    let first = list.next()?;
    for again in list {
        report.error(repeated(what, span(first), span(again)));
    }
    Some(first)
}

/// Makes the diagnostic for a statement that is repeated.
pub(crate) fn repeated(what: &str, first: Span, again: Span) -> Diagnostic {
    let message = format!("`{what}` is stated twice");
    Diagnostic::new(Code::Repeated, again, message).also(first, "stated here first")
}

/// Reports names that are declared twice.
pub(crate) fn unique<'a>(
    names: impl IntoIterator<Item = Name<'a>>,
    kind: &str,
    report: &mut Report,
) -> Result<(), Reported> {
    let names = names.into_iter().map(|name| (name.text(), name.span()));
    duplicates(names, report, |name, first, again| {
        declared_twice(kind, name, first, again)
    })
}

/// Reports names that appear twice.
///
/// - `make`: makes the diagnostic of a name, of where it appears first, and of where again.
pub(super) fn duplicates<'n>(
    names: impl Iterator<Item = (&'n str, Span)>,
    report: &mut Report,
    make: impl Fn(&str, Span, Span) -> Diagnostic,
) -> Result<(), Reported> {
    let mut seen = BTreeMap::new();
    let mut all = Ok(());
    for (name, span) in names {
        let first = *seen.entry(name).or_insert(span);
        if first != span {
            all = Err(report.error(make(name, first, span)));
        }
    }
    all
}

/// Makes the diagnostic for a name that is declared twice.
pub(crate) fn declared_twice(kind: &str, name: &str, first: Span, again: Span) -> Diagnostic {
    let message = format!("the {kind} `{name}` is declared twice");
    Diagnostic::new(Code::DuplicateName, again, message).also(first, "declared here first")
}

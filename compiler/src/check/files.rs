//! Files that a task names: pictures and particle positions.

use super::Context;
use crate::ast::Text;
use crate::diag::{Code, Diagnostic};
use crate::path;
use fab_program::FileRef;

/// Returns the file that a text names; None, with a report, where it names none below the entry's folder.
pub(crate) fn named(text: &Text, what: &str, context: &mut Context<'_>) -> Option<FileRef> {
    let Some(written) = text.plain() else {
        let message = format!("the path of {what} has a placeholder");
        context
            .push(Diagnostic::new(Code::BadPath, text.span, message).help("write the path itself"));
        return None;
    };
    let bad = |fault: &str| {
        Diagnostic::new(
            Code::BadPath,
            text.span,
            format!("the path `{written}` {fault}"),
        )
    };
    if let Some(fault) = path::fault(&written) {
        context.push(bad(fault));
        return None;
    }
    let Some(path) = path::within(&context.loaded.portable_names[text.span.file.0], &written)
    else {
        context.push(
            bad("leads out of the folder of the first file")
                .help("move it beside the first file or below"),
        );
        return None;
    };
    Some(FileRef { path })
}

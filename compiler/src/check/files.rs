//! Files that a task names: pictures and particle positions.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Reported};
use crate::path;
use fab_grammar::ast::Text;
use fab_program::FileRef;

/// Returns the file that a text names. It must be in the entry's folder or below.
pub(crate) fn named(
    text: Text<'_>,
    what: &str,
    context: &mut Context<'_, '_>,
) -> Result<FileRef, Reported> {
    let bad = |message: String| Diagnostic::new(Code::BadPath, text.span(), message);
    let Some(written) = text.plain() else {
        let diagnostic = bad(format!("the path of {what} has a placeholder"));
        return Err(context.error(diagnostic.help("write the path itself")));
    };
    if let Some(fault) = path::fault(&written) {
        return Err(context.error(bad(format!("the path `{written}` {fault}"))));
    }
    let here = &context.loaded.texts.portable_names[text.span().file.index()];
    path::within(here, &written)
        .map(|path| FileRef { path })
        .ok_or_else(|| {
            let message = format!("the path `{written}` leads out of the folder of the first file");
            context.error(bad(message).help("move it into the folder of the first file, or below"))
        })
}

//! Texts of at most some lines, without placeholders: sources of values, names of colours.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Reported};
use fab_grammar::ast::{Expr, Text};

/// The most characters of a colour's name.
const MAX_COLOUR_CHARS: usize = 40;

/// Reads a short text without placeholders.
pub(super) fn line(
    text: Text<'_>,
    what: &str,
    most: usize,
    context: &mut Context<'_, '_>,
) -> Result<String, Reported> {
    let Some(plain) = text.plain() else {
        let message = format!("{what} cannot have a placeholder");
        let diagnostic = Diagnostic::new(Code::WrongForm, text.span(), message);
        return Err(context.error(diagnostic.help("write plain text")));
    };
    let n_chars = plain.chars().count();
    if plain.trim().is_empty() {
        return Err(context.fault(Code::EmptyText, text.span(), "the text is empty"));
    }
    if n_chars > most {
        let message = format!("{what} has {n_chars} characters, at most {most} are accepted");
        return Err(context.fault(Code::TextTooLong, text.span(), message));
    }
    // Line breaks of the source mean nothing.
    Ok(plain.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Reads the name of a colour: a word, or words in quotes.
pub(super) fn colour_name(
    expr: Expr<'_>,
    context: &mut Context<'_, '_>,
) -> Result<String, Reported> {
    match expr {
        Expr::Name(name) => Ok(name.text().to_owned()),
        Expr::Text(text) => line(text, "a colour's name", MAX_COLOUR_CHARS, context),
        _ => {
            let diagnostic = context.unexpected(Code::WrongForm, expr, "the name of a colour");
            Err(context.error(diagnostic.help("write a word such as `orange`, or `\"dark blue\"`")))
        }
    }
}

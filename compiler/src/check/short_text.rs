//! Texts of at most some lines, without placeholders: what a task is for, sources of values, names of colours.

use super::context::{Context, Result};
use crate::diag::Code;
use fab_grammar::ast::{Expr, Text};

/// The most characters of a colour's name.
const MAX_COLOUR_CHARS: usize = 40;

/// Reads a short text without placeholders.
pub(super) fn short(
    text: Text<'_>,
    what: &str,
    most: usize,
    context: &mut Context<'_>,
) -> Result<String> {
    let span = text.span();
    let Some(plain) = text.plain() else {
        let message = format!("{what} cannot have a placeholder");
        return Err(context.refuse(Code::WrongForm, span, message, "write plain text"));
    };
    let n_chars = plain.chars().count();
    if plain.trim().is_empty() {
        return Err(context.fault(Code::EmptyText, span, "the text is empty"));
    }
    if n_chars > most {
        let message = format!("{what} has {n_chars} characters, at most {most} are accepted");
        return Err(context.fault(Code::TextTooLong, span, message));
    }
    Ok(plain)
}

/// Reads a short text on one line: line breaks become blanks.
pub(super) fn line(
    text: Text<'_>,
    what: &str,
    most: usize,
    context: &mut Context<'_>,
) -> Result<String> {
    let text = short(text, what, most, context)?;
    Ok(text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Reads the name of a colour: a word, or words in quotes.
pub(super) fn colour_name(expr: Expr<'_>, context: &mut Context<'_>) -> Result<String> {
    match expr {
        Expr::Name(name) => Ok(name.text().to_owned()),
        Expr::Text(text) => line(text, "a colour's name", MAX_COLOUR_CHARS, context),
        _ => {
            let help = Some("write a word such as `orange`, or `\"dark blue\"`");
            Err(context.wrong(Code::WrongForm, expr, "the name of a colour", help))
        }
    }
}

//! `read action` and `read NAME from "…{NAME}"`: what is taken from an answer.

use super::Context;
use crate::ast;
use crate::diag::{Code, Diagnostic};
use fab_program::Read;

/// Builds what is read; None, with a report, where the pattern does not say what.
pub(crate) fn check(read: &ast::Read, context: &mut Context<'_>) -> Option<Read> {
    let bad = |span, message: String| Diagnostic::new(Code::BadPattern, span, message);
    let name = &read.name.text;
    let help = format!("write `read {name} from \"Instructions: {{{name}}}\"`");
    let Some(pattern) = &read.pattern else {
        if name == "action" {
            return Some(Read::Action);
        }
        context.push(
            bad(
                read.span,
                format!("it is not said where `{name}` begins in the answer"),
            )
            .help(help),
        );
        return None;
    };
    if name == "action" {
        context.push(
            bad(
                pattern.span,
                "`action` is read in its own format".to_owned(),
            )
            .help("write `read action` alone"),
        );
        return None;
    }
    let Some(written) = pattern.plain() else {
        context.push(bad(pattern.span, "a pattern has no `{{ … }}`".to_owned()).help(help));
        return None;
    };
    let hole = format!("{{{name}}}");
    let mut parts = written.splitn(2, &hole);
    let before = parts.next().unwrap_or_default().trim();
    let Some(after) = parts.next().map(str::trim) else {
        context.push(bad(pattern.span, format!("the pattern has no `{hole}`")).help(help));
        return None;
    };
    if before.is_empty() || after.contains(&hole) {
        let message = if before.is_empty() {
            format!("no words stand before `{hole}`")
        } else {
            format!("the pattern has `{hole}` twice")
        };
        context.push(bad(pattern.span, message).help(help));
        return None;
    }
    Some(Read::Text {
        name: name.clone(),
        before: before.to_owned(),
        after: after.to_owned(),
    })
}

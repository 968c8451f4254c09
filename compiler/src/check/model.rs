//! `model text, temperature 0, tokens 769`: which model a stage asks, and how.

use super::Context;
use super::quantity::{Measure, Wanted, read, read_whole};
use crate::ast::{Expr, Ident, Settings};
use crate::diag::{Code, Diagnostic};
use crate::merge::unique;
use fab_program::ModelRole;

const TEMPERATURE: Wanted = Wanted {
    measure: Measure::Number,
    range: 0.0..=2.0,
    range_words: "a number from `0` to `2`",
};
const TOP_P: Wanted = Wanted {
    measure: Measure::Number,
    range: 0.0..=1.0,
    range_words: "a fraction from `0` to `1`",
};
const TOKENS: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=100_000.0,
    range_words: "a count from `1` to `100000`",
};

/// What `model …` states.
pub(crate) struct Checked {
    pub role: ModelRole,
    pub temperature: Option<f64>,
    pub top_p: Option<f64>,
    pub max_tokens: Option<u32>,
}

/// Builds the settings; None, with a report, where the kind of model is wrong.
pub(crate) fn check(part: &Settings, context: &mut Context<'_>) -> Option<Checked> {
    let mut list = part.list.iter();
    let (kind, value) = list.next()?;
    let role = match kind.text.as_str() {
        "vision" => Some(ModelRole::Vision),
        "text" => Some(ModelRole::Text),
        _ => {
            context.unknown("kind of model", kind, ["vision", "text"]);
            None
        }
    };
    if let Some(value) = value {
        context.push(Diagnostic::new(
            Code::WrongForm,
            value.span,
            format!("`{}` takes no number", kind.text),
        ));
    }
    let mut checked = Checked {
        role: ModelRole::Text,
        temperature: None,
        top_p: None,
        max_tokens: None,
    };
    unique(
        part.list.iter().map(|(name, _)| name),
        "setting",
        context.report,
    );
    for (name, value) in list {
        let Some(value) = required(name, value.as_ref(), context) else {
            continue;
        };
        match name.text.as_str() {
            "temperature" => checked.temperature = read(value, &TEMPERATURE, context),
            "top_p" => checked.top_p = read(value, &TOP_P, context),
            _ => checked.max_tokens = read_whole(value, &TOKENS, context),
        }
    }
    Some(Checked {
        role: role?,
        ..checked
    })
}

fn required<'e>(
    name: &Ident,
    value: Option<&'e Expr>,
    context: &mut Context<'_>,
) -> Option<&'e Expr> {
    if !matches!(name.text.as_str(), "temperature" | "top_p" | "tokens") {
        context.unknown("setting", name, ["temperature", "top_p", "tokens"]);
        return None;
    }
    if value.is_none() {
        let message = format!("`{}` needs a number", name.text);
        context.push(
            Diagnostic::new(Code::WrongForm, name.span, message)
                .help(format!("write `{} 0`", name.text)),
        );
    }
    value
}

//! Texts become templates in the portable Jinja subset.
//!
//! Every variable is a value that is known where the text is said; everything else is literal, and a `{`
//! that Jinja could take for its own is escaped.

use super::Context;
use super::shown::{self, Placed};
use crate::ast::{Piece, Text};
use crate::diag::{Code, Diagnostic};
use crate::source::Span;
use fab_program::render::Jinja;
use fab_program::{Condition, Placeholder, Template, Variable};
use std::collections::BTreeMap;

/// The most bytes of one text.
pub(crate) const MAX_TEXT_BYTES: usize = 16 << 10;

/// Where a text is said, which decides what it may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the stage of this number: keypoints, and what earlier stages read.
    Stage(usize),
    /// In the message of a check: all of these and the action's fields.
    Message,
    /// In what is said of a step's result before it is asked again: keypoints, and the overlap.
    Result,
    /// Nowhere yet: a component that no stage says.
    Nowhere,
}

/// Where and under which condition a text is said.
#[derive(Clone, Copy)]
pub(crate) struct Scope<'s> {
    pub place: Place,
    /// Whether there was an action before, wherever it is said.
    pub has_last: bool,
    /// How the text is introduced, for advice.
    pub guarded: &'s str,
}

/// Gives each value of a task one name, and each name one value.
#[derive(Default)]
pub(crate) struct Variables {
    /// By the value's JSON.
    names: BTreeMap<String, String>,
    /// For each name that is taken, the number that its next namesake tries.
    taken: BTreeMap<String, u32>,
}

impl Variables {
    /// Returns the variable's name of a value that is written so in the source.
    fn name(&mut self, shown: &Placeholder, written: &str) -> String {
        const MOST: usize = 48;
        let key = serde_json::to_string(shown).expect("a value has string keys and finite numbers");
        if let Some(name) = self.names.get(&key) {
            return name.clone();
        }
        let words = written
            .split(|character: char| !character.is_ascii_alphanumeric() && character != '_')
            .filter(|word| !word.is_empty());
        let mut base = words.collect::<Vec<_>>().join("_");
        base.truncate(MOST);
        if !base.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') {
            base.insert(0, '_');
        }
        let mut name = base.clone();
        while self.taken.contains_key(&name) {
            let number = self.taken.entry(base.clone()).or_insert(2);
            name = format!("{base}_{number}");
            *number += 1;
        }
        self.taken.insert(name.clone(), 2);
        self.names.insert(key, name.clone());
        name
    }
}

/// Builds the template of a text; None, with a report, where the text is wrong.
pub(crate) fn template(
    name: &str,
    text: &Text,
    when: Option<Condition>,
    scope: Scope<'_>,
    context: &mut Context<'_>,
) -> Option<Template> {
    if text.is_blank() {
        context.push(Diagnostic::new(
            Code::EmptyText,
            text.span,
            "the text is empty",
        ));
        return None;
    }
    if text.literal_bytes() > MAX_TEXT_BYTES {
        let message = format!(
            "the text has {} bytes, at most {MAX_TEXT_BYTES} are accepted",
            text.literal_bytes()
        );
        context.push(Diagnostic::new(Code::TextTooLong, text.span, message));
        return None;
    }
    let mut jinja = Jinja::default();
    let mut variables: BTreeMap<String, Placeholder> = BTreeMap::new();
    let mut is_right = true;
    for piece in &text.pieces {
        let expr = match piece {
            Piece::Literal(literal) => {
                single_braces(literal, text, context);
                jinja.literal(literal);
                continue;
            }
            Piece::Value(expr) => expr,
        };
        match shown::check(expr, scope, context) {
            None => is_right = false,
            Some(Placed::Literal(words)) => jinja.literal(&words),
            Some(Placed::Value(shown)) => {
                let written = context.loaded.sources.text(expr.span);
                let name = context.variables.name(&shown, written);
                jinja.variable(&name);
                variables.insert(name, *shown);
            }
        }
    }
    let source = context.loaded.sources.get(text.span.file);
    let template = Template {
        name: name.to_owned(),
        when,
        text: jinja.finish(),
        variables: variables
            .into_iter()
            .map(|(name, value)| Variable { name, value })
            .collect(),
        declared_in: context.loaded.portable_names[text.span.file.0].clone(),
        line: source.line_and_column(text.start).0 as u32,
    };
    is_right.then_some(template)
}
/// Warns of `{name}` where the name has a value: likely one brace was forgotten.
fn single_braces(literal: &str, text: &Text, context: &mut Context<'_>) {
    const LONGEST: usize = 64;
    let source = &context.loaded.sources.get(text.span.file).text[text.span.range()];
    let mut from = 0;
    for (at, _) in literal.match_indices('{') {
        let rest = &literal[at + 1..];
        let Some(length) = rest.bytes().take(LONGEST).position(|byte| byte == b'}') else {
            continue;
        };
        let name = rest[..length].trim_matches(' ');
        let is_value = context.names.get(name).is_some()
            || context.constants.contains_key(name)
            || context.layers.iter().any(|layer| layer.name == name)
            || [shown::FORMAT, shown::POINTS].contains(&name);
        // Two braces are meant as they stand: behind wrong quotes, or for a model that is to read them.
        let is_double = literal[..at].ends_with('{') || rest[length + 1..].starts_with('}');
        if !is_value || is_double {
            continue;
        }
        let written = &literal[at..at + length + 2];
        let Some(offset) = source[from..].find(written) else {
            continue;
        };
        let start = text.span.start + from + offset;
        from += offset + written.len();
        let span = Span::new(text.span.file, start..start + written.len());
        let message = format!("`{written}` stands for itself, not for the value `{name}`");
        context.push(
            Diagnostic::new(Code::SingleBraces, span, message)
                .help(format!("write `{{{{ {name} }}}}` for the value")),
        );
    }
}

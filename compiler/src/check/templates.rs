//! Texts become templates in the portable Jinja subset.
//!
//! Every variable is a name that is known where the text is said; everything else is literal, and a `{`
//! that Jinja could take for its own is escaped.

use super::Context;
use super::keypoints::wrong_kind;
use super::names::Meaning;
use crate::ast::{Ident, Piece, Text};
use crate::diag::{Code, Diagnostic};
use crate::program::{ActionField, KeypointShape, Shown, Template, Variable};
use crate::space;
use std::collections::BTreeSet;

/// The most bytes of one text.
pub(crate) const MAX_TEXT_BYTES: usize = 16 << 10;

/// The name of the constant that spells the answer's format.
const FORMAT: &str = "actions.format";

/// Where a text is said, which decides what it may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the stage of this number: keypoints, and what earlier stages read.
    Stage(usize),
    /// In the message of a check: all of these and the action's fields.
    Message,
    /// Nowhere yet: a component that no stage says.
    Nowhere,
}

/// Builds the template of a text; None, with a report, where the text is wrong.
pub(crate) fn template(
    name: &str,
    text: &Text,
    place: Place,
    actions: &[ActionField],
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
    let mut variables = BTreeSet::new();
    let mut is_right = true;
    for piece in &text.pieces {
        match piece {
            Piece::Literal(literal) => jinja.literal(literal),
            Piece::Variable { path, .. } if path == FORMAT => {
                jinja.literal(&space::format(actions))
            }
            Piece::Variable { path, span } => {
                is_right &= is_known(
                    &Ident {
                        text: path.clone(),
                        span: *span,
                    },
                    place,
                    context,
                );
                jinja.variable(path);
                variables.insert(path.clone());
            }
        }
    }
    let source = context.loaded.sources.get(text.span.file);
    let template = Template {
        name: name.to_owned(),
        text: jinja.finish(),
        when: None,
        variables: variables
            .into_iter()
            .map(|name| variable(name, actions, context))
            .collect(),
        declared_in: context.loaded.portable_names[text.span.file.0].clone(),
        line: source.line_and_column(text.start).0 as u32,
    };
    is_right.then_some(template)
}

fn is_known(name: &Ident, place: Place, context: &mut Context<'_>) -> bool {
    let late = |message: String, help: &str| {
        Diagnostic::new(Code::NotYetKnown, name.span, message).help(help)
    };
    let diagnostic = match (context.names.get(&name.text), place) {
        (None, _) => {
            let mut candidates = context.names.that(|meaning| match (meaning, place) {
                (Meaning::Keypoint(shape), _) => shape != Some(KeypointShape::Mask),
                (Meaning::Text { stage }, Place::Stage(here)) => stage < here,
                (Meaning::Field, Place::Stage(_)) => false,
                (Meaning::Text { .. } | Meaning::Field, Place::Message | Place::Nowhere) => true,
            });
            candidates.push(FORMAT);
            context.unknown("value", name, candidates);
            return false;
        }
        (Some(Meaning::Keypoint(Some(KeypointShape::Mask))), _) => wrong_kind(
            name,
            KeypointShape::Mask,
            "something that can be written as text",
        ),
        (Some(Meaning::Text { stage }), Place::Stage(here)) if stage >= here => late(
            format!("`{}` is not read before this stage", name.text),
            "stages run in order; a text is known to the stages after the one that reads it",
        ),
        (Some(Meaning::Field), Place::Stage(_)) => late(
            format!("`{}` is known only when an action is proposed", name.text),
            "fields of the action can be written in the messages of checks",
        ),
        (Some(_), _) => return true,
    };
    context.push(diagnostic);
    false
}

/// Writes Jinja source.
#[derive(Default)]
struct Jinja {
    text: String,
    /// Whether a literal `{` waits to learn what follows it.
    has_brace: bool,
}

impl Jinja {
    fn literal(&mut self, literal: &str) {
        for character in literal.chars() {
            self.settle(matches!(character, '{' | '%' | '#'));
            if character == '{' {
                self.has_brace = true;
            } else {
                self.text.push(character);
            }
        }
    }

    fn variable(&mut self, path: &str) {
        self.settle(true);
        self.text.push_str("{{ ");
        self.text.push_str(path);
        self.text.push_str(" }}");
    }

    /// Writes a waiting brace, escaped where Jinja would join it with what follows.
    fn settle(&mut self, would_join: bool) {
        if std::mem::take(&mut self.has_brace) {
            self.text
                .push_str(if would_join { "{{ \"{\" }}" } else { "{" });
        }
    }

    fn finish(mut self) -> String {
        self.settle(false);
        self.text
    }
}

fn variable(name: String, actions: &[ActionField], context: &Context<'_>) -> Variable {
    let value = match context.names.get(&name) {
        Some(Meaning::Text { .. }) => Shown::Text { name: name.clone() },
        Some(Meaning::Field) if actions.iter().any(|field| field.name == name) => Shown::Field {
            field: name.clone(),
        },
        _ => Shown::Points {
            keypoint: name.clone(),
        },
    };
    Variable { name, value }
}

//! `actions { pick: one of corners … }`.

use super::Context;
use super::keypoints::wrong_kind;
use super::names::Meaning;
use crate::ast::{self, Field, Ident};
use crate::diag::{Code, Diagnostic, nearest};
use crate::merge::unique;
use crate::program::{ActionField, Choices, KeypointShape};

/// The fields that an action has, each once.
pub(super) const FIELDS: [&str; 2] = ["pick", "place"];

/// Builds the action space.
pub(crate) fn check(part: &ast::Actions, context: &mut Context<'_>) -> Vec<ActionField> {
    unique(
        part.fields.iter().map(|field| &field.name),
        "field",
        context.report,
    );
    for field in part
        .fields
        .iter()
        .filter(|field| !FIELDS.contains(&field.name.text.as_str()))
    {
        let diagnostic = Diagnostic::new(
            Code::UnknownField,
            field.name.span,
            format!("an action has no `{}`", field.name.text),
        );
        context.push(match nearest(&field.name.text, FIELDS) {
            Some(meant) => diagnostic
                .help(format!("did you mean `{meant}`?"))
                .edit(field.name.span, meant),
            None => diagnostic.help("its fields are `pick` and `place`"),
        });
    }
    let has_unknown = part
        .fields
        .iter()
        .any(|field| !FIELDS.contains(&field.name.text.as_str()));
    for wanted in FIELDS {
        let is_there = part.fields.iter().any(|field| field.name.text == wanted);
        // An unknown field is probably the missing one, misspelt.
        if !is_there && !has_unknown && !part.has_faults {
            let message = format!("the action has no `{wanted}`");
            context.push(
                Diagnostic::new(Code::MissingField, part.span, message)
                    .help(format!("write `{wanted}: one of …`")),
            );
        }
    }
    part.fields
        .iter()
        .map(|part| field(part, context))
        .collect()
}

fn field(part: &Field, context: &mut Context<'_>) -> ActionField {
    unique(part.one_of.iter(), "choice", context.report);
    let one_of = part
        .one_of
        .iter()
        .filter(|choice| is_offered(choice, context))
        .map(|choice| choice.text.clone());
    ActionField {
        name: part.name.text.clone(),
        choices: Choices::Points {
            keypoints: one_of.collect(),
        },
    }
}

/// Returns whether a choice names points; reports it where not.
fn is_offered(choice: &Ident, context: &mut Context<'_>) -> bool {
    match context.names.get(&choice.text) {
        Some(Meaning::Keypoint(Some(KeypointShape::Mask))) => {
            context.push(wrong_kind(
                choice,
                KeypointShape::Mask,
                "points to choose from",
            ));
            false
        }
        Some(Meaning::Keypoint(_)) => true,
        _ => {
            let has_points = |meaning| matches!(meaning, Meaning::Keypoint(shape) if shape != Some(KeypointShape::Mask));
            context.unknown("keypoint", choice, context.names.that(has_points));
            false
        }
    }
}

//! `example { say "…" reply "…" }` of a stage: questions with their answers.

use super::Context;
use super::files;
use crate::ast::{self, Reply, Saying, Sayings, Stage, Text};
use crate::diag::{Code, Diagnostic};
use crate::merge::once;
use fab_program::pointing::Notation;
use fab_program::reply;
use fab_program::space;
use fab_program::{ActionField, Example, LiteralText, ModelRole, Read, Value};

/// The most examples of a stage, and pictures of an example.
const MAX_EXAMPLES: usize = 32;
const MAX_IMAGES: usize = 8;

/// Builds the examples; what is wrong is left out.
pub(crate) fn check(
    stage: &Stage,
    role: Option<ModelRole>,
    read: Option<&Read>,
    context: &mut Context<'_>,
) -> Vec<Example> {
    if let Some(beyond) = stage.examples.get(MAX_EXAMPLES) {
        let message = format!("a stage has at most {MAX_EXAMPLES} examples");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return Vec::new();
    }
    stage
        .examples
        .iter()
        .filter_map(|example| one(example, role, read, context))
        .collect()
}

fn one(
    example: &ast::Example,
    role: Option<ModelRole>,
    read: Option<&Read>,
    context: &mut Context<'_>,
) -> Option<Example> {
    let say = once(&example.say, "`say`", |part| part.span, context.report);
    let reply = once(
        &example.replies,
        "`reply`",
        |part| part.span,
        context.report,
    );
    for (part, is_there) in [("say", say.is_some()), ("reply", reply.is_some())] {
        if !is_there && !example.has_faults {
            let message = format!("the example has no `{part}`");
            context.push(
                Diagnostic::new(Code::BadExample, example.span, message)
                    .help(format!("write `{part} \"…\"`")),
            );
        }
    }
    if let (Some(image), Some(ModelRole::Text)) = (example.images.first(), role) {
        let message = "a text model is shown the picture of an example";
        context.push(
            Diagnostic::new(Code::PicturesForTextModel, image.span, message)
                .help("write `model vision`, or remove the image"),
        );
    }
    if let Some(beyond) = example.images.get(MAX_IMAGES) {
        let message = format!("an example has at most {MAX_IMAGES} images");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return None;
    }
    let images: Vec<_> = example
        .images
        .iter()
        .filter_map(|image| files::named(&image.path, "an image", context))
        .collect();
    let say = say.and_then(|say| question(say, context));
    let reply = reply.and_then(|reply| answer(reply, read, context));
    let is_whole = images.len() == example.images.len();
    let example = Example {
        say: say?,
        images,
        reply: reply?,
    };
    is_whole.then_some(example)
}

fn question(say: &Sayings, context: &mut Context<'_>) -> Option<Vec<LiteralText>> {
    let mut texts = Vec::with_capacity(say.list.len());
    for saying in &say.list {
        match saying {
            Saying::Text(text) => texts.push(words(text, context)?),
            Saying::Component(name) => {
                let message = "an example says its own words, not components";
                context.push(
                    Diagnostic::new(Code::BadExample, name.span, message)
                        .help("write the text in quotes"),
                );
                return None;
            }
        }
    }
    Some(texts)
}

fn words(text: &Text, context: &mut Context<'_>) -> Option<LiteralText> {
    let plain = literal(text, context)?;
    let source = context.loaded.sources.get(text.span.file);
    Some(LiteralText {
        text: plain,
        declared_in: context.loaded.portable_names[text.span.file.0].clone(),
        line: source.line_and_column(text.start).0 as u32,
    })
}

/// Returns a text without placeholders.
pub(super) fn literal(text: &Text, context: &mut Context<'_>) -> Option<String> {
    let plain = text.plain();
    if plain.is_none() {
        let message = "this text stands as it is and has no `{{ … }}`";
        context.push(
            Diagnostic::new(Code::BadExample, text.span, message)
                .help("write the values themselves"),
        );
    }
    plain
}

/// Returns the answer, if the stage can read it.
fn answer(reply: &Reply, read: Option<&Read>, context: &mut Context<'_>) -> Option<LiteralText> {
    let answer = words(&reply.text, context)?;
    let said = answer.text.as_str();
    let unreadable = match read? {
        Read::Text { before, after, .. } => reply::read_text(before, after, said)
            .err()
            .map(|malformed| malformed.message),
        Read::Action => unreadable_action(said, context),
    };
    if let Some(why) = unreadable {
        let message = "the answer of this example is not one that the stage accepts";
        context.push(Diagnostic::new(Code::BadExample, reply.text.span, message).help(why));
        return None;
    }
    Some(answer)
}

/// Says why an answer cannot be read as an action whose fixed choices are offered; None: it can.
fn unreadable_action(said: &str, context: &Context<'_>) -> Option<String> {
    // Where a field's own declaration is wrong, an answer cannot be judged.
    let declared = context
        .names
        .that(|meaning| meaning == super::names::Meaning::Field);
    let is_whole = declared
        .iter()
        .all(|name| *name == "place" || context.actions.iter().any(|field| field.name == **name));
    if !is_whole {
        return None;
    }
    let edge_m = context
        .cloth
        .as_ref()
        .map_or(f64::NAN, |cloth| cloth.edge_m());
    let reading = match reply::read_fields(&context.actions, edge_m, &Notation::pixels(), said) {
        Ok(reading) => reading,
        Err(malformed) => return Some(malformed.message),
    };
    let is_offered = |field: &ActionField, value: &Value| {
        let declared = space::declared(field);
        declared.is_empty() || declared.contains(value)
    };
    let refused = context.actions.iter().find_map(|field| {
        let value = reading.value.get(&field.name)?;
        (!is_offered(field, value)).then(|| (field, value.clone()))
    });
    refused.map(|(field, value)| {
        format!(
            "the {} `{}` is not offered; it is one of {}",
            field.name,
            space::text(field, &value),
            space::listed(field, &space::declared(field))
        )
    })
}

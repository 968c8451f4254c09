//! `example { say "…" reply "…" }` of a stage: questions with their answers.

use super::context::Context;
use super::files;
use crate::diag::{Code, Diagnostic, Reported, every};
use crate::loader::Wanted;
use crate::merge::once;
use fab_grammar::ast::{self, ComponentOrText, Image, Reply, Sayings, Stage, Text};
use fab_program::pointing::Notation;
use fab_program::{
    ActionField, Example, FileRef, LiteralText, ModelRole, Read, Value, reply, space,
};

/// The most examples of a stage.
const MAX_EXAMPLES: usize = 32;

/// The most pictures of an example.
const MAX_IMAGES: usize = 8;

/// What the answers of a stage's examples must match.
struct Reader<'r> {
    role: Result<ModelRole, Reported>,
    read: Result<&'r Read, Reported>,
    fields: Result<Vec<ActionField>, Reported>,
}

/// Builds the examples of a stage.
///
/// - `role`, `read`: the model that the stage asks, and what it reads from the answer.
pub(crate) fn check<'a>(
    stage: Stage<'a>,
    role: Result<ModelRole, Reported>,
    read: Result<&Read, Reported>,
    context: &mut Context<'a, '_>,
) -> Vec<Result<Example, Reported>> {
    let beyond = stage
        .examples()
        .nth(MAX_EXAMPLES)
        .map(|example| example.head_span());
    let within = context.bounded(beyond, || {
        format!("a stage has at most {MAX_EXAMPLES} examples")
    });
    if let Err(reported) = within {
        return vec![Err(reported)];
    }
    let reader = Reader {
        role,
        read,
        fields: fields(context),
    };
    stage
        .examples()
        .map(|example| one(example, &reader, context))
        .collect()
}

/// Returns the fields of the action if all are right; without them no answer can be judged.
fn fields(context: &Context<'_, '_>) -> Result<Vec<ActionField>, Reported> {
    context.actions.complete?;
    context
        .actions
        .list
        .iter()
        .map(|(_, field)| field.clone())
        .collect()
}

fn one<'a>(
    example: ast::Example<'a>,
    reader: &Reader<'_>,
    context: &mut Context<'a, '_>,
) -> Result<Example, Reported> {
    let say = once(example.say(), "say", Sayings::span, context.report);
    let reply = once(example.replies(), "reply", Reply::span, context.report);
    let alone = say.alone.and(reply.alone);
    let say = required(say.first, "say", example, context).and_then(|say| question(say, context));
    let images = images(example, reader.role, context);
    let reply = required(reply.first, "reply", example, context);
    let reply = reply.and_then(|reply| answer(reply, reader, context));
    alone?;
    Ok(Example {
        say: say?,
        images: images?,
        reply: reply?,
    })
}

fn required<T>(
    part: Option<T>,
    what: &str,
    example: ast::Example<'_>,
    context: &mut Context<'_, '_>,
) -> Result<T, Reported> {
    part.ok_or_else(|| {
        let span = example.head_span();
        let message = format!("the example has no `{what}`");
        let diagnostic = Diagnostic::new(Code::BadExample, span, message);
        let diagnostic = diagnostic.help(format!("write `{what} \"…\"`"));
        context.error(diagnostic)
    })
}

fn question<'a>(
    say: Sayings<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<LiteralText>, Reported> {
    let texts = say.list().map(|saying| match saying {
        ComponentOrText::Text(text) => words(text, context),
        ComponentOrText::Component(name) => {
            let message = "an example cannot use components";
            let diagnostic = Diagnostic::new(Code::BadExample, name.span(), message);
            Err(context.error(diagnostic.help("write the text in quotes")))
        }
    });
    every(texts)
}

fn images<'a>(
    example: ast::Example<'a>,
    role: Result<ModelRole, Reported>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<FileRef>, Reported> {
    let mut all = Ok(());
    if let (Some(image), Ok(ModelRole::Text)) = (example.images().next(), role) {
        let message = "the example shows a picture to a text model";
        let diagnostic = Diagnostic::new(Code::PicturesForTextModel, image.span(), message);
        let help = "write `model vision`, or remove the image";
        all = Err(context.error(diagnostic.help(help)));
    }
    let beyond = example.images().nth(MAX_IMAGES).map(Image::span);
    context.bounded(beyond, || {
        format!("an example has at most {MAX_IMAGES} images")
    })?;
    let images = example
        .images()
        .map(|image| files::named(image.path(), "an image", Wanted::Picture, context));
    let images = every(images);
    all.and(images)
}

fn words(text: Text<'_>, context: &mut Context<'_, '_>) -> Result<LiteralText, Reported> {
    let plain = plain(text, context)?;
    let (declared_in, line) = context.loaded.place(text.span().file, text.start());
    Ok(LiteralText {
        text: plain,
        declared_in,
        line,
    })
}

/// Returns a text that must not have placeholders.
pub(super) fn plain(text: Text<'_>, context: &mut Context<'_, '_>) -> Result<String, Reported> {
    text.plain().ok_or_else(|| {
        let message = "this text is used as it is and cannot contain `{{ … }}`";
        let diagnostic = Diagnostic::new(Code::BadExample, text.span(), message);
        context.error(diagnostic.help("write the values themselves"))
    })
}

/// Returns the answer if the stage can read it.
fn answer(
    reply: Reply<'_>,
    reader: &Reader<'_>,
    context: &mut Context<'_, '_>,
) -> Result<LiteralText, Reported> {
    let answer = words(reply.text(), context)?;
    let refused = match reader.read? {
        Read::Text { before, after, .. } => {
            let reading = reply::read_text(before, after, &answer.text);
            reading.err().map(|malformed| malformed.message)
        }
        Read::Action => {
            let fields = reader.fields.as_ref().map_err(|reported| *reported)?;
            unreadable_action(fields, context.edge_m()?, &answer.text)
        }
    };
    let Some(why) = refused else {
        return Ok(answer);
    };
    let message = "the stage does not accept the answer of this example";
    let diagnostic = Diagnostic::new(Code::BadExample, reply.text().span(), message);
    Err(context.error(diagnostic.help(why)))
}

/// Returns why an answer cannot be read as an action, or which of its choices is not offered; `None` if it is right.
fn unreadable_action(fields: &[ActionField], edge_m: f64, answer: &str) -> Option<String> {
    let reading = match reply::read_fields(fields, edge_m, &Notation::pixels(), answer) {
        Ok(reading) => reading,
        Err(malformed) => return Some(malformed.message),
    };
    fields.iter().find_map(|field| {
        let value: &Value = reading.value.get(&field.name)?;
        let offered = space::declared(field);
        (!offered.is_empty() && !offered.contains(value)).then(|| {
            format!(
                "the {} `{}` is not offered; the choices are {}",
                field.name,
                space::text(field, value),
                space::listed(field, &offered)
            )
        })
    })
}

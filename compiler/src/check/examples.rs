//! `example { say "…" reply "…" }` of a stage: questions with their answers.

use super::context::{Context, Result};
use super::files;
use crate::diag::{Code, every};
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
    stage: &'r str,
    role: Result<ModelRole>,
    read: Result<&'r Read>,
    fields: Result<Vec<ActionField>>,
}

/// Builds the examples of a stage.
///
/// - `role`, `read`: the model that the stage asks, and what it reads from the answer.
pub(crate) fn check(
    stage: Stage<'_>,
    role: Result<ModelRole>,
    read: Result<&Read>,
    context: &mut Context<'_>,
) -> Result<Vec<Example>> {
    let places = stage.examples().map(|example| example.head_span());
    context.at_most(MAX_EXAMPLES, places, "a stage", "examples")?;
    let reader = Reader {
        stage: stage.name().text(),
        role,
        read,
        // Without all of them, no answer can be judged.
        fields: { context.complete }.map(|()| context.actions.right().cloned().collect()),
    };
    every({ stage.examples() }.map(|example| one(example, &reader, context)))
}

fn one(
    example: ast::Example<'_>,
    reader: &Reader<'_>,
    context: &mut Context<'_>,
) -> Result<Example> {
    let say = once(example.say(), "say", Sayings::span, context.report);
    let reply = once(example.replies(), "reply", Reply::span, context.report);
    let (Some(say), Some(reply)) = (say, reply) else {
        let lines = [("say", say.is_some()), ("reply", reply.is_some())];
        let block = ("the example", example.head_span());
        let help = "it needs both a `say \"…\"` and a `reply \"…\"`";
        return Err(context.lacking(Code::BadExample, block, &lines, help));
    };
    let say = question(say, context);
    let images = images(example, reader, context);
    let reply = answer(reply, reader, context);
    Ok(Example {
        say: say?,
        images: images?,
        reply: reply?,
    })
}

fn question(say: Sayings<'_>, context: &mut Context<'_>) -> Result<Vec<LiteralText>> {
    let texts = say.list().map(|saying| match saying {
        ComponentOrText::Text(text) => words(text, context),
        ComponentOrText::Component(name) => {
            let message = "an example cannot use components";
            let help = "write the text in quotes";
            Err(context.refuse(Code::BadExample, name.span(), message, help))
        }
    });
    every(texts)
}

fn images(
    example: ast::Example<'_>,
    reader: &Reader<'_>,
    context: &mut Context<'_>,
) -> Result<Vec<FileRef>> {
    if let (Some(image), Ok(ModelRole::Text)) = (example.images().next(), reader.role) {
        context.text_model(image.span(), "the example", reader.stage);
    }
    let places = example.images().map(Image::span);
    context.at_most(MAX_IMAGES, places, "an example", "images")?;
    let image = |it: Image<'_>| files::named(it.path(), "an image", Wanted::Picture, context);
    every(example.images().map(image))
}

fn words(text: Text<'_>, context: &mut Context<'_>) -> Result<LiteralText> {
    let plain = plain(text, context)?;
    let (declared_in, line) = context.loaded.place(text.span().file, text.start());
    Ok(LiteralText {
        text: plain,
        declared_in,
        line,
    })
}

/// Returns a text that must not have placeholders.
pub(super) fn plain(text: Text<'_>, context: &mut Context<'_>) -> Result<String> {
    text.plain().ok_or_else(|| {
        let message = "this text is used as it is and cannot contain `{{ … }}`";
        let help = "write the values themselves";
        context.refuse(Code::BadExample, text.span(), message, help)
    })
}

/// Returns the answer if the stage can read it.
fn answer(reply: Reply<'_>, reader: &Reader<'_>, context: &mut Context<'_>) -> Result<LiteralText> {
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
    Err(context.refuse(Code::BadExample, reply.text().span(), message, why))
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
        let (name, stated) = (&field.name, space::text(field, value));
        let listed = space::listed(field, &offered);
        (!offered.is_empty() && !offered.contains(value))
            .then(|| format!("the {name} `{stated}` is not offered; the choices are {listed}"))
    })
}

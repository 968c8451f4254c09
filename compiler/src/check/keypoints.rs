//! `const reach = 0.2edge` and `keypoints { cloth = mask(depth < 646mm) … }`.

use super::context::Context;
use super::expressions::{Scope, call};
use super::names::Meaning;
use super::quantity::unit;
use crate::diag::{Code, Diagnostic, Reported, every};
use crate::merge::Merged;
use fab_grammar::ast::{Expr, Name, NamedValue};
use fab_program::data::keypoints::AT;
use fab_program::vocabulary::Args;
use fab_program::{EXTRACTORS, Keypoint, Moment};

/// The most keypoints of a task.
const MAX_KEYPOINTS: usize = 256;

/// Names that keypoints cannot have.
pub(crate) const RESERVED: [&str; 5] = ["last", "step", "scene", "depth", "unreachable"];

/// Reads the constants.
pub(crate) fn constants<'a>(merged: &Merged<'a>, context: &mut Context<'a, '_>) {
    for constant in merged.constants.iter() {
        let is_free = is_free(constant.name(), context);
        let value = match constant.value() {
            Expr::Quantity(quantity) => match quantity.unit() {
                Some(name) => unit(quantity, name, context).map(|_| quantity),
                None => Ok(quantity),
            },
            other => {
                let found = context.written(other.span());
                let message = format!("expected a number and its unit, found `{found}`");
                let diagnostic = Diagnostic::new(Code::WrongForm, other.span(), message);
                let help = format!("write `const {} = 20mm`", constant.name().text());
                Err(context.error(diagnostic.help(help)))
            }
        };
        let value = value.and_then(|value| is_free.map(|()| value));
        context.constants.insert(constant.name().text(), value);
    }
}

/// Reports a constant with the name of a reserved word, a text or a field. A clash with a keypoint is reported there.
fn is_free(name: Name<'_>, context: &mut Context<'_, '_>) -> Result<(), Reported> {
    let taken_by = match context.names.get(name.text()) {
        _ if RESERVED.contains(&name.text()) => "is a reserved name",
        Some(Meaning::Text { .. }) => "is a text that a stage reads",
        Some(Meaning::Field) => "is a field of the action",
        Some(Meaning::DuplicateNames(reported)) => return Err(reported),
        Some(Meaning::Keypoint(_)) | None => return Ok(()),
    };
    let message = format!("`{}` {taken_by}", name.text());
    let diagnostic = Diagnostic::new(Code::DuplicateName, name.span(), message);
    Err(context.error(diagnostic.help("choose another name for the constant")))
}

/// Builds the keypoints in order.
pub(crate) fn check<'a>(
    merged: &Merged<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<Keypoint>, Reported> {
    let beyond = merged.keypoints.iter().nth(MAX_KEYPOINTS);
    context.bounded(beyond.map(|it| it.name().span()), || {
        format!("a task has at most {MAX_KEYPOINTS} keypoints")
    })?;
    let places = merged.keypoints.iter().filter_map(|keypoint| {
        let name = keypoint.name().text();
        Some((name, (merged.keypoints.place(name)?, Ok(()))))
    });
    context.keypoints = places.collect();
    every(merged.keypoints.iter().map(|keypoint| {
        let found = keypoint_of(keypoint, merged, context);
        if let (Err(reported), Some((_, state))) =
            (&found, context.keypoints.get_mut(keypoint.name().text()))
        {
            *state = Err(*reported);
        }
        found
    }))
}

fn keypoint_of<'a>(
    keypoint: NamedValue<'a>,
    merged: &Merged<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Keypoint, Reported> {
    let name = keypoint.name();
    let mut named = context.names.one_meaning(name.text());
    if RESERVED.contains(&name.text()) {
        let message = format!("`{}` is a reserved name", name.text());
        let diagnostic = Diagnostic::new(Code::DuplicateName, name.span(), message);
        named = Err(context.error(diagnostic.help("choose another name for the keypoint")));
    }
    if let Some(constant) = merged.constants.get(name.text()) {
        let message = format!("the name `{}` is declared twice", name.text());
        let diagnostic = Diagnostic::new(Code::DuplicateName, name.span(), message);
        named = Err(context
            .error(diagnostic.also(constant.name().span(), "this constant has the same name")));
    }
    let signatures = EXTRACTORS.iter().map(|row| &row.call.signature);
    let scope = Scope::Above(merged.keypoints.place(name.text()).unwrap_or_default());
    let (row, args, _) = call("extractor", keypoint.value(), signatures, scope, context)?;
    named?;
    Ok(Keypoint {
        name: name.text().to_owned(),
        moment: moment(&args),
        extractor: (EXTRACTORS[row].call.make)(&args),
    })
}

/// Returns the picture that a keypoint is taken from: the latest one without an `at` argument.
fn moment(args: &Args) -> Moment {
    if args.is_given(AT.name) {
        args.meaning(AT.name, Moment::from_word)
    } else {
        Moment::Now
    }
}

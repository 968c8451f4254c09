//! `const reach = 0.2edge` and `keypoints { cloth = mask(depth < 646mm) … }`.

use super::context::{Context, Result};
use super::expressions::call;
use super::names::Meaning;
use super::quantity::unit;
use crate::diag::{Code, every};
use crate::merge::Merged;
use fab_grammar::ast::{Expr, NamedValue};
use fab_program::data::keypoints::AT;
use fab_program::vocabulary::Args;
use fab_program::{EXTRACTORS, Keypoint, Moment};

/// The most keypoints of a task.
const MAX_KEYPOINTS: usize = 256;

/// Checks the values of the constants.
pub(crate) fn constants<'a>(merged: &Merged<'a>, context: &mut Context<'a>) {
    for constant in merged.constants.iter() {
        let name = constant.name().text();
        let value = match constant.value() {
            Expr::Quantity(quantity) => match quantity.unit() {
                Some(name) => unit(quantity, name, context).map(drop),
                None => Ok(()),
            },
            other => {
                let expected = "a number and its unit";
                let diagnostic = context.unexpected(Code::WrongForm, other, expected);
                let help = format!("write `const {name} = 20mm`");
                Err(context.error(diagnostic.help(help)))
            }
        };
        if let Err(reported) = value {
            context.names.fail(name, reported);
        }
    }
}

/// Builds the keypoints in order.
pub(crate) fn check<'a>(merged: &Merged<'a>, context: &mut Context<'a>) -> Result<Vec<Keypoint>> {
    let places = merged.keypoints.iter().map(|it| it.name().span());
    context.at_most(MAX_KEYPOINTS, places, "a task", "keypoints")?;
    every(merged.keypoints.iter().map(|declared| {
        let name = declared.name().text();
        let found = keypoint(declared, merged, context);
        // Without a shape, nothing can be said about where it is used.
        if let (Err(reported), Ok(Some(Meaning::Keypoint(None, _)))) =
            (&found, context.names.get(name))
        {
            context.names.fail(name, *reported);
        }
        found
    }))
}

fn keypoint(
    declared: NamedValue<'_>,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Result<Keypoint> {
    let name = declared.name().text();
    let signatures = EXTRACTORS.iter().map(|row| &row.call.signature);
    context.n_keypoints = merged.keypoints.place(name).unwrap_or_default();
    let called = call("extractor", declared.value(), signatures, context);
    context.n_keypoints = usize::MAX;
    let (row, args, _) = called?;
    Ok(Keypoint {
        name: name.to_owned(),
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

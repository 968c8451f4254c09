//! `annotate { corner_dots = dot(corners, color: blue) … }`: what is drawn on the camera's picture.

use super::context::{Context, Named, Result};
use super::expressions::call;
use crate::lang::annotate::{COLOR, MARKS, POINTS, rgb};
use crate::merge::Merged;
use fab_grammar::ast::NamedValue;
use fab_program::Depends;
use fab_program::vocabulary::{ArgValue, Args};
use fab_program::{Layer, Spot};

/// The most layers.
const MAX_LAYERS: usize = 32;

/// Builds the layers in order.
pub(crate) fn check<'a>(merged: &Merged<'a>, context: &mut Context<'a>) {
    let layers = || merged.annotate().into_iter().flat_map(|part| part.list());
    let places = layers().map(|declared| declared.name().span());
    let within = context.at_most(MAX_LAYERS, places, "a task", "layers");
    let layers = layers().map(|declared| {
        let layer = within.and_then(|()| layer(declared, context));
        (declared.name().text(), layer)
    });
    context.layers = Named(layers.collect());
}

fn layer(declared: NamedValue<'_>, context: &mut Context<'_>) -> Result<Layer> {
    let name = declared.name();
    let signatures = MARKS.iter().map(|row| &row.signature);
    let (row, args, bound) = call("mark", declared.value(), signatures, context)?;
    for ((_, value), (_, expr)) in args.0.iter().zip(&bound) {
        if let ArgValue::Point(point) = value
            && point.uses().action
        {
            context.needs_action(expr.span());
        }
    }
    let mark = (MARKS[row].make)(&args);
    let words = words(MARKS[row].signature.name, &args);
    Ok(Layer {
        name: name.text().to_owned(),
        rgb: rgb(args.word(COLOR.name)),
        mark,
        words,
    })
}

/// Returns a layer's name as prompts write it, without an article: `blue dots`, `red ring`.
fn words(mark: &str, args: &Args) -> String {
    let color = args.word(COLOR.name);
    let ending = match (args.spots(POINTS.name).as_slice(), mark) {
        // A mark without a list of points is drawn once.
        ([] | [Spot::One { .. }], _) => "",
        (_, "cross") => "es",
        _ => "s",
    };
    format!("{color} {mark}{ending}")
}

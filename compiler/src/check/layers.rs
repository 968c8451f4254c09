//! `annotate { corner_dots = dot(corners, color: blue) … }`: what is drawn on the camera's picture.

use super::Context;
use super::arguments::{Bound, bare, bind, optional, rest};
use super::measures::keypoint;
use super::names::Meaning;
use super::points::point;
use super::quantity::{Measure, Wanted, read_whole};
use crate::ast::{Argument, Expr, ExprKind, Ident, Keypoint};
use crate::diag::{Code, Diagnostic};
use crate::merge::{Merged, unique};
use fab_program::Depends;
use fab_program::{KeypointShape, Layer, Mark, Point, Spot};

/// The most layers.
const MAX_LAYERS: usize = 32;

const RADIUS: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=100.0,
    range_words: "a size from `1px` to `100px`",
};
const WIDTH: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=20.0,
    range_words: "a width from `1px` to `20px`",
};

/// The colours, red green blue.
const COLORS: &[(&str, [u8; 3])] = &[
    ("black", [0, 0, 0]),
    ("white", [255, 255, 255]),
    ("gray", [128, 128, 128]),
    ("red", [255, 0, 0]),
    ("green", [0, 255, 0]),
    ("blue", [0, 0, 255]),
    ("yellow", [255, 255, 0]),
    ("cyan", [0, 255, 255]),
    ("magenta", [255, 0, 255]),
    ("purple", [128, 0, 128]),
];

/// Builds the layers in order; what is wrong is left out.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Vec<Layer> {
    let Some(part) = merged.annotate else {
        return Vec::new();
    };
    unique(
        part.list.iter().map(|layer| &layer.name),
        "layer",
        context.report,
    );
    if let Some(beyond) = part.list.get(MAX_LAYERS) {
        let message = format!("at most {MAX_LAYERS} layers are drawn");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return Vec::new();
    }
    part.list
        .iter()
        .filter_map(|declared| layer(declared, context))
        .collect()
}

fn layer(declared: &Keypoint, context: &mut Context<'_>) -> Option<Layer> {
    const FORMS: &str = "write `dot(corners, color: blue)`, `ring(…)`, `cross(…)`, `number(…)`, `arrow(A, B, …)`, `box(…)` or `outline(…)`";
    let ExprKind::Call { name, arguments } = &declared.value.kind else {
        let message = "expected something to draw";
        context.push(Diagnostic::new(Code::WrongForm, declared.value.span, message).help(FORMS));
        return None;
    };
    if context.names.get(&declared.name.text).is_some() {
        let message = format!("the name `{}` is declared twice", declared.name.text);
        context.push(
            Diagnostic::new(Code::DuplicateName, declared.name.span, message)
                .help("layers share one space of names with keypoints, texts and fields"),
        );
    }
    let (mark, word, is_one) = match name.text.as_str() {
        "dot" => spots(name, arguments, context, |at, radius_px, _| Mark::Dot {
            at,
            radius_px,
        })?,
        "ring" => spots(name, arguments, context, |at, radius_px, width_px| {
            Mark::Ring {
                at,
                radius_px,
                width_px,
            }
        })?,
        "cross" => spots(name, arguments, context, |at, radius_px, width_px| {
            Mark::Cross {
                at,
                radius_px,
                width_px,
            }
        })?,
        "number" => spots(name, arguments, context, |at, _, _| Mark::Number { at })?,
        "arrow" => arrow(name, arguments, context)?,
        "box" => framed(name, arguments, KeypointShape::Box, context)?,
        "outline" => framed(name, arguments, KeypointShape::Outline, context)?,
        _ => {
            let known = ["dot", "ring", "cross", "number", "arrow", "box", "outline"];
            context.unknown("mark", name, known);
            return None;
        }
    };
    let (color, rgb) = color(name, arguments, context)?;
    let words = match is_one {
        Several::No => format!("{color} {word}"),
        Several::Yes => format!("{color} {}", plural(word)),
    };
    Some(Layer {
        name: declared.name.text.clone(),
        rgb,
        mark,
        words,
    })
}

/// Whether a layer draws its mark more than once.
enum Several {
    Yes,
    No,
}

fn plural(word: &str) -> String {
    match word {
        "cross" | "box" => format!("{word}es"),
        _ => format!("{word}s"),
    }
}

fn color(
    call: &Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
) -> Option<(&'static str, [u8; 3])> {
    let given = arguments.iter().find(|argument| {
        argument
            .label
            .as_ref()
            .is_some_and(|label| label.text == "color")
    });
    let Some(argument) = given else {
        let message = format!("`{}` lacks `color`", call.text);
        context.push(
            Diagnostic::new(Code::WrongArguments, call.span, message).help("write `color: blue`"),
        );
        return None;
    };
    let names = || COLORS.iter().map(|(name, _)| *name);
    let ExprKind::Name(text) = &argument.value.kind else {
        let found = context.written(argument.value.span);
        let message = format!("expected a colour, found `{found}`");
        context.push(
            Diagnostic::new(Code::WrongForm, argument.value.span, message)
                .help(format!("colours are {}", crate::diag::among(names()))),
        );
        return None;
    };
    let found = COLORS.iter().find(|(name, _)| name == text);
    if found.is_none() {
        let name = Ident {
            text: text.clone(),
            span: argument.value.span,
        };
        context.unknown("colour", &name, names());
    }
    found.copied()
}

type Drawn<'w> = (Mark, &'w str, Several);

fn spots<'w>(
    name: &'w Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
    mark: impl Fn(Vec<Spot>, u32, u32) -> Mark,
) -> Option<Drawn<'w>> {
    let parameters = match name.text.as_str() {
        "dot" => vec![rest("points"), optional("color"), optional("radius")],
        "number" => vec![rest("points"), optional("color")],
        _ => vec![
            rest("points"),
            optional("color"),
            optional("radius"),
            optional("width"),
        ],
    };
    let bound = bind(name, arguments, &parameters, context)?;
    let radius_px = size(&bound, "radius", &RADIUS, 3, context);
    let width_px = size(&bound, "width", &WIDTH, 1, context);
    let mut at = Vec::new();
    let mut is_right = true;
    for expr in bound.rest() {
        match spot(expr, context) {
            Some(spot) => at.push(spot),
            None => is_right = false,
        }
    }
    let several = match at.as_slice() {
        [Spot::One { .. }] => Several::No,
        _ => Several::Yes,
    };
    let mark = mark(at, radius_px?, width_px?);
    is_right.then_some((mark, name.text.as_str(), several))
}

fn size(
    bound: &Bound<'_>,
    name: &str,
    wanted: &Wanted,
    default: u32,
    context: &mut Context<'_>,
) -> Option<u32> {
    bound
        .get(name)
        .map_or(Some(default), |size| read_whole(size, wanted, context))
}

fn spot(expr: &Expr, context: &mut Context<'_>) -> Option<Spot> {
    if let ExprKind::Name(name) = &expr.kind
        && context.names.get(name) == Some(Meaning::Keypoint(Some(KeypointShape::Points)))
    {
        return Some(Spot::Points {
            keypoint: name.clone(),
        });
    }
    let point = settled(expr, context)?;
    Some(Spot::One { point })
}

/// Builds a point that is known before an action is proposed.
fn settled(expr: &Expr, context: &mut Context<'_>) -> Option<Point> {
    let point = point(expr, context)?;
    if point.uses().action {
        super::uses::needs_action(expr.span, context);
        return None;
    }
    Some(point)
}

fn arrow<'w>(
    name: &'w Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
) -> Option<Drawn<'w>> {
    let parameters = [
        bare("from"),
        bare("to"),
        optional("color"),
        optional("width"),
    ];
    let bound = bind(name, arguments, &parameters, context)?;
    let from = settled(bound.get("from")?, context);
    let to = settled(bound.get("to")?, context);
    let width_px = size(&bound, "width", &WIDTH, 2, context);
    let mark = Mark::Arrow {
        from: from?,
        to: to?,
        width_px: width_px?,
    };
    Some((mark, "arrow", Several::No))
}

fn framed<'w>(
    name: &'w Ident,
    arguments: &[Argument],
    shape: KeypointShape,
    context: &mut Context<'_>,
) -> Option<Drawn<'w>> {
    let (own, words) = match shape {
        KeypointShape::Box => ("spacing", "a box"),
        _ => ("width", "an outline"),
    };
    let parameters = [bare("keypoint"), optional("color"), optional(own)];
    let bound = bind(name, arguments, &parameters, context)?;
    let of = keypoint(bound.get("keypoint")?, &[shape], words, context);
    let size = size(&bound, own, &WIDTH, 1, context);
    let mark = match shape {
        KeypointShape::Box => Mark::Box {
            of: of?,
            spacing_px: size?,
        },
        _ => Mark::Outline {
            of: of?,
            width_px: size?,
        },
    };
    Some((mark, name.text.as_str(), Several::No))
}

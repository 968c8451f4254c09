//! `keypoints { cloth = mask(depth < 646mm) … }`.

use super::Context;
use super::extractors;
use super::masks;
use super::names::Meaning;
use crate::ast::{Argument, Expr, ExprKind, Ident, Keypoint};
use crate::diag::{Code, Diagnostic, among};
use crate::merge::Merged;
use fab_program::{self as program, Extractor, KeypointShape, Moment};

/// The most keypoints of a task.
const MAX_KEYPOINTS: usize = 256;

/// The extractors.
const EXTRACTORS: [&str; 13] = [
    "mask",
    "closed",
    "largest",
    "harris",
    "shi_tomasi",
    "centroid",
    "bounding_box",
    "center",
    "contour",
    "edge_middles",
    "along",
    "toward",
    "points",
];

/// Builds the keypoints in order; what is wrong is left out.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Vec<program::Keypoint> {
    let mut found = Vec::with_capacity(merged.keypoints.len());
    if let Some(beyond) = merged.keypoints.iter().nth(MAX_KEYPOINTS) {
        let message = format!("a task has at most {MAX_KEYPOINTS} keypoints");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return found;
    }
    for keypoint in merged.keypoints.iter() {
        let name = &keypoint.name.text;
        if matches!(
            name.as_str(),
            "last" | "step" | "scene" | "depth" | "unreachable"
        ) {
            let message = format!("`{name}` has a meaning of its own");
            context.push(
                Diagnostic::new(Code::DuplicateName, keypoint.name.span, message)
                    .help("choose another name for the keypoint"),
            );
        }
        if let Some(constant) = context.constants.get(name.as_str()) {
            let span = constant.name.span;
            let message = format!("the name `{name}` is declared twice");
            context.push(
                Diagnostic::new(Code::DuplicateName, keypoint.name.span, message)
                    .also(span, "this constant has it too"),
            );
        }
        let earlier = Earlier {
            merged,
            place: merged.keypoints.place(name).unwrap_or_default(),
        };
        if let Some((moment, extractor)) = extractor(keypoint, earlier, context) {
            found.push(program::Keypoint {
                name: name.clone(),
                moment,
                extractor,
            });
        }
    }
    found
}

/// The keypoints above one.
#[derive(Clone, Copy)]
pub(super) struct Earlier<'m, 'a> {
    merged: &'m Merged<'a>,
    place: usize,
}

impl Earlier<'_, '_> {
    /// Returns the name of an earlier keypoint of a shape; None, with a report, where there is none.
    pub fn named(
        self,
        expr: &Expr,
        wanted: KeypointShape,
        context: &mut Context<'_>,
    ) -> Option<String> {
        let words = a_shape(wanted);
        let ExprKind::Name(name) = &expr.kind else {
            let message = format!("expected the name of {words}");
            context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
            return None;
        };
        let name = Ident {
            text: name.clone(),
            span: expr.span,
        };
        match context.names.get(&name.text) {
            Some(Meaning::Keypoint(shape)) => {
                let place = self.merged.keypoints.place(&name.text);
                if place.is_none_or(|place| place >= self.place) {
                    let message = format!("`{}` is declared only below", name.text);
                    context.push(
                        Diagnostic::new(Code::NotYetKnown, name.span, message)
                            .help("an extractor uses keypoints above it"),
                    );
                    return None;
                }
                // A keypoint whose own declaration is wrong is reported there.
                let shape = shape?;
                if shape != wanted {
                    context.push(wrong_kind(&name, shape, words));
                    return None;
                }
                Some(name.text)
            }
            _ => {
                let fits = |meaning| meaning == Meaning::Keypoint(Some(wanted));
                let kind = match wanted {
                    KeypointShape::Box => "box",
                    KeypointShape::Outline => "outline",
                    KeypointShape::Points => "list of points",
                    KeypointShape::Point => "point",
                    KeypointShape::Mask => "mask",
                };
                context.unknown(kind, &name, context.names.that(fits));
                None
            }
        }
    }
}

fn extractor(
    keypoint: &Keypoint,
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let ExprKind::Call { name, arguments } = &keypoint.value.kind else {
        context.push(
            Diagnostic::new(Code::WrongForm, keypoint.value.span, "expected an extractor")
                .help("write `mask(depth < 646mm)`, `harris(MASK, …)`, `shi_tomasi(MASK, …)` or `centroid(MASK)`"),
        );
        return None;
    };
    let arguments: &[Argument] = arguments;
    let one = |parameter: (&'static str, KeypointShape), make, context: &mut Context<'_>| {
        extractors::of_one(name, arguments, parameter, make, earlier, context)
    };
    let of_mask = ("mask", KeypointShape::Mask);
    match name.text.as_str() {
        "mask" => masks::mask(name, arguments, context),
        "closed" => masks::closed(name, arguments, earlier, context),
        "largest" => masks::largest(name, arguments, earlier, context),
        "toward" => extractors::toward(name, arguments, earlier, context),
        "harris" | "shi_tomasi" => extractors::corners(name, arguments, earlier, context),
        "centroid" => one(of_mask, |mask| Extractor::Centroid { mask }, context),
        "bounding_box" => one(of_mask, |mask| Extractor::BoundingBox { mask }, context),
        "center" if arguments.is_empty() => Some((Moment::Now, Extractor::PictureCenter)),
        "center" => one(
            ("box", KeypointShape::Box),
            |of| Extractor::BoxCenter { of },
            context,
        ),
        "edge_middles" => one(
            ("outline", KeypointShape::Outline),
            |outline| Extractor::EdgeMiddles { outline },
            context,
        ),
        "contour" => extractors::contour(name, arguments, earlier, context),
        "along" => extractors::along(name, arguments, earlier, context),
        "points" => extractors::fixed(name, arguments, context),
        _ => {
            context.unknown("extractor", name, EXTRACTORS);
            None
        }
    }
}

fn a_shape(shape: KeypointShape) -> &'static str {
    match shape {
        KeypointShape::Mask => "a mask",
        KeypointShape::Box => "a box",
        KeypointShape::Outline => "an outline",
        KeypointShape::Points => "a list of points",
        KeypointShape::Point => "a point",
    }
}

/// Reports a keypoint of the wrong shape.
pub(super) fn wrong_kind(name: &Ident, shape: KeypointShape, wanted: &str) -> Diagnostic {
    let is = match shape {
        KeypointShape::Mask => "a mask, a set of pixels",
        other => a_shape(other),
    };
    Diagnostic::new(
        Code::WrongKindOfName,
        name.span,
        format!("expected {wanted}, found `{}`", name.text),
    )
    .label(format!("this is {is}"))
}

/// Reads `at: now` or `at: start`.
pub(super) fn moment(at: Option<&Expr>, context: &mut Context<'_>) -> Option<Moment> {
    let Some(expr) = at else {
        return Some(Moment::Now);
    };
    match &expr.kind {
        ExprKind::Name(name) if name == "now" => Some(Moment::Now),
        ExprKind::Name(name) if name == "start" => Some(Moment::Start),
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected {}, found `{found}`", among(["now", "start"]));
            context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
            None
        }
    }
}

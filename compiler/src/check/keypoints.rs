//! `keypoints { cloth = mask(depth < 646mm) … }`.

use super::Context;
use super::arguments::{Bound, Parameter, bare, bind, named, optional};
use super::camera::IMAGE;
use super::names::Meaning;
use super::quantity::{Measure, Wanted, read, read_whole};
use crate::ast::{Argument, Expr, ExprKind, Ident, Keypoint};
use crate::diag::{Code, Diagnostic, among};
use crate::merge::Merged;
use crate::program::{self, Camera, Extractor, KeypointShape, Moment, Response, Sight};

/// Harris' free parameter where none is stated: the detector's usual one (protocol, section 6).
const DEFAULT_HARRIS_K: f64 = 0.04;

const DEPTH: Wanted = Wanted {
    measure: Measure::Length,
    range: 1e-3..=10.0,
    range_words: "a depth from `1mm` to `10m`",
};
const MAX_POINTS: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=1000.0,
    range_words: "a number of points from `1` to `1000`",
};
const QUALITY: Wanted = Wanted {
    measure: Measure::Number,
    range: 1e-6..=1.0,
    range_words: "a fraction above `0` and at most `1`",
};
const SPACING: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 0.0..=2048.0,
    range_words: "a distance from `0px` to `2048px`",
};
const HARRIS_K: Wanted = Wanted {
    measure: Measure::Number,
    range: 1e-3..=0.25,
    range_words: "a number from `0.001` to `0.25`",
};

/// Builds the keypoints in order; what is wrong is left out.
pub(crate) fn check(
    merged: &Merged<'_>,
    camera: Option<&Camera>,
    context: &mut Context<'_>,
) -> Vec<program::Keypoint> {
    let mut found = Vec::with_capacity(merged.keypoints.len());
    for (number, keypoint) in merged.keypoints.iter().enumerate() {
        let earlier: Vec<&str> = merged.keypoints[..number]
            .iter()
            .map(|keypoint| keypoint.name.text.as_str())
            .collect();
        if let Some((moment, extractor)) = extractor(keypoint, &earlier, camera, context) {
            found.push(program::Keypoint {
                name: keypoint.name.text.clone(),
                moment,
                extractor,
            });
        }
    }
    found
}

fn extractor(
    keypoint: &Keypoint,
    earlier: &[&str],
    camera: Option<&Camera>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let ExprKind::Call { name, arguments } = &keypoint.value.kind else {
        context.push(
            Diagnostic::new(Code::WrongForm, keypoint.value.span, "expected an extractor")
                .help("write `mask(depth < 646mm)`, `harris(MASK, …)`, `shi_tomasi(MASK, …)` or `centroid(MASK)`"),
        );
        return None;
    };
    match name.text.as_str() {
        "mask" => {
            let bound = bind(name, arguments, &[bare("depth < limit")], context)?;
            let below_m = depth_limit(bound.get("depth < limit")?, camera, context)?;
            Some((Moment::Now, Extractor::DepthMask { below_m }))
        }
        "harris" => {
            let bound = corner_arguments(name, arguments, Some(optional("k")), context)?;
            let k = bound
                .get("k")
                .map_or(Some(DEFAULT_HARRIS_K), |k| read(k, &HARRIS_K, context));
            let response = k.map(|k| Response::Harris { k });
            corners(&bound, response, earlier, context)
        }
        "shi_tomasi" => {
            let bound = corner_arguments(name, arguments, None, context)?;
            corners(&bound, Some(Response::ShiTomasi), earlier, context)
        }
        "centroid" => {
            let bound = bind(name, arguments, &[bare("mask"), optional("at")], context)?;
            let mask = mask(bound.get("mask")?, earlier, context);
            let moment = moment(bound.get("at"), context);
            Some((moment?, Extractor::Centroid { mask: mask? }))
        }
        _ => {
            context.unknown(
                "extractor",
                name,
                ["mask", "harris", "shi_tomasi", "centroid"],
            );
            None
        }
    }
}

fn depth_limit(expr: &Expr, camera: Option<&Camera>, context: &mut Context<'_>) -> Option<f64> {
    let limit = match &expr.kind {
        ExprKind::Compare { left, sign, right }
            if sign.text == "<"
                && matches!(&left.kind, ExprKind::Name(name) if name == "depth") =>
        {
            right
        }
        _ => {
            context.push(
                Diagnostic::new(Code::WrongForm, expr.span, "expected a limit of the depth")
                    .help("write `mask(depth < 646mm)`: the pixels nearer to the camera than that"),
            );
            return None;
        }
    };
    let below_m = read(limit, &DEPTH, context)?;
    if let Some(camera) = camera
        && below_m >= camera.height_m
    {
        let message = format!(
            "the mask reaches the table, which is {}mm from the camera",
            camera.height_m * 1000.0
        );
        context.push(
            Diagnostic::new(Code::MaskSeesTable, limit.span, message)
                .help("a flat cloth lies about 5 mm above the table"),
        );
    }
    Some(below_m)
}

/// Matches what every corner detector takes, and what only one does.
fn corner_arguments<'a>(
    name: &Ident,
    arguments: &'a [Argument],
    own: Option<Parameter>,
    context: &mut Context<'_>,
) -> Option<Bound<'a>> {
    let mut parameters = vec![
        bare("mask"),
        named("image"),
        named("max"),
        named("quality"),
        named("spacing"),
    ];
    parameters.extend(own);
    parameters.push(optional("at"));
    bind(name, arguments, &parameters, context)
}

fn corners(
    bound: &Bound<'_>,
    response: Option<Response>,
    earlier: &[&str],
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let mask = mask(bound.get("mask")?, earlier, context);
    let image_px = read_whole(bound.get("image")?, &IMAGE, context);
    let max = read_whole(bound.get("max")?, &MAX_POINTS, context);
    let quality = read(bound.get("quality")?, &QUALITY, context);
    let spacing_px = read(bound.get("spacing")?, &SPACING, context);
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Corners {
        mask: mask?,
        of: Sight::Depth,
        image_px: image_px?,
        max: max?,
        quality: quality?,
        spacing_px: spacing_px?,
        block_px: 3,
        response: response?,
    };
    Some((moment?, extractor))
}

fn mask(expr: &Expr, earlier: &[&str], context: &mut Context<'_>) -> Option<String> {
    let ExprKind::Name(name) = &expr.kind else {
        context.push(Diagnostic::new(
            Code::WrongForm,
            expr.span,
            "expected the name of a mask",
        ));
        return None;
    };
    let name = Ident {
        text: name.clone(),
        span: expr.span,
    };
    match context.names.get(&name.text) {
        Some(Meaning::Keypoint(shape)) => {
            if !earlier.contains(&name.text.as_str()) {
                let message = format!("`{}` is declared only below", name.text);
                context.push(
                    Diagnostic::new(Code::NotYetKnown, name.span, message)
                        .help("an extractor uses keypoints above it"),
                );
                return None;
            }
            // A keypoint whose own declaration is wrong is reported there.
            let shape = shape?;
            if shape != KeypointShape::Mask {
                context.push(wrong_kind(&name, shape, "a mask"));
                return None;
            }
            Some(name.text)
        }
        _ => {
            let is_mask = |meaning| meaning == Meaning::Keypoint(Some(KeypointShape::Mask));
            context.unknown("mask", &name, context.names.that(is_mask));
            None
        }
    }
}

/// Reports a keypoint of the wrong shape.
pub(super) fn wrong_kind(name: &Ident, shape: KeypointShape, wanted: &str) -> Diagnostic {
    let is = match shape {
        KeypointShape::Mask => "a mask, a set of pixels",
        KeypointShape::Box => "a box",
        KeypointShape::Outline => "an outline",
        KeypointShape::Points => "a list of points",
        KeypointShape::Point => "a point",
    };
    Diagnostic::new(
        Code::WrongKindOfName,
        name.span,
        format!("expected {wanted}, found `{}`", name.text),
    )
    .label(format!("this is {is}"))
}

fn moment(at: Option<&Expr>, context: &mut Context<'_>) -> Option<Moment> {
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

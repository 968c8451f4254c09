//! Extractors: `harris(…)`, `contour(…)` and the others; masks have a file of their own.

use super::Context;
use super::arguments::{Bound, Parameter, bare, bind, named, optional, rest};
use super::camera::IMAGE;
use super::keypoints::{Earlier, moment};
use super::quantity::{Measure, Wanted, read, read_whole};
use super::subgoals::pixel;
use crate::ast::{Argument, Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among};
use fab_program::{Extractor, Inside, KeypointShape, Moment, Response, Sight};

/// Harris' free parameter where none is stated: the detector's usual one (protocol, section 6).
const DEFAULT_HARRIS_K: f64 = 0.04;

/// Side of the square over which a response is averaged where none is stated: OpenCV's, which the paper keeps.
const DEFAULT_BLOCK_PX: u32 = 3;

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
const SHARE: Wanted = Wanted {
    measure: Measure::Number,
    range: 1e-3..=0.999,
    range_words: "a share from `0.001` to `0.999`",
};
const BLOCK: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=31.0,
    range_words: "an odd side from `1px` to `31px`",
};

/// Builds `harris(…)` or `shi_tomasi(…)`.
pub(super) fn corners(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let is_harris = name.text == "harris";
    let mut parameters: Vec<Parameter> = vec![
        bare("mask"),
        named("max"),
        named("quality"),
        named("spacing"),
        optional("image"),
        optional("of"),
        optional("white"),
        optional("inside"),
        optional("margin"),
        optional("block"),
    ];
    parameters.extend(is_harris.then(|| optional("k")));
    parameters.push(optional("at"));
    let bound = bind(name, arguments, &parameters, context)?;
    let mask = earlier.named(bound.get("mask")?, KeypointShape::Mask, context);
    let response = if is_harris {
        bound
            .get("k")
            .map_or(Some(DEFAULT_HARRIS_K), |k| read(k, &HARRIS_K, context))
            .map(|k| Response::Harris { k })
    } else {
        Some(Response::ShiTomasi)
    };
    let own_px = context.camera.as_ref().map(|camera| camera.image_px);
    let image_px = match bound.get("image") {
        Some(image) => read_whole(image, &IMAGE, context),
        // Without a camera the task is no program.
        None => own_px,
    };
    let max = read_whole(bound.get("max")?, &MAX_POINTS, context);
    let quality = read(bound.get("quality")?, &QUALITY, context);
    let spacing_px = read(bound.get("spacing")?, &SPACING, context);
    let block_px = block(&bound, context);
    let of = sight(bound.get("of"), context);
    let white = white(&bound, of, earlier, context);
    let inside = inside(&bound, earlier, context);
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Corners {
        mask: mask?,
        of: of?,
        white: white?,
        inside: inside?,
        image_px: image_px?,
        max: max?,
        quality: quality?,
        spacing_px: spacing_px?,
        block_px: block_px?,
        response: response?,
    };
    Some((moment?, extractor))
}

fn block(bound: &Bound<'_>, context: &mut Context<'_>) -> Option<u32> {
    match bound.get("block") {
        Some(expr) => odd(expr, &BLOCK, context),
        None => Some(DEFAULT_BLOCK_PX),
    }
}

/// Reads the side of a square that has a middle pixel.
pub(super) fn odd(expr: &Expr, wanted: &Wanted, context: &mut Context<'_>) -> Option<u32> {
    let side_px = read_whole(expr, wanted, context)?;
    if side_px % 2 == 1 {
        return Some(side_px);
    }
    let written = context.written(expr.span);
    context.push(
        Diagnostic::new(
            Code::OutOfRange,
            expr.span,
            format!("`{written}` is out of range"),
        )
        .help(format!("accepted is {}", wanted.range_words)),
    );
    None
}

fn sight(of: Option<&Expr>, context: &mut Context<'_>) -> Option<Sight> {
    let Some(expr) = of else {
        return Some(Sight::Depth);
    };
    match &expr.kind {
        ExprKind::Name(name) if name == "depth" => Some(Sight::Depth),
        ExprKind::Name(name) if name == "mask" => Some(Sight::Mask),
        ExprKind::Name(name) if name == "picture" => Some(Sight::Picture),
        ExprKind::Name(name) if name == "misread_picture" => Some(Sight::MisreadPicture),
        _ => {
            let found = context.written(expr.span);
            let names = among(["depth", "mask", "picture", "misread_picture"]);
            let message = format!("expected {names}, found `{found}`");
            context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
            None
        }
    }
}

/// Reads `white: MASK`: None where it is wrong, nothing inside where it is not stated.
fn white(
    bound: &Bound<'_>,
    of: Option<Sight>,
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<Option<String>> {
    let Some(expr) = bound.get("white") else {
        return Some(None);
    };
    if let Some(Sight::Depth | Sight::Mask) = of {
        let message = "`white` paints a picture that the detector does not look at";
        context.push(
            Diagnostic::new(Code::WrongArguments, expr.span, message)
                .help("write `of: picture`, or leave `white` out"),
        );
        return None;
    }
    earlier.named(expr, KeypointShape::Mask, context).map(Some)
}

/// Reads `inside: BOX, margin: 20px`: None where it is wrong, nothing inside where it is not stated.
fn inside(
    bound: &Bound<'_>,
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<Option<Inside>> {
    let Some(expr) = bound.get("inside") else {
        if let Some(margin) = bound.get("margin") {
            let message = "`margin` says how far beside a box, and there is no `inside`";
            context.push(
                Diagnostic::new(Code::WrongArguments, margin.span, message)
                    .help("write `inside: BOX` beside it, or leave `margin` out"),
            );
            return None;
        }
        return Some(None);
    };
    let of = earlier.named(expr, KeypointShape::Box, context);
    let margin_px = match bound.get("margin") {
        Some(margin) => read(margin, &SPACING, context),
        None => Some(0.0),
    };
    Some(Some(Inside {
        of: of?,
        margin_px: margin_px?,
    }))
}

/// Builds `toward(POINTS, POINT, share: 0.1)`.
pub(super) fn toward(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let parameters = [
        bare("points"),
        bare("point"),
        named("share"),
        optional("at"),
    ];
    let bound = bind(name, arguments, &parameters, context)?;
    let points = earlier.named(bound.get("points")?, KeypointShape::Points, context);
    let to = earlier.named(bound.get("point")?, KeypointShape::Point, context);
    let share = read(bound.get("share")?, &SHARE, context);
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Toward {
        points: points?,
        to: to?,
        share: share?,
    };
    Some((moment?, extractor))
}

/// Builds an extractor of one earlier keypoint and nothing else.
pub(super) fn of_one(
    name: &Ident,
    arguments: &[Argument],
    (parameter, shape): (&'static str, KeypointShape),
    make: fn(String) -> Extractor,
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let bound = bind(name, arguments, &[bare(parameter), optional("at")], context)?;
    let of = earlier.named(bound.get(parameter)?, shape, context);
    let moment = moment(bound.get("at"), context);
    Some((moment?, make(of?)))
}

/// Builds `contour(MASK, tolerance: 2px)`.
pub(super) fn contour(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let parameters = [bare("mask"), named("tolerance"), optional("at")];
    let bound = bind(name, arguments, &parameters, context)?;
    let mask = earlier.named(bound.get("mask")?, KeypointShape::Mask, context);
    let tolerance_px = read(bound.get("tolerance")?, &SPACING, context);
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Contour {
        mask: mask?,
        tolerance_px: tolerance_px?,
    };
    Some((moment?, extractor))
}

/// Builds `along(OUTLINE, count: 12)`.
pub(super) fn along(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let parameters = [bare("outline"), named("count"), optional("at")];
    let bound = bind(name, arguments, &parameters, context)?;
    let outline = earlier.named(bound.get("outline")?, KeypointShape::Outline, context);
    let count = read_whole(bound.get("count")?, &MAX_POINTS, context);
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Along {
        outline: outline?,
        count: count?,
    };
    Some((moment?, extractor))
}

/// Builds `points((40px, 52px), …)`.
pub(super) fn fixed(
    name: &Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    const MOST: usize = 1000;
    let bound = bind(name, arguments, &[rest("points")], context)?;
    if let Some(beyond) = bound.rest().get(MOST) {
        let message = format!("at most {MOST} points are listed");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return None;
    }
    let mut points = Vec::with_capacity(bound.rest().len());
    for expr in bound.rest() {
        let ExprKind::Pair(pair) = &expr.kind else {
            let found = context.written(expr.span);
            let message = format!("expected a pixel, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongForm, expr.span, message).help("write `(40px, 52px)`"),
            );
            return None;
        };
        let point = pixel(pair, context)?;
        let side = context.camera.as_ref().map(|camera| camera.image_px as i32);
        if side.is_some_and(|side| point.u >= side || point.v >= side) {
            let written = context.written(expr.span);
            let message = format!("`{written}` lies outside of the picture");
            context.push(
                Diagnostic::new(Code::OutOfRange, expr.span, message).help(
                    "the camera's `image` says how large the picture is; pixels count from 0",
                ),
            );
            return None;
        }
        points.push(point);
    }
    Some((Moment::Now, Extractor::Fixed { points }))
}

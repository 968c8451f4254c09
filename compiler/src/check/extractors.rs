//! Extractors: `mask(…)`, `harris(…)`, `contour(…)` and the others.

use super::Context;
use super::arguments::{Bound, Parameter, bare, bind, named, optional, rest};
use super::camera::IMAGE;
use super::keypoints::{Earlier, moment};
use super::quantity::{Measure, Wanted, read, read_whole};
use super::subgoals::pixel;
use crate::ast::{Argument, Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among};
use crate::program::{Extractor, KeypointShape, Moment, Response, Sight};

/// Harris' free parameter where none is stated: the detector's usual one (protocol, section 6).
const DEFAULT_HARRIS_K: f64 = 0.04;

/// Side of the square over which a response is averaged where none is stated: OpenCV's, which the paper keeps.
const DEFAULT_BLOCK_PX: u32 = 3;

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
const BLOCK: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=31.0,
    range_words: "an odd side from `1px` to `31px`",
};
const HUE: Wanted = Wanted {
    measure: Measure::Angle,
    range: 0.0..=std::f64::consts::TAU,
    range_words: "a hue from `0deg` to `360deg`",
};
const FRACTION: Wanted = Wanted {
    measure: Measure::Number,
    range: 0.0..=1.0,
    range_words: "a fraction from `0` to `1`",
};

/// Builds a mask by depth, or by colour.
pub(super) fn mask(
    name: &Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let is_colored = arguments.iter().any(|argument| argument.label.is_some());
    if !is_colored {
        let bound = bind(name, arguments, &[bare("depth < limit")], context)?;
        let below_m = depth_limit(bound.get("depth < limit")?, context)?;
        return Some((Moment::Now, Extractor::DepthMask { below_m }));
    }
    let parameters = [named("hue"), named("saturation"), named("value")];
    let bound = bind(name, arguments, &parameters, context)?;
    let hue = range(bound.get("hue")?, &HUE, context);
    let saturation = range(bound.get("saturation")?, &FRACTION, context);
    let value = range(bound.get("value")?, &FRACTION, context);
    let (saturation, value) = (saturation?, value?);
    for (limits, name) in [(saturation, "saturation"), (value, "value")] {
        if limits[0] > limits[1] {
            let message = format!("the range of `{name}` ends below its beginning");
            let span = bound.get(name)?.span;
            context.push(Diagnostic::new(Code::OutOfRange, span, message));
            return None;
        }
    }
    let extractor = Extractor::ColorMask {
        // The way through radians must not move a limit off the whole degree that it names.
        hue_deg: hue?.map(|hue_rad| (hue_rad.to_degrees() * 1e9).round() / 1e9),
        saturation,
        value,
    };
    Some((Moment::Now, extractor))
}

/// Reads `A to B`.
fn range(expr: &Expr, wanted: &Wanted, context: &mut Context<'_>) -> Option<[f64; 2]> {
    let ExprKind::Range { low, high } = &expr.kind else {
        let found = context.written(expr.span);
        let message = format!("expected a range, found `{found}`");
        context.push(
            Diagnostic::new(Code::WrongForm, expr.span, message)
                .help(format!("write `A to B`, each {}", wanted.range_words)),
        );
        return None;
    };
    let low = read(low, wanted, context);
    let high = read(high, wanted, context);
    Some([low?, high?])
}

fn depth_limit(expr: &Expr, context: &mut Context<'_>) -> Option<f64> {
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
    let height_m = context.camera.as_ref().map(|camera| camera.height_m);
    if let Some(height_m) = height_m.filter(|height_m| below_m >= *height_m) {
        let message = format!(
            "the mask reaches the table, which is {}mm from the camera",
            crate::exact::written(height_m * 1000.0, 3)
        );
        context.push(
            Diagnostic::new(Code::MaskSeesTable, limit.span, message)
                .help("a flat cloth lies about 5 mm above the table"),
        );
    }
    Some(below_m)
}

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
    let moment = moment(bound.get("at"), context);
    let extractor = Extractor::Corners {
        mask: mask?,
        of: of?,
        white: white?,
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
    let Some(expr) = bound.get("block") else {
        return Some(DEFAULT_BLOCK_PX);
    };
    let block_px = read_whole(expr, &BLOCK, context)?;
    if block_px % 2 == 1 {
        return Some(block_px);
    }
    let written = context.written(expr.span);
    context.push(
        Diagnostic::new(
            Code::OutOfRange,
            expr.span,
            format!("`{written}` is out of range"),
        )
        .help(format!("accepted is {}", BLOCK.range_words)),
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

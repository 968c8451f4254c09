//! Masks: `mask(…)` by depth, by colour, or of one side of a split, and `closed(…)` of another one.

use super::Context;
use super::arguments::{bare, bind, named, optional};
use super::extractors::odd;
use super::keypoints::Earlier;
use super::quantity::{Measure, Wanted, read, read_whole};
use crate::ast::{Argument, Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among};
use fab_program::{Channel, Extractor, KeypointShape, Moment, Side};

/// How far the two sides of a split lie apart where it is not stated. A cloth and a table that look alike to a person lie
/// nearer; the simulator's two kinds of tiles are 0.12 apart, and are no cloth.
const DEFAULT_CONTRAST: f64 = 0.15;

const DEPTH: Wanted = Wanted {
    measure: Measure::Length,
    range: 1e-3..=10.0,
    range_words: "a depth from `1mm` to `10m`",
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
const BLUR: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=101.0,
    range_words: "an odd side from `1px` to `101px`",
};
const CLOSING: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 1.0..=200.0,
    range_words: "a side from `1px` to `200px`",
};

/// Builds a mask by depth, by colour, or of one side of a split.
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
    let splits = |argument: &Argument| argument.label.as_ref().is_some_and(|it| it.text == "split");
    if arguments.iter().any(splits) {
        return split(name, arguments, context);
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
            fab_program::exact::written(height_m * 1000.0, 3)
        );
        context.push(
            Diagnostic::new(Code::MaskSeesTable, limit.span, message)
                .help("a flat cloth lies about 5 mm above the table"),
        );
    }
    Some(below_m)
}

/// Builds `mask(split: saturation, keep: high, blur: 9px)`.
fn split(
    name: &Ident,
    arguments: &[Argument],
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let parameters = [
        named("split"),
        named("keep"),
        optional("blur"),
        optional("contrast"),
    ];
    let bound = bind(name, arguments, &parameters, context)?;
    let channels = [
        ("brightness", Channel::Brightness),
        ("saturation", Channel::Saturation),
    ];
    let of = one_of(bound.get("split")?, channels, context);
    let sides = [("low", Side::Low), ("high", Side::High)];
    let keep = one_of(bound.get("keep")?, sides, context);
    let blur_px = match bound.get("blur") {
        Some(blur) => odd(blur, &BLUR, context),
        None => Some(1),
    };
    let contrast = match bound.get("contrast") {
        Some(contrast) => read(contrast, &FRACTION, context),
        None => Some(DEFAULT_CONTRAST),
    };
    let extractor = Extractor::SplitMask {
        of: of?,
        keep: keep?,
        blur_px: blur_px?,
        contrast: contrast?,
    };
    Some((Moment::Now, extractor))
}

fn one_of<T: Copy>(
    expr: &Expr,
    words: [(&'static str, T); 2],
    context: &mut Context<'_>,
) -> Option<T> {
    let meant = |word: &str| words.iter().find(|(known, _)| *known == word);
    if let ExprKind::Name(name) = &expr.kind
        && let Some((_, value)) = meant(name)
    {
        return Some(*value);
    }
    let found = context.written(expr.span);
    let names = among(words.map(|(name, _)| name));
    let message = format!("expected {names}, found `{found}`");
    context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
    None
}

/// Builds `closed(MASK, by: 10px)`.
pub(super) fn closed(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let bound = bind(name, arguments, &[bare("mask"), named("by")], context)?;
    let mask = earlier.named(bound.get("mask")?, KeypointShape::Mask, context);
    let by_px = read_whole(bound.get("by")?, &CLOSING, context);
    let extractor = Extractor::Closed {
        mask: mask?,
        by_px: by_px?,
    };
    Some((Moment::Now, extractor))
}

/// Builds `largest(MASK)`.
pub(super) fn largest(
    name: &Ident,
    arguments: &[Argument],
    earlier: Earlier<'_, '_>,
    context: &mut Context<'_>,
) -> Option<(Moment, Extractor)> {
    let bound = bind(name, arguments, &[bare("mask")], context)?;
    let mask = earlier.named(bound.get("mask")?, KeypointShape::Mask, context)?;
    Some((Moment::Now, Extractor::Largest { mask }))
}

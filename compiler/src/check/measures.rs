//! Measures of conditions and texts: `distance(…)`, `chebyshev(…)`, `angle_between(…)`, `count(…)`, `coverage(…)`.

use super::Context;
use super::arguments::{bare, bind};
use super::names::Meaning;
use super::points::{direction_field, heading, point};
use super::values::{AsPercent, Frame, FramedLength, NativeLength, Operand};
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic};
use fab_program::{Camera, Cloth, KeypointShape, Number};

/// Builds a call; None, with a report unless it is made elsewhere, where there is none such.
pub(super) fn call(name: &Ident, expr: &Expr, context: &mut Context<'_>) -> Option<Operand> {
    let ExprKind::Call { arguments, .. } = &expr.kind else {
        return None;
    };
    match name.text.as_str() {
        "distance" | "chebyshev" => {
            let bound = bind(name, arguments, &[bare("a"), bare("b")], context)?;
            let a = point(bound.get("a")?, context);
            let b = point(bound.get("b")?, context);
            let (a, b) = (a?, b?);
            Some(Operand::Length(FramedLength {
                native: match name.text.as_str() {
                    "distance" => NativeLength::Distance(a, b),
                    _ => NativeLength::Chebyshev(a, b),
                },
                frame: Frame::Picture,
                unit: "px".to_owned(),
            }))
        }
        "angle_between" => {
            let bound = bind(name, arguments, &[bare("a"), bare("b")], context)?;
            let a = heading(bound.get("a")?, context);
            let b = heading(bound.get("b")?, context);
            Some(Operand::Between {
                a: a?,
                b: b?,
                unit: "deg".to_owned(),
            })
        }
        "count" => {
            let bound = bind(name, arguments, &[bare("points")], context)?;
            let shapes = [KeypointShape::Points];
            let keypoint = keypoint(bound.get("points")?, &shapes, "points to count", context)?;
            Some(Operand::Counted {
                number: Number::Count { keypoint },
                as_percent: AsPercent::No,
            })
        }
        "coverage" => {
            let bound = bind(name, arguments, &[bare("mask")], context)?;
            let mask = keypoint(
                bound.get("mask")?,
                &[KeypointShape::Mask],
                "a mask",
                context,
            )?;
            let px_per_m = context.camera.as_ref().map(Camera::px_per_m)?;
            let area_m2 = context.cloth.as_ref().map(Cloth::area_m2)?;
            Some(Operand::Counted {
                number: Number::Coverage {
                    mask,
                    flat_px: area_m2 * px_per_m * px_per_m,
                },
                as_percent: AsPercent::No,
            })
        }
        "mirror" => point(expr, context).map(Operand::Point),
        "nearest" => {
            let bound = bind(
                name,
                arguments,
                &[bare("field"), bare("direction")],
                context,
            )?;
            direction_field(bound.get("field")?, context)?;
            heading(bound.get("direction")?, context)?;
            let message =
                "`nearest` is written in texts, as `{{ nearest(direction, from center to pick) }}`";
            context.push(Diagnostic::new(Code::WrongExpression, expr.span, message));
            None
        }
        _ => {
            let known = [
                "distance",
                "chebyshev",
                "angle_between",
                "count",
                "coverage",
                "mirror",
            ];
            context.unknown("measure", name, known);
            None
        }
    }
}

/// Returns the name of a keypoint of one of the wanted shapes.
pub(super) fn keypoint(
    expr: &Expr,
    wanted: &[KeypointShape],
    words: &str,
    context: &mut Context<'_>,
) -> Option<String> {
    let ExprKind::Name(text) = &expr.kind else {
        let found = context.written(expr.span);
        let message = format!("expected {words}, found `{found}`");
        context.push(Diagnostic::new(Code::WrongExpression, expr.span, message));
        return None;
    };
    let name = Ident {
        text: text.clone(),
        span: expr.span,
    };
    match context.names.get(text) {
        Some(Meaning::Keypoint(Some(shape))) if wanted.contains(&shape) => Some(name.text),
        // Its own declaration is wrong and reported there.
        Some(Meaning::Keypoint(None)) => None,
        Some(Meaning::Keypoint(Some(shape))) => {
            context.push(super::keypoints::wrong_kind(&name, shape, words));
            None
        }
        _ => {
            let fits = |meaning| matches!(meaning, Meaning::Keypoint(Some(shape)) if wanted.contains(&shape));
            let candidates = context.names.that(fits);
            let kind = match wanted {
                [KeypointShape::Mask, ..] => "mask",
                [KeypointShape::Box] => "box",
                [KeypointShape::Outline] => "outline",
                _ => "keypoint",
            };
            context.unknown(kind, &name, candidates);
            None
        }
    }
}

//! Conditions of checks: comparisons of lengths in pixels, `P within N of MASK`, joined by `and`, `or`, `not`.

use super::Context;
use super::arguments::{bare, bind};
use super::keypoints::wrong_kind;
use super::names::Meaning;
use super::quantity::{Measure, Wanted, read};
use crate::ast::{self, ExprKind, Ident};
use crate::diag::{Code, Diagnostic};
use crate::program::{Comparison, Condition, KeypointShape, Length, Point};

const PIXELS: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 0.0..=10_000.0,
    range_words: "a length from `0px` to `10000px`",
};

/// Builds a condition; None, with a report, where it is wrong.
pub(crate) fn check(expr: &ast::Expr, context: &mut Context<'_>) -> Option<Condition> {
    match &expr.kind {
        ExprKind::All(parts) => Some(Condition::All {
            of: all(parts, context)?,
        }),
        ExprKind::Any(parts) => Some(Condition::Any {
            of: all(parts, context)?,
        }),
        ExprKind::Not(part) => Some(Condition::Not {
            of: Box::new(check(part, context)?),
        }),
        ExprKind::Compare { left, sign, right } => {
            let is = comparison(sign, context);
            let left = length(left, context);
            let right = length(right, context);
            Some(Condition::Lengths {
                left: left?,
                is: is?,
                right: right?,
            })
        }
        ExprKind::Within {
            point,
            margin,
            mask,
        } => {
            let margin_px = margin
                .as_ref()
                .map_or(Some(0.0), |margin| read(margin, &PIXELS, context));
            let point = self::point(point, context);
            let mask = self::mask(mask, context);
            Some(Condition::Within {
                point: point?,
                region: mask?,
                margin_px: margin_px?,
            })
        }
        _ => {
            let found = context.written(expr.span);
            context.push(
                Diagnostic::new(
                    Code::WrongExpression,
                    expr.span,
                    format!("expected a condition, found `{found}`"),
                )
                .help("write such as `distance(pick, place) > 10px` or `pick within 8px of cloth`"),
            );
            None
        }
    }
}

/// Checks every part before giving up, so that each is reported.
fn all(parts: &[ast::Expr], context: &mut Context<'_>) -> Option<Vec<Condition>> {
    let checked: Vec<Option<Condition>> = parts.iter().map(|part| check(part, context)).collect();
    checked.into_iter().collect()
}

fn comparison(sign: &Ident, context: &mut Context<'_>) -> Option<Comparison> {
    let (right, help) = match sign.text.as_str() {
        "<" => return Some(Comparison::Less),
        "<=" => return Some(Comparison::AtMost),
        ">" => return Some(Comparison::Greater),
        ">=" => return Some(Comparison::AtLeast),
        "≤" => (Some("<="), "write `<=`"),
        "≥" => (Some(">="), "write `>=`"),
        _ => (
            None,
            "measured lengths are hardly ever equal; write `<`, `<=`, `>` or `>=`",
        ),
    };
    let mut diagnostic = Diagnostic::new(
        Code::WrongExpression,
        sign.span,
        format!("lengths are not compared by `{}`", sign.text),
    )
    .help(help);
    if let Some(right) = right {
        diagnostic = diagnostic.edit(sign.span, right);
    }
    context.push(diagnostic);
    None
}

fn length(expr: &ast::Expr, context: &mut Context<'_>) -> Option<Length> {
    match &expr.kind {
        ExprKind::Quantity { .. } => Some(Length::Constant {
            value: read(expr, &PIXELS, context)?,
        }),
        ExprKind::Call { name, arguments } if name.text == "distance" => {
            let bound = bind(name, arguments, &[bare("a"), bare("b")], context)?;
            let a = point(bound.get("a")?, context);
            let b = point(bound.get("b")?, context);
            Some(Length::Distance { a: a?, b: b? })
        }
        ExprKind::Call { name, .. } => {
            context.unknown("measure", name, ["distance"]);
            None
        }
        _ => {
            let found = context.written(expr.span);
            context.push(
                Diagnostic::new(
                    Code::WrongExpression,
                    expr.span,
                    format!("expected a length in the picture, found `{found}`"),
                )
                .help("write `distance(pick, place)`, or a number of pixels such as `10px`"),
            );
            None
        }
    }
}

fn point(expr: &ast::Expr, context: &mut Context<'_>) -> Option<Point> {
    let name = name(expr, "a point", context)?;
    match context.names.get(&name.text) {
        Some(Meaning::Field) => Some(Point::Action { field: name.text }),
        Some(Meaning::Keypoint(Some(KeypointShape::Point))) => {
            Some(Point::Keypoint { name: name.text })
        }
        // Its own declaration is wrong and reported there.
        Some(Meaning::Keypoint(None)) => None,
        Some(Meaning::Keypoint(Some(shape))) => {
            context.push(wrong_kind(&name, shape, "one point"));
            None
        }
        Some(Meaning::Text { .. }) | None => {
            let is_point = |meaning| {
                matches!(
                    meaning,
                    Meaning::Field | Meaning::Keypoint(Some(KeypointShape::Point))
                )
            };
            context.unknown("point", &name, context.names.that(is_point));
            None
        }
    }
}

fn mask(expr: &ast::Expr, context: &mut Context<'_>) -> Option<String> {
    let name = name(expr, "a mask", context)?;
    match context.names.get(&name.text) {
        Some(Meaning::Keypoint(Some(KeypointShape::Mask))) => Some(name.text),
        Some(Meaning::Keypoint(None)) => None,
        Some(Meaning::Keypoint(Some(shape))) => {
            context.push(wrong_kind(&name, shape, "a mask"));
            None
        }
        _ => {
            let is_mask = |meaning| meaning == Meaning::Keypoint(Some(KeypointShape::Mask));
            context.unknown("mask", &name, context.names.that(is_mask));
            None
        }
    }
}

fn name(expr: &ast::Expr, wanted: &str, context: &mut Context<'_>) -> Option<Ident> {
    if let ExprKind::Name(name) = &expr.kind {
        return Some(Ident {
            text: name.clone(),
            span: expr.span,
        });
    }
    let found = context.written(expr.span);
    context.push(Diagnostic::new(
        Code::WrongExpression,
        expr.span,
        format!("expected {wanted}, found `{found}`"),
    ));
    None
}

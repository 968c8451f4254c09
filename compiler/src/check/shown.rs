//! Placeholders: what `{{ … }}` of a text stands for.

use super::Context;
use super::arguments::{bare, bind};
use super::conditions::UNREACHABLE;
use super::keypoints::wrong_kind;
use super::names::Meaning;
use super::points::{direction_field, heading};
use super::templates::{Place, Scope};
use super::uses::{needs_action, needs_last};
use super::values::{AsPercent, Frame, FramedLength, NativeLength, Operand, lowered, operand};
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic};
use fab_program::Depends;
use fab_program::exact;
use fab_program::space;
use fab_program::units;
use fab_program::{
    Camera, Choices, Cloth, KeypointShape, Length, NumberFormat, OVERLAP, Placeholder, Point,
};

/// The placeholder that spells the answer's format.
pub(super) const FORMAT: &str = "actions.format";

/// The placeholder that says how a point is written.
pub(super) const POINTS: &str = "actions.points";

/// What a placeholder becomes.
pub(crate) enum Placed {
    /// Words that are known now.
    Literal(String),
    /// A value that is known later.
    Value(Box<Placeholder>),
}

/// Builds a placeholder; None, with a report, where it is wrong.
pub(crate) fn check(expr: &Expr, scope: Scope<'_>, context: &mut Context<'_>) -> Option<Placed> {
    let placed = value(expr, scope, context)?;
    let Placed::Value(shown) = &placed else {
        return Some(placed);
    };
    let uses = shown.uses();
    if uses.action && matches!(scope.place, Place::Stage(_) | Place::Result) {
        needs_action(expr.span, context);
        return None;
    }
    if uses.last && !scope.has_last && scope.place != Place::Nowhere {
        needs_last(expr.span, scope.guarded, context);
        return None;
    }
    Some(placed)
}

fn later(shown: Placeholder) -> Placed {
    Placed::Value(Box::new(shown))
}

fn value(expr: &Expr, scope: Scope<'_>, context: &mut Context<'_>) -> Option<Placed> {
    match &expr.kind {
        ExprKind::Name(text) if !context.constants.contains_key(text.as_str()) => {
            let name = Ident {
                text: text.clone(),
                span: expr.span,
            };
            named(&name, scope, context)
        }
        ExprKind::Path(path) => dotted(&path.clone(), expr, context),
        ExprKind::Call { name, arguments } if name.text == "nearest" => {
            let bound = bind(
                name,
                arguments,
                &[bare("field"), bare("direction")],
                context,
            )?;
            let field = direction_field(bound.get("field")?, context);
            let to = heading(bound.get("direction")?, context);
            Some(later(Placeholder::Nearest {
                field: field?,
                to: to?,
            }))
        }
        _ => {
            let value = operand(expr, context)?;
            written(value, expr, context)
        }
    }
}

fn named(name: &Ident, scope: Scope<'_>, context: &mut Context<'_>) -> Option<Placed> {
    if let Some(layer) = context.layers.iter().find(|layer| layer.name == name.text) {
        let words = layer.words.clone();
        let uses_last = context.last_layers.contains(&name.text);
        if uses_last && !scope.has_last && scope.place != Place::Nowhere {
            needs_last(name.span, scope.guarded, context);
            return None;
        }
        context.named_layers.push((name.text.clone(), name.span));
        return Some(Placed::Literal(words));
    }
    let text = name.text.clone();
    let late = |message: String, help: &str| {
        Diagnostic::new(Code::NotYetKnown, name.span, message).help(help)
    };
    let shown = match context.names.get(&name.text) {
        Some(Meaning::Keypoint(Some(KeypointShape::Points))) => {
            Placeholder::Points { keypoint: text }
        }
        Some(Meaning::Keypoint(Some(KeypointShape::Point))) => Placeholder::Point {
            point: Point::Keypoint { name: text },
        },
        // Its own declaration is wrong and reported there.
        Some(Meaning::Keypoint(None)) => return None,
        Some(Meaning::Keypoint(Some(shape))) => {
            context.push(wrong_kind(
                name,
                shape,
                "something that can be written as text",
            ));
            return None;
        }
        Some(Meaning::Text { stage }) => {
            if matches!(scope.place, Place::Stage(here) if stage >= here)
                || scope.place == Place::Result
            {
                context.push(late(
                    format!("`{}` is not read before this stage", name.text),
                    "stages run in order; a text is known to the stages after the one that reads it",
                ));
                return None;
            }
            Placeholder::Text { name: text }
        }
        Some(Meaning::Field) => match context.actions.iter().any(|field| field.name == text) {
            true => Placeholder::Field { field: text },
            false => {
                let expr = Expr {
                    span: name.span,
                    kind: ExprKind::Name(text),
                };
                return operand(&expr, context).and_then(|value| written(value, &expr, context));
            }
        },
        None if name.text == OVERLAP && scope.place == Place::Result => {
            Placeholder::Text { name: text }
        }
        None if name.text == UNREACHABLE => Placeholder::Unreachable,
        None if name.text == "step" => {
            let expr = Expr {
                span: name.span,
                kind: ExprKind::Name(text),
            };
            return operand(&expr, context).and_then(|value| written(value, &expr, context));
        }
        None => {
            unknown(name, scope.place, context);
            return None;
        }
    };
    Some(later(shown))
}

fn unknown(name: &Ident, place: Place, context: &mut Context<'_>) {
    // A layer whose own declaration is wrong is reported there.
    if context.declared_layers.contains(name.text.as_str()) {
        return;
    }
    let mut candidates = context.names.that(|meaning| match (meaning, place) {
        (Meaning::Keypoint(shape), _) => {
            shape.is_some_and(|shape| matches!(shape, KeypointShape::Points | KeypointShape::Point))
        }
        (Meaning::Text { stage }, Place::Stage(here)) => stage < here,
        (Meaning::Field, Place::Stage(_))
        | (Meaning::Text { .. } | Meaning::Field, Place::Result) => false,
        (Meaning::Text { .. } | Meaning::Field, Place::Message | Place::Nowhere) => true,
    });
    let constants: Vec<&str> = context.constants.keys().copied().collect();
    let layers: Vec<String> = context
        .layers
        .iter()
        .map(|layer| layer.name.clone())
        .collect();
    candidates.extend(constants);
    candidates.extend(layers.iter().map(String::as_str));
    candidates.extend([FORMAT, POINTS]);
    context.unknown("value", name, candidates);
}

/// Builds `actions.format`, `FIELD.choices`, `last.pick` and the like.
fn dotted(path: &str, expr: &Expr, context: &mut Context<'_>) -> Option<Placed> {
    if path == FORMAT {
        return Some(later(Placeholder::Format));
    }
    if path == POINTS {
        return Some(later(Placeholder::PointForm));
    }
    if let Some(name) = path.strip_suffix(".choices")
        && let Some(field) = context.actions.iter().find(|field| field.name == name)
    {
        return Some(match field.choices {
            Choices::Points { .. } => later(Placeholder::Choices {
                field: name.to_owned(),
            }),
            Choices::Region { ref mask } => Placed::Literal(space::any_of(mask)),
            _ => Placed::Literal(space::listed(field, &space::declared(field))),
        });
    }
    if let Some(name) = path.strip_prefix("last.") {
        if matches!(name, "pick" | "place") {
            let value = operand(expr, context)?;
            return written(value, expr, context);
        }
        if context.actions.iter().any(|field| field.name == name) {
            return Some(later(Placeholder::LastField {
                field: name.to_owned(),
            }));
        }
    }
    // A field whose own declaration is wrong is reported there.
    let field = path
        .trim_start_matches("last.")
        .trim_end_matches(".choices");
    let is_declared = context.names.get(field) == Some(Meaning::Field);
    if is_declared && !context.actions.iter().any(|known| known.name == field) {
        return None;
    }
    let name = Ident {
        text: path.to_owned(),
        span: expr.span,
    };
    let mut candidates = vec![
        FORMAT.to_owned(),
        POINTS.to_owned(),
        "last.pick".to_owned(),
        "last.place".to_owned(),
    ];
    candidates.extend(
        context
            .actions
            .iter()
            .map(|field| format!("{}.choices", field.name)),
    );
    context.unknown("value", &name, candidates.iter().map(String::as_str));
    None
}

/// Writes a value, whatever it is.
fn written(value: Operand, expr: &Expr, context: &mut Context<'_>) -> Option<Placed> {
    let plain = |factor: f64, decimals: u8, unit: &str| NumberFormat {
        factor,
        decimals,
        unit: unit.to_owned(),
    };
    let of_angle = |unit: &str| NumberFormat::angle(units::find(unit).unwrap_or(&units::DEG));
    Some(match value {
        Operand::Length(length) => self::length(&length, context)?,
        Operand::Angle { deg, unit } => Placed::Literal(of_angle(&unit).write(deg)),
        Operand::Between { a, b, unit } => later(Placeholder::Angle {
            a,
            b,
            written: of_angle(&unit),
        }),
        Operand::Number(value) => Placed::Literal(exact::written(value, 4)),
        Operand::Counted { number, as_percent } => later(Placeholder::Number {
            number,
            written: match as_percent {
                AsPercent::Yes => plain(100.0, 0, "%"),
                AsPercent::No => plain(1.0, 3, ""),
            },
        }),
        Operand::Point(point) => later(Placeholder::Point { point }),
        Operand::WordField(field) => later(Placeholder::Field { field }),
        Operand::Word(word) => Placed::Literal(word),
        Operand::Heading => {
            let found = context.written(expr.span);
            let message = format!("the direction `{found}` has no text");
            context.push(
                Diagnostic::new(Code::WrongExpression, expr.span, message)
                    .help("write `nearest(direction, …)` for the choice that is nearest to it"),
            );
            return None;
        }
    })
}

fn length(length: &FramedLength, context: &Context<'_>) -> Option<Placed> {
    let edge_m = context.cloth.as_ref().map_or(f64::NAN, Cloth::edge_m);
    let px_per_m = context.camera.as_ref().map_or(f64::NAN, Camera::px_per_m);
    let mut written = NumberFormat::length(units::find(&length.unit)?, edge_m);
    let is_measured = matches!(
        length.native,
        NativeLength::Distance(..) | NativeLength::Chebyshev(..)
    );
    if is_measured && length.frame == Frame::Table {
        written.factor /= px_per_m;
    }
    if written.factor.is_nan() {
        return None;
    }
    Some(match lowered(&length.native, length.frame, context)? {
        // Pixels are those of the picture that a model is sent, which is known later.
        Length::Constant { value } if length.unit != "px" => Placed::Literal(written.write(value)),
        length => later(Placeholder::Length { length, written }),
    })
}

//! Points and directions of conditions and texts.

use super::Context;
use super::arguments::{bare, bind};
use super::keypoints::wrong_kind;
use super::names::Meaning;
use super::values::fixed_deg;
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic};
use fab_program::exact::vector_of;
use fab_program::{Camera, Choices, End, Heading, KeypointShape, Point};

/// Builds a point; None, with a report, where it is wrong.
pub(crate) fn point(expr: &Expr, context: &mut Context<'_>) -> Option<Point> {
    match &expr.kind {
        ExprKind::Path(path) => {
            let path = path.clone();
            last_end(&path, expr, context)
        }
        ExprKind::Call { name, arguments } if name.text == "mirror" => {
            let bound = bind(name, arguments, &[bare("point"), bare("about")], context)?;
            let of = point(bound.get("point")?, context);
            let about = point(bound.get("about")?, context);
            Some(Point::Mirror {
                of: Box::new(of?),
                about: Box::new(about?),
            })
        }
        ExprKind::Name(text) => named(
            Ident {
                text: text.clone(),
                span: expr.span,
            },
            context,
        ),
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a point, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongExpression, expr.span, message)
                    .help("points are `pick`, `place`, `last.pick`, `last.place`, `mirror(…)` and keypoints that are one point"),
            );
            None
        }
    }
}

fn last_end(path: &str, expr: &Expr, context: &mut Context<'_>) -> Option<Point> {
    let end = match path {
        "last.pick" => End::Pick,
        "last.place" => End::Place,
        _ => {
            let name = Ident {
                text: path.to_owned(),
                span: expr.span,
            };
            context.unknown("point", &name, ["last.pick", "last.place"]);
            return None;
        }
    };
    Some(Point::Last { end })
}

fn named(name: Ident, context: &mut Context<'_>) -> Option<Point> {
    let choices = context
        .actions
        .iter()
        .find(|field| field.name == name.text)
        .map(|field| &field.choices);
    match (context.names.get(&name.text), choices) {
        (Some(Meaning::Field), Some(choices)) if choices.are_points() => {
            Some(Point::Action { field: name.text })
        }
        (Some(Meaning::Field), Some(_)) => {
            let message = format!("expected a point, found `{}`", name.text);
            context.push(
                Diagnostic::new(Code::WrongKindOfName, name.span, message)
                    .label("this field of the action is no point"),
            );
            None
        }
        (Some(Meaning::Field), None) if name.text == "place" => carried(context),
        // The action is wrong, and reported where it is declared.
        (Some(Meaning::Field), None) => None,
        (Some(Meaning::Keypoint(Some(KeypointShape::Point))), _) => {
            Some(Point::Keypoint { name: name.text })
        }
        (Some(Meaning::Keypoint(None)), _) => None,
        (Some(Meaning::Keypoint(Some(shape))), _) => {
            context.push(wrong_kind(&name, shape, "one point"));
            None
        }
        (None, _) if name.text == "last" => {
            let message = "`last` is a condition, not a point";
            context.push(
                Diagnostic::new(Code::WrongExpression, name.span, message)
                    .help("write `last.pick` or `last.place`"),
            );
            None
        }
        (Some(Meaning::Text { .. }) | None, _) => {
            let is_point = |meaning| {
                matches!(
                    meaning,
                    Meaning::Field | Meaning::Keypoint(Some(KeypointShape::Point))
                )
            };
            let candidates = context.names.that(is_point);
            context.unknown("point", &name, candidates);
            None
        }
    }
}

/// Returns where an action by direction and distance leads; None where the action is none such.
fn carried(context: &Context<'_>) -> Option<Point> {
    let has = |wanted: &str, fits: fn(&Choices) -> bool| {
        let mut fields = context.actions.iter();
        fields.any(|field| field.name == wanted && fits(&field.choices))
    };
    let is_there = has("pick", Choices::are_points)
        && has("direction", |choices| {
            matches!(choices, Choices::Directions { .. })
        })
        && has("distance", |choices| {
            matches!(choices, Choices::Lengths { .. })
        });
    let px_per_m = context.camera.as_ref().map(Camera::px_per_m)?;
    is_there.then(|| Point::Carried {
        from: Box::new(Point::Action {
            field: "pick".to_owned(),
        }),
        direction: "direction".to_owned(),
        distance: "distance".to_owned(),
        px_per_m,
    })
}

/// Returns whether an expression can only be a direction.
pub(super) fn is_heading(expr: &Expr, context: &Context<'_>) -> bool {
    match &expr.kind {
        ExprKind::Heading { .. } => true,
        ExprKind::Path(path) => path
            .strip_prefix("last.")
            .is_some_and(|field| is_direction(field, context)),
        ExprKind::Name(name) => is_direction(name, context),
        _ => false,
    }
}

fn is_direction(name: &str, context: &Context<'_>) -> bool {
    let mut fields = context.actions.iter();
    fields.any(|field| field.name == name && matches!(field.choices, Choices::Directions { .. }))
}

/// Builds a direction; None, with a report, where it is wrong.
pub(crate) fn heading(expr: &Expr, context: &mut Context<'_>) -> Option<Heading> {
    match &expr.kind {
        ExprKind::Heading { from, to } => {
            let from = point(from, context);
            let to = point(to, context);
            Some(Heading::FromTo {
                from: from?,
                to: to?,
            })
        }
        ExprKind::Path(path) if is_heading(expr, context) => Some(Heading::Last {
            field: path.trim_start_matches("last.").to_owned(),
        }),
        ExprKind::Name(name) if is_direction(name, context) => Some(Heading::Field {
            field: name.clone(),
        }),
        ExprKind::Quantity { .. } => Some(Heading::Constant {
            vector: vector_of(fixed_deg(expr, context)?),
        }),
        ExprKind::Name(name) if context.constants.contains_key(name.as_str()) => {
            Some(Heading::Constant {
                vector: vector_of(fixed_deg(expr, context)?),
            })
        }
        // A field that is wrong is reported where it is declared.
        ExprKind::Name(name)
            if context.names.get(name) == Some(Meaning::Field)
                && !context.actions.iter().any(|field| field.name == *name) =>
        {
            None
        }
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a direction, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongExpression, expr.span, message)
                    .help("write `from center to pick`, an angle such as `45deg`, or a field of the action that is a direction"),
            );
            None
        }
    }
}

/// Returns the name of a field that is a direction.
pub(crate) fn direction_field(expr: &Expr, context: &mut Context<'_>) -> Option<String> {
    match &expr.kind {
        ExprKind::Name(name) if is_direction(name, context) => Some(name.clone()),
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a field that is a direction, found `{found}`");
            context.push(Diagnostic::new(Code::WrongExpression, expr.span, message));
            None
        }
    }
}

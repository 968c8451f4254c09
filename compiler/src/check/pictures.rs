//! `show subgoal(now) with arrow, subgoal(next)`: the pictures of a question.

use super::Context;
use crate::ast::{Expr, ExprKind, Ident, Pictures};
use crate::diag::{Code, Diagnostic};
use fab_program::{Arrow, Layers, Picture, SubgoalStep};

/// The most pictures in one question.
const MAX_PICTURES: usize = 16;

/// Builds the pictures; what is wrong is left out.
pub(crate) fn check(part: &Pictures, context: &mut Context<'_>) -> Vec<Picture> {
    if let Some((beyond, _)) = part.list.get(MAX_PICTURES) {
        context.push(Diagnostic::new(
            Code::OutOfRange,
            beyond.span,
            format!("at most {MAX_PICTURES} pictures are shown at once"),
        ));
        return Vec::new();
    }
    part.list
        .iter()
        .filter_map(|(expr, with)| picture(expr, with.as_ref(), context))
        .collect()
}

fn picture(expr: &Expr, with: Option<&Ident>, context: &mut Context<'_>) -> Option<Picture> {
    if let ExprKind::Name(name) = &expr.kind
        && name == "scene"
    {
        let layers = match with {
            None => Layers::Absent,
            Some(name) if name.text == "annotations" => Layers::Drawn,
            Some(name) => {
                context.unknown("drawing", name, ["annotations"]);
                return None;
            }
        };
        return Some(Picture::Scene { layers });
    }
    let which = match &expr.kind {
        ExprKind::Call { name, arguments } if name.text == "subgoal" => {
            match arguments.as_slice() {
                [argument] if argument.label.is_none() => match &argument.value.kind {
                    ExprKind::Name(which) if which == "now" => Some(SubgoalStep::Now),
                    ExprKind::Name(which) if which == "next" => Some(SubgoalStep::Next),
                    _ => None,
                },
                _ => None,
            }
        }
        _ => None,
    };
    if which.is_none() {
        let found = context.written(expr.span);
        let message = format!("expected a picture, found `{found}`");
        context.push(
            Diagnostic::new(Code::WrongForm, expr.span, message).help(
                "write `subgoal(now)` or `subgoal(next)`, or `scene` for what the camera sees",
            ),
        );
    }
    let arrow = match with {
        None => Arrow::Absent,
        Some(name) if name.text == "arrow" => Arrow::Drawn,
        Some(name) => {
            context.unknown("drawing", name, ["arrow"]);
            return None;
        }
    };
    Some(Picture::Subgoal {
        which: which?,
        arrow,
    })
}

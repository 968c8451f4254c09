//! Conditions: comparisons, `P within N of MASK`, `last`, joined by `and`, `or`, `not`.

use super::Context;
use super::measures::keypoint;
use super::points::point;
use super::quantity::{Measure, Wanted, read};
use super::values::{Frame, FramedLength, Operand, common_frame, kind_of, lowered, operand};
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among, nearest};
use fab_program::exact::cos_deg;
use fab_program::{Choices, Comparison, Condition, KeypointShape, Length, Number};

const PIXELS: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 0.0..=10_000.0,
    range_words: "a length from `0px` to `10000px`",
};

/// What is out of reach: a condition of components, and a value of texts.
pub(super) const UNREACHABLE: &str = "unreachable";

const FORMS: &str = "write such as `distance(pick, place) > 10px` or `pick within 8px of cloth`";

/// Builds a condition; None, with a report, where it is wrong.
pub(crate) fn check(expr: &Expr, context: &mut Context<'_>) -> Option<Condition> {
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
        ExprKind::Compare { left, sign, right } => compare(expr, left, sign, right, context),
        ExprKind::Within {
            point: at,
            margin,
            mask,
        } => {
            let margin_px = margin
                .as_ref()
                .map_or(Some(0.0), |margin| read(margin, &PIXELS, context));
            let point = point(at, context);
            let shapes = [KeypointShape::Mask, KeypointShape::Box];
            let region = keypoint(mask, &shapes, "a mask or a box", context);
            Some(Condition::Within {
                point: point?,
                region: region?,
                margin_px: margin_px?,
            })
        }
        ExprKind::Name(name) if name == "last" && context.names.get(name).is_none() => {
            Some(Condition::Last)
        }
        ExprKind::Name(name) if name == UNREACHABLE && context.names.get(name).is_none() => {
            Some(Condition::Unreachable)
        }
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a condition, found `{found}`");
            let diagnostic = Diagnostic::new(Code::WrongExpression, expr.span, message);
            let is_truth = matches!(found.to_lowercase().as_str(), "true" | "false" | "none");
            context.push(if is_truth {
                diagnostic.help("a condition says what it depends on; remove what always holds")
            } else {
                diagnostic.help(FORMS)
            });
            None
        }
    }
}

/// Checks every part before giving up, so that each is reported.
fn all(parts: &[Expr], context: &mut Context<'_>) -> Option<Vec<Condition>> {
    let checked: Vec<Option<Condition>> = parts.iter().map(|part| check(part, context)).collect();
    checked.into_iter().collect()
}

fn compare(
    whole: &Expr,
    left_expr: &Expr,
    sign: &Ident,
    right_expr: &Expr,
    context: &mut Context<'_>,
) -> Option<Condition> {
    let left = operand(left_expr, context);
    if let (Some(Operand::WordField(field)), ExprKind::Name(word)) = (&left, &right_expr.kind)
        && context.names.get(word).is_none()
    {
        let message = format!("`{field}` is compared with `{word}`, which is no text in quotes");
        context.push(
            Diagnostic::new(Code::WrongExpression, right_expr.span, message)
                .help(format!("write `\"{word}\"`"))
                .edit(right_expr.span, format!("\"{word}\"")),
        );
        return None;
    }
    let right = operand(right_expr, context);
    let (left, right) = (left?, right?);
    match (left, right) {
        (Operand::Length(left), Operand::Length(right)) => {
            let is = comparison(sign, "lengths", context);
            lengths(whole, (left_expr, &left), (right_expr, &right), is, context)
        }
        (Operand::Between { a, b, .. }, Operand::Angle { deg, .. }) => {
            let is = comparison(sign, "angles", context)?;
            angle(right_expr, deg, context)?;
            Some(Condition::Angle {
                a,
                b,
                is,
                limit_deg: deg,
                limit_cos: cos_deg(deg),
            })
        }
        (Operand::Angle { deg, .. }, Operand::Between { a, b, .. }) => {
            let is = comparison(sign, "angles", context)?.reversed();
            angle(left_expr, deg, context)?;
            Some(Condition::Angle {
                a,
                b,
                is,
                limit_deg: deg,
                limit_cos: cos_deg(deg),
            })
        }
        (Operand::Counted { number, .. }, Operand::Number(limit)) => {
            counted(number, sign, limit, std::convert::identity, context)
        }
        (Operand::Number(limit), Operand::Counted { number, .. }) => {
            counted(number, sign, limit, Comparison::reversed, context)
        }
        (Operand::WordField(field), Operand::Word(word)) => {
            words(field, word, sign, right_expr, context)
        }
        (Operand::Word(word), Operand::WordField(field)) => {
            words(field, word, sign, left_expr, context)
        }
        (left, right) => {
            unlike(whole, (left_expr, &left), (right_expr, &right), context);
            None
        }
    }
}

/// Reports two values that cannot be compared.
fn unlike(
    whole: &Expr,
    (left_expr, left): (&Expr, &Operand),
    (right_expr, right): (&Expr, &Operand),
    context: &mut Context<'_>,
) {
    let (left_kind, right_kind) = (kind_of(left), kind_of(right));
    let written = |expr: &Expr| context.written(expr.span);
    let (left_words, right_words) = (written(left_expr), written(right_expr));
    let are_places = matches!(left, Operand::Point(_) | Operand::Heading);
    let (code, span, message) = if left_kind == right_kind && are_places {
        let message =
            format!("`{left_words}` and `{right_words}` have no order: each is {left_kind}");
        (Code::WrongExpression, whole.span, message)
    } else if left_kind == right_kind {
        let message = format!("`{left_words}` and `{right_words}` are both constants");
        (Code::WrongExpression, whole.span, message)
    } else if let Operand::Number(_) = right {
        let message = format!("`{right_words}` has no unit");
        (Code::MissingUnit, right_expr.span, message)
    } else if let Operand::Number(_) = left {
        let message = format!("`{left_words}` has no unit");
        (Code::MissingUnit, left_expr.span, message)
    } else {
        let message = format!("{left_kind} is compared with {right_kind}");
        (Code::WrongQuantity, right_expr.span, message)
    };
    let diagnostic = Diagnostic::new(code, span, message);
    context.push(match (left, right) {
        _ if left_kind == right_kind => diagnostic.help(FORMS),
        (Operand::Heading, _) | (_, Operand::Heading) => {
            diagnostic.help("write `angle_between(direction, from center to pick) < 45deg`")
        }
        _ => diagnostic
            .label(format!("expected {left_kind}"))
            .also(left_expr.span, format!("this is {left_kind}")),
    });
}

fn lengths(
    whole: &Expr,
    (left_expr, left): (&Expr, &FramedLength),
    (right_expr, right): (&Expr, &FramedLength),
    is: Option<Comparison>,
    context: &mut Context<'_>,
) -> Option<Condition> {
    if left.frame != right.frame {
        let (left_words, right_words) = (
            context.written(left_expr.span),
            context.written(right_expr.span),
        );
        let to = |length: &FramedLength| match length.frame {
            Frame::Picture => "px".to_owned(),
            Frame::Table if length.unit == "edge" => "edge".to_owned(),
            Frame::Table => "mm".to_owned(),
        };
        let message = "a length in the picture is compared with a length on the table";
        context.push(
            Diagnostic::new(Code::MixedFrames, right_expr.span, message)
                .label(kind_of(&Operand::Length(right.clone())))
                .also(left_expr.span, kind_of(&Operand::Length(left.clone())))
                .help(format!(
                    "write `{right_words} in {}`, or `{left_words} in {}`",
                    to(left),
                    to(right)
                )),
        );
        return None;
    }
    let frame = common_frame(&left.native, &right.native);
    let lowered_left = lowered(&left.native, frame, context);
    let lowered_right = lowered(&right.native, frame, context);
    let (left, right) = (lowered_left?, lowered_right?);
    if let (Length::Constant { .. }, Length::Constant { .. }) = (&left, &right) {
        let found = context.written(whole.span);
        let message = format!("`{found}` compares two constants");
        context.push(
            Diagnostic::new(Code::WrongExpression, whole.span, message).help(
                "one side depends on the action or the scene, such as `distance(pick, place)`",
            ),
        );
        return None;
    }
    Some(Condition::Lengths {
        left,
        is: is?,
        right,
    })
}

/// Compares a number; whole ones can be equal.
fn counted(
    number: Number,
    sign: &Ident,
    limit: f64,
    turned: fn(Comparison) -> Comparison,
    context: &mut Context<'_>,
) -> Option<Condition> {
    let compared = |is| Condition::Number {
        left: number.clone(),
        is,
        limit,
    };
    let is_whole = !matches!(number, Number::Coverage { .. });
    let equal = || Condition::All {
        of: vec![compared(Comparison::AtLeast), compared(Comparison::AtMost)],
    };
    match sign.text.as_str() {
        "==" if is_whole => Some(equal()),
        "!=" if is_whole => Some(Condition::Not {
            of: Box::new(equal()),
        }),
        _ => Some(compared(turned(comparison(sign, "numbers", context)?))),
    }
}

fn angle(expr: &Expr, deg: f64, context: &mut Context<'_>) -> Option<()> {
    if (0.0..=180.0).contains(&deg) {
        return Some(());
    }
    let written = context.written(expr.span);
    context.push(
        Diagnostic::new(
            Code::OutOfRange,
            expr.span,
            format!("`{written}` is out of range"),
        )
        .help("the angle between two directions is from `0deg` to `180deg`"),
    );
    None
}

fn words(
    field: String,
    word: String,
    sign: &Ident,
    written: &Expr,
    context: &mut Context<'_>,
) -> Option<Condition> {
    let choices = context.actions.iter().find(|known| known.name == field);
    if let Some(Choices::Words { choices }) = choices.map(|field| &field.choices)
        && !choices.contains(&word)
    {
        let message = format!("`{field}` is never `{word}`");
        let names: Vec<&str> = choices.iter().map(String::as_str).collect();
        let diagnostic = Diagnostic::new(Code::UnknownName, written.span, message);
        let diagnostic = match nearest(&word, names.iter().copied()) {
            Some(meant) => diagnostic.meant(written.span, &format!("\"{meant}\"")),
            None => diagnostic.help(format!("it is {}", among(names))),
        };
        context.push(diagnostic);
        return None;
    }
    let holds = Condition::Word { field, is: word };
    match sign.text.as_str() {
        "==" => Some(holds),
        "!=" => Some(Condition::Not {
            of: Box::new(holds),
        }),
        _ => {
            let message = format!("words are not compared by `{}`", sign.text);
            context.push(
                Diagnostic::new(Code::WrongExpression, sign.span, message)
                    .help("write `==` or `!=`"),
            );
            None
        }
    }
}

fn comparison(sign: &Ident, what: &str, context: &mut Context<'_>) -> Option<Comparison> {
    let (right, help) = match sign.text.as_str() {
        "<" => return Some(Comparison::Less),
        "<=" => return Some(Comparison::AtMost),
        ">" => return Some(Comparison::Greater),
        ">=" => return Some(Comparison::AtLeast),
        "≤" => (Some("<="), "write `<=`"),
        "≥" => (Some(">="), "write `>=`"),
        _ => (
            None,
            "measured values are hardly ever equal; write `<`, `<=`, `>` or `>=`",
        ),
    };
    let mut diagnostic = Diagnostic::new(
        Code::WrongExpression,
        sign.span,
        format!("{what} are not compared by `{}`", sign.text),
    )
    .help(help);
    if let Some(right) = right {
        diagnostic = diagnostic.edit(sign.span, right);
    }
    context.push(diagnostic);
    None
}

//! Values of conditions and texts: what an expression is, with its frame.
//!
//! Lengths carry the frame in which they are compared: the picture or the table. What the camera makes of
//! the one in the other is only converted where `in` says so.

use super::names::Meaning;
use super::points::{heading, is_heading, point};
use super::quantity::{Measure, measure_of, no_conversion, quantity};
use super::{Context, measures};
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic};
use fab_program::exact::normalised_deg;
use fab_program::{
    Camera, Choices, Heading, KeypointShape, Length, LengthUnit, Number, Point, PointMeasure,
};

/// Where a length is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    Picture,
    Table,
}

/// A value.
#[derive(Clone, Debug)]
pub(crate) enum Operand {
    Length(FramedLength),
    /// A fixed angle, degrees, and the unit that it is written in.
    Angle {
        deg: f64,
        unit: String,
    },
    Between {
        a: Heading,
        b: Heading,
        unit: String,
    },
    Number(f64),
    Counted {
        number: Number,
        as_percent: AsPercent,
    },
    Point(Point),
    Heading,
    /// A field that is a word.
    WordField(String),
    Word(String),
}

/// Whether a fraction is written as a percentage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AsPercent {
    Yes,
    No,
}

/// A length and the frame that it is compared in.
#[derive(Clone, Debug)]
pub(crate) struct FramedLength {
    pub native: NativeLength,
    pub frame: Frame,
    /// The unit that it is written in.
    pub unit: String,
}

/// A length as it is known.
#[derive(Clone, Debug)]
pub(crate) enum NativeLength {
    /// Pixels.
    Picture(f64),
    /// Metres.
    Table(f64),
    /// Between two points of the picture.
    Distance(Point, Point),
    /// Between two points of the picture, along the axis on which they are farther apart.
    Chebyshev(Point, Point),
    /// A field that is a length on the table.
    Field(String),
}

impl NativeLength {
    fn is_table(&self) -> bool {
        matches!(self, NativeLength::Table(_) | NativeLength::Field(_))
    }
}

/// Returns a length in pixels or in metres; None where that needs a camera and there is none.
pub(crate) fn lowered(
    length: &NativeLength,
    frame: Frame,
    context: &Context<'_>,
) -> Option<Length> {
    let px_per_m = context.camera.as_ref().map(Camera::px_per_m);
    let constant = |value: f64| (!value.is_nan()).then_some(Length::Constant { value });
    match (length, frame) {
        (NativeLength::Picture(px), Frame::Picture) => constant(*px),
        (NativeLength::Picture(px), Frame::Table) => constant(px / px_per_m?),
        (NativeLength::Table(m), Frame::Table) => constant(*m),
        (NativeLength::Table(m), Frame::Picture) => constant(m * px_per_m?),
        (NativeLength::Distance(a, b), _) => of_points("distance", a, b),
        (NativeLength::Chebyshev(a, b), _) => of_points("chebyshev", a, b),
        (NativeLength::Field(field), Frame::Table) => Some(Length::Field {
            field: field.clone(),
            scale: 1.0,
        }),
        (NativeLength::Field(field), Frame::Picture) => Some(Length::Field {
            field: field.clone(),
            scale: px_per_m?,
        }),
    }
}

fn of_points(measure: &str, a: &Point, b: &Point) -> Option<Length> {
    PointMeasure::new(measure, vec![a.clone(), b.clone()]).map(Length::OfPoints)
}

/// Returns the frame in which two lengths can both be known: the picture, where one is measured in it.
pub(crate) fn common_frame(a: &NativeLength, b: &NativeLength) -> Frame {
    if a.is_table() && b.is_table() {
        Frame::Table
    } else {
        Frame::Picture
    }
}

/// Builds a value; None, with a report unless it is made elsewhere, where there is none.
pub(crate) fn operand(expr: &Expr, context: &mut Context<'_>) -> Option<Operand> {
    match &expr.kind {
        ExprKind::Converted { value, target } => {
            let value = operand(value, context)?;
            converted(value, target, context)
        }
        ExprKind::Quantity { .. } => constant(expr, context),
        ExprKind::Name(name) if context.constants.contains_key(name.as_str()) => {
            constant(expr, context)
        }
        ExprKind::Name(name) if name == "step" && context.names.get(name).is_none() => {
            Some(Operand::Counted {
                number: Number::Step,
                as_percent: AsPercent::No,
            })
        }
        ExprKind::Name(name) => named(name, expr, context),
        ExprKind::Path(_) if is_heading(expr, context) => {
            heading(expr, context).map(|_| Operand::Heading)
        }
        ExprKind::Path(_) => point(expr, context).map(Operand::Point),
        ExprKind::Heading { .. } => heading(expr, context).map(|_| Operand::Heading),
        ExprKind::Text(text) => match text.plain() {
            Some(word) => Some(Operand::Word(word)),
            None => {
                let message = "a word to compare with has no `{{ … }}`";
                context.push(Diagnostic::new(Code::WrongExpression, expr.span, message));
                None
            }
        },
        ExprKind::Call { name, .. } => measures::call(name, expr, context),
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a value, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongExpression, expr.span, message)
                    .help("write such as `distance(pick, place)` or `10px`"),
            );
            None
        }
    }
}

fn constant(expr: &Expr, context: &mut Context<'_>) -> Option<Operand> {
    let found = quantity(expr, context)?;
    let length = |native, frame| {
        Operand::Length(FramedLength {
            native,
            frame,
            unit: found.unit.clone(),
        })
    };
    // Numbers of absurd size would overflow when they are squared.
    if found.value.abs() > 1e6 {
        let written = context.written(expr.span);
        context.push(
            Diagnostic::new(
                Code::OutOfRange,
                expr.span,
                format!("`{written}` is out of range"),
            )
            .help("accepted are values up to a million in pixels, metres or degrees"),
        );
        return None;
    }
    let is_length = matches!(found.measure, Measure::Length | Measure::Pixels);
    if is_length && found.value < 0.0 {
        let written = context.written(expr.span);
        context.push(
            Diagnostic::new(
                Code::OutOfRange,
                expr.span,
                format!("`{written}` is out of range"),
            )
            .help("a length is never negative"),
        );
        return None;
    }
    Some(match found.measure {
        Measure::Pixels => length(NativeLength::Picture(found.value), Frame::Picture),
        Measure::Length => length(NativeLength::Table(found.value), Frame::Table),
        Measure::Angle => Operand::Angle {
            // Whole degrees stay whole: they are not passed through radians.
            deg: if found.unit == "deg" {
                found.number
            } else {
                found.value.to_degrees()
            },
            unit: found.unit,
        },
        Measure::Number => Operand::Number(found.value),
    })
}

fn named(name: &str, expr: &Expr, context: &mut Context<'_>) -> Option<Operand> {
    let field = context.actions.iter().find(|field| field.name == name);
    let choices = field.map(|field| field.choices.clone());
    match (context.names.get(name), choices) {
        (Some(Meaning::Field), Some(Choices::Lengths { unit, .. })) => {
            Some(Operand::Length(FramedLength {
                native: NativeLength::Field(name.to_owned()),
                frame: Frame::Table,
                unit: unit.name.to_owned(),
            }))
        }
        (Some(Meaning::Field), Some(Choices::Directions { .. })) => Some(Operand::Heading),
        (Some(Meaning::Field), Some(Choices::Words { .. })) => {
            Some(Operand::WordField(name.to_owned()))
        }
        (None, _) if name != "last" => {
            let name = Ident {
                text: name.to_owned(),
                span: expr.span,
            };
            let is_value = |meaning| {
                matches!(
                    meaning,
                    Meaning::Field | Meaning::Keypoint(Some(KeypointShape::Point))
                )
            };
            let mut candidates = context.names.that(is_value);
            let constants: Vec<&str> = context.constants.keys().copied().collect();
            candidates.extend(constants);
            context.unknown("value", &name, candidates);
            None
        }
        _ => point(expr, context).map(Operand::Point),
    }
}

fn converted(value: Operand, target: &Ident, context: &mut Context<'_>) -> Option<Operand> {
    let unit = target.text.clone();
    match (value, measure_of(&target.text)) {
        (Operand::Length(length), Some(Measure::Pixels)) => Some(Operand::Length(FramedLength {
            frame: Frame::Picture,
            unit,
            ..length
        })),
        (Operand::Length(length), Some(Measure::Length)) => Some(Operand::Length(FramedLength {
            frame: Frame::Table,
            unit,
            ..length
        })),
        (Operand::Angle { deg, .. }, Some(Measure::Angle)) => Some(Operand::Angle { deg, unit }),
        (Operand::Between { a, b, .. }, Some(Measure::Angle)) => {
            Some(Operand::Between { a, b, unit })
        }
        (Operand::Counted { number, .. }, None) if unit == "percent" => Some(Operand::Counted {
            number,
            as_percent: AsPercent::Yes,
        }),
        (value, _) => {
            let message = format!("{} has no size in `{unit}`", kind_of(&value));
            context.push(no_conversion(target, message));
            None
        }
    }
}

/// Says what a value is.
pub(crate) fn kind_of(value: &Operand) -> &'static str {
    match value {
        Operand::Length(FramedLength {
            frame: Frame::Picture,
            ..
        }) => "a length in the picture",
        Operand::Length(_) => "a length on the table",
        Operand::Angle { .. } | Operand::Between { .. } => "an angle",
        Operand::Number(_) | Operand::Counted { .. } => "a number",
        Operand::Point(_) => "a point",
        Operand::Heading => "a direction",
        Operand::WordField(_) | Operand::Word(_) => "a word",
    }
}

/// Returns the unit of that name.
pub(crate) fn length_unit(name: &str) -> Option<LengthUnit> {
    LengthUnit::find(name)
}

/// Returns a fixed direction, degrees within one turn.
pub(crate) fn fixed_deg(expr: &Expr, context: &mut Context<'_>) -> Option<f64> {
    match constant(expr, context)? {
        Operand::Angle { deg, .. } => Some(normalised_deg(deg)),
        other => {
            let message = format!("expected a direction, found {}", kind_of(&other));
            context.push(
                Diagnostic::new(Code::WrongQuantity, expr.span, message).help(
                    "write an angle such as `45deg`, counter-clockwise from the image's right",
                ),
            );
            None
        }
    }
}

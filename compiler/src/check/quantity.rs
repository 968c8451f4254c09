//! Numbers with units: what they measure, in base units, and in which range.

use super::Context;
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, nearest};
use std::f64::consts::PI;
use std::ops::RangeInclusive;

/// What a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// A length on the table, metres.
    Length,
    /// A length in a picture, pixels.
    Pixels,
    /// An angle, radians.
    Angle,
    /// A multiple of the cloth's longer side.
    Edges,
    /// A plain number.
    Number,
}

/// Every unit, what it measures, and its size in base units.
const UNITS: &[(&str, Measure, f64)] = &[
    ("mm", Measure::Length, 0.001),
    ("cm", Measure::Length, 0.01),
    ("m", Measure::Length, 1.0),
    ("px", Measure::Pixels, 1.0),
    ("deg", Measure::Angle, PI / 180.0),
    ("rad", Measure::Angle, 1.0),
    ("edge", Measure::Edges, 1.0),
];

/// Units of other worlds, and what to write instead.
const FOREIGN_UNITS: &[(&str, &str)] = &[
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("pixel", "px"),
    ("pixels", "px"),
    ("millimeters", "mm"),
    ("millimetres", "mm"),
    ("centimeters", "cm"),
    ("centimetres", "cm"),
    ("meters", "m"),
    ("metres", "m"),
    ("edges", "edge"),
    ("radians", "rad"),
];

impl Measure {
    fn words(self) -> &'static str {
        match self {
            Measure::Length => "a length on the table such as `40mm`",
            Measure::Pixels => "a length in the picture such as `10px`",
            Measure::Angle => "an angle such as `45deg`",
            Measure::Edges => "a multiple of the cloth's longer side such as `0.5edge`",
            Measure::Number => "a number without a unit",
        }
    }

    fn noun(self) -> &'static str {
        match self {
            Measure::Length => "a length on the table",
            Measure::Pixels => "a length in the picture",
            Measure::Angle => "an angle",
            Measure::Edges => "a multiple of the cloth's longer side",
            Measure::Number => "a plain number",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Measure::Length => "mm",
            Measure::Pixels => "px",
            Measure::Angle => "deg",
            Measure::Edges => "edge",
            Measure::Number => "",
        }
    }
}

/// Which values are accepted.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    pub measure: Measure,
    /// In base units, both ends included.
    pub range: RangeInclusive<f64>,
    /// The range in words, e.g. `from 16px to 2048px`.
    pub range_words: &'static str,
}

/// Reads a quantity in base units; None, with a report, where it is not what is wanted.
pub(crate) fn read(expr: &Expr, wanted: &Wanted, context: &mut Context<'_>) -> Option<f64> {
    let value = measured(expr, wanted.measure, context)?;
    if wanted.range.contains(&value) {
        return Some(value);
    }
    let written = written(expr, context);
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

/// Reads a count in base units: a quantity that is a whole number.
pub(crate) fn read_whole(expr: &Expr, wanted: &Wanted, context: &mut Context<'_>) -> Option<u32> {
    let value = measured(expr, wanted.measure, context)?;
    if value.fract() != 0.0 {
        let written = written(expr, context);
        let message = format!("`{written}` is not a whole number");
        context.push(
            Diagnostic::new(Code::NotWhole, expr.span, message)
                .help(format!("accepted is {}", wanted.range_words)),
        );
        return None;
    }
    // Every range of counts ends far below 2^32, so nothing is cut off.
    read(expr, wanted, context).map(|value| value as u32)
}

fn written(expr: &Expr, context: &Context<'_>) -> String {
    context.written(expr.span)
}

fn measured(expr: &Expr, wanted: Measure, context: &mut Context<'_>) -> Option<f64> {
    let ExprKind::Quantity { value, unit, .. } = &expr.kind else {
        let message = format!(
            "expected {}, found `{}`",
            wanted.words(),
            written(expr, context)
        );
        context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
        return None;
    };
    let (measure, size) = match unit {
        None => (Measure::Number, 1.0),
        Some(unit) => self::unit(unit, context)?,
    };
    if measure == wanted {
        return Some(value * size);
    }
    let written = written(expr, context);
    context.push(match (wanted, measure) {
        (_, Measure::Number) => Diagnostic::new(
            Code::MissingUnit,
            expr.span,
            format!("`{written}` has no unit"),
        )
        .label(format!("expected {}", wanted.noun()))
        .help(format!("write `{written}{}`", wanted.unit())),
        (Measure::Number, _) => Diagnostic::new(
            Code::WrongQuantity,
            expr.span,
            format!("expected a number without a unit, found `{written}`"),
        )
        .label(format!("this is {}", measure.noun())),
        _ => Diagnostic::new(
            Code::WrongQuantity,
            expr.span,
            format!("expected {}, found {}", wanted.noun(), measure.noun()),
        )
        .label(format!("`{written}` is {}", measure.noun()))
        .help(format!("write {}", wanted.words())),
    });
    None
}

fn unit(unit: &Ident, context: &mut Context<'_>) -> Option<(Measure, f64)> {
    if let Some((_, measure, size)) = UNITS.iter().find(|(name, ..)| *name == unit.text) {
        return Some((*measure, *size));
    }
    let foreign = FOREIGN_UNITS
        .iter()
        .find(|(name, _)| *name == unit.text)
        .map(|(_, right)| *right);
    let meant = foreign.or_else(|| nearest(&unit.text, UNITS.iter().map(|(name, ..)| *name)));
    let diagnostic = Diagnostic::new(
        Code::UnknownUnit,
        unit.span,
        format!("there is no unit `{}`", unit.text),
    );
    context.push(match meant {
        Some(meant) => diagnostic
            .help(format!("did you mean `{meant}`?"))
            .edit(unit.span, meant),
        None => diagnostic.help("units are `mm`, `cm`, `m`, `px`, `deg`, `rad` and `edge`"),
    });
    None
}

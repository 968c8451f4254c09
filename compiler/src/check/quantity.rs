//! Numbers with units: what they measure, in base units, and in which range.

use super::Context;
use super::constants::{is_broken, resolved};
use crate::ast::{Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, nearest};
use fab_program::{Camera, Cloth};
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
    /// A plain number.
    Number,
}

/// Every unit, what it measures, and its size in base units; that of `edge` is the cloth's.
const UNITS: &[(&str, Measure, f64)] = &[
    ("mm", Measure::Length, 0.001),
    ("cm", Measure::Length, 0.01),
    ("m", Measure::Length, 1.0),
    ("px", Measure::Pixels, 1.0),
    ("deg", Measure::Angle, PI / 180.0),
    ("rad", Measure::Angle, 1.0),
    ("edge", Measure::Length, f64::NAN),
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
    ("millimeter", "mm"),
    ("millimetre", "mm"),
    ("radian", "rad"),
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
            Measure::Number => "a number without a unit",
        }
    }

    pub(super) fn noun(self) -> &'static str {
        match self {
            Measure::Length => "a length on the table",
            Measure::Pixels => "a length in the picture",
            Measure::Angle => "an angle",
            Measure::Number => "a plain number",
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Measure::Length => "mm",
            Measure::Pixels => "px",
            Measure::Angle => "deg",
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

/// A number with its unit.
#[derive(Clone, Debug)]
pub(crate) struct Quantity {
    /// In base units; not a number where the unit is `edge` and there is no cloth.
    pub value: f64,
    pub measure: Measure,
    /// The number as written.
    pub number: f64,
    /// The unit as written; empty for a plain number.
    pub unit: String,
}

/// Reads a number and its unit, or a constant; None where it is none, or, with a report, where the unit is unknown.
pub(crate) fn quantity(expr: &Expr, context: &mut Context<'_>) -> Option<Quantity> {
    let ExprKind::Quantity { value, unit } = &resolved(expr, context).kind else {
        return None;
    };
    let (value, unit) = (*value, unit.clone());
    let Some(unit) = unit else {
        return Some(Quantity {
            value,
            measure: Measure::Number,
            number: value,
            unit: String::new(),
        });
    };
    let (measure, mut size) = self::unit(&unit, context)?;
    if unit.text == "edge" {
        size = context.cloth.as_ref().map_or(f64::NAN, Cloth::edge_m);
    }
    Some(Quantity {
        value: value * size,
        measure,
        number: value,
        unit: unit.text,
    })
}

/// Returns what a unit measures; None where there is no such unit.
pub(crate) fn measure_of(unit: &str) -> Option<Measure> {
    let known = UNITS.iter().find(|(name, ..)| *name == unit);
    known.map(|(_, measure, _)| *measure)
}

fn measured(expr: &Expr, wanted: Measure, context: &mut Context<'_>) -> Option<f64> {
    if let ExprKind::Converted { value, target } = &expr.kind {
        return converted(value, target, wanted, context);
    }
    if is_broken(expr, context) {
        return None;
    }
    if !matches!(resolved(expr, context).kind, ExprKind::Quantity { .. }) {
        let message = format!(
            "expected {}, found `{}`",
            wanted.words(),
            written(expr, context)
        );
        context.push(Diagnostic::new(Code::WrongForm, expr.span, message));
        return None;
    }
    let found = quantity(expr, context)?;
    if found.measure == wanted {
        // Without a cloth the task is no program, and `edge` has no size.
        return (!found.value.is_nan()).then_some(found.value);
    }
    let measure = found.measure;
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
        (Measure::Pixels, Measure::Length) if context.camera.is_some() => {
            mixed(expr, wanted, measure, format!("write `{written} in px`"))
        }
        (Measure::Length, Measure::Pixels) => Diagnostic::new(
            Code::MixedFrames,
            expr.span,
            format!("expected {}, found {}", wanted.noun(), measure.noun()),
        )
        .help(format!("write {}", wanted.words())),
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

fn mixed(expr: &Expr, wanted: Measure, found: Measure, conversion: String) -> Diagnostic {
    Diagnostic::new(
        Code::MixedFrames,
        expr.span,
        format!("expected {}, found {}", wanted.noun(), found.noun()),
    )
    .help(format!(
        "{conversion} for what the camera makes of it, or write {}",
        wanted.words()
    ))
}

/// Reads `VALUE in UNIT` as a length in the wanted frame.
fn converted(
    value: &Expr,
    target: &Ident,
    wanted: Measure,
    context: &mut Context<'_>,
) -> Option<f64> {
    let to = measure_of(&target.text);
    if to != Some(wanted) {
        context.push(no_conversion(
            target,
            format!(
                "expected {}, found a value in `{}`",
                wanted.noun(),
                target.text
            ),
        ));
        return None;
    }
    let from = quantity(value, context)?;
    let px_per_m = context.camera.as_ref().map(Camera::px_per_m);
    let result = match (from.measure, wanted) {
        (from, to) if from == to => Some(1.0),
        (Measure::Length, Measure::Pixels) => px_per_m,
        (Measure::Pixels, Measure::Length) => px_per_m.map(|px_per_m| 1.0 / px_per_m),
        _ => {
            let message = format!("{} has no size in `{}`", from.measure.noun(), target.text);
            context.push(no_conversion(target, message));
            None
        }
    };
    result
        .map(|factor| from.value * factor)
        .filter(|value| !value.is_nan())
}

/// Reports a conversion that makes no sense.
pub(super) fn no_conversion(target: &Ident, message: String) -> Diagnostic {
    Diagnostic::new(Code::NoConversion, target.span, message)
        .help("behind `in` stand `px`, `mm`, `cm`, `m` or `edge` for lengths, `deg` or `rad` for angles, `percent` for fractions")
}

fn unit(unit: &Ident, context: &mut Context<'_>) -> Option<(Measure, f64)> {
    if let Some((_, measure, size)) = UNITS.iter().find(|(name, ..)| *name == unit.text) {
        return Some((*measure, *size));
    }
    let foreign = FOREIGN_UNITS
        .iter()
        .find(|(name, _)| *name == unit.text)
        .map(|(_, right)| *right);
    let diagnostic = Diagnostic::new(
        Code::UnknownUnit,
        unit.span,
        format!("there is no unit `{}`", unit.text),
    );
    let near = nearest(&unit.text, UNITS.iter().map(|(name, ..)| *name));
    if unit.text == "%" {
        context.push(diagnostic.help("write a fraction: `0.9` for nine tenths"));
        return None;
    }
    context.push(match (foreign, near) {
        (Some(right), _) => diagnostic
            .help(format!("write `{right}`"))
            .edit(unit.span, right),
        (None, Some(meant)) => diagnostic.meant(unit.span, meant),
        (None, None) => diagnostic.help("units are `mm`, `cm`, `m`, `px`, `deg`, `rad` and `edge`"),
    });
    None
}

//! Numbers with units: their dimension, their value in base units, and their range.

use super::context::Context;
use crate::diag::{Code, Diagnostic, Reported, among, nearest};
use fab_grammar::ast::{Expr, Name, Quantity};
use fab_program::exact::written;
use fab_program::units::{self, Dimension, UNITS};
use fab_program::vocabulary::Range;

/// A number with its unit.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// In base units; NaN if the unit is `edge` and the task, a base, has no cloth.
    pub value: f64,
    pub dimension: Dimension,
    /// The number as written.
    pub number: f64,
    /// The unit as written; empty for a plain number.
    pub unit: &'static str,
}

impl Measured {
    /// Returns an angle in degrees; whole degrees stay exact because they are not converted through radians.
    pub fn deg(&self) -> f64 {
        let is_degrees = units::base((1.0, self.unit)).to_degrees() == 1.0;
        if is_degrees {
            self.number
        } else {
            self.value.to_degrees()
        }
    }
}

/// Describes a dimension, with an example of how a number is written in it.
fn example(dimension: Dimension) -> String {
    let example = match dimension {
        Dimension::Length => "40mm",
        Dimension::Pixels => "10px",
        Dimension::Angle => "45deg",
        Dimension::Speed => "200mm/s",
        Dimension::ArealDensity => "420g/m2",
        Dimension::Number => return "a number without a unit".to_owned(),
    };
    format!("{} such as `{example}`", dimension.noun())
}

/// Returns the unit that advice uses for a dimension.
fn usual_unit(dimension: Dimension) -> &'static str {
    let mut rows = UNITS.iter();
    rows.find(|unit| unit.dimension == dimension)
        .map_or("", |unit| unit.name)
}

/// Returns the quantity of a number or of a named constant; `None` for any other expression.
pub(crate) fn quantity_of<'a>(
    expr: Expr<'a>,
    context: &Context<'a, '_>,
) -> Result<Option<Quantity<'a>>, Reported> {
    match expr {
        Expr::Quantity(quantity) => Ok(Some(quantity)),
        Expr::Name(name) => match context.constants.get(name.text()) {
            Some(Ok(quantity)) => Ok(Some(*quantity)),
            Some(Err(reported)) => Err(*reported),
            None => context.may_be_hidden(name.text()).map(|()| None),
        },
        _ => Ok(None),
    }
}

/// Reads a number with its unit, or a constant; `None` for any other expression.
pub(crate) fn measured<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Option<Measured>, Reported> {
    let Some(quantity) = quantity_of(expr, context)? else {
        return Ok(None);
    };
    let number = quantity.value();
    let Some(name) = quantity.unit() else {
        let dimension = Dimension::Number;
        return Ok(Some(Measured {
            value: number,
            dimension,
            number,
            unit: "",
        }));
    };
    let unit = unit(quantity, name, context)?;
    let size = if unit.size.is_nan() {
        context.edge_m()?
    } else {
        unit.size
    };
    Ok(Some(Measured {
        value: number * size,
        dimension: unit.dimension,
        number,
        unit: unit.name,
    }))
}

/// Reads a number in a range, in base units. NaN, for `edge` in a base without a cloth, passes every range.
pub(crate) fn read<'a>(
    expr: Expr<'a>,
    range: &Range,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    let value = in_dimension(expr, range.dimension(), Precision::Any, context)?;
    if range.contains(value) || value.is_nan() {
        return Ok(value);
    }
    Err(out_of_range(
        expr,
        &format!("expected {}", range.words()),
        context,
    ))
}

/// Reads a whole number in a range.
pub(crate) fn read_whole<'a>(
    expr: Expr<'a>,
    range: &Range,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    let value = in_dimension(expr, range.dimension(), Precision::Whole, context)?;
    if value.fract() == 0.0 {
        return read(expr, range, context);
    }
    let help = format!("expected {}", range.words());
    Err(not_whole(expr, &help, context))
}

/// Reports a number that is not whole.
pub(super) fn not_whole(expr: Expr<'_>, help: &str, context: &mut Context<'_, '_>) -> Reported {
    let written = context.written(expr.span());
    let message = format!("`{written}` is not a whole number");
    context.error(Diagnostic::new(Code::NotWhole, expr.span(), message).help(help))
}

/// Reports a number outside of its range.
pub(super) fn out_of_range(expr: Expr<'_>, help: &str, context: &mut Context<'_, '_>) -> Reported {
    let written = context.written(expr.span());
    let stated = match expr {
        Expr::Name(name) => context.constants.get(name.text()),
        _ => None,
    };
    let Some(Ok(stated)) = stated else {
        let message = format!("`{written}` is out of range");
        return context.error(Diagnostic::new(Code::OutOfRange, expr.span(), message).help(help));
    };
    let place = stated.span();
    let message = format!("`{written}` is `{}`, out of range", context.written(place));
    let diagnostic = Diagnostic::new(Code::OutOfRange, expr.span(), message);
    context.error(diagnostic.also(place, "stated here").help(help))
}

/// Which numbers are accepted. A length on the table is hardly ever a whole number of pixels.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Precision {
    Any,
    Whole,
}

fn in_dimension<'a>(
    expr: Expr<'a>,
    expected: Dimension,
    precision: Precision,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    if let Expr::Converted(converted) = expr {
        return self::converted(converted.value(), converted.target(), expected, context);
    }
    let Some(found) = measured(expr, context)? else {
        let diagnostic = context.unexpected(Code::WrongForm, expr, &example(expected));
        return Err(context.error(diagnostic));
    };
    if found.dimension == expected {
        return Ok(found.value);
    }
    let written = context.written(expr.span());
    let (expected_noun, found_noun) = (expected.noun(), found.dimension.noun());
    let new = |code, message: String| Diagnostic::new(code, expr.span(), message);
    let mixed = || {
        new(
            Code::MixedFrames,
            format!("expected {expected_noun}, found {found_noun}"),
        )
    };
    let help = format!("write {}", example(expected));
    let diagnostic = match (expected, found.dimension) {
        (_, Dimension::Number) => {
            let help = match expr {
                Expr::Name(_) => format!("give the constant a unit: {}", example(expected)),
                _ => format!("write `{written}{}`", usual_unit(expected)),
            };
            no_unit(expr, expected_noun, context).help(help)
        }
        (Dimension::Number, _) => new(
            Code::WrongQuantity,
            format!("expected a number without a unit, found `{written}`"),
        )
        .label(format!("this is {found_noun}")),
        (Dimension::Pixels, Dimension::Length)
            if precision == Precision::Any && matches!(context.camera, Ok(Some(_))) =>
        {
            mixed().help(format!(
                "write `{written} in px` for its length in the picture, or {help}"
            ))
        }
        (Dimension::Length, Dimension::Pixels) | (Dimension::Pixels, Dimension::Length) => {
            mixed().help(help)
        }
        _ => new(
            Code::WrongQuantity,
            format!("expected {expected_noun}, found {found_noun}"),
        )
        .label(format!("`{written}` is {found_noun}"))
        .help(help),
    };
    Err(context.error(diagnostic))
}

/// Makes the diagnostic for a number without a unit. A constant is reported where it is declared, once for all uses.
pub(super) fn no_unit(expr: Expr<'_>, expected: &str, context: &Context<'_, '_>) -> Diagnostic {
    let message = format!("`{}` has no unit", context.written(expr.span()));
    let declared = match expr {
        Expr::Name(name) => context.constants.get(name.text()),
        _ => None,
    };
    match declared {
        Some(Ok(number)) => Diagnostic::new(Code::MissingUnit, number.span(), message)
            .also(expr.span(), format!("expected {expected}")),
        _ => Diagnostic::new(Code::MissingUnit, expr.span(), message)
            .label(format!("expected {expected}")),
    }
}

/// Reads `VALUE in UNIT` in the expected dimension.
fn converted<'a>(
    value: Expr<'a>,
    target: Name<'a>,
    expected: Dimension,
    context: &mut Context<'a, '_>,
) -> Result<f64, Reported> {
    if units::find(target.text()).map(|unit| unit.dimension) != Some(expected) {
        let message = format!(
            "expected {}, found a value in `{}`",
            expected.noun(),
            target.text()
        );
        let units = units_of(&[expected]);
        return Err(no_conversion(target, message, units, context));
    }
    let Some(from) = measured(value, context)? else {
        let diagnostic = context.unexpected(Code::WrongForm, value, &example(expected));
        return Err(context.error(diagnostic));
    };
    match (from.dimension, expected) {
        (from_dimension, to) if from_dimension == to => Ok(from.value),
        (Dimension::Length, Dimension::Pixels) => Ok(from.value * context.px_per_m()?),
        (Dimension::Pixels, Dimension::Length) => Ok(from.value / context.px_per_m()?),
        (dimension, _) => {
            if let (Dimension::Number, Expr::Name(_)) = (dimension, value) {
                return Err(context.error(no_unit(value, expected.noun(), context)));
            }
            let message = format!(
                "{} cannot be converted to `{}`",
                dimension.noun(),
                target.text()
            );
            Err(no_conversion(
                target,
                message,
                units_of(&[dimension]),
                context,
            ))
        }
    }
}

/// Returns the names of the units of these dimensions.
pub(super) fn units_of(dimensions: &[Dimension]) -> Vec<&'static str> {
    let units = UNITS.iter();
    let units = units.filter(|unit| dimensions.contains(&unit.dimension));
    units.map(|unit| unit.name).collect()
}

/// Reports a conversion that makes no sense.
///
/// - `fitting`: the units that would fit.
pub(super) fn no_conversion(
    target: Name<'_>,
    message: String,
    fitting: Vec<&'static str>,
    context: &mut Context<'_, '_>,
) -> Reported {
    let lengths = among(units_of(&[Dimension::Length, Dimension::Pixels]));
    let angles = among(units_of(&[Dimension::Angle]));
    let diagnostic = Diagnostic::new(Code::NoConversion, target.span(), message);
    let is_spelled = |unit: &&units::Unit| {
        fitting.contains(&unit.name) && unit.spellings.contains(&target.text())
    };
    let spelled = UNITS.iter().find(is_spelled).map(|unit| unit.name);
    let meant = match units::find(target.text()) {
        None => spelled.or_else(|| nearest(target.text(), fitting.iter().copied())),
        Some(_) => None,
    };
    context.error(match meant {
        Some(meant) => diagnostic.meant(target.span(), meant),
        None if fitting == units_of(&[Dimension::Speed]) => {
            diagnostic.help(format!("after `in`, write {} for speeds", among(fitting)))
        }
        None => diagnostic.help(format!(
            "after `in`, write {lengths} for lengths, {angles} for angles, `percent` for fractions"
        )),
    })
}

pub(super) fn unit(
    quantity: Quantity<'_>,
    name: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<&'static units::Unit, Reported> {
    let word = name.text();
    if let Some(unit) = units::find(word) {
        return Ok(unit);
    }
    let message = format!("there is no unit `{word}`");
    let diagnostic = Diagnostic::new(Code::UnknownUnit, name.span(), message);
    if word == "%" {
        let fraction = written(quantity.value() / 100.0, 6);
        return Err(context.error(diagnostic.help(format!(
            "write `{fraction}` for a fraction, `{fraction}edge` for a part of the cloth's longer side"
        ))));
    }
    let right = UNITS.iter().find(|unit| unit.spellings.contains(&word));
    let mut names = UNITS.iter().map(|unit| unit.name);
    // `167g` for `167g/m2`
    let begun = names.find(|name| name.split_once('/').is_some_and(|(first, _)| first == word));
    let near = begun.or_else(|| nearest(word, UNITS.iter().map(|unit| unit.name)));
    Err(context.error(match (right, near) {
        (Some(right), _) => diagnostic
            .help(format!("write `{}`", right.name))
            .edit(name.span(), right.name),
        (None, Some(meant)) => diagnostic.meant(name.span(), meant),
        (None, None) => {
            let all = among(UNITS.iter().map(|unit| unit.name)).replace(" or ", " and ");
            diagnostic.help(format!("units are {all}"))
        }
    }))
}

//! Numbers with units: their dimension, their value in base units, and their range.

use super::context::{Context, Result};
use super::names::Meaning;
use crate::diag::{Code, Diagnostic, Reported, among, nearest};
use fab_grammar::ast::{Expr, Name, Quantity};
use fab_program::exact::written;
use fab_program::units::{self, Dimension, UNITS, Unit};
use fab_program::vocabulary::Range;

/// A number with its unit.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// In base units; NaN if the unit is `edge` and the task, a base, has no cloth.
    pub value: f64,
    /// The number as written.
    pub number: f64,
    /// The unit; `None` for a plain number.
    pub unit: Option<&'static Unit>,
}

impl Measured {
    pub fn dimension(&self) -> Dimension {
        self.unit.map_or(Dimension::Number, |unit| unit.dimension)
    }
}

/// Describes a dimension, with an example of how a number is written in it.
fn example(dimension: Dimension) -> String {
    match dimension {
        Dimension::Number => "a number without a unit".to_owned(),
        _ => format!("{} such as `40{}`", dimension.noun(), usual_unit(dimension)),
    }
}

/// Returns the unit that advice uses for a dimension.
pub(super) fn usual_unit(dimension: Dimension) -> &'static str {
    let mut rows = UNITS.iter();
    rows.find(|unit| unit.dimension == dimension)
        .map_or("", |unit| unit.name)
}

/// Returns the quantity of a number or of a named constant; `None` for any other expression.
pub(crate) fn quantity_of<'a>(
    expr: Expr<'a>,
    context: &Context<'a>,
) -> Result<Option<Quantity<'a>>> {
    match expr {
        Expr::Quantity(quantity) => Ok(Some(quantity)),
        _ => constant(expr, context),
    }
}

/// Returns the quantity of a named constant; `None` for any other expression.
fn constant<'a>(expr: Expr<'a>, context: &Context<'a>) -> Result<Option<Quantity<'a>>> {
    let Expr::Name(name) = expr else {
        return Ok(None);
    };
    Ok(match context.names.get(name.text())? {
        Some(Meaning::Constant(Expr::Quantity(quantity))) => Some(quantity),
        _ => None,
    })
}

/// Reads a number with its unit, or a constant; `None` for any other expression.
pub(crate) fn measured(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Option<Measured>> {
    let Some(quantity) = quantity_of(expr, context)? else {
        return Ok(None);
    };
    let number = quantity.value();
    let unit = quantity.unit().map(|name| unit(quantity, name, context));
    let unit = unit.transpose()?;
    let size = unit.map_or(Ok(1.0), |unit| size(unit, context))?;
    Ok(Some(Measured {
        value: number * size,
        number,
        unit,
    }))
}

/// Returns the size of a unit in base units.
pub(super) fn size(unit: &Unit, context: &Context<'_>) -> Result<f64> {
    if *unit == units::EDGE {
        return context.edge_m();
    }
    Ok(unit.size)
}

/// Reads a number in a range, in base units. NaN, for `edge` in a base without a cloth, passes every range.
pub(crate) fn read(expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Result<f64> {
    let value = in_dimension(expr, range.dimension(), context)?;
    in_range(value, expr, range, context)
}

/// Reads a whole number in a range.
pub(crate) fn read_whole(expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Result<f64> {
    let value = in_dimension(expr, range.dimension(), context)?;
    whole(value, expr, range, context)
}

/// Reports a number that is not whole, or not in a range.
pub(super) fn whole(
    value: f64,
    expr: Expr<'_>,
    range: &Range,
    context: &mut Context<'_>,
) -> Result<f64> {
    if value.fract() != 0.0 {
        let message = format!("`{}` is not a whole number", context.written(expr.span()));
        let help = format!("expected {}", range.words());
        return Err(context.refuse(Code::NotWhole, expr.span(), message, help));
    }
    in_range(value, expr, range, context)
}

fn in_range(value: f64, expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Result<f64> {
    if range.contains(value) || value.is_nan() {
        return Ok(value);
    }
    Err(beyond(expr, range, context))
}

/// Reports a number outside of a range.
pub(super) fn beyond(expr: Expr<'_>, range: &Range, context: &mut Context<'_>) -> Reported {
    out_of_range(expr, &format!("expected {}", range.words()), context)
}

/// Reports a number that is too large or too small.
pub(super) fn out_of_range(expr: Expr<'_>, help: &str, context: &mut Context<'_>) -> Reported {
    let written = context.written(expr.span());
    let Ok(Some(stated)) = constant(expr, context) else {
        let message = format!("`{written}` is out of range");
        return context.refuse(Code::OutOfRange, expr.span(), message, help);
    };
    let place = stated.span();
    let message = format!("`{written}` is `{}`, out of range", context.written(place));
    let diagnostic = Diagnostic::new(Code::OutOfRange, expr.span(), message);
    context.error(diagnostic.also(place, "stated here").help(help))
}

fn in_dimension(expr: Expr<'_>, expected: Dimension, context: &mut Context<'_>) -> Result<f64> {
    let (stated, target) = match expr {
        Expr::Converted(converted) => (converted.value(), Some(converted.target())),
        _ => (expr, None),
    };
    let Some(found) = measured(stated, context)? else {
        let diagnostic = context.unexpected(Code::WrongForm, stated, &example(expected));
        return Err(context.error(diagnostic));
    };
    let (value, dimension) = match target {
        Some(target) => converted(&found, target, context)?,
        None => (found.value, found.dimension()),
    };
    if dimension == expected {
        return Ok(value);
    }
    let written = context.written(expr.span());
    let (expected_noun, found_noun) = (expected.noun(), dimension.noun());
    let message = format!("expected {expected_noun}, found {found_noun}");
    let new = |code, message: String| Diagnostic::new(code, expr.span(), message);
    let help = format!("write {}", example(expected));
    Err(context.error(match (expected, dimension) {
        (_, Dimension::Number) => no_unit(expr, expected_noun, context).help(match expr {
            Expr::Name(_) => format!("give the constant a unit: {}", example(expected)),
            _ => format!("write `{written}{}`", usual_unit(expected)),
        }),
        (Dimension::Number, _) => new(
            Code::WrongQuantity,
            format!("expected a number without a unit, found `{written}`"),
        )
        .label(format!("this is {found_noun}")),
        (Dimension::Pixels, Dimension::Length)
            if matches!(context.camera, Ok(Some(_))) && !written.contains(" in ") =>
        {
            let in_px = format!("write `{written} in px` for its length in the picture, or {help}");
            new(Code::MixedFrames, message).help(in_px)
        }
        (Dimension::Length, Dimension::Pixels) | (Dimension::Pixels, Dimension::Length) => {
            new(Code::MixedFrames, message).help(help)
        }
        _ => new(Code::WrongQuantity, message)
            .label(format!("`{written}` is {found_noun}"))
            .help(help),
    }))
}

/// Converts a value, as `VALUE in UNIT` asks; returns it in base units with its dimension.
fn converted(
    found: &Measured,
    target: Name<'_>,
    context: &mut Context<'_>,
) -> Result<(f64, Dimension)> {
    let from = found.dimension();
    match (from, units::find(target.text()).map(|unit| unit.dimension)) {
        (from, Some(to)) if from == to => Ok((found.value, to)),
        (Dimension::Length, Some(to @ Dimension::Pixels)) => {
            Ok((found.value * context.px_per_m()?, to))
        }
        (Dimension::Pixels, Some(to @ Dimension::Length)) => {
            Ok((found.value / context.px_per_m()?, to))
        }
        _ => Err(no_conversion(
            target,
            from.noun(),
            units_of(&[from]),
            context,
        )),
    }
}

/// Makes the diagnostic for a number without a unit. A constant is reported where it is declared, once for all uses.
pub(super) fn no_unit(expr: Expr<'_>, expected: &str, context: &Context<'_>) -> Diagnostic {
    let message = format!("`{}` has no unit", context.written(expr.span()));
    let expected = format!("expected {expected}");
    match constant(expr, context) {
        Ok(Some(number)) => {
            Diagnostic::new(Code::MissingUnit, number.span(), message).also(expr.span(), expected)
        }
        _ => Diagnostic::new(Code::MissingUnit, expr.span(), message).label(expected),
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
/// - `what`: the kind of the value.
/// - `fitting`: the units that would fit.
pub(super) fn no_conversion(
    target: Name<'_>,
    what: &str,
    fitting: Vec<&'static str>,
    context: &mut Context<'_>,
) -> Reported {
    let word = target.text();
    let message = format!("{what} cannot be converted to `{word}`");
    let diagnostic = Diagnostic::new(Code::NoConversion, target.span(), message);
    let meant = spelled(word).map(|unit| unit.name);
    let meant = meant.filter(|name| fitting.contains(name));
    context.error(
        match meant.or_else(|| nearest(word, fitting.iter().copied())) {
            Some(meant) if units::find(word).is_none() => diagnostic.meant(target.span(), meant),
            _ if fitting.is_empty() => diagnostic.help("remove the conversion"),
            _ => diagnostic.help(format!("after `in`, write {}", among(fitting))),
        },
    )
}

/// Returns the unit that has a word as another spelling.
fn spelled(word: &str) -> Option<&'static Unit> {
    UNITS.iter().find(|unit| unit.spellings.contains(&word))
}

/// Returns the unit of a number; reports an unknown one.
pub(super) fn unit(
    quantity: Quantity<'_>,
    name: Name<'_>,
    context: &mut Context<'_>,
) -> Result<&'static Unit> {
    let word = name.text();
    if let Some(unit) = units::find(word) {
        return Ok(unit);
    }
    let message = format!("there is no unit `{word}`");
    let diagnostic = Diagnostic::new(Code::UnknownUnit, name.span(), message);
    if word == "%" {
        let part = written(quantity.value() / 100.0, 6);
        return Err(context.error(diagnostic.help(format!(
            "write `{part}` for a fraction, `{part}edge` for a part of the cloth's longer side"
        ))));
    }
    let names = UNITS.iter().map(|unit| unit.name);
    // `167g` for `167g/m2`
    let is_begun = |name: &&str| name.split_once('/').is_some_and(|(first, _)| first == word);
    let begun = names.clone().find(is_begun);
    Err(context.error(match (spelled(word), begun) {
        (Some(right), _) => diagnostic
            .help(format!("write `{}`", right.name))
            .edit(name.span(), right.name),
        (None, Some(meant)) => diagnostic.meant(name.span(), meant),
        (None, None) => diagnostic.suggest(word, names, ""),
    }))
}

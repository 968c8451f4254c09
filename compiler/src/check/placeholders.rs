//! Turns texts into templates: each `{{ … }}` is looked up, and all other text is literal.
//!
//! In: a text, where it is used, and what is known about the task. Out: a [`Template`] in the portable Jinja subset. A
//! value that is already known is written into the template; one that is known only at run time becomes a variable. A
//! `{` that Jinja would interpret is escaped.

use super::context::Context;
use super::expressions::{AsPercent, FramedLength, Operand, measure, operand, wrong_shape};
use super::missing_action::{needs_action, needs_last};
use super::names::Meaning;
use super::quantity::size;
use crate::diag::{Code, Diagnostic, Reported};
use crate::lang::conditions::UNREACHABLE;
use fab_grammar::Span;
use fab_grammar::ast::{Expr, Name, Path, Piece, Text};
use fab_program::Depends;
use fab_program::measures::{MEASURES, Measure};
use fab_program::render::Jinja;
use fab_program::space::{self, DECIMALS};
use fab_program::units::{self, Dimension, Unit};
use fab_program::{
    Choices, Colour, Condition, Face, KeypointShape, Length, NumberFormat, OVERLAP, Placeholder,
    Point, Template, Variable, exact,
};
use std::collections::BTreeMap;

/// The most bytes of one text.
const MAX_TEXT_BYTES: usize = 16 << 10;

/// The placeholder for the answer's format.
const FORMAT: &str = "actions.format";

/// The placeholder for how a point is written.
const POINTS: &str = "actions.points";

/// The placeholders for the colours of the cloth's faces.
const FACES: [(&str, Face); 2] = [("cloth.upper", Face::Upper), ("cloth.under", Face::Under)];

/// Where a text is used. This decides which names it may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextPlace {
    /// In the stage with this index: keypoints, and texts that earlier stages read.
    Stage(usize),
    /// In the message of a check: the same, and the action's fields.
    Message,
    /// In the message about a step's result: keypoints, and the overlap.
    Result,
    /// Nowhere: a component that no stage says.
    Nowhere,
}

/// Where, and on which condition, a text is used.
#[derive(Clone, Copy)]
pub(crate) struct TextScope<'s> {
    pub place: TextPlace,
    /// Whether the text is used only if there was a previous action.
    pub has_last: bool,
    /// The beginning of the text's declaration, for advice on its condition.
    pub guarded: &'s str,
}

impl TextScope<'_> {
    /// Reports a value that depends on the previous action, unless there always is one.
    fn require_last(self, span: Span, context: &mut Context<'_, '_>) -> Result<(), Reported> {
        if self.has_last || self.place == TextPlace::Nowhere {
            return Ok(());
        }
        Err(needs_last(span, self.guarded, context))
    }
}

/// Builds the template of a text.
pub(crate) fn template<'a>(
    name: &str,
    text: Text<'a>,
    when: Option<Condition>,
    scope: TextScope<'_>,
    context: &mut Context<'a, '_>,
) -> Result<Template, Reported> {
    let n_bytes = text.literal_bytes();
    if text.is_blank() {
        return Err(context.fault(Code::EmptyText, text.span(), "the text is empty"));
    }
    if n_bytes > MAX_TEXT_BYTES {
        let message =
            format!("the text has {n_bytes} bytes, at most {MAX_TEXT_BYTES} are accepted");
        return Err(context.fault(Code::TextTooLong, text.span(), message));
    }
    single_braces(text, context);
    let mut jinja = Jinja::default();
    let mut variables: BTreeMap<String, Placeholder> = BTreeMap::new();
    let mut all = Ok(());
    for piece in text.pieces() {
        let expr = match piece {
            Piece::Literal(literal) => {
                jinja.literal(&literal);
                continue;
            }
            Piece::Value(expr) => expr,
        };
        match resolve(expr, scope, context) {
            Ok(Resolved::Words(words)) => jinja.literal(&words),
            Ok(Resolved::Later(value)) => {
                let written = context.loaded.written(expr.span());
                let name = context.variables.name(&value, written);
                jinja.variable(&name);
                variables.insert(name, *value);
            }
            Err(reported) => all = Err(reported),
        }
    }
    all?;
    let (declared_in, line) = context.loaded.place(text.span().file, text.start());
    let variables = variables
        .into_iter()
        .map(|(name, value)| Variable { name, value })
        .collect();
    Ok(Template {
        name: name.to_owned(),
        when,
        text: jinja.finish(),
        variables,
        declared_in,
        line,
    })
}

/// Warns about `{name}` and `{measure(…)}` if they have a value: the second brace was probably forgotten.
fn single_braces(text: Text<'_>, context: &mut Context<'_, '_>) {
    const LONGEST: usize = 64;
    let span = text.span();
    let source = context.loaded.written(span);
    for (at, _) in source.match_indices('{') {
        let inside = &source[at + 1..];
        // After two braces the quotes are wrong, or one is missing at the end, and that was reported already.
        let (Some(length), false) = (inside.find(['}', '\n']), source[..at].ends_with('{')) else {
            continue;
        };
        let value = inside[..length].trim_matches(' ');
        if !inside[length..].starts_with('}') || length > LONGEST || !is_value(value, context) {
            continue;
        }
        let n_closing = if inside[length..].starts_with("}}") {
            2
        } else {
            1
        };
        let end = at + 1 + length + n_closing;
        let message = format!(
            "`{}` is literal text, not the value `{value}`",
            &source[at..end]
        );
        let span = Span::new(span.file, span.start + at..span.start + end);
        let diagnostic = Diagnostic::new(Code::SingleBraces, span, message);
        context.remark(diagnostic.help(format!("write `{{{{ {value} }}}}` for the value")));
    }
}

/// Returns whether a text is a name that has a value, or a measure.
fn is_value(text: &str, context: &Context<'_, '_>) -> bool {
    let text = text.split_once(" in ").map_or(text, |(value, _)| value);
    if let Some((word, _)) = text.split_once('(') {
        return MEASURES.iter().any(|row| row.signature.name == word);
    }
    let is_field = |name: &str| context.names.get(name) == Some(Meaning::Field);
    context.names.get(text).is_some()
        || context.constants.contains_key(text)
        || context.layers.contains_key(text)
        || [FORMAT, POINTS, UNREACHABLE, "step"].contains(&text)
        || FACES.iter().any(|(face, _)| *face == text)
        || text.strip_prefix("last.").is_some_and(is_field)
        || text.strip_suffix(".choices").is_some_and(is_field)
}

// ---- placeholders --------------------------------------------------------------------------------

/// The content of a placeholder.
enum Resolved {
    /// A text that is known at compile time.
    Words(String),
    /// A value that is known only at run time.
    Later(Box<Placeholder>),
}

fn later(value: Placeholder) -> Resolved {
    Resolved::Later(Box::new(value))
}

/// Finds the value of a placeholder, and reports one that is not known where the text is used.
fn resolve<'a>(
    expr: Expr<'a>,
    scope: TextScope<'_>,
    context: &mut Context<'a, '_>,
) -> Result<Resolved, Reported> {
    let resolved = match expr {
        Expr::Name(name) if !context.constants.contains_key(name.text()) => {
            named(name, scope, context)?
        }
        Expr::Path(path) => dotted(path, context)?,
        Expr::Call(call) => match measure(call, context)? {
            Measure::Nearest { field, to } => later(Placeholder::Nearest { field, to }),
            _ => written(expr, context)?,
        },
        _ => written(expr, context)?,
    };
    if let Resolved::Later(value) = &resolved {
        let uses = value.uses();
        if uses.action && matches!(scope.place, TextPlace::Stage(_) | TextPlace::Result) {
            return Err(needs_action(expr.span(), context));
        }
        if uses.last {
            scope.require_last(expr.span(), context)?;
        }
    }
    Ok(resolved)
}

fn named<'a>(
    name: Name<'a>,
    scope: TextScope<'_>,
    context: &mut Context<'a, '_>,
) -> Result<Resolved, Reported> {
    let text = name.text().to_owned();
    if let Some(layer) = context.layers.get(name.text()) {
        let layer = layer.as_ref().map_err(|reported| *reported)?;
        let (words, uses_last) = (layer.words.clone(), layer.uses_last());
        if uses_last {
            scope.require_last(name.span(), context)?;
        }
        context.named_layers.push((text, name.span()));
        return Ok(Resolved::Words(words));
    }
    Ok(later(match context.names.get(name.text()) {
        Some(Meaning::Keypoint(Some(KeypointShape::Points))) => {
            Placeholder::Points { keypoint: text }
        }
        Some(Meaning::Keypoint(Some(KeypointShape::Point))) => Placeholder::Point {
            point: Point::Keypoint { name: text },
        },
        Some(Meaning::Keypoint(shape)) => {
            let expected = "something that can be written as text";
            return Err(wrong_shape(name, shape, expected, context));
        }
        Some(Meaning::Text { stage }) => {
            let is_read = match scope.place {
                TextPlace::Stage(here) => stage < here,
                TextPlace::Message | TextPlace::Nowhere => true,
                TextPlace::Result => false,
            };
            if !is_read {
                let message = format!("`{text}` is not read before this stage");
                let diagnostic = Diagnostic::new(Code::NotYetKnown, name.span(), message);
                return Err(context.error(diagnostic.help(
                    "stages run in order; a text is known to the stages after the one that reads it",
                )));
            }
            Placeholder::Text { name: text }
        }
        Some(Meaning::DuplicateNames(reported)) => return Err(reported),
        Some(Meaning::Field) => match context.actions.get(name.text())? {
            Some(_) => Placeholder::Field { field: text },
            // The place that results from a direction and a distance.
            None => return written(Expr::Name(name), context),
        },
        None if text == OVERLAP && scope.place == TextPlace::Result => {
            Placeholder::Text { name: text }
        }
        None if text == UNREACHABLE => Placeholder::Unreachable,
        None if text == "step" => return written(Expr::Name(name), context),
        None => {
            let candidates = candidates(scope.place, context);
            return Err(context.unknown("value", name, candidates));
        }
    }))
}

/// Returns the names that can be used in a text at this place.
fn candidates<'a>(place: TextPlace, context: &Context<'a, '_>) -> Vec<&'a str> {
    let mut names = context.names.that(|meaning| match (meaning, place) {
        (Meaning::Keypoint(shape), _) => {
            matches!(shape, Some(KeypointShape::Points | KeypointShape::Point))
        }
        (Meaning::Text { stage }, TextPlace::Stage(here)) => stage < here,
        (Meaning::Field, TextPlace::Stage(_)) | (_, TextPlace::Result) => false,
        (Meaning::DuplicateNames(_), _) => false,
        (_, TextPlace::Message | TextPlace::Nowhere) => true,
    });
    names.extend(context.constants.keys());
    names.extend(context.layers.keys());
    names.extend([FORMAT, POINTS, "step"]);
    names.extend((place == TextPlace::Result).then_some(OVERLAP));
    names
}

/// Finds the value of `actions.format`, `FIELD.choices`, `last.pick` and other names with dots.
fn dotted<'a>(path: Path<'a>, context: &mut Context<'a, '_>) -> Result<Resolved, Reported> {
    let text = path.text();
    match text {
        FORMAT => return Ok(later(Placeholder::Format)),
        POINTS => return Ok(later(Placeholder::PointForm)),
        "last.pick" | "last.place" => return written(Expr::Path(path), context),
        _ => {}
    }
    if let Some((_, face)) = FACES.iter().find(|(name, _)| *name == text) {
        let cloth = context.cloth.as_ref().map_err(|reported| *reported)?;
        // A base without a cloth never becomes a program.
        let colour = cloth
            .as_ref()
            .map_or_else(|| Colour::recorded(*face), |it| it.colour(*face));
        return Ok(Resolved::Words(colour.name));
    }
    let of_choices = text.strip_suffix(".choices");
    if let Some(name) = of_choices
        && let Some(field) = context.actions.get(name)?
    {
        return Ok(match &field.choices {
            Choices::Points { .. } => later(Placeholder::Choices {
                field: name.to_owned(),
            }),
            Choices::Region { mask } => Resolved::Words(space::any_of(mask)),
            _ => Resolved::Words(space::listed(field, &space::declared(field))),
        });
    }
    let of_last = text.strip_prefix("last.");
    if let Some(name) = of_last
        && context.actions.get(name)?.is_some()
    {
        return Ok(later(Placeholder::LastField {
            field: name.to_owned(),
        }));
    }
    // A field that the action lacks is reported at the action's declaration.
    if of_choices
        .or(of_last)
        .and_then(|name| context.names.get(name))
        == Some(Meaning::Field)
    {
        context.actions.complete?;
    }
    let choices = context
        .actions
        .right()
        .map(|field| format!("{}.choices", field.name));
    let choices: Vec<String> = choices.collect();
    let candidates = [FORMAT, POINTS, "last.pick", "last.place"].into_iter();
    let candidates = candidates.chain(FACES.map(|(name, _)| name));
    let candidates = candidates.chain(choices.iter().map(String::as_str));
    Err(context.unknown_at("value", text, path.span(), candidates))
}

// ---- how values are written ----------------------------------------------------------------------

/// Resolves a placeholder with any value.
fn written<'a>(expr: Expr<'a>, context: &mut Context<'a, '_>) -> Result<Resolved, Reported> {
    let plain = |factor, decimals, unit: &str| NumberFormat {
        factor,
        decimals,
        unit: unit.to_owned(),
    };
    Ok(match operand(expr, context)? {
        Operand::Length(length) => self::length(&length, context)?,
        Operand::Angle { deg, unit } => Resolved::Words(number(deg, &of_degrees(unit))),
        Operand::Between { a, b, unit } => later(Placeholder::Angle {
            a,
            b,
            written: of_degrees(unit),
        }),
        Operand::Number(value) => Resolved::Words(exact::written(value, DECIMALS)),
        Operand::Counted { number, as_percent } => {
            let written = match as_percent {
                AsPercent::Yes => plain(100.0, 0, "%"),
                AsPercent::No => plain(1.0, 3, ""),
            };
            later(Placeholder::Number { number, written })
        }
        Operand::Point(point) => later(Placeholder::Point { point }),
        Operand::WordField(field) => later(Placeholder::Field { field }),
        Operand::Quadrant { point, about } => later(Placeholder::Quadrant { point, about }),
        Operand::Word(word) => Resolved::Words(word),
        Operand::Heading => {
            let message = format!(
                "the direction `{}` cannot be written as text",
                context.written(expr.span())
            );
            let diagnostic = Diagnostic::new(Code::WrongExpression, expr.span(), message);
            return Err(context.error(
                diagnostic
                    .help("write `nearest(direction, …)` for the choice that is nearest to it"),
            ));
        }
    })
}

/// Returns the format of a number in a unit.
///
/// - `factor`: converts the number to the unit.
fn in_unit(unit: &Unit, factor: f64) -> NumberFormat {
    NumberFormat {
        factor,
        decimals: unit.decimals,
        unit: format!(" {}", unit.name),
    }
}

/// Returns the format of degrees in a unit of angles.
fn of_degrees(unit: &Unit) -> NumberFormat {
    in_unit(unit, units::DEG.size / unit.size)
}

fn length(length: &FramedLength, context: &Context<'_, '_>) -> Result<Resolved, Reported> {
    let frame = length.unit.dimension;
    // A measure of the picture stays in pixels, even if it is written as a length on the table.
    let base = match &length.length {
        Length::OfPoints(_) if frame == Dimension::Length => context.px_per_m()?,
        _ => 1.0,
    };
    let written = in_unit(length.unit, 1.0 / size(length.unit, context)? / base);
    Ok(match length.in_frame(frame, context)? {
        // A pixel's size depends on the picture that is sent to the model, which is not known yet.
        Length::Constant { value } if frame != Dimension::Pixels => {
            Resolved::Words(number(value, &written))
        }
        length => later(Placeholder::Length { length, written }),
    })
}

fn number(value: f64, written: &NumberFormat) -> String {
    let digits = exact::written(value * written.factor, usize::from(written.decimals));
    format!("{digits}{}", written.unit)
}

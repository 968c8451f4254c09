//! Turns texts into templates: each `{{ … }}` is looked up, and all other text is literal.
//!
//! In: a text, where it is used, and what is known about the task. Out: a [`Template`] in the portable Jinja subset. A
//! value that is already known is written into the template; one that is known only at run time becomes a variable. A
//! `{` that Jinja would interpret is escaped.

use super::context::{Context, Result};
use super::expressions::{FramedLength, Operand, operand, wrong_kind};
use super::names::Meaning;
use super::quantity::size;
use crate::diag::Code;
use crate::lang::conditions::UNREACHABLE;
use fab_grammar::Span;
use fab_grammar::ast::{Expr, Name, Path, Piece, Text};
use fab_program::Depends;
use fab_program::measures::MEASURES;
use fab_program::render::Jinja;
use fab_program::space::{self, DECIMALS};
use fab_program::units::{self, Dimension, Unit};
use fab_program::{
    Choices, Condition, Face, KeypointShape, Length, NumberFormat, OVERLAP, Placeholder, Template,
    Variable, exact,
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

impl<'s> TextScope<'s> {
    pub fn new(place: TextPlace, has_last: bool, guarded: &'s str) -> TextScope<'s> {
        TextScope {
            place,
            has_last,
            guarded,
        }
    }

    /// Reports a value that depends on the previous action, unless there always is one.
    fn require_last(self, span: Span, context: &mut Context<'_>) -> Result<()> {
        if self.has_last || self.place == TextPlace::Nowhere {
            return Ok(());
        }
        Err(context.needs_last(span, self.guarded))
    }
}

/// Builds the template of a text.
pub(crate) fn template(
    name: &str,
    text: Text<'_>,
    when: Option<Condition>,
    scope: TextScope<'_>,
    context: &mut Context<'_>,
) -> Result<Template> {
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
            // It was reported, so no program has this text.
            Err(_) => {}
        }
    }
    let (declared_in, line) = context.loaded.place(text.span().file, text.start());
    let variables = variables.into_iter();
    let variables = variables.map(|(name, value)| Variable { name, value });
    Ok(Template {
        name: name.to_owned(),
        when,
        text: jinja.finish(),
        variables: variables.collect(),
        declared_in,
        line,
    })
}

/// Warns about `{name}` and `{measure(…)}` if they have a value: the second brace was probably forgotten.
fn single_braces(text: Text<'_>, context: &mut Context<'_>) {
    const LONGEST: usize = 64;
    let span = text.span();
    let source = context.loaded.written(span);
    for (at, _) in source.match_indices('{') {
        let inside = &source[at + 1..];
        // After two braces the quotes are wrong, or one is missing at the end, and that was reported already.
        let Some(length) = inside.find(['}', '\n']).filter(|it| *it <= LONGEST) else {
            continue;
        };
        let (value, rest) = (inside[..length].trim_matches(' '), &inside[length..]);
        if source[..at].ends_with('{') || !rest.starts_with('}') || !is_value(value, context) {
            continue;
        }
        let n_closing = if rest.starts_with("}}") { 2 } else { 1 };
        let end = at + 1 + length + n_closing;
        let written = &source[at..end];
        let message = format!("`{written}` is literal text, not the value `{value}`");
        let help = format!("write `{{{{ {value} }}}}` for the value");
        let span = Span::new(span.file, span.start + at..span.start + end);
        context.warn(Code::SingleBraces, span, message, help);
    }
}

/// Returns whether a text is a name that has a value, or a measure.
fn is_value(text: &str, context: &Context<'_>) -> bool {
    let text = text.split_once(" in ").map_or(text, |(value, _)| value);
    if let Some((word, _)) = text.split_once('(') {
        return MEASURES.iter().any(|row| row.signature.name == word);
    }
    let is_name = |name: &str| !matches!(context.names.get(name), Ok(None));
    let is_field = |name: &str| matches!(context.names.get(name), Ok(Some(Meaning::Field)));
    is_name(text)
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
fn resolve(expr: Expr<'_>, scope: TextScope<'_>, context: &mut Context<'_>) -> Result<Resolved> {
    let resolved = match expr {
        Expr::Name(name) => named(name, scope, context)?,
        Expr::Path(path) => dotted(path, scope, context)?,
        _ => written(expr, scope, context)?,
    };
    if let Resolved::Later(value) = &resolved {
        let uses = value.uses();
        if uses.action && matches!(scope.place, TextPlace::Stage(_) | TextPlace::Result) {
            return Err(context.needs_action(expr.span()));
        }
        if uses.last {
            scope.require_last(expr.span(), context)?;
        }
    }
    Ok(resolved)
}

fn named(name: Name<'_>, scope: TextScope<'_>, context: &mut Context<'_>) -> Result<Resolved> {
    let text = name.text().to_owned();
    match context.names.get(name.text())? {
        Some(Meaning::Field) if context.actions.get(name.text())?.is_some() => {
            Ok(later(Placeholder::Field { field: text }))
        }
        None if text == OVERLAP && scope.place == TextPlace::Result => {
            Ok(later(Placeholder::Text { name: text }))
        }
        None if text == UNREACHABLE => Ok(later(Placeholder::Unreachable)),
        None if text != "step" => {
            let candidates = candidates(scope.place, context);
            Err(context.unknown("value", name, candidates))
        }
        _ => written(Expr::Name(name), scope, context),
    }
}

/// Returns the names that can be used in a text at this place.
fn candidates<'a>(place: TextPlace, context: &Context<'a>) -> Vec<&'a str> {
    let mut names = context.names.that(|meaning| match (meaning, place) {
        (Meaning::Keypoint(shape, _), _) => {
            matches!(shape, Some(KeypointShape::Points | KeypointShape::Point))
        }
        (Meaning::Constant(_) | Meaning::Layer, _) => true,
        (Meaning::Text(stage), TextPlace::Stage(here)) => stage < here,
        (Meaning::Field, TextPlace::Stage(_)) | (_, TextPlace::Result) => false,
        (_, TextPlace::Message | TextPlace::Nowhere) => true,
    });
    names.extend([FORMAT, POINTS, "step"]);
    names.extend((place == TextPlace::Result).then_some(OVERLAP));
    names
}

/// Finds the value of `actions.format`, `FIELD.choices`, `last.pick` and other names with dots.
fn dotted(path: Path<'_>, scope: TextScope<'_>, context: &mut Context<'_>) -> Result<Resolved> {
    let text = path.text();
    match text {
        FORMAT => return Ok(later(Placeholder::Format)),
        POINTS => return Ok(later(Placeholder::PointForm)),
        "last.pick" | "last.place" => return written(Expr::Path(path), scope, context),
        _ => {}
    }
    if let Some((_, face)) = FACES.iter().find(|(name, _)| *name == text) {
        return Ok(Resolved::Words(context.colour(*face)?.name));
    }
    let of_choices = text.strip_suffix(".choices");
    let of_last = text.strip_prefix("last.");
    if let Some(name) = of_choices.or(of_last)
        && let Some(Meaning::Field) = context.names.get(name)?
    {
        match (context.actions.get(name)?, of_choices) {
            (Some(field), Some(_)) => {
                return Ok(Resolved::Words(match &field.choices {
                    Choices::Points { keypoints } => points_in_words(keypoints, context),
                    Choices::Region { mask } => space::any_of(mask),
                    _ => space::listed(field, &space::declared(field)),
                }));
            }
            (Some(_), None) => {
                return Ok(later(Placeholder::LastField {
                    field: name.to_owned(),
                }));
            }
            // A field that the action lacks is reported at the action's declaration.
            (None, _) => context.complete?,
        }
    }
    let fields = context.actions.right();
    let choices = fields.map(|field| format!("{}.choices", field.name));
    let choices: Vec<String> = choices.collect();
    let candidates = [FORMAT, POINTS, "last.pick", "last.place"].into_iter();
    let candidates = candidates.chain(FACES.map(|(name, _)| name));
    let candidates = candidates.chain(choices.iter().map(String::as_str));
    Err(context.unknown_at("value", text, path.span(), candidates))
}

/// Names the keypoints that a field offers, such as `the listed corners, the listed side points or the center`.
fn points_in_words(keypoints: &[String], context: &Context<'_>) -> String {
    let words = keypoints.iter().map(|name| {
        let is_one = matches!(
            context.names.get(name),
            Ok(Some(Meaning::Keypoint(Some(KeypointShape::Point), _)))
        );
        let listed = if is_one { "" } else { "listed " };
        format!("the {listed}{}", name.replace('_', " "))
    });
    let words: Vec<String> = words.collect();
    match words.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => words.concat(),
    }
}

// ---- how values are written ----------------------------------------------------------------------

/// Resolves a placeholder with any value.
fn written(expr: Expr<'_>, scope: TextScope<'_>, context: &mut Context<'_>) -> Result<Resolved> {
    let unwritable = "something that can be written as text";
    Ok(match operand(expr, context)? {
        Operand::Length(length) => self::length(&length, context)?,
        Operand::Angle(deg, unit) => Resolved::Words(number(deg, &of_degrees(unit))),
        Operand::Between([a, b], unit) => later(Placeholder::Angle {
            a,
            b,
            written: of_degrees(unit),
        }),
        Operand::Number(value) => Resolved::Words(exact::written(value, DECIMALS)),
        Operand::Counted(number, written) => later(Placeholder::Number { number, written }),
        Operand::Point(point) => later(Placeholder::Point { point }),
        Operand::WordField(field) => later(Placeholder::Field { field }),
        Operand::Quadrant([point, about]) => later(Placeholder::Quadrant { point, about }),
        Operand::Word(word) => Resolved::Words(word),
        Operand::Nearest(field, to) => later(Placeholder::Nearest { field, to }),
        Operand::Keypoint(name, KeypointShape::Points) => {
            later(Placeholder::Points { keypoint: name })
        }
        Operand::Keypoint(_, shape) => match expr {
            Expr::Name(name) => return Err(wrong_kind(name, unwritable, shape.words(), context)),
            _ => return Err(context.wrong(Code::WrongExpression, expr, unwritable, None)),
        },
        Operand::Text(name, stage) => {
            let is_read = match scope.place {
                TextPlace::Stage(here) => stage < here,
                TextPlace::Message | TextPlace::Nowhere => true,
                TextPlace::Result => false,
            };
            if !is_read {
                let message = format!("`{name}` is not read before this stage");
                let help = "stages run in order; a text is known to the stages after the one that reads it";
                return Err(context.refuse(Code::NotYetKnown, expr.span(), message, help));
            }
            later(Placeholder::Text { name })
        }
        Operand::Layer(name) => {
            let layer = context
                .layers
                .get(&name)?
                .expect("every layer has been read");
            let (words, uses_last) = (layer.words.clone(), layer.uses_last());
            if uses_last {
                scope.require_last(expr.span(), context)?;
            }
            context.named_layers.push((name, expr.span()));
            Resolved::Words(words)
        }
        Operand::Heading(_) => {
            let written = context.written(expr.span());
            let message = format!("the direction `{written}` cannot be written as text");
            let help = "write `nearest(direction, …)` for the choice that is nearest to it";
            return Err(context.refuse(Code::WrongExpression, expr.span(), message, help));
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

fn length(length: &FramedLength, context: &Context<'_>) -> Result<Resolved> {
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

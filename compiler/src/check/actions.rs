//! `actions { pick: one of corners … }`.

use super::Context;
use super::constants::{is_broken, resolved};
use super::keypoints::wrong_kind;
use super::names::Meaning;
use super::quantity::{Measure, Quantity, quantity};
use super::values::{fixed_deg, length_unit};
use crate::ast::{self, Expr, ExprKind, Field, Ident};
use crate::diag::{Code, Diagnostic, nearest};
use crate::merge::unique;
use fab_program::exact::vector_of;
use fab_program::{ActionField, Choices, Direction, KeypointShape, LengthChoice};
use std::collections::BTreeMap;

/// The fields that move the cloth.
pub(super) const FIELDS: [&str; 4] = ["pick", "place", "direction", "distance"];

/// The most fields of an action, and choices of a field.
const MAX_FIELDS: usize = 16;
const MAX_CHOICES: usize = 256;

/// Builds the action space.
pub(crate) fn check(part: &ast::Actions, context: &mut Context<'_>) -> Vec<ActionField> {
    unique(
        part.fields.iter().map(|field| &field.name),
        "field",
        context.report,
    );
    if let Some(beyond) = part.fields.get(MAX_FIELDS) {
        let message = format!("an action has at most {MAX_FIELDS} fields");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.name.span, message));
        return Vec::new();
    }
    let fields: Vec<ActionField> = part
        .fields
        .iter()
        .filter_map(|field| self::field(field, context))
        .collect();
    if !part.has_faults && fields.len() == part.fields.len() {
        completeness(part, &fields, context);
    }
    fields
}

/// Reports an action that moves nothing, or moves it in two ways.
fn completeness(part: &ast::Actions, fields: &[ActionField], context: &mut Context<'_>) {
    let has = |name: &str| fields.iter().any(|field| field.name == name);
    // A field that moves nothing may be one that does, misspelt.
    for field in &part.fields {
        let name = field.name.text.as_str();
        let meant = nearest(name, FIELDS).filter(|meant| !has(meant));
        if let Some(meant) = meant
            && !FIELDS.contains(&name)
        {
            context.push(
                Diagnostic::new(
                    Code::UnknownField,
                    field.name.span,
                    format!("the field `{name}` moves nothing"),
                )
                .meant(field.name.span, meant),
            );
            return;
        }
    }
    let missing = |message: String, help: &str| {
        Diagnostic::new(Code::MissingField, part.span, message).help(help)
    };
    if !has("pick") {
        let help = "write `pick: one of …`";
        context.push(missing("the action has no `pick`".to_owned(), help));
    }
    let others = [has("direction"), has("distance")];
    match (has("place"), others) {
        (true, [false, false]) | (false, [true, true]) => {}
        (false, [false, false]) => context.push(missing(
            "the action has no `place`".to_owned(),
            "write `place: one of …`, or a `direction` and a `distance`",
        )),
        (false, [direction, _]) => {
            let (there, lacking) = if direction {
                ("direction", "distance")
            } else {
                ("distance", "direction")
            };
            context.push(missing(
                format!("the action has a `{there}` and no `{lacking}`"),
                "the place follows from the pick, a direction and a distance",
            ));
        }
        (true, _) => context.push(missing(
            "the action has a `place` beside a direction or a distance".to_owned(),
            "the place is either chosen, or follows from a direction and a distance",
        )),
    }
}

fn field(part: &Field, context: &mut Context<'_>) -> Option<ActionField> {
    let name = part.name.text.clone();
    if let Some(mask) = &part.any_of {
        return region(&name, mask, context);
    }
    if let Some(beyond) = part.one_of.get(MAX_CHOICES) {
        let message = format!("a field has at most {MAX_CHOICES} choices");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return None;
    }
    if part.one_of.iter().any(|choice| is_broken(choice, context)) {
        return None;
    }
    if let Some(bare) = part.one_of.iter().find(|choice| is_bare(choice, context)) {
        let written = context.written(bare.span);
        let unit = if name == "direction" { "deg" } else { "mm" };
        let message = format!("`{written}` has no unit");
        context.push(
            Diagnostic::new(Code::MissingUnit, bare.span, message)
                .help(format!("write `{written}{unit}`, or words in quotes")),
        );
        return None;
    }
    let kinds: Vec<Kind> = part
        .one_of
        .iter()
        .map(|choice| Kind::of(choice, context))
        .collect();
    let first = *kinds.first()?;
    if let Some(other) = kinds.iter().position(|kind| *kind != first) {
        let message = format!(
            "`{name}` offers {} and {}",
            first.words(),
            kinds[other].words()
        );
        context.push(
            Diagnostic::new(Code::MixedChoices, part.one_of[other].span, message).also(
                part.one_of[0].span,
                format!("this is one of {}", first.words()),
            ),
        );
        return None;
    }
    if let Some(wanted) = Kind::wanted(&name).filter(|wanted| *wanted != first) {
        let message = format!("`{name}` offers {}, not {}", wanted.words(), first.words());
        context.push(
            Diagnostic::new(Code::MixedChoices, part.one_of[0].span, message)
                .help(wanted.example()),
        );
        return None;
    }
    let choices = match first {
        Kind::Points => points(part, context),
        Kind::Directions => directions(part, context),
        Kind::Lengths => lengths(part, context),
        Kind::Words => words(part, context),
    }?;
    Some(ActionField { name, choices })
}

/// Returns whether a choice is a number without a unit.
fn is_bare(choice: &Expr, context: &Context<'_>) -> bool {
    matches!(
        resolved(choice, context).kind,
        ExprKind::Quantity { unit: None, .. }
    )
}

/// What a field offers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Points,
    Directions,
    Lengths,
    Words,
}

impl Kind {
    fn of(choice: &Expr, context: &Context<'_>) -> Kind {
        match &resolved(choice, context).kind {
            ExprKind::Quantity {
                unit: Some(unit), ..
            } if matches!(
                unit.text.as_str(),
                "deg" | "rad" | "°" | "degree" | "degrees"
            ) =>
            {
                Kind::Directions
            }
            ExprKind::Quantity { .. } => Kind::Lengths,
            ExprKind::Text(_) => Kind::Words,
            _ => Kind::Points,
        }
    }

    /// Returns what a field of that name must offer.
    fn wanted(name: &str) -> Option<Kind> {
        match name {
            "pick" | "place" => Some(Kind::Points),
            "direction" => Some(Kind::Directions),
            "distance" => Some(Kind::Lengths),
            _ => None,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Kind::Points => "points",
            Kind::Directions => "directions",
            Kind::Lengths => "lengths",
            Kind::Words => "words",
        }
    }

    fn example(self) -> &'static str {
        match self {
            Kind::Points => "write the names of keypoints, such as `one of corners, center`",
            Kind::Directions => "write angles, such as `one of 0deg, 90deg, 180deg, 270deg`",
            Kind::Lengths => "write lengths on the table, such as `one of 0.25edge, 0.5edge`",
            Kind::Words => "write words in quotes, such as `one of \"soft\", \"firm\"`",
        }
    }
}

/// Builds a field that may be any pixel of a mask.
fn region(name: &str, mask: &Ident, context: &mut Context<'_>) -> Option<ActionField> {
    if let Some(wanted) = Kind::wanted(name).filter(|wanted| *wanted != Kind::Points) {
        let message = format!("`{name}` offers {}, not points", wanted.words());
        context
            .push(Diagnostic::new(Code::MixedChoices, mask.span, message).help(wanted.example()));
        return None;
    }
    match context.names.get(&mask.text) {
        Some(Meaning::Keypoint(None | Some(KeypointShape::Mask))) => {}
        Some(Meaning::Keypoint(Some(shape))) => {
            context.push(wrong_kind(mask, shape, "a mask"));
            return None;
        }
        _ => {
            let is_mask = |meaning| matches!(meaning, Meaning::Keypoint(Some(KeypointShape::Mask)));
            context.unknown("mask", mask, context.names.that(is_mask));
            return None;
        }
    }
    Some(ActionField {
        name: name.to_owned(),
        choices: Choices::Region {
            mask: mask.text.clone(),
        },
    })
}

fn points(part: &Field, context: &mut Context<'_>) -> Option<Choices> {
    let names: Vec<Ident> = part
        .one_of
        .iter()
        .map(|choice| Ident {
            text: context.loaded.sources.text(choice.span).to_owned(),
            span: choice.span,
        })
        .collect();
    unique(names.iter(), "choice", context.report);
    let offered = names
        .iter()
        .filter(|choice| is_offered(choice, context))
        .map(|choice| choice.text.clone());
    Some(Choices::Points {
        keypoints: offered.collect(),
    })
}

/// Returns whether a choice names points; reports it where not.
fn is_offered(choice: &Ident, context: &mut Context<'_>) -> bool {
    let are_points = |shape| matches!(shape, KeypointShape::Points | KeypointShape::Point);
    match context.names.get(&choice.text) {
        Some(Meaning::Keypoint(Some(shape))) if !are_points(shape) => {
            context.push(wrong_kind(choice, shape, "points to choose from"));
            false
        }
        Some(Meaning::Keypoint(_)) => true,
        _ => {
            let has_points = |meaning| matches!(meaning, Meaning::Keypoint(shape) if shape.is_none_or(are_points));
            context.unknown("keypoint", choice, context.names.that(has_points));
            false
        }
    }
}

fn directions(part: &Field, context: &mut Context<'_>) -> Option<Choices> {
    let mut choices = Vec::with_capacity(part.one_of.len());
    let mut seen = BTreeMap::new();
    for choice in &part.one_of {
        let deg = fixed_deg(choice, context)?;
        if let Some(first) = seen.insert(deg.to_bits(), choice.span) {
            twice(choice, first, context);
        }
        choices.push(Direction {
            deg,
            vector: vector_of(deg),
        });
    }
    Some(Choices::Directions { choices })
}

fn lengths(part: &Field, context: &mut Context<'_>) -> Option<Choices> {
    let mut choices = Vec::with_capacity(part.one_of.len());
    let mut first_unit: Option<String> = None;
    let mut seen = BTreeMap::new();
    for choice in &part.one_of {
        let Quantity {
            value,
            measure,
            number,
            unit,
        } = quantity(choice, context)?;
        if measure != Measure::Length {
            let written = context.written(choice.span);
            let message = format!("expected a length on the table, found `{written}`");
            let code = if measure == Measure::Number {
                Code::MissingUnit
            } else {
                Code::MixedFrames
            };
            context.push(
                Diagnostic::new(code, choice.span, message)
                    .label(format!("this is {}", measure.noun()))
                    .help("the arm moves over the table: write such as `0.25edge` or `50mm`"),
            );
            return None;
        }
        if number <= 0.0 {
            let written = context.written(choice.span);
            let message = format!("`{written}` is out of range");
            context.push(
                Diagnostic::new(Code::OutOfRange, choice.span, message)
                    .help("accepted are lengths above zero"),
            );
            return None;
        }
        if let Some(first) = &first_unit
            && *first != unit
        {
            let message = format!(
                "`{}` offers lengths in `{first}` and in `{unit}`",
                part.name.text
            );
            context.push(
                Diagnostic::new(Code::MixedChoices, choice.span, message)
                    .help("write all of them in one unit, which prompts and answers use"),
            );
            return None;
        }
        first_unit = Some(unit);
        if let Some(first) = seen.insert(number.to_bits(), choice.span) {
            twice(choice, first, context);
        }
        // Without a cloth the task is no program, and `edge` has no size.
        choices.push(LengthChoice {
            value: number,
            m: value,
        });
    }
    Some(Choices::Lengths {
        unit: length_unit(&first_unit?)?,
        choices,
    })
}

fn words(part: &Field, context: &mut Context<'_>) -> Option<Choices> {
    let mut choices: Vec<String> = Vec::with_capacity(part.one_of.len());
    let mut seen = BTreeMap::new();
    for choice in &part.one_of {
        let ExprKind::Text(text) = &choice.kind else {
            return None;
        };
        let word = text.plain().filter(|word| !word.trim().is_empty());
        let Some(word) = word else {
            let message = "a choice is a word without `{{ … }}`";
            context.push(Diagnostic::new(Code::EmptyText, choice.span, message));
            return None;
        };
        if let Some(first) = seen.insert(word.to_lowercase(), choice.span) {
            twice(choice, first, context);
        }
        choices.push(word);
    }
    Some(Choices::Words { choices })
}

fn twice(choice: &Expr, first: crate::source::Span, context: &mut Context<'_>) {
    let written = context.written(choice.span);
    let message = format!("the choice `{written}` is offered twice");
    context.push(
        Diagnostic::new(Code::DuplicateName, choice.span, message)
            .also(first, "offered here first"),
    );
}

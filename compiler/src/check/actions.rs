//! `actions { pick: one of corners … }`: the fields of an answer, and the choices of each.

use super::context::{Context, Named, Result};
use super::expressions::{fixed_deg, keypoint, wrong_kind};
use super::names::Meaning;
use super::quantity::{measured, no_unit, quantity_of, read, unit as unit_of, usual_unit};
use crate::diag::{Code, Diagnostic, Reported, every, nearest};
use crate::lang::actions::{ChoiceKind, FIELDS, FieldRow, field as moving_field};
use fab_grammar::Span;
use fab_grammar::ast::{Actions, Expr, Field, Name};
use fab_program::exact::vector_of;
use fab_program::units::Dimension;
use fab_program::vocabulary::Range;
use fab_program::{ActionField, Choices, Direction, KeypointShape, LengthChoice, LengthUnit};
use std::collections::BTreeMap;

/// The most fields of an action.
const MAX_FIELDS: usize = 16;

/// The most choices that a field lists; one keypoint among them may be many points.
const MAX_CHOICES: usize = 256;

/// Builds the action space.
pub(crate) fn check<'a>(part: Actions<'a>, context: &mut Context<'a>) {
    let places = part.fields().map(|field| field.name().span());
    let within = context.at_most(MAX_FIELDS, places, "an action", "fields");
    let fields = part.fields().map(|field| {
        let name = field.name().text();
        let field = within.and_then(|()| self::field(field, context));
        (name, field)
    });
    let list: Vec<(&str, Result<ActionField>)> = fields.collect();
    let right = |(_, field): &(_, Result<ActionField>)| field.as_ref().map(drop).map_err(|it| *it);
    let mut complete = list.iter().try_for_each(right);
    // A field with an error may be the missing one.
    if complete.is_ok() {
        for fault in incomplete(part) {
            complete = Err(context.error(fault));
        }
    }
    (context.actions, context.complete) = (Named(list), complete);
}

/// Reports fields that do not make a complete action: one is missing, or two contradict each other.
fn incomplete(part: Actions<'_>) -> Vec<Diagnostic> {
    let has = |name: &str| part.fields().any(|field| field.name().text() == name);
    for name in part.fields().map(|field| field.name()) {
        let expected = FIELDS.iter().filter(|row| row.is_expected);
        let lacking = expected.map(|row| row.name).filter(|name| !has(name));
        if moving_field(name.text()).is_none()
            && let Some(meant) = nearest(name.text(), lacking)
        {
            let message = format!("the field `{}` moves nothing", name.text());
            let diagnostic = Diagnostic::new(Code::UnknownField, name.span(), message);
            return vec![diagnostic.meant(name.span(), meant)];
        }
    }
    let computed = "the place is computed from the pick, a `direction` and a `distance`";
    let place = match ["place", "direction", "distance"].map(has) {
        [true, false, false] | [false, true, true] => None,
        [false, false, false] => Some((
            "the action has no `place`",
            "write `place: one of …`, or a `direction` and a `distance`",
        )),
        [false, true, false] => Some(("the action has a `direction` but no `distance`", computed)),
        [false, false, true] => Some(("the action has a `distance` but no `direction`", computed)),
        [true, ..] => Some((
            "the action has a `place` as well as a `direction` or a `distance`",
            "use either a `place`, or a `direction` and a `distance`",
        )),
    };
    let pick = (!has("pick")).then_some(("the action has no `pick`", "write `pick: one of …`"));
    let fault =
        |(message, help)| Diagnostic::new(Code::MissingField, part.head_span(), message).help(help);
    [pick, place].into_iter().flatten().map(fault).collect()
}

fn field(part: Field<'_>, context: &mut Context<'_>) -> Result<ActionField> {
    let row = moving_field(part.name().text());
    let choices = match part.any_of() {
        Some(mask) => region(mask, row, context),
        None => listed(part, row, context),
    };
    Ok(ActionField {
        name: part.name().text().to_owned(),
        choices: choices?,
    })
}

/// Builds a field that may be any pixel of a mask.
fn region(mask: Name<'_>, row: Option<&FieldRow>, context: &mut Context<'_>) -> Result<Choices> {
    offers(row, ChoiceKind::Points, mask.span(), context)?;
    let shapes = [KeypointShape::Mask];
    let mask = keypoint(Expr::Name(mask), &shapes, context)?;
    Ok(Choices::Region { mask })
}

/// Builds a field from a list of choices, all of one kind.
fn listed(part: Field<'_>, row: Option<&FieldRow>, context: &mut Context<'_>) -> Result<Choices> {
    let (name, list) = (part.name(), part.one_of().collect::<Vec<Expr<'_>>>());
    let places = list.iter().map(|choice| choice.span());
    context.at_most(MAX_CHOICES, places, "a field", "choices")?;
    let Some(first) = list.first() else {
        let message = format!("`{}` offers nothing", name.text());
        return Err(context.fault(Code::MissingField, name.span(), message));
    };
    let kinds = list.iter().map(|choice| kind(*choice, row, context));
    let kinds = kinds.collect::<Result<Vec<ChoiceKind>>>()?;
    let kind = kinds[0];
    if let Some(other) = kinds.iter().position(|other| *other != kind) {
        let (name, noun, found) = (name.text(), kind.noun(), kinds[other].noun());
        let message = format!("`{name}` offers {noun} and {found}");
        let diagnostic = Diagnostic::new(Code::MixedChoices, list[other].span(), message)
            .also(first.span(), format!("this is one of {noun}"));
        return Err(context.error(diagnostic));
    }
    offers(row, kind, first.span(), context)?;
    match kind {
        ChoiceKind::Points => points(&list, row, context),
        ChoiceKind::Directions => directions(&list, context),
        ChoiceKind::Lengths | ChoiceKind::Speeds => lengths(name, &list, row, context),
        ChoiceKind::Words => words(&list, context),
    }
}

fn kind(choice: Expr<'_>, row: Option<&FieldRow>, context: &mut Context<'_>) -> Result<ChoiceKind> {
    let Some(quantity) = quantity_of(choice, context)? else {
        return Ok(match choice {
            Expr::Text(_) => ChoiceKind::Words,
            _ => ChoiceKind::Points,
        });
    };
    let Some(unit) = quantity.unit() else {
        let kind = row.map_or(ChoiceKind::Lengths, |row| row.choices);
        let diagnostic = no_unit(choice, &format!("one of {}", kind.noun()), context);
        let or_words = row.map_or(", or words in quotes", |_| "");
        let (written, unit) = (context.written(choice.span()), usual_unit(kind.dimension()));
        return Err(context.error(diagnostic.help(format!("write `{written}{unit}`{or_words}"))));
    };
    Ok(ChoiceKind::of(unit_of(quantity, unit, context)?.dimension))
}

/// Reports choices of the wrong kind for a field that acts.
fn offers(
    row: Option<&FieldRow>,
    kind: ChoiceKind,
    span: Span,
    context: &mut Context<'_>,
) -> Result<()> {
    let Some(row) = row.filter(|row| row.choices != kind) else {
        return Ok(());
    };
    let (name, noun, found) = (row.name, row.choices.noun(), kind.noun());
    let message = format!("`{name}` offers {noun}, not {found}");
    let help = format!("write, for example, `{}`", row.example);
    Err(context.refuse(Code::MixedChoices, span, message, help))
}

// ---- choices by kind -----------------------------------------------------------------------------

/// Reads every choice, and reports those with the same key as an earlier one.
fn distinct<K: Ord, T>(
    list: &[Expr<'_>],
    context: &mut Context<'_>,
    mut read: impl FnMut(Expr<'_>, &mut Context<'_>) -> Result<(K, T)>,
) -> Result<Vec<T>> {
    let mut seen: BTreeMap<K, Span> = BTreeMap::new();
    let choices = list.iter().map(|choice| {
        let (key, value) = read(*choice, context)?;
        let Some(first) = seen.insert(key, choice.span()) else {
            return Ok(value);
        };
        let written = context.written(choice.span());
        let message = format!("the choice `{written}` is offered twice");
        let diagnostic = Diagnostic::new(Code::DuplicateName, choice.span(), message);
        Err(context.error(diagnostic.also(first, "offered here first")))
    });
    every(choices)
}

fn are_points(shape: KeypointShape) -> bool {
    matches!(shape, KeypointShape::Points | KeypointShape::Point)
}

fn points(list: &[Expr<'_>], row: Option<&FieldRow>, context: &mut Context<'_>) -> Result<Choices> {
    let keypoints = distinct(list, context, |choice, context| {
        let written = context.loaded.written(choice.span());
        match (choice, context.names.get(written)?) {
            (Expr::Name(name), Some(Meaning::Keypoint(shape, _))) => match shape {
                Some(shape) if !are_points(shape) => {
                    let expected = "points to choose from";
                    Err(wrong_kind(name, expected, shape.words(), context))
                }
                _ => Ok((written.to_owned(), written.to_owned())),
            },
            _ => Err(no_keypoint(choice, row, context)),
        }
    })?;
    Ok(Choices::Points { keypoints })
}

/// Reports a choice that names no keypoint; in a field that may offer words, it may be one without quotes.
fn no_keypoint(choice: Expr<'_>, row: Option<&FieldRow>, context: &mut Context<'_>) -> Reported {
    let written = context.loaded.written(choice.span());
    let offered = context.names.that(
        |meaning| matches!(meaning, Meaning::Keypoint(shape, _) if shape.is_none_or(are_points)),
    );
    if row.is_none() && nearest(written, offered.iter().copied()).is_none() {
        let message = format!("there is no keypoint `{written}`");
        let help = format!("words are written in quotes: write `\"{written}\"`");
        return context.refuse(Code::UnknownName, choice.span(), message, help);
    }
    context.unknown_at("keypoint", written, choice.span(), offered)
}

fn directions(list: &[Expr<'_>], context: &mut Context<'_>) -> Result<Choices> {
    let choices = distinct(list, context, |choice, context| {
        let deg = fixed_deg(choice, context)?;
        let vector = vector_of(deg);
        Ok((deg.to_bits(), Direction { deg, vector }))
    })?;
    Ok(Choices::Directions { choices })
}

fn lengths(
    field: Name<'_>,
    list: &[Expr<'_>],
    row: Option<&FieldRow>,
    context: &mut Context<'_>,
) -> Result<Choices> {
    let range = row.and_then(|row| row.range);
    let read = distinct(list, context, |choice, context| {
        let (unit, length) = length(choice, range, context)?;
        Ok(((unit.name, length.value.to_bits()), (unit, length)))
    })?;
    let unit = read[0].0;
    if let Some(other) = read.iter().position(|(own, _)| *own != unit) {
        let (first, other, span) = (unit.name, read[other].0.name, list[other].span());
        let (name, noun) = (field.text(), ChoiceKind::of(unit.dimension).noun());
        let message = format!("`{name}` offers {noun} in `{first}` and in `{other}`");
        let help = "write all of them in one unit; prompts and answers use it too";
        return Err(context.refuse(Code::MixedChoices, span, message, help));
    }
    Ok(Choices::Lengths {
        unit,
        choices: read.into_iter().map(|(_, length)| length).collect(),
    })
}

/// How far a field that does not act may reach. An arm moves no further, and a prompt would show less as 0.
const LENGTH: Range = Range::new("a length", (0.001, "mm"), (100.0, "m"));

/// How fast a field that does not act may be.
const SPEED: Range = Range::new("a speed", (0.001, "mm/s"), (100.0, "m/s"));

fn length(
    choice: Expr<'_>,
    range: Option<Range>,
    context: &mut Context<'_>,
) -> Result<(LengthUnit, LengthChoice)> {
    let found = measured(choice, context)?;
    let stated = found.and_then(|found| Some((found.number, found.unit.and_then(LengthUnit::of)?)));
    let is_speed = stated.is_some_and(|(_, unit)| unit.dimension == Dimension::Speed);
    let range = range.unwrap_or(if is_speed { SPEED } else { LENGTH });
    let m = read(choice, &range, context)?;
    let (number, unit) = stated.expect("a length or a speed has a unit of its kind");
    // Without a cloth there is no program, and `edge` has no size.
    Ok((
        unit,
        LengthChoice {
            // Without the sign of `-0mm`, which a prompt would show.
            value: number + 0.0,
            m: m + 0.0,
        },
    ))
}

fn words(list: &[Expr<'_>], context: &mut Context<'_>) -> Result<Choices> {
    let choices = distinct(list, context, |choice, context| {
        let word = match choice {
            Expr::Text(text) if text.is_blank() => Err("the text is empty"),
            Expr::Text(text) => text.plain().ok_or("a choice cannot contain `{{ … }}`"),
            _ => unreachable!("a list of words has only texts"),
        };
        let fault = |message| context.fault(Code::EmptyText, choice.span(), message);
        let word = word.map_err(fault)?;
        Ok((word.to_lowercase(), word))
    })?;
    Ok(Choices::Words { choices })
}

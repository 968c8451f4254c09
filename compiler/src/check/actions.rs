//! `actions { pick: one of corners … }`: the fields of an answer, and the choices of each.

use super::context::{Context, Fields};
use super::expressions::{Scope, fixed_deg, keypoint, wrong_shape};
use super::names::Meaning;
use super::quantity::{beyond, measured, out_of_range, quantity_of, unit as unit_of};
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
pub(crate) fn check<'a>(part: Actions<'a>, context: &mut Context<'a, '_>) -> Fields<'a> {
    let beyond = part
        .fields()
        .nth(MAX_FIELDS)
        .map(|field| field.name().span());
    let within = context.bounded(beyond, || {
        format!("an action has at most {MAX_FIELDS} fields")
    });
    let fields = part.fields().map(|field| {
        let name = field.name().text();
        let once = context.names.one_meaning(name);
        let field = within.and_then(|()| self::field(field, context));
        (name, field.and_then(|field| once.map(|()| field)))
    });
    let list: Vec<(&str, Result<ActionField, Reported>)> = fields.collect();
    let right = list
        .iter()
        .try_for_each(|(_, field)| field.as_ref().map(drop).map_err(|it| *it));
    // A field with an error may be the missing one.
    let complete = right.and_then(|()| {
        let mut complete = Ok(());
        for fault in incomplete(part) {
            complete = Err(context.error(fault));
        }
        complete
    });
    Fields { list, complete }
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
    let place = match [has("place"), has("direction"), has("distance")] {
        [true, false, false] | [false, true, true] => None,
        [false, false, false] => Some((
            "the action has no `place`",
            "write `place: one of …`, or a `direction` and a `distance`",
        )),
        [false, true, false] => Some((
            "the action has a `direction` but no `distance`",
            "the place is computed from the pick, a `direction` and a `distance`",
        )),
        [false, false, true] => Some((
            "the action has a `distance` but no `direction`",
            "the place is computed from the pick, a `direction` and a `distance`",
        )),
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

fn field<'a>(part: Field<'a>, context: &mut Context<'a, '_>) -> Result<ActionField, Reported> {
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
fn region<'a>(
    mask: Name<'a>,
    row: Option<&FieldRow>,
    context: &mut Context<'a, '_>,
) -> Result<Choices, Reported> {
    offers(row, ChoiceKind::Points, mask.span(), context)?;
    let shapes = [KeypointShape::Mask];
    let mask = keypoint(Expr::Name(mask), &shapes, Scope::Everywhere, context)?;
    Ok(Choices::Region { mask })
}

/// Builds a field from a list of choices, all of one kind.
fn listed<'a>(
    part: Field<'a>,
    row: Option<&FieldRow>,
    context: &mut Context<'a, '_>,
) -> Result<Choices, Reported> {
    let (name, list) = (part.name(), part.one_of().collect::<Vec<Expr<'a>>>());
    context.bounded(list.get(MAX_CHOICES).map(|beyond| beyond.span()), || {
        format!("a field has at most {MAX_CHOICES} choices")
    })?;
    let Some(first) = list.first() else {
        let message = format!("`{}` offers nothing", name.text());
        let diagnostic = Diagnostic::new(Code::MissingField, name.span(), message);
        return Err(context.error(diagnostic));
    };
    let kinds: Vec<ChoiceKind> = list
        .iter()
        .map(|choice| kind(*choice, row, context))
        .collect::<Result<_, _>>()?;
    let kind = kinds[0];
    if let Some(other) = kinds.iter().position(|other| *other != kind) {
        let message = format!(
            "`{}` offers {} and {}",
            name.text(),
            kind.noun(),
            kinds[other].noun()
        );
        let diagnostic = Diagnostic::new(Code::MixedChoices, list[other].span(), message);
        let label = format!("this is one of {}", kind.noun());
        return Err(context.error(diagnostic.also(first.span(), label)));
    }
    offers(row, kind, first.span(), context)?;
    match kind {
        ChoiceKind::Points => points(&list, row, context),
        ChoiceKind::Directions => directions(&list, context),
        ChoiceKind::Lengths | ChoiceKind::Speeds => lengths(name, &list, row, context),
        ChoiceKind::Words => words(&list, context),
    }
}

fn kind<'a>(
    choice: Expr<'a>,
    row: Option<&FieldRow>,
    context: &mut Context<'a, '_>,
) -> Result<ChoiceKind, Reported> {
    let Some(quantity) = quantity_of(choice, context)? else {
        let is_word = matches!(choice, Expr::Text(_));
        return Ok(if is_word {
            ChoiceKind::Words
        } else {
            ChoiceKind::Points
        });
    };
    let Some(unit) = quantity.unit() else {
        let written = context.written(choice.span());
        let unit = row
            .map_or(ChoiceKind::Lengths, |row| row.choices)
            .usual_unit();
        let message = format!("`{written}` has no unit");
        let diagnostic = Diagnostic::new(Code::MissingUnit, choice.span(), message);
        let or_words = if row.is_none() {
            ", or words in quotes"
        } else {
            ""
        };
        let help = format!("write `{written}{unit}`{or_words}");
        return Err(context.error(diagnostic.help(help)));
    };
    Ok(ChoiceKind::of(unit_of(quantity, unit, context)?.dimension))
}

/// Reports choices of the wrong kind for a field that acts.
fn offers(
    row: Option<&FieldRow>,
    kind: ChoiceKind,
    span: Span,
    context: &mut Context<'_, '_>,
) -> Result<(), Reported> {
    let Some(row) = row.filter(|row| row.choices != kind) else {
        return Ok(());
    };
    let message = format!(
        "`{}` offers {}, not {}",
        row.name,
        row.choices.noun(),
        kind.noun()
    );
    let diagnostic = Diagnostic::new(Code::MixedChoices, span, message);
    Err(context.error(diagnostic.help(format!("write, for example, `{}`", row.example))))
}

// ---- choices by kind -----------------------------------------------------------------------------

/// Reads every choice, and reports those with the same key as an earlier one.
fn distinct<'a, K: Ord, T>(
    list: &[Expr<'a>],
    context: &mut Context<'a, '_>,
    mut read: impl FnMut(Expr<'a>, &mut Context<'a, '_>) -> Result<(K, T), Reported>,
) -> Result<Vec<T>, Reported> {
    let mut seen: BTreeMap<K, Span> = BTreeMap::new();
    let choices = list.iter().map(|choice| {
        let (key, value) = read(*choice, context)?;
        let Some(first) = seen.insert(key, choice.span()) else {
            return Ok(value);
        };
        let message = format!(
            "the choice `{}` is offered twice",
            context.written(choice.span())
        );
        let diagnostic = Diagnostic::new(Code::DuplicateName, choice.span(), message);
        Err(context.error(diagnostic.also(first, "offered here first")))
    });
    every(choices)
}

fn are_points(shape: KeypointShape) -> bool {
    matches!(shape, KeypointShape::Points | KeypointShape::Point)
}

/// Returns the keypoints that may be choices, including those with an error, which may be points too.
fn offerable<'a>(context: &Context<'a, '_>) -> Vec<&'a str> {
    context
        .names
        .that(|meaning| matches!(meaning, Meaning::Keypoint(shape) if shape.is_none_or(are_points)))
}

fn points<'a>(
    list: &[Expr<'a>],
    row: Option<&FieldRow>,
    context: &mut Context<'a, '_>,
) -> Result<Choices, Reported> {
    let keypoints = distinct(list, context, |choice, context| {
        let written = context.loaded.written(choice.span());
        match (choice, context.names.get(written)) {
            (Expr::Name(_), Some(Meaning::Keypoint(Some(shape)))) if are_points(shape) => {
                Ok((written, written.to_owned()))
            }
            (Expr::Name(name), Some(Meaning::Keypoint(shape))) => {
                Err(wrong_shape(name, shape, "points to choose from", context))
            }
            (_, Some(Meaning::DuplicateNames(reported))) => Err(reported),
            (Expr::Name(name), None) if row.is_none() => Err(bare_word(name, context)),
            _ => {
                let offered = offerable(context);
                Err(context.unknown_at("keypoint", written, choice.span(), offered))
            }
        }
    })?;
    Ok(Choices::Points { keypoints })
}

/// Reports an unquoted choice that names no keypoint, in a field that may offer words.
fn bare_word(name: Name<'_>, context: &mut Context<'_, '_>) -> Reported {
    let message = format!("there is no keypoint `{}`", name.text());
    let diagnostic = Diagnostic::new(Code::UnknownName, name.span(), message);
    context.error(match nearest(name.text(), offerable(context)) {
        Some(meant) => diagnostic.meant(name.span(), meant),
        None => diagnostic.help(format!(
            "words are written in quotes: write `\"{}\"`",
            name.text()
        )),
    })
}

fn directions<'a>(list: &[Expr<'a>], context: &mut Context<'a, '_>) -> Result<Choices, Reported> {
    let choices = distinct(list, context, |choice, context| {
        let deg = fixed_deg(choice, context)?;
        Ok((
            deg.to_bits(),
            Direction {
                deg,
                vector: vector_of(deg),
            },
        ))
    })?;
    Ok(Choices::Directions { choices })
}

fn lengths<'a>(
    field: Name<'a>,
    list: &[Expr<'a>],
    row: Option<&FieldRow>,
    context: &mut Context<'a, '_>,
) -> Result<Choices, Reported> {
    let range = row.and_then(|row| row.range);
    let read = distinct(list, context, |choice, context| {
        let (unit, length) = length(choice, range.as_ref(), context)?;
        Ok(((unit.name, length.value.to_bits()), (unit, length)))
    })?;
    let unit = read[0].0;
    if let Some(other) = read.iter().position(|(own, _)| *own != unit) {
        let (first, other, span) = (unit.name, read[other].0.name, list[other].span());
        let message = format!(
            "`{}` offers {} in `{first}` and in `{other}`",
            field.text(),
            ChoiceKind::of(unit.dimension).noun()
        );
        let diagnostic = Diagnostic::new(Code::MixedChoices, span, message);
        let help = "write all of them in one unit; prompts and answers use it too";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(Choices::Lengths {
        unit,
        choices: read.into_iter().map(|(_, length)| length).collect(),
    })
}

/// The smallest length in its unit; a prompt would show a smaller one as 0.
const LEAST_LENGTH: f64 = 0.001;

/// The longest distance that an arm may move, metres. The limit also rules out infinite lengths.
const MOST_LENGTH_M: f64 = 100.0;

fn length<'a>(
    choice: Expr<'a>,
    range: Option<&Range>,
    context: &mut Context<'a, '_>,
) -> Result<(LengthUnit, LengthChoice), Reported> {
    const EXPECTED: &str = "a length on the table";
    let Some(found) = measured(choice, context)? else {
        let diagnostic = context.unexpected(Code::WrongForm, choice, EXPECTED);
        return Err(context.error(diagnostic));
    };
    let Some(unit) = found.unit.and_then(LengthUnit::of) else {
        let code = match found.dimension() {
            Dimension::Number => Code::MissingUnit,
            Dimension::ArealDensity => Code::WrongQuantity,
            Dimension::Length | Dimension::Pixels | Dimension::Angle | Dimension::Speed => {
                Code::MixedFrames
            }
        };
        let diagnostic = context.unexpected(code, choice, EXPECTED);
        let diagnostic = diagnostic.label(format!("this is {}", found.dimension().noun()));
        let help = "the arm moves over the table: write, for example, `0.25edge` or `50mm`";
        return Err(context.error(diagnostic.help(help)));
    };
    if let Some(range) = range {
        if !range.contains(found.value) && !found.value.is_nan() {
            return Err(beyond(choice, range, context));
        }
    } else if found.number < LEAST_LENGTH || found.value > MOST_LENGTH_M {
        let help = format!(
            "write at least {LEAST_LENGTH} of its unit, and at most {MOST_LENGTH_M} {}",
            if unit.dimension == Dimension::Speed {
                "m/s"
            } else {
                "m"
            }
        );
        return Err(out_of_range(choice, &help, context));
    }
    // Without a cloth there is no program, and `edge` has no size.
    Ok((
        unit,
        LengthChoice {
            // Without the sign of `-0mm`, which a prompt would show.
            value: found.number + 0.0,
            m: found.value + 0.0,
        },
    ))
}

fn words<'a>(list: &[Expr<'a>], context: &mut Context<'a, '_>) -> Result<Choices, Reported> {
    let choices = distinct(list, context, |choice, context| {
        let word = match choice {
            Expr::Text(text) if !text.is_blank() => text.plain(),
            _ => None,
        };
        let word = word.ok_or_else(|| {
            let message = match choice {
                Expr::Text(text) if text.is_blank() => "the text is empty",
                _ => "a choice cannot contain `{{ … }}`",
            };
            context.fault(Code::EmptyText, choice.span(), message)
        })?;
        Ok((word.to_lowercase(), word))
    })?;
    Ok(Choices::Words { choices })
}

//! Conditions: comparisons, `POINT within N of MASK`, `last`, joined by `and`, `or`, `not`.

use super::context::Context;
use super::expressions::{AsPercent, FramedLength, Operand, Scope, keypoint, operand, point};
use super::names::Meaning;
use super::quantity::{beyond, no_unit, not_whole, read};
use crate::diag::{Code, Diagnostic, Reported, among, every, nearest};
use crate::lang::conditions::{
    ANGLE_BETWEEN, MARGIN, SIGNS, Sign, SignRow, WORDS, sign as meaning,
};
use fab_grammar::ast::{Compare, Expr, Name, Within};
use fab_program::exact::cos_deg;
use fab_program::measures::{COLUMN, QUADRANTS, ROW};
use fab_program::units::{Dimension, Unit};
use fab_program::{
    Choices, Comparison, Condition, KeypointShape, Length, Number, Point, PointMeasure,
};

const FORMS: &str =
    "write, for example, `distance(pick, place) > 10px` or `pick within 8px of cloth`";

/// Builds a condition.
pub(crate) fn check<'a>(
    expr: Expr<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Condition, Reported> {
    match expr {
        Expr::All(all) => Ok(Condition::All {
            of: every(all.parts().map(|part| check(part, context)))?,
        }),
        Expr::Any(any) => Ok(Condition::Any {
            of: every(any.parts().map(|part| check(part, context)))?,
        }),
        Expr::Not(not) => Ok(Condition::Not {
            of: Box::new(check(not.condition(), context)?),
        }),
        Expr::Compare(compare) => self::compare(compare, context),
        Expr::Within(within) => self::within(within, context),
        _ => word(expr, context).ok_or_else(|| {
            let diagnostic = context.unexpected(Code::WrongExpression, expr, "a condition");
            let conditions = WORDS.iter().filter(|row| row.condition.is_some());
            let meant = match expr {
                Expr::Name(name) => nearest(name.text(), conditions.map(|row| row.name)),
                _ => None,
            };
            context.error(match meant {
                Some(meant) => diagnostic.meant(expr.span(), meant),
                None => diagnostic.help(FORMS),
            })
        }),
    }
}

fn within<'a>(within: Within<'a>, context: &mut Context<'a, '_>) -> Result<Condition, Reported> {
    let margin_px = within
        .margin()
        .map_or(Ok(0.0), |margin| read(margin, &MARGIN, context));
    let point = point(within.point(), context);
    let shapes = [KeypointShape::Mask, KeypointShape::Box];
    if let Expr::Name(name) = within.region()
        && context.names.get(name.text()) == Some(Meaning::Keypoint(Some(KeypointShape::Point)))
    {
        return Err(near_a_point(within, name, context));
    }
    let region = keypoint(within.region(), &shapes, Scope::Everywhere, context);
    Ok(Condition::Within {
        point: point?,
        region: region?,
        margin_px: margin_px?,
    })
}

/// Reports a point in place of a region, with the distance that is meant.
fn near_a_point(within: Within<'_>, name: Name<'_>, context: &mut Context<'_, '_>) -> Reported {
    let message = format!("expected a mask or a box, found `{}`", name.text());
    let diagnostic = Diagnostic::new(Code::WrongKindOfName, name.span(), message);
    let point = context.written(within.point().span());
    let margin = within.margin().map(|margin| context.written(margin.span()));
    let margin = margin.unwrap_or_else(|| "10px".to_owned());
    context.error(diagnostic.label("this is a point").help(format!(
        "write `distance({point}, {}) <= {margin}`",
        name.text()
    )))
}

/// Returns the condition that a single word states; `None` if it states none, or if the task declares that name.
fn word(expr: Expr<'_>, context: &Context<'_, '_>) -> Option<Condition> {
    let Expr::Name(name) = expr else {
        return None;
    };
    let row = WORDS.iter().find(|row| row.name == name.text());
    let row = row.filter(|row| context.names.get(row.name).is_none())?;
    row.condition.map(|make| make())
}

// ---- comparisons ---------------------------------------------------------------------------------

fn compare<'a>(compare: Compare<'a>, context: &mut Context<'a, '_>) -> Result<Condition, Reported> {
    let sign = compare.sign();
    let left = operand(compare.left(), context);
    if let (Ok(Operand::WordField(_) | Operand::Quadrant { .. }), Expr::Name(word)) =
        (&left, compare.right())
        && context.names.get(word.text()).is_none()
    {
        let (span, word) = (word.span(), word.text());
        let left = context.written(compare.left().span());
        let message = format!("`{left}` is compared with `{word}`, which is not a text in quotes");
        let diagnostic = Diagnostic::new(Code::WrongExpression, span, message);
        let quoted = format!("\"{word}\"");
        return Err(context.error(
            diagnostic
                .help(format!("write `{quoted}`"))
                .edit(span, quoted),
        ));
    }
    let right = operand(compare.right(), context);
    let left = Side {
        expr: compare.left(),
        value: left?,
    };
    let right = Side {
        expr: compare.right(),
        value: right?,
    };
    if let (Operand::Length(a), Operand::Length(b)) = (&left.value, &right.value) {
        return lengths(compare, [a, b], context);
    }
    if let Some(compared) = fixed(&left, &right, sign, |is| is, context) {
        return compared;
    }
    if let Some(compared) = fixed(&right, &left, sign, Comparison::reversed, context) {
        return compared;
    }
    let diagnostic = unlike(compare, &left, &right, context);
    Err(context.error(diagnostic))
}

/// One side of a comparison.
struct Side<'a> {
    expr: Expr<'a>,
    value: Operand,
}

/// Compares a value with a constant; `None` for any other pair.
///
/// - `turned`: mirrors the comparison if the constant is on the left.
fn fixed<'a>(
    value: &Side<'a>,
    limit: &Side<'a>,
    sign: Name<'a>,
    turned: fn(Comparison) -> Comparison,
    context: &mut Context<'a, '_>,
) -> Option<Result<Condition, Reported>> {
    Some(match (value.value.clone(), &limit.value) {
        (Operand::Between { a, b, .. }, Operand::Angle { deg, .. }) => {
            let (limit_deg, limit_cos) = (*deg, cos_deg(*deg));
            let is = order(sign, "angles", context);
            let accepted = ANGLE_BETWEEN
                .contains(deg.to_radians())
                .then_some(())
                .ok_or_else(|| beyond(limit.expr, &ANGLE_BETWEEN, context));
            accepted.and(is).map(|is| Condition::Angle {
                a,
                b,
                is: turned(is),
                limit_deg,
                limit_cos,
            })
        }
        (Operand::Counted { number, as_percent }, Operand::Number(written)) => {
            let is_same = matches!(meaning(sign.text()), Some(Sign::Same | Sign::Different));
            if is_same && number.is_whole() && written.fract() != 0.0 {
                let help = "a count is a whole number: compare it with one, or use `<` or `>`";
                return Some(Err(not_whole(limit.expr, help, context)));
            }
            let share = match as_percent {
                AsPercent::Yes => written / 100.0,
                AsPercent::No => *written,
            };
            counted(number, sign, share, turned, context)
        }
        (Operand::WordField(field), Operand::Word(word)) => {
            words(field, word, limit.expr, sign, context)
        }
        (Operand::WordField(field), Operand::Quadrant { point, about }) => {
            declared_quadrant(field, [point, about], limit.expr, sign, context)
        }
        (Operand::Quadrant { point, about }, Operand::Word(word)) => {
            let name = context.written(value.expr.span());
            let words = quadrants().map(|(word, _)| word);
            let found = quadrants().find(|(known, _)| known == word);
            let of = found
                .map(|(_, sides)| in_quadrant(sides, [&point, &about]))
                .ok_or_else(|| never(&name, word, limit.expr, words, context));
            of.and_then(|of| same(Condition::All { of }, sign, context))
        }
        _ => return None,
    })
}

fn lengths<'a>(
    compare: Compare<'a>,
    [left, right]: [&FramedLength; 2],
    context: &mut Context<'a, '_>,
) -> Result<Condition, Reported> {
    let is = order(compare.sign(), "lengths", context);
    let [left_in, right_in] = [left, right].map(|length| length.unit.dimension);
    if left_in != right_in {
        let (left_noun, right_noun) = (left_in.noun(), right_in.noun());
        let message = format!("{left_noun} is compared with {right_noun}");
        let diagnostic = Diagnostic::new(Code::MixedFrames, compare.right().span(), message)
            .label(right_noun)
            .also(compare.left().span(), left_noun);
        if [left_in, right_in].contains(&Dimension::Speed) {
            let help = "compare a speed with a speed such as `200mm/s`";
            return Err(context.error(diagnostic.help(help)));
        }
        let [a, b] = [compare.left(), compare.right()].map(|side| {
            let value = match side {
                Expr::Converted(converted) => converted.value(),
                _ => side,
            };
            context.written(value.span())
        });
        let help = format!(
            "write `{b} in {}`, or `{a} in {}`",
            left.unit.name, right.unit.name
        );
        return Err(context.error(diagnostic.help(help)));
    }
    // In the picture if one is measured in it.
    let is_picture = [left, right]
        .iter()
        .any(|it| it.native == Dimension::Pixels);
    let frame = if is_picture {
        Dimension::Pixels
    } else {
        left_in
    };
    let (left, right) = (
        left.in_frame(frame, context)?,
        right.in_frame(frame, context)?,
    );
    if let (Length::Constant { .. }, Length::Constant { .. }) = (&left, &right) {
        let span = compare.span();
        let message = format!("`{}` compares two constants", context.written(span));
        let diagnostic = Diagnostic::new(Code::WrongExpression, span, message);
        let help =
            "one side must depend on the action or the scene, such as `distance(pick, place)`";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(Condition::Lengths {
        left,
        is: is?,
        right,
    })
}

/// Compares a number. Only whole numbers can be tested for equality.
fn counted(
    number: Number,
    sign: Name<'_>,
    limit: f64,
    turned: fn(Comparison) -> Comparison,
    context: &mut Context<'_, '_>,
) -> Result<Condition, Reported> {
    let is_whole = number.is_whole();
    let compared = |is| Condition::Number {
        left: number.clone(),
        is,
        limit,
    };
    let same = || Condition::All {
        of: [Comparison::AtLeast, Comparison::AtMost]
            .map(compared)
            .into(),
    };
    match meaning(sign.text()) {
        Some(Sign::Same) if is_whole => Ok(same()),
        Some(Sign::Different) if is_whole => Ok(Condition::Not {
            of: Box::new(same()),
        }),
        _ => Ok(compared(turned(order(sign, "numbers", context)?))),
    }
}

fn words(
    field: String,
    word: &str,
    written: Expr<'_>,
    sign: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Condition, Reported> {
    let choices = offered_words(&field, context)?;
    if !choices.iter().any(|known| known == word) {
        return Err(never(
            &field,
            word,
            written,
            choices.iter().map(String::as_str),
            context,
        ));
    }
    let is = word.to_owned();
    same(Condition::Word { field, is }, sign, context)
}

/// Reports a word that a value never is.
fn never<'w>(
    value: &str,
    word: &str,
    written: Expr<'_>,
    words: impl Iterator<Item = &'w str> + Clone,
    context: &mut Context<'_, '_>,
) -> Reported {
    let message = format!("`{value}` is never `{word}`");
    let diagnostic = Diagnostic::new(Code::UnknownName, written.span(), message);
    context.error(match nearest(word, words.clone()) {
        Some(meant) => diagnostic.meant(written.span(), &format!("\"{meant}\"")),
        None => diagnostic.help(format!("it is {}", among(words))),
    })
}

/// Compares a field with where a point lies: the field has one of its words, and the point lies there.
///
/// - `points`: the point, and the one that it is seen from.
fn declared_quadrant(
    field: String,
    points: [&Point; 2],
    quadrant: Expr<'_>,
    sign: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Condition, Reported> {
    let choices = offered_words(&field, context)?;
    let words = quadrants().map(|(word, _)| word);
    if let Some(other) = choices
        .iter()
        .find(|it| words.clone().all(|word| word != **it))
    {
        let written = context.written(quadrant.span());
        let message = format!("`{field}` offers `{other}`, which `{written}` never is");
        let diagnostic = Diagnostic::new(Code::WrongExpression, quadrant.span(), message);
        let help = match nearest(other, words.clone()) {
            Some(meant) => format!("offer `\"{meant}\"` in its place"),
            None => format!("it is {}; offer no other word", among(words)),
        };
        return Err(context.error(diagnostic.help(help)));
    }
    let offered = quadrants().filter(|(word, _)| choices.iter().any(|it| it == word));
    let of = offered.map(|(word, sides)| {
        let (field, is) = (field.clone(), word.to_owned());
        let mut of = vec![Condition::Word { field, is }];
        of.extend(in_quadrant(sides, points));
        Condition::All { of }
    });
    same(Condition::Any { of: of.collect() }, sign, context)
}

/// Returns the words that a field offers.
fn offered_words(field: &str, context: &Context<'_, '_>) -> Result<Vec<String>, Reported> {
    let field = context.actions.get(field)?;
    Ok(match field.map(|field| &field.choices) {
        Some(Choices::Words { choices }) => choices.clone(),
        _ => Vec::new(),
    })
}

/// Returns each word of a quadrant, and how a point's column and row compare there with those of the other point.
fn quadrants() -> impl Iterator<Item = (&'static str, [Comparison; 2])> + Clone {
    let sides = [Comparison::Less, Comparison::AtLeast];
    let rows = QUADRANTS.into_iter().zip(sides);
    rows.flat_map(move |(words, row)| {
        let columns = words.into_iter().zip(sides);
        columns.map(move |(word, column)| (word, [column, row]))
    })
}

/// Returns the conditions under which the first point lies on these sides of the second.
fn in_quadrant(sides: [Comparison; 2], points: [&Point; 2]) -> Vec<Condition> {
    let [left, right] = points.map(|point| {
        [COLUMN, ROW].map(|axis| {
            let measure = PointMeasure::new(axis.signature.name, vec![point.clone()]);
            Length::OfPoints(measure.expect("a column and a row measure one point"))
        })
    });
    let sides = left.into_iter().zip(right).zip(sides);
    sides
        .map(|((left, right), is)| Condition::Lengths { left, is, right })
        .collect()
}

/// Returns whether a condition holds, or with `!=` that it does not; other signs do not compare words.
fn same(
    holds: Condition,
    sign: Name<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Condition, Reported> {
    match meaning(sign.text()) {
        Some(Sign::Same) => Ok(holds),
        Some(Sign::Different) => Ok(Condition::Not {
            of: Box::new(holds),
        }),
        _ => {
            let message = format!("words cannot be compared with `{}`", sign.text());
            let diagnostic = Diagnostic::new(Code::WrongExpression, sign.span(), message);
            Err(context.error(diagnostic.help("write `==` or `!=`")))
        }
    }
}

/// Returns which of two values is the larger.
fn order(
    sign: Name<'_>,
    what: &str,
    context: &mut Context<'_, '_>,
) -> Result<Comparison, Reported> {
    if let Some(Sign::Order(is)) = meaning(sign.text()) {
        return Ok(is);
    }
    let misspelt = |row: &&SignRow| row.misspelling == Some(sign.text());
    if let Some(row) = SIGNS.iter().find(misspelt) {
        return Err(context.error(not_a_sign(sign, row.name)));
    }
    let message = format!("{what} cannot be compared with `{}`", sign.text());
    let diagnostic = Diagnostic::new(Code::WrongExpression, sign.span(), message);
    let orders = SIGNS
        .iter()
        .filter(|row| matches!(row.means, Sign::Order(_)));
    let orders = among(orders.map(|row| row.name));
    let help = format!("measured values are hardly ever equal; write {orders}");
    Err(context.error(diagnostic.help(help)))
}

/// Reports a sign that people write for another one, such as `≤` for `<=`.
pub(super) fn not_a_sign(sign: Name<'_>, right: &str) -> Diagnostic {
    let message = format!("`{}` is written `{right}` here", sign.text());
    Diagnostic::new(Code::WrongExpression, sign.span(), message)
        .help(format!("write `{right}`"))
        .edit(sign.span(), right)
}

/// Reports why two values cannot be compared.
fn unlike(
    compare: Compare<'_>,
    left: &Side<'_>,
    right: &Side<'_>,
    context: &Context<'_, '_>,
) -> Diagnostic {
    match (&left.value, &right.value) {
        (measured, Operand::Number(_)) if let Some(unit) = measured.unit() => {
            return without_unit(right, left, unit, context);
        }
        (Operand::Number(_), measured) if let Some(unit) = measured.unit() => {
            return without_unit(left, right, unit, context);
        }
        _ => {}
    }
    let [left_kind, right_kind] = [left, right].map(|side| side.value.noun());
    if left_kind != right_kind {
        let message = format!("{left_kind} is compared with {right_kind}");
        let diagnostic = Diagnostic::new(Code::WrongQuantity, right.expr.span(), message)
            .label(format!("expected {left_kind}"))
            .also(left.expr.span(), format!("this is {left_kind}"));
        return match (&left.value, &right.value) {
            (Operand::Heading, _) | (_, Operand::Heading) => {
                diagnostic.help("write `angle_between(direction, from center to pick) < 45deg`")
            }
            _ => diagnostic,
        };
    }
    let [a, b] = [left, right].map(|side| context.written(side.expr.span()));
    let both = format!("`{a}` and `{b}`");
    let sign = if compare.sign().text() == "!=" {
        ">"
    } else {
        "<"
    };
    let (why, help) = match &left.value {
        Operand::Point(_) => (
            "are points, which cannot be compared",
            format!("write, for example, `distance({a}, {b}) {sign} 10px`"),
        ),
        Operand::Heading => (
            "are directions, which cannot be compared",
            format!("write, for example, `angle_between({a}, {b}) {sign} 45deg`"),
        ),
        left if left.is_constant() && right.value.is_constant() => {
            ("are both constants", FORMS.to_owned())
        }
        _ => (
            "cannot be compared, because neither is a constant",
            "one side must be a constant: a number, an angle such as `45deg`, or a word in quotes"
                .to_owned(),
        ),
    };
    let message = format!("{both} {why}");
    Diagnostic::new(Code::WrongExpression, compare.span(), message).help(help)
}

/// Reports a number without a unit beside a value that has one.
fn without_unit(
    number: &Side<'_>,
    measured: &Side<'_>,
    unit: &Unit,
    context: &Context<'_, '_>,
) -> Diagnostic {
    let kind = measured.value.noun();
    let diagnostic = no_unit(number.expr, kind, context);
    let diagnostic = diagnostic.also(measured.expr.span(), format!("this is {kind}"));
    match number.expr {
        Expr::Quantity(_) => {
            let written = context.written(number.expr.span());
            diagnostic.help(format!("write `{written}{}`", unit.name))
        }
        _ => diagnostic,
    }
}

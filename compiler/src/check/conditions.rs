//! Conditions: comparisons, `POINT within N of MASK`, `last`, joined by `and`, `or`, `not`.

use super::context::{Context, Declared, Result};
use super::expressions::{FramedLength, Operand, keypoint, operand, point};
use super::names::Meaning;
use super::quantity::{beyond, no_unit, read};
use crate::diag::{Code, Diagnostic, Reported, among, every, nearest};
use crate::lang::conditions::{
    ANGLE_BETWEEN, MARGIN, MISSPELT_SIGNS, Sign, UNREACHABLE, sign as meaning,
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
pub(crate) fn check(expr: Expr<'_>, context: &mut Context<'_>) -> Result<Condition> {
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
        _ => word(expr, context)?.ok_or_else(|| {
            let diagnostic = context.unexpected(Code::WrongExpression, expr, "a condition");
            context.error(diagnostic.help(FORMS))
        }),
    }
}

fn within(within: Within<'_>, context: &mut Context<'_>) -> Result<Condition> {
    let margin_px = within
        .margin()
        .map_or(Ok(0.0), |margin| read(margin, &MARGIN, context));
    let point = point(within.point(), context);
    let region = region(within, context);
    Ok(Condition::Within {
        point: point?,
        region: region?,
        margin_px: margin_px?,
    })
}

/// Returns the name of a mask or a box; for a point, reports the distance that is meant.
fn region(within: Within<'_>, context: &mut Context<'_>) -> Result<String> {
    let shapes = [KeypointShape::Mask, KeypointShape::Box];
    let written = context.loaded.written(within.region().span());
    let Some(Meaning::Keypoint(Some(KeypointShape::Point), _)) = context.names.get(written)? else {
        return keypoint(within.region(), &shapes, context);
    };
    let [point, name] = [within.point(), within.region()].map(|it| context.written(it.span()));
    let margin = within.margin().map(|margin| context.written(margin.span()));
    let margin = margin.unwrap_or_else(|| "10px".to_owned());
    let message = format!("expected a mask or a box, found `{name}`");
    let diagnostic = Diagnostic::new(Code::WrongKindOfName, within.region().span(), message)
        .label("this is a point")
        .help(format!("write `distance({point}, {name}) <= {margin}`"));
    Err(context.error(diagnostic))
}

/// Returns the condition that a single word states; `None` if it states none, or if the task declares that name.
fn word(expr: Expr<'_>, context: &Context<'_>) -> Declared<Condition> {
    let Expr::Name(name) = expr else {
        return Ok(None);
    };
    let is_declared = context.names.get(name.text())?.is_some();
    Ok(match name.text() {
        _ if is_declared => None,
        "last" => Some(Condition::Last),
        UNREACHABLE => Some(Condition::Unreachable),
        _ => None,
    })
}

// ---- comparisons ---------------------------------------------------------------------------------

/// One side of a comparison.
struct Side<'a> {
    expr: Expr<'a>,
    value: Operand,
}

fn compare(compare: Compare<'_>, context: &mut Context<'_>) -> Result<Condition> {
    let sign = sign(compare.sign(), context);
    let left = operand(compare.left(), context);
    if let (Ok(Operand::WordField(_) | Operand::Quadrant(_)), Expr::Name(word)) =
        (&left, compare.right())
        && context.names.get(word.text())?.is_none()
    {
        let (span, word) = (word.span(), word.text());
        let left = context.written(compare.left().span());
        let message = format!("`{left}` is compared with `{word}`, which is not a text in quotes");
        let quoted = format!("\"{word}\"");
        let diagnostic = Diagnostic::new(Code::WrongExpression, span, message)
            .help(format!("write `{quoted}`"))
            .edit(span, quoted);
        return Err(context.error(diagnostic));
    }
    let right = operand(compare.right(), context);
    let (sign, left, right) = (sign?, left?, right?);
    if let (Operand::Length(left), Operand::Length(right)) = (&left, &right) {
        return lengths(compare, [left, right], sign, context);
    }
    let [left, right] = [(compare.left(), left), (compare.right(), right)];
    let [left, right] = [left, right].map(|(expr, value)| Side { expr, value });
    let fixed = if left.value.is_constant() {
        let turned = match sign {
            Sign::Order(is) => Sign::Order(is.reversed()),
            other => other,
        };
        fixed(compare, &right, &left, turned, context)?
    } else {
        fixed(compare, &left, &right, sign, context)?
    };
    fixed.ok_or_else(|| {
        let diagnostic = unlike(compare, &left, &right, context);
        context.error(diagnostic)
    })
}

/// Returns the meaning of a sign; reports one that people write for another, such as `≤` for `<=`.
pub(super) fn sign(sign: Name<'_>, context: &mut Context<'_>) -> Result<Sign> {
    let written = sign.text();
    if let Some((_, right)) = MISSPELT_SIGNS.iter().find(|(wrong, _)| *wrong == written) {
        let message = format!("`{written}` is written `{right}` here");
        let diagnostic = Diagnostic::new(Code::WrongExpression, sign.span(), message)
            .help(format!("write `{right}`"))
            .edit(sign.span(), *right);
        return Err(context.error(diagnostic));
    }
    Ok(meaning(written).expect("every sign that is read has a row"))
}

/// Compares a value with a constant, or a field with what a point measures; `None` for any other pair.
fn fixed(
    compare: Compare<'_>,
    value: &Side<'_>,
    limit: &Side<'_>,
    sign: Sign,
    context: &mut Context<'_>,
) -> Declared<Condition> {
    Ok(Some(match (&value.value, &limit.value) {
        (Operand::Between([a, b], _), Operand::Angle(deg, _)) => {
            let is = order(compare, sign, "angles", context);
            if !ANGLE_BETWEEN.contains(deg.to_radians()) {
                return Err(beyond(limit.expr, &ANGLE_BETWEEN, context));
            }
            Condition::Angle {
                a: a.clone(),
                b: b.clone(),
                is: is?,
                limit_deg: *deg,
                limit_cos: cos_deg(*deg),
            }
        }
        (Operand::Counted(number, written), Operand::Number(limit)) => {
            counted(compare, number, sign, limit / written.factor, context)?
        }
        (Operand::WordField(_) | Operand::Quadrant(_), Operand::Word(word)) => {
            let mut words = words(&value.value, context)?;
            let Some(at) = words.iter().position(|(known, _)| known == word) else {
                return Err(never(value, limit, word, &words, context));
            };
            same(compare, together(words.swap_remove(at).1), sign, context)?
        }
        (Operand::WordField(_), Operand::Quadrant(_)) => {
            quadrant(compare, value, limit, sign, context)?
        }
        (Operand::Quadrant(_), Operand::WordField(_)) => {
            quadrant(compare, limit, value, sign, context)?
        }
        _ => return Ok(None),
    }))
}

fn lengths(
    compare: Compare<'_>,
    [left, right]: [&FramedLength; 2],
    sign: Sign,
    context: &mut Context<'_>,
) -> Result<Condition> {
    let is = order(compare, sign, "lengths", context);
    let [left_in, right_in] = [left, right].map(|length| length.unit.dimension);
    if left_in != right_in {
        let (left_noun, right_noun) = (left_in.noun(), right_in.noun());
        let message = format!("{left_noun} is compared with {right_noun}");
        let help = if [left_in, right_in].contains(&Dimension::Speed) {
            "compare a speed with a speed such as `200mm/s`".to_owned()
        } else {
            let [a, b] = [compare.left(), compare.right()].map(|side| {
                let value = match side {
                    Expr::Converted(converted) => converted.value(),
                    _ => side,
                };
                context.written(value.span())
            });
            let [left, right] = [left, right].map(|length| length.unit.name);
            format!("write `{b} in {left}`, or `{a} in {right}`")
        };
        let diagnostic = Diagnostic::new(Code::MixedFrames, compare.right().span(), message)
            .label(right_noun)
            .also(compare.left().span(), left_noun)
            .help(help);
        return Err(context.error(diagnostic));
    }
    // In the picture if one is measured in it.
    let natives = [left, right].map(|length| length.native);
    let frame = if natives.contains(&Dimension::Pixels) {
        Dimension::Pixels
    } else {
        left_in
    };
    let left = left.in_frame(frame, context)?;
    let right = right.in_frame(frame, context)?;
    if let (Length::Constant { .. }, Length::Constant { .. }) = (&left, &right) {
        let span = compare.span();
        let message = format!("`{}` compares two constants", context.written(span));
        let help =
            "one side must depend on the action or the scene, such as `distance(pick, place)`";
        return Err(context.refuse(Code::WrongExpression, span, message, help));
    }
    Ok(Condition::Lengths {
        left,
        is: is?,
        right,
    })
}

/// Compares a number. Only whole numbers can be tested for equality.
fn counted(
    compare: Compare<'_>,
    number: &Number,
    sign: Sign,
    limit: f64,
    context: &mut Context<'_>,
) -> Result<Condition> {
    let compared = |is| Condition::Number {
        left: number.clone(),
        is,
        limit,
    };
    if number.is_whole() && !matches!(sign, Sign::Order(_)) {
        let of = [Comparison::AtLeast, Comparison::AtMost].map(compared);
        return same(compare, Condition::All { of: of.into() }, sign, context);
    }
    order(compare, sign, "numbers", context).map(compared)
}

// ---- words ---------------------------------------------------------------------------------------

/// The words that a value can be, each with the conditions under which it is that word.
type Words = Vec<(String, Vec<Condition>)>;

/// Returns the words that a field offers, or those for where a point lies; none for other values.
fn words(value: &Operand, context: &Context<'_>) -> Result<Words> {
    Ok(match value {
        Operand::WordField(field) => match context.actions.get(field)?.map(|it| &it.choices) {
            Some(Choices::Words { choices }) => {
                let is = |word: &String| Condition::Word {
                    field: field.clone(),
                    is: word.clone(),
                };
                choices
                    .iter()
                    .map(|word| (word.clone(), vec![is(word)]))
                    .collect()
            }
            _ => Vec::new(),
        },
        Operand::Quadrant([point, about]) => {
            let sides = [Comparison::Less, Comparison::AtLeast];
            let rows = QUADRANTS.into_iter().zip(sides);
            let all = rows.flat_map(|(words, row)| {
                let columns = words.into_iter().zip(sides);
                columns.map(move |(word, column)| (word.to_owned(), [column, row]))
            });
            let lies = |is| in_quadrant([point, about], is);
            all.map(|(word, is)| (word, lies(is))).collect()
        }
        _ => Vec::new(),
    })
}

/// Returns the conditions that the first point's column and row compare so with those of the second.
fn in_quadrant(points: [&Point; 2], is: [Comparison; 2]) -> Vec<Condition> {
    let axes = [COLUMN, ROW].into_iter().zip(is);
    let conditions = axes.map(|(axis, is)| {
        let [left, right] = points.map(|point| {
            let measure = PointMeasure::new(axis.signature.name, vec![point.clone()]);
            Length::OfPoints(measure.expect("a column and a row measure one point"))
        });
        Condition::Lengths { left, is, right }
    });
    conditions.collect()
}

/// Returns the condition that all of these hold.
fn together(mut of: Vec<Condition>) -> Condition {
    if of.len() == 1 {
        of.remove(0)
    } else {
        Condition::All { of }
    }
}

/// Compares a field with where a point lies: the field has one of its words, and the point lies there.
fn quadrant(
    compare: Compare<'_>,
    field: &Side<'_>,
    quadrant: &Side<'_>,
    sign: Sign,
    context: &mut Context<'_>,
) -> Result<Condition> {
    let offered = words(&field.value, context)?;
    let lies = words(&quadrant.value, context)?;
    let names = || lies.iter().map(|(word, _)| word.as_str());
    if let Some((other, _)) = offered
        .iter()
        .find(|(word, _)| names().all(|it| it != word))
    {
        let [field, where_it_lies] =
            [field, quadrant].map(|side| context.written(side.expr.span()));
        let message = format!("`{field}` offers `{other}`, which `{where_it_lies}` never is");
        let help = match nearest(other, names()) {
            Some(meant) => format!("offer `\"{meant}\"` in its place"),
            None => format!("it is {}; offer no other word", among(names())),
        };
        let span = quadrant.expr.span();
        return Err(context.refuse(Code::WrongExpression, span, message, help));
    }
    let of = lies.into_iter().filter_map(|(word, lies)| {
        let (_, is) = offered.iter().find(|(offered, _)| *offered == word)?;
        Some(together([is.clone(), lies].concat()))
    });
    same(compare, Condition::Any { of: of.collect() }, sign, context)
}

/// Reports a word that a value never is.
fn never(
    value: &Side<'_>,
    limit: &Side<'_>,
    word: &str,
    words: &Words,
    context: &mut Context<'_>,
) -> Reported {
    let span = limit.expr.span();
    let value = context.written(value.expr.span());
    let message = format!("`{value}` is never `{word}`");
    let diagnostic = Diagnostic::new(Code::UnknownName, span, message);
    let names = || words.iter().map(|(word, _)| word.as_str());
    context.error(match nearest(word, names()) {
        Some(meant) => diagnostic.meant(span, &format!("\"{meant}\"")),
        None => diagnostic.help(format!("it is {}", among(names()))),
    })
}

/// Returns whether a condition holds, or with `!=` that it does not; other signs do not compare words.
fn same(
    compare: Compare<'_>,
    holds: Condition,
    sign: Sign,
    context: &mut Context<'_>,
) -> Result<Condition> {
    match sign {
        Sign::Same => Ok(holds),
        Sign::Different => Ok(Condition::Not {
            of: Box::new(holds),
        }),
        Sign::Order(_) => Err(unfit(compare, "words", "write `==` or `!=`", context)),
    }
}

/// Returns which of two values is the larger.
fn order(
    compare: Compare<'_>,
    sign: Sign,
    what: &str,
    context: &mut Context<'_>,
) -> Result<Comparison> {
    let Sign::Order(is) = sign else {
        let help = "measured values are hardly ever equal; write `<`, `<=`, `>` or `>=`";
        return Err(unfit(compare, what, help, context));
    };
    Ok(is)
}

fn unfit(compare: Compare<'_>, what: &str, help: &str, context: &mut Context<'_>) -> Reported {
    let sign = compare.sign();
    let message = format!("{what} cannot be compared with `{}`", sign.text());
    context.refuse(Code::WrongExpression, sign.span(), message, help)
}

// ---- values that cannot be compared --------------------------------------------------------------

/// Reports why two values cannot be compared.
fn unlike(
    compare: Compare<'_>,
    left: &Side<'_>,
    right: &Side<'_>,
    context: &Context<'_>,
) -> Diagnostic {
    for (number, measured) in [(right, left), (left, right)] {
        if let (Operand::Number(_), Some(unit)) = (&number.value, measured.value.unit()) {
            return without_unit(number, measured, unit, context);
        }
    }
    let [left_kind, right_kind] = [left, right].map(|side| side.value.noun());
    if left_kind != right_kind {
        let message = format!("{left_kind} is compared with {right_kind}");
        let diagnostic = Diagnostic::new(Code::WrongQuantity, right.expr.span(), message)
            .label(format!("expected {left_kind}"))
            .also(left.expr.span(), format!("this is {left_kind}"));
        return match (&left.value, &right.value) {
            (Operand::Heading(_), _) | (_, Operand::Heading(_)) => {
                diagnostic.help("write `angle_between(direction, from center to pick) < 45deg`")
            }
            _ => diagnostic,
        };
    }
    let [a, b] = [left, right].map(|side| context.written(side.expr.span()));
    let sign = match compare.sign().text() {
        "!=" => ">",
        _ => "<",
    };
    let (why, help) = match &left.value {
        Operand::Point(_) => (
            "are points, which cannot be compared",
            format!("write, for example, `distance({a}, {b}) {sign} 10px`"),
        ),
        Operand::Heading(_) => (
            "are directions, which cannot be compared",
            format!("write, for example, `angle_between({a}, {b}) {sign} 45deg`"),
        ),
        left if left.is_constant() => ("are both constants", FORMS.to_owned()),
        _ => (
            "cannot be compared, because neither is a constant",
            "write a number, an angle such as `45deg`, or a word in quotes on one side".to_owned(),
        ),
    };
    let message = format!("`{a}` and `{b}` {why}");
    Diagnostic::new(Code::WrongExpression, compare.span(), message).help(help)
}

/// Reports a number without a unit beside a value that has one.
fn without_unit(
    number: &Side<'_>,
    measured: &Side<'_>,
    unit: &Unit,
    context: &Context<'_>,
) -> Diagnostic {
    let kind = measured.value.noun();
    let diagnostic =
        no_unit(number.expr, kind, context).also(measured.expr.span(), format!("this is {kind}"));
    let Expr::Quantity(_) = number.expr else {
        return diagnostic;
    };
    let written = context.written(number.expr.span());
    diagnostic.help(format!("write `{written}{}`", unit.name))
}

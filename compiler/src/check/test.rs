//! `test "…" { given NAME = … reply "…" expect … }`: an answer and its expected verdict, in a task or one of its variants.

use super::context::{Context, Declared, Result};
use super::examples::plain;
use super::expressions;
use super::names::Meaning;
use super::quantity::read_whole;
use super::stage::{Prompts, number_of};
use crate::diag::{Code, Reported, every};
use crate::lang::test::{EXPECTATIONS, GIVEN, STEP};
use crate::merge::{Merged, declared_twice, once, repeated};
use fab_grammar::ast::{self, Body, Expr, Name, Reply};
use fab_program::verify::OFFERED;
use fab_program::{Expect, Given, Keypoint, KeypointShape, PixelPoint, Read, Stage, Test};
use std::collections::BTreeMap;

/// The most tests of a task.
const MAX_TESTS: usize = 1000;

/// What bounds the values that a test may give.
pub(crate) struct Bounds<'p> {
    /// Those of the task; none if one has an error.
    pub keypoints: &'p [Keypoint],
    /// The most steps; `None` in a base, or if it has an error.
    pub horizon: Option<u32>,
}

/// Builds the tests of a task, or those that a variant states itself.
pub(crate) fn check(
    merged: &Merged<'_>,
    prompts: &Prompts,
    bounds: &Bounds<'_>,
    context: &mut Context<'_>,
) -> Vec<Result<Test>> {
    // Tests are not inherited, and neither are those of an inherited variant.
    let task = merged.task.body().span();
    let body = merged.own_body().filter(|body| task.contains(body.span()));
    let tests = || body.into_iter().flat_map(Body::tests);
    let places = tests().map(|test| test.head_span());
    if let Err(reported) = context.at_most(MAX_TESTS, places, "a task", "tests") {
        return vec![Err(reported)];
    }
    let mut seen = BTreeMap::new();
    let mut all = Vec::new();
    for test in tests() {
        if let Some(text) = test.name()
            && let Some(name) = text.plain()
            && let Some(first) = seen.insert(name.clone(), text.span())
        {
            let diagnostic = declared_twice("test", &name, first, text.span());
            all.push(Err(context.error(diagnostic)));
        }
        all.extend(one(test, merged, prompts, bounds, context).transpose());
    }
    all
}

/// Builds one test; `None` in a base without a stage that a reply could answer.
fn one(
    test: ast::Test<'_>,
    merged: &Merged<'_>,
    prompts: &Prompts,
    bounds: &Bounds<'_>,
    context: &mut Context<'_>,
) -> Declared<Test> {
    let reply = once(test.replies(), "reply", Reply::span, context.report);
    let expect = once(test.expect(), "expect", ast::Expect::span, context.report);
    let name = required(test.name(), "a name in quotes", test, context);
    let alone = reply.alone.and(expect.alone);
    let reply = required(reply.first, "`reply`", test, context);
    let expect = required(expect.first, "`expect`", test, context);

    let name = name.and_then(|text| match plain(text, context)? {
        name if name.trim().is_empty() => {
            let message = "the test's name is empty";
            Err(context.fault(Code::TestIncomplete, text.span(), message))
        }
        name => Ok(name),
    });
    let given = self::given(test, bounds, context);
    let answer = reply.and_then(|reply| plain(reply.text(), context));
    let stage = reply.and_then(|reply| answered(reply, merged, prompts, context));
    let expect =
        expect.and_then(|line| self::expect(line, stage?.map(|(_, stage)| stage), merged, context));
    alone?;
    let (name, given, answer) = (name?, given?, answer?);
    let expect = expect?;
    let Some((stage, _)) = stage? else {
        return Ok(None);
    };
    let (declared_in, line) = context.loaded.place(test.span().file, test.span().start);
    let task = merged.task.name().text().to_owned();
    Ok(Some(Test {
        name,
        task,
        variant: merged
            .variant
            .as_ref()
            .map(|variant| variant.name.to_string()),
        given,
        stage,
        reply: answer,
        expect,
        declared_in,
        line,
    }))
}

fn required<T>(
    part: Option<T>,
    what: &str,
    test: ast::Test<'_>,
    context: &mut Context<'_>,
) -> Result<T> {
    part.ok_or_else(|| {
        let message = format!("the test lacks {what}");
        let help = "write `test \"what it shows\" { given NAME = … reply \"…\" expect … }`";
        context.refuse(Code::TestIncomplete, test.head_span(), message, help)
    })
}

/// Finds the stage that the reply answers, by default the last one; `None` in a base without stages.
fn answered<'p>(
    reply: Reply<'_>,
    merged: &Merged<'_>,
    prompts: &'p Prompts,
    context: &mut Context<'_>,
) -> Declared<(usize, &'p Stage)> {
    let number = match reply.stage() {
        None => prompts.stages.len().checked_sub(1),
        Some(name) => Some(number_of(name, merged, context)?),
    };
    let stage = |number: usize| prompts.stages[number].as_ref().map(|stage| (number, stage));
    number.map(stage).transpose().map_err(|reported| *reported)
}

// ---- given ---------------------------------------------------------------------------------------

/// Pick and place of the previous action, where given.
type Last = [Option<PixelPoint>; 2];

fn given(test: ast::Test<'_>, bounds: &Bounds<'_>, context: &mut Context<'_>) -> Result<Given> {
    let mut given = Given {
        step: 1,
        ..Given::default()
    };
    let mut last: Last = [None, None];
    let mut all = Ok(());
    let mut seen = BTreeMap::new();
    for part in test.given() {
        let name = part.name();
        if let Some(first) = seen.insert(name.text(), name.span()) {
            all = Err(context.error(repeated(name.text(), first, name.span())));
        } else if let Err(reported) = give(part, &mut given, &mut last, bounds, context) {
            all = Err(reported);
        }
    }
    // A wrong line may be the one that is missing.
    all?;
    given.last = match last {
        [None, None] => None,
        [Some(pick), Some(place)] => Some([pick, place]),
        [Some(_), None] | [None, Some(_)] => {
            let message = "the previous action must have both a pick and a place";
            let help = "give both `last.pick` and `last.place`";
            return Err(context.refuse(Code::TestIncomplete, test.head_span(), message, help));
        }
    };
    if let (Some(step), Some(_), 1) = (seen.get("step"), given.last, given.step) {
        let message = "no action comes before the first step";
        let help = "give a later step, or leave `last.pick` and `last.place` out";
        return Err(context.refuse(Code::OutOfRange, *step, message, help));
    }
    Ok(given)
}

/// Reads one `given` line.
fn give(
    part: ast::Given<'_>,
    given: &mut Given,
    last: &mut Last,
    bounds: &Bounds<'_>,
    context: &mut Context<'_>,
) -> Result<()> {
    use KeypointShape::{Box, Mask, Point, Points};
    let name = part.name();
    let text = name.text().to_owned();
    match name.text() {
        "last.pick" => last[0] = Some(pixel(single(part, context)?, part, context)?),
        "last.place" => last[1] = Some(pixel(single(part, context)?, part, context)?),
        "step" => {
            let value = single(part, context)?;
            given.step = read_whole(value, &STEP, context)? as u32;
            if let Some(horizon) = bounds.horizon.filter(|most| given.step > *most) {
                let message = format!("the task has at most {horizon} steps");
                return Err(context.fault(Code::OutOfRange, value.span(), message));
            }
        }
        _ => match context.names.get(name.text())? {
            Some(Meaning::Text { .. }) => {
                let text_given = part
                    .text()
                    .ok_or_else(|| expected(part, "a text in quotes", context))?;
                given.texts.push((text, plain(text_given, context)?));
            }
            Some(Meaning::Keypoint {
                shape: Some(Points),
                ..
            }) => {
                let keypoint = bounds.keypoints.iter().find(|it| it.name == text);
                let most = keypoint.and_then(|it| it.extractor.most_points(bounds.keypoints));
                let places = part.values().map(|value| value.span());
                let most = most.map_or(usize::MAX, |most| most as usize);
                context.at_most(most, places, &format!("`{text}`"), "points")?;
                given.points.push((text, points(part, context)?));
            }
            Some(Meaning::Keypoint {
                shape: Some(Point), ..
            }) => {
                let point = shown(single(part, context)?, part, context)?;
                given.points.push((text, vec![point]));
            }
            Some(Meaning::Keypoint {
                shape: Some(Mask | Box),
                ..
            }) => given.regions.push((text, rectangle(part, context)?)),
            _ => {
                let mut candidates = context.names.that(|meaning| {
                    matches!(meaning, Meaning::Keypoint { .. } | Meaning::Text { .. })
                });
                candidates.extend(GIVEN.iter().map(|word| word.name));
                return Err(context.unknown("value to give", name, candidates));
            }
        },
    }
    Ok(())
}

/// Reports a given value of the wrong kind.
fn expected(part: ast::Given<'_>, what: &str, context: &mut Context<'_>) -> Reported {
    let name = part.name();
    let text = part.text().map(|text| text.span());
    let value = || part.values().next().map(|value| value.span());
    let span = text.or_else(value).unwrap_or(name.span());
    let found = context.written(span);
    let message = format!("expected {what} for `{}`, found `{found}`", name.text());
    context.fault(Code::WrongForm, span, message)
}

fn single<'a>(part: ast::Given<'a>, context: &mut Context<'_>) -> Result<Expr<'a>> {
    let mut values = part.values();
    match (part.text(), values.next(), values.next()) {
        (None, Some(value), None) => Ok(value),
        _ => Err(expected(part, "one value", context)),
    }
}

fn pixel(value: Expr<'_>, part: ast::Given<'_>, context: &mut Context<'_>) -> Result<PixelPoint> {
    match value {
        Expr::Pair(pair) => expressions::pixel(pair.parts(), context),
        _ => Err(expected(part, "a pixel such as `(40px, 52px)`", context)),
    }
}

/// Reads a pixel of the picture.
fn shown(value: Expr<'_>, part: ast::Given<'_>, context: &mut Context<'_>) -> Result<PixelPoint> {
    match value {
        Expr::Pair(_) => expressions::pixel_in_picture(value, context),
        _ => pixel(value, part, context),
    }
}

fn points(part: ast::Given<'_>, context: &mut Context<'_>) -> Result<Vec<PixelPoint>> {
    if part.text().is_some() {
        let what = "pixels such as `(40px, 52px), (180px, 52px)`";
        return Err(expected(part, what, context));
    }
    every(part.values().map(|value| shown(value, part, context)))
}

/// Reads `(40px, 52px) to (180px, 170px)`.
fn rectangle(part: ast::Given<'_>, context: &mut Context<'_>) -> Result<[PixelPoint; 2]> {
    let Expr::Range(corners) = single(part, context)? else {
        let what = "a rectangle such as `(40px, 52px) to (180px, 170px)`";
        return Err(expected(part, what, context));
    };
    let low = shown(corners.low(), part, context);
    let high = shown(corners.high(), part, context);
    Ok([low?, high?])
}

// ---- expect --------------------------------------------------------------------------------------

/// Reads what a test expects. In a base without stages, not everything can be checked.
fn expect(
    line: ast::Expect<'_>,
    stage: Option<&Stage>,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Result<Expect> {
    let what = context.word("expectation", line.what(), EXPECTATIONS)?;
    let name = stage.map_or("", |stage| &stage.name);
    let message = match (what, stage.map(|stage| &stage.read)) {
        ("malformed", _) => return Ok(Expect::Malformed),
        ("text", Some(Read::Action)) => format!("the stage `{name}` reads the action"),
        ("text", _) => match line.text() {
            Some(text) => return plain(text, context).map(|text| Expect::Text { text }),
            None => "the line does not state the expected text".to_owned(),
        },
        (_, Some(Read::Text { .. })) => format!("the stage `{name}` reads a text"),
        ("accept", _) => return Ok(Expect::Accept),
        _ => match line.check() {
            Some(check) => return reject(check, merged, context),
            None => "the line does not state the expected check".to_owned(),
        },
    };
    let help = "for an action write `accept`, `reject(CHECK)` or `malformed`; for a text, `text \"…\"` or `malformed`";
    Err(context.refuse(Code::TestIncomplete, line.span(), message, help))
}

fn reject(check: Name<'_>, merged: &Merged<'_>, context: &mut Context<'_>) -> Result<Expect> {
    let known = || merged.checks.names().chain([OFFERED]);
    if !known().any(|known| known == check.text()) {
        return Err(context.unknown("check", check, known()));
    }
    Ok(Expect::Reject {
        check: check.text().to_owned(),
    })
}

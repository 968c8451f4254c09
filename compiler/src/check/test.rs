//! `test "…" { given NAME = … reply "…" expect … }`: an answer and its expected verdict, in a task or one of its variants.

use super::context::{Context, Declared};
use super::examples::plain;
use super::expressions;
use super::names::Meaning;
use super::quantity::read_whole;
use super::stage::{Prompts, number_of};
use crate::diag::{Code, Diagnostic, Reported, every};
use crate::lang::test::{EXPECTATIONS, GIVEN, STEP};
use crate::merge::{Merged, declared_twice, once, repeated};
use fab_grammar::ast::{self, Body, Expr, Name, Reply};
use fab_program::verify::OFFERED;
use fab_program::{Expect, Given, Keypoint, KeypointShape, PixelPoint, Read, Stage, Test};
use std::collections::BTreeMap;

/// The most tests of a task.
const MAX_TESTS: usize = 1000;

/// The most points that a test gives for one keypoint.
const MAX_POINTS: usize = 1000;

/// What bounds the values that a test may give.
pub(crate) struct Bounds<'p> {
    /// Those of the task; none if one has an error.
    pub keypoints: &'p [Keypoint],
    /// The most steps; `None` in a base, or if it has an error.
    pub horizon: Option<u32>,
}

/// Builds the tests of a task, or those that a variant states itself.
pub(crate) fn check<'a>(
    merged: &Merged<'a>,
    prompts: &Prompts,
    bounds: &Bounds<'_>,
    context: &mut Context<'a, '_>,
) -> Vec<Result<Test, Reported>> {
    // Tests are not inherited, and neither are those of an inherited variant.
    let task = merged.task.body().span();
    let body = merged.own_body().filter(|body| task.contains(body.span()));
    let tests = || body.into_iter().flat_map(Body::tests);
    let beyond = tests().nth(MAX_TESTS).map(|test| test.head_span());
    let within = context.bounded(beyond, || format!("a task has at most {MAX_TESTS} tests"));
    if let Err(reported) = within {
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
fn one<'a>(
    test: ast::Test<'a>,
    merged: &Merged<'a>,
    prompts: &Prompts,
    bounds: &Bounds<'_>,
    context: &mut Context<'a, '_>,
) -> Declared<Test> {
    let reply = once(test.replies(), "reply", Reply::span, context.report);
    let expect = once(test.expect(), "expect", ast::Expect::span, context.report);
    let name = required(test.name(), "a name in quotes", test, context);
    let alone = reply.alone.and(expect.alone);
    let reply = required(reply.first, "`reply`", test, context);
    let expect = required(expect.first, "`expect`", test, context);

    let name = name.and_then(|text| match plain(text, context)? {
        name if name.trim().is_empty() => Err(context.fault(
            Code::TestIncomplete,
            text.span(),
            "the test's name is empty",
        )),
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
    context: &mut Context<'_, '_>,
) -> Result<T, Reported> {
    part.ok_or_else(|| {
        let span = test.head_span();
        let message = format!("the test lacks {what}");
        let diagnostic = Diagnostic::new(Code::TestIncomplete, span, message);
        let help = "write `test \"what it shows\" { given NAME = … reply \"…\" expect accept }`";
        context.error(diagnostic.help(help))
    })
}

/// Finds the stage that the reply answers, by default the last one; `None` in a base without stages.
fn answered<'p>(
    reply: Reply<'_>,
    merged: &Merged<'_>,
    prompts: &'p Prompts,
    context: &mut Context<'_, '_>,
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

fn given<'a>(
    test: ast::Test<'a>,
    bounds: &Bounds<'_>,
    context: &mut Context<'a, '_>,
) -> Result<Given, Reported> {
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
            let diagnostic = Diagnostic::new(Code::TestIncomplete, test.head_span(), message);
            let help = "give both `last.pick` and `last.place`";
            return Err(context.error(diagnostic.help(help)));
        }
    };
    if let (Some(step), Some(_), 1) = (seen.get("step"), given.last, given.step) {
        let message = "no action comes before the first step";
        let diagnostic = Diagnostic::new(Code::OutOfRange, *step, message);
        let help = "give a later step, or leave `last.pick` and `last.place` out";
        return Err(context.error(diagnostic.help(help)));
    }
    Ok(given)
}

/// Reads one `given` line.
fn give<'a>(
    part: ast::Given<'a>,
    given: &mut Given,
    last: &mut Last,
    bounds: &Bounds<'_>,
    context: &mut Context<'a, '_>,
) -> Result<(), Reported> {
    use KeypointShape::{Box, Mask, Outline, Point, Points};
    let name = part.name();
    let text = name.text().to_owned();
    match (name.text(), context.names.get(name.text())) {
        ("last.pick", _) => last[0] = Some(pixel(single(part, context)?, part, context)?),
        ("last.place", _) => last[1] = Some(pixel(single(part, context)?, part, context)?),
        ("step", _) => {
            let value = single(part, context)?;
            given.step = read_whole(value, &STEP, context)? as u32;
            let horizon = bounds.horizon.unwrap_or(given.step);
            context.bounded((given.step > horizon).then(|| value.span()), || {
                format!("the task has at most {horizon} steps")
            })?;
        }
        (_, Some(Meaning::DuplicateNames(reported))) => return Err(reported),
        (_, Some(Meaning::Text { .. })) => {
            let text_given = part
                .text()
                .ok_or_else(|| expected(part, "a text in quotes", context))?;
            given.texts.push((text, plain(text_given, context)?));
        }
        (_, Some(Meaning::Keypoint(Some(Points)))) => {
            let keypoint = bounds.keypoints.iter().find(|it| it.name == text);
            let most = keypoint.and_then(|it| it.extractor.most_points(bounds.keypoints));
            if let Some(most) = most {
                let beyond = part.values().nth(most as usize).map(|value| value.span());
                context.bounded(beyond, || format!("`{text}` has at most {most} points"))?;
            }
            given.points.push((text, points(part, context)?));
        }
        (_, Some(Meaning::Keypoint(Some(Point)))) => {
            given
                .points
                .push((text, vec![shown(single(part, context)?, part, context)?]));
        }
        (_, Some(Meaning::Keypoint(Some(Mask | Box)))) => {
            given.regions.push((text, rectangle(part, context)?));
        }
        (_, Some(Meaning::Keypoint(Some(Outline)))) => {
            let message = "no check or text depends on an outline";
            return Err(context.fault(Code::WrongKindOfName, name.span(), message));
        }
        (_, Some(Meaning::Keypoint(None))) => {
            return Err(expressions::wrong_shape(name, None, "a keypoint", context));
        }
        (_, Some(Meaning::Field) | None) => {
            let mut candidates = context.names.that(|meaning| meaning != Meaning::Field);
            candidates.extend(GIVEN.iter().map(|word| word.name));
            return Err(context.unknown("value to give", name, candidates));
        }
    }
    Ok(())
}

/// Reports a given value of the wrong kind.
fn expected(part: ast::Given<'_>, what: &str, context: &mut Context<'_, '_>) -> Reported {
    let name = part.name();
    let text = part.text().map(|text| text.span());
    let value = || part.values().next().map(|value| value.span());
    let span = text.or_else(value).unwrap_or(name.span());
    let found = context.written(span);
    let message = format!("expected {what} for `{}`, found `{found}`", name.text());
    context.fault(Code::WrongForm, span, message)
}

fn single<'a>(part: ast::Given<'a>, context: &mut Context<'a, '_>) -> Result<Expr<'a>, Reported> {
    let mut values = part.values();
    match (part.text(), values.next(), values.next()) {
        (None, Some(value), None) => Ok(value),
        _ => Err(expected(part, "one value", context)),
    }
}

fn pixel<'a>(
    value: Expr<'a>,
    part: ast::Given<'a>,
    context: &mut Context<'a, '_>,
) -> Result<PixelPoint, Reported> {
    match value {
        Expr::Pair(pair) => expressions::pixel(pair.parts(), context),
        _ => Err(expected(part, "a pixel such as `(40px, 52px)`", context)),
    }
}

/// Reads a pixel of the picture.
fn shown<'a>(
    value: Expr<'a>,
    part: ast::Given<'a>,
    context: &mut Context<'a, '_>,
) -> Result<PixelPoint, Reported> {
    match value {
        Expr::Pair(_) => expressions::pixel_in_picture(value, context),
        _ => pixel(value, part, context),
    }
}

fn points<'a>(
    part: ast::Given<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<PixelPoint>, Reported> {
    if !(1..=MAX_POINTS).contains(&part.values().count()) {
        let what = "pixels such as `(40px, 52px), (180px, 52px)`";
        return Err(expected(part, what, context));
    }
    every(part.values().map(|value| shown(value, part, context)))
}

/// Reads `(40px, 52px) to (180px, 170px)`.
fn rectangle<'a>(
    part: ast::Given<'a>,
    context: &mut Context<'a, '_>,
) -> Result<[PixelPoint; 2], Reported> {
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
fn expect<'a>(
    line: ast::Expect<'a>,
    stage: Option<&Stage>,
    merged: &Merged<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Expect, Reported> {
    let reads = |stage: &&Stage, action: bool| (stage.read == Read::Action) == action;
    let reads_action = stage.filter(|stage| reads(stage, true));
    let reads_text = stage.filter(|stage| reads(stage, false));
    match context.word("expectation", line.what(), EXPECTATIONS)? {
        "malformed" => Ok(Expect::Malformed),
        "text" if let Some(stage) = reads_action => Err(mismatch(
            line,
            &format!("the stage `{}` reads the action", stage.name),
            context,
        )),
        "text" => match line.text() {
            Some(text) => plain(text, context).map(|text| Expect::Text { text }),
            None => Err(mismatch(
                line,
                "the line does not state the expected text",
                context,
            )),
        },
        _ if let Some(stage) = reads_text => Err(mismatch(
            line,
            &format!("the stage `{}` reads a text", stage.name),
            context,
        )),
        "accept" => Ok(Expect::Accept),
        _ => match line.check() {
            Some(check) => reject(check, merged, context),
            None => Err(mismatch(
                line,
                "the line does not state the expected check",
                context,
            )),
        },
    }
}

fn mismatch(line: ast::Expect<'_>, message: &str, context: &mut Context<'_, '_>) -> Reported {
    let diagnostic = Diagnostic::new(Code::TestIncomplete, line.span(), message);
    context.error(diagnostic.help(
        "for an action write `accept`, `reject(CHECK)` or `malformed`; for a text, `text \"…\"` or `malformed`",
    ))
}

fn reject(
    check: Name<'_>,
    merged: &Merged<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Expect, Reported> {
    let mut known = merged.checks.names().chain([OFFERED]);
    if known.any(|known| known == check.text()) {
        return Ok(Expect::Reject {
            check: check.text().to_owned(),
        });
    }
    Err(context.unknown("check", check, merged.checks.names().chain([OFFERED])))
}

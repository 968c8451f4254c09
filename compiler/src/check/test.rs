//! `test "…" { given NAME = … reply "…" expect … }`: an answer and its expected verdict, in a task or one of its variants.

use super::context::{Context, Declared, Result};
use super::examples::plain;
use super::expressions::{pixel, pixel_in_picture};
use super::names::Meaning;
use super::quantity::read_whole;
use crate::diag::{Code, every};
use crate::lang::test::{EXPECTATIONS, GIVEN, STEP};
use crate::merge::{Merged, declared_twice, once, repeated};
use fab_grammar::ast::{self, Body, Expr, Name, Reply};
use fab_program::verify::OFFERED;
use fab_program::{Expect, Given, KeypointShape, PixelPoint, Read, Stage, Test};
use std::collections::BTreeMap;

/// Builds the tests of a task, or those that a variant states itself.
pub(crate) fn check(merged: &Merged<'_>, context: &mut Context<'_>) -> Result<Vec<Test>> {
    // Tests are not inherited, and neither are those of an inherited variant.
    let task = merged.task.body().span();
    let body = merged.own_body().filter(|body| task.contains(body.span()));
    let mut seen = BTreeMap::new();
    let tests = body.into_iter().flat_map(Body::tests).map(|test| {
        if let Some(text) = test.name()
            && let Some(name) = text.plain()
            && let Some(first) = seen.insert(name.clone(), text.span())
        {
            let diagnostic = declared_twice("test", &name, first, text.span());
            context.error(diagnostic);
        }
        one(test, merged, context)
    });
    Ok(every(tests)?.into_iter().flatten().collect())
}

/// Builds one test; `None` in a base without a stage that a reply could answer.
fn one(test: ast::Test<'_>, merged: &Merged<'_>, context: &mut Context<'_>) -> Declared<Test> {
    let reply = once(test.replies(), "reply", Reply::span, context.report);
    let expect = once(test.expect(), "expect", ast::Expect::span, context.report);
    let (Some(name), Some(reply), Some(expect)) = (test.name(), reply, expect) else {
        let lines = [
            ("name", test.name().is_some()),
            ("reply", reply.is_some()),
            ("expect", expect.is_some()),
        ];
        let help = "write `test \"what it shows\" { given NAME = … reply \"…\" expect … }`";
        let block = ("the test", test.head_span());
        return Err(context.lacking(Code::TestIncomplete, block, &lines, help));
    };
    let name = plain(name, context).and_then(|text| {
        if text.trim().is_empty() {
            let message = "the test's name is empty";
            return Err(context.fault(Code::TestIncomplete, name.span(), message));
        }
        Ok(text)
    });
    let given = self::given(test, context);
    let answer = plain(reply.text(), context);
    let stage = answered(reply, context)?;
    let asked = stage.as_ref().map(|(_, asked)| asked);
    let expect = self::expect(expect, asked, merged, context);
    let Some((stage, _)) = stage else {
        return Ok(None);
    };
    let (declared_in, line) = context.loaded.place(test.span().file, test.span().start);
    Ok(Some(Test {
        name: name?,
        task: merged.task.name().text().to_owned(),
        variant: merged.variant.as_ref().map(|it| it.name.to_string()),
        given: given?,
        stage,
        reply: answer?,
        expect: expect?,
        declared_in,
        line,
    }))
}

/// Finds the stage that the reply answers, by default the last one; `None` in a base without stages.
fn answered(reply: Reply<'_>, context: &mut Context<'_>) -> Declared<(usize, Stage)> {
    match (reply.stage(), context.stages.0.last()) {
        (Some(name), _) => context.stage(name).map(Some),
        (None, Some((_, last))) => Ok(Some((context.stages.0.len() - 1, last.clone()?))),
        (None, None) => Ok(None),
    }
}

// ---- given ---------------------------------------------------------------------------------------

/// Pick and place of the previous action, where given.
type Last = [Option<PixelPoint>; 2];

fn given(test: ast::Test<'_>, context: &mut Context<'_>) -> Result<Given> {
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
        } else if let Err(reported) = give(part, &mut given, &mut last, context) {
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
    context: &mut Context<'_>,
) -> Result<()> {
    use KeypointShape::{Box, Mask, Point, Points};
    let name = part.name();
    let text = name.text().to_owned();
    match name.text() {
        "last.pick" => last[0] = Some(pixel(single(part, context)?, context)?),
        "last.place" => last[1] = Some(pixel(single(part, context)?, context)?),
        "step" => {
            let value = single(part, context)?;
            given.step = read_whole(value, &STEP, context)? as u32;
            if let Ok(Some(horizon)) = context.horizon
                && given.step > horizon
            {
                let message = format!("the task has at most {horizon} steps");
                return Err(context.fault(Code::OutOfRange, value.span(), message));
            }
        }
        _ => match context.names.get(name.text())? {
            Some(Meaning::Text(_)) => match part.text() {
                Some(given_text) => given.texts.push((text, plain(given_text, context)?)),
                None => {
                    let message = format!("`{text}` is a text");
                    let help = "write it in quotes";
                    return Err(context.refuse(Code::WrongForm, part.span(), message, help));
                }
            },
            Some(Meaning::Keypoint(Some(shape @ (Point | Points)), _)) => {
                let keypoints = context.keypoints.as_deref().unwrap_or_default();
                let keypoint = keypoints.iter().find(|it| it.name == text);
                let most = keypoint.and_then(|it| it.extractor.most_points(keypoints));
                let most = if shape == Point { Some(1) } else { most };
                let most = most.map_or(usize::MAX, |most| most as usize);
                let values = values(part, most, context)?.into_iter();
                let points = every(values.map(|value| pixel_in_picture(value, context)))?;
                given.points.push((text, points));
            }
            Some(Meaning::Keypoint(Some(Mask | Box), _)) => {
                given.regions.push((text, rectangle(part, context)?))
            }
            _ => {
                let mut candidates = context
                    .names
                    .that(|meaning| matches!(meaning, Meaning::Keypoint(..) | Meaning::Text(_)));
                candidates.extend(GIVEN.iter().map(|word| word.name));
                return Err(context.unknown("value to give", name, candidates));
            }
        },
    }
    Ok(())
}

/// Returns the values of a line, at most so many.
fn values<'a>(
    part: ast::Given<'a>,
    most: usize,
    context: &mut Context<'_>,
) -> Result<Vec<Expr<'a>>> {
    let name = part.name().text();
    if let Some(text) = part.text() {
        let message = format!("`{name}` is no text");
        let help = "write pixels such as `(40px, 52px)`, without quotes";
        return Err(context.refuse(Code::WrongForm, text.span(), message, help));
    }
    let places = part.values().map(|value| value.span());
    let parts = if most == 1 { "point" } else { "points" };
    context.at_most(most, places, &format!("`{name}`"), parts)?;
    Ok(part.values().collect())
}

fn single<'a>(part: ast::Given<'a>, context: &mut Context<'_>) -> Result<Expr<'a>> {
    values(part, 1, context).map(|values| values[0])
}

/// Reads `(40px, 52px) to (180px, 170px)`.
fn rectangle(part: ast::Given<'_>, context: &mut Context<'_>) -> Result<[PixelPoint; 2]> {
    let value = single(part, context)?;
    let Expr::Range(corners) = value else {
        let help = Some("state two corners, such as `(40px, 52px) to (180px, 170px)`");
        return Err(context.wrong(Code::WrongForm, value, "a rectangle", help));
    };
    let low = pixel_in_picture(corners.low(), context);
    let high = pixel_in_picture(corners.high(), context);
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

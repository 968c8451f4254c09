//! `test "…" { given … reply "…" expect … }`: what is to come of an answer.

use super::Context;
use super::examples::literal;
use super::names::Meaning;
use super::quantity::{Measure, Wanted, read_whole};
use super::subgoals::pixel;
use crate::ast::{self, Expr, ExprKind, Ident};
use crate::diag::{Code, Diagnostic, among, nearest};
use crate::merge::{Merged, once};
use fab_program::verify::OFFERED;
use fab_program::{Expect, Given, KeypointShape, PixelPoint, Read, Stage, Test};

/// The most tests of a task, and points that one gives.
const MAX_TESTS: usize = 1000;
const MAX_POINTS: usize = 1000;

const STEP: Wanted = Wanted {
    measure: Measure::Number,
    range: 1.0..=100.0,
    range_words: "a step from `1` to `100`",
};

/// Builds the tests of a task; what is wrong is left out.
pub(crate) fn check(merged: &Merged<'_>, stages: &[Stage], context: &mut Context<'_>) -> Vec<Test> {
    let tests = &merged.task.tests;
    if let Some(beyond) = tests.get(MAX_TESTS) {
        let message = format!("a task has at most {MAX_TESTS} tests");
        context.push(Diagnostic::new(Code::OutOfRange, beyond.span, message));
        return Vec::new();
    }
    tests
        .iter()
        .filter_map(|test| one(test, merged, stages, context))
        .collect()
}

fn one(
    test: &ast::Test,
    merged: &Merged<'_>,
    stages: &[Stage],
    context: &mut Context<'_>,
) -> Option<Test> {
    let reply = once(&test.replies, "`reply`", |part| part.span, context.report);
    let expect = once(&test.expect, "`expect`", |part| part.span, context.report);
    let lacks = [
        ("a name in quotes", test.name.is_some()),
        ("`reply`", reply.is_some()),
        ("`expect`", expect.is_some()),
    ];
    for (part, is_there) in lacks {
        if !is_there && !test.has_faults {
            let message = format!("the test lacks {part}");
            context.push(
                Diagnostic::new(Code::TestIncomplete, test.span, message)
                    .help("write `test \"what it shows\" { given … reply \"…\" expect accept }`"),
            );
        }
    }
    let mut given = Given {
        step: 1,
        ..Given::default()
    };
    let mut last = [None, None];
    let mut is_right = true;
    for part in &test.given {
        is_right &= self::given(part, &mut given, &mut last, context).is_some();
    }
    given.last = match last {
        [Some(pick), Some(place)] => Some([pick, place]),
        [None, None] => None,
        _ => {
            let message = "the action before has a pick and a place";
            context.push(
                Diagnostic::new(Code::TestIncomplete, test.span, message)
                    .help("give both `last.pick` and `last.place`"),
            );
            return None;
        }
    };
    let name = literal(test.name.as_ref()?, context);
    let (reply, expect) = (reply?, expect?);
    let stage = match &reply.stage {
        None => stages.len().checked_sub(1),
        Some(name) => {
            let found = stages.iter().position(|stage| stage.name == name.text);
            if found.is_none() && merged.stages.get(&name.text).is_none() {
                let names = merged.stages.iter().map(|stage| stage.name.text.as_str());
                context.unknown("stage", name, names);
            }
            found
        }
    }?;
    let said = literal(&reply.text, context);
    let expect = self::expect(expect, &stages[stage], merged, context);
    let source = context.loaded.sources.get(test.span.file);
    let test = Test {
        name: name?,
        task: merged.task.name.text.clone(),
        given,
        stage,
        reply: said?,
        expect: expect?,
        declared_in: context.loaded.portable_names[test.span.file.0].clone(),
        line: source.line_and_column(test.span.start).0 as u32,
    };
    is_right.then_some(test)
}

fn given(
    part: &ast::Given,
    given: &mut Given,
    last: &mut [Option<PixelPoint>; 2],
    context: &mut Context<'_>,
) -> Option<()> {
    let name = &part.name;
    match name.text.as_str() {
        "last.pick" => last[0] = Some(point(part, context)?),
        "last.place" => last[1] = Some(point(part, context)?),
        "step" => {
            let value = single(part, context)?;
            given.step = read_whole(value, &STEP, context)?;
        }
        _ => match context.names.get(&name.text) {
            Some(Meaning::Text { .. }) => {
                let Some(text) = &part.text else {
                    expected(part, "a text in quotes", context);
                    return None;
                };
                given
                    .texts
                    .push((name.text.clone(), literal(text, context)?));
            }
            Some(Meaning::Keypoint(Some(KeypointShape::Points | KeypointShape::Point))) => {
                given
                    .points
                    .push((name.text.clone(), points(part, context)?));
            }
            Some(Meaning::Keypoint(Some(KeypointShape::Mask | KeypointShape::Box))) => {
                given
                    .regions
                    .push((name.text.clone(), rectangle(part, context)?));
            }
            // Its own declaration is wrong and reported there.
            Some(Meaning::Keypoint(None)) => return None,
            Some(Meaning::Keypoint(Some(KeypointShape::Outline))) => {
                let message = "no check and no text depends on an outline";
                context.push(Diagnostic::new(Code::WrongKindOfName, name.span, message));
                return None;
            }
            Some(Meaning::Field) | None => {
                let mut candidates = context.names.that(|meaning| meaning != Meaning::Field);
                candidates.extend(["last.pick", "last.place", "step"]);
                context.unknown("value to give", name, candidates);
                return None;
            }
        },
    }
    Some(())
}

fn expected(part: &ast::Given, what: &str, context: &mut Context<'_>) {
    let span = match (&part.text, part.values.first()) {
        (Some(text), _) => text.span,
        (None, Some(value)) => value.span,
        (None, None) => part.name.span,
    };
    let found = context.written(span);
    let message = format!("expected {what} for `{}`, found `{found}`", part.name.text);
    context.push(Diagnostic::new(Code::WrongForm, span, message));
}

fn single<'p>(part: &'p ast::Given, context: &mut Context<'_>) -> Option<&'p Expr> {
    match part.values.as_slice() {
        [value] if part.text.is_none() => Some(value),
        _ => {
            expected(part, "one value", context);
            None
        }
    }
}

fn point(part: &ast::Given, context: &mut Context<'_>) -> Option<PixelPoint> {
    let value = single(part, context)?;
    pixel_of(value, part, context)
}

fn pixel_of(value: &Expr, part: &ast::Given, context: &mut Context<'_>) -> Option<PixelPoint> {
    match &value.kind {
        ExprKind::Pair(pair) => pixel(pair, context),
        _ => {
            expected(part, "a pixel such as `(40px, 52px)`", context);
            None
        }
    }
}

fn points(part: &ast::Given, context: &mut Context<'_>) -> Option<Vec<PixelPoint>> {
    if part.values.is_empty() || part.values.len() > MAX_POINTS {
        expected(
            part,
            "pixels such as `(40px, 52px), (180px, 52px)`",
            context,
        );
        return None;
    }
    let points: Vec<Option<PixelPoint>> = part
        .values
        .iter()
        .map(|value| pixel_of(value, part, context))
        .collect();
    points.into_iter().collect()
}

/// Reads `(40px, 52px) to (180px, 170px)`.
fn rectangle(part: &ast::Given, context: &mut Context<'_>) -> Option<[PixelPoint; 2]> {
    const FORM: &str = "a rectangle such as `(40px, 52px) to (180px, 170px)`";
    let value = single(part, context)?;
    let ExprKind::Range { low, high } = &value.kind else {
        expected(part, FORM, context);
        return None;
    };
    let low = pixel_of(low, part, context);
    let high = pixel_of(high, part, context);
    Some([low?, high?])
}

fn expect(
    part: &ast::Expect,
    stage: &Stage,
    merged: &Merged<'_>,
    context: &mut Context<'_>,
) -> Option<Expect> {
    let what = part.what.text.as_str();
    let known = ["accept", "reject", "malformed", "text"];
    let reads_action = matches!(stage.read, Read::Action);
    match what {
        "accept" | "reject" if !reads_action => mismatch(
            part,
            &format!("the stage `{}` reads a text", stage.name),
            context,
        ),
        "text" if reads_action => mismatch(
            part,
            &format!("the stage `{}` reads the action", stage.name),
            context,
        ),
        "accept" => Some(Expect::Accept),
        "malformed" => Some(Expect::Malformed),
        "reject" => {
            let Some(check) = &part.check else {
                return mismatch(part, "it is not said which check refuses", context);
            };
            self::check_name(check, merged, context)
        }
        "text" => {
            let Some(text) = &part.text else {
                return mismatch(part, "it is not said which text is read", context);
            };
            literal(text, context).map(|text| Expect::Text { text })
        }
        _ => {
            context.unknown("expectation", &part.what, known);
            None
        }
    }
}

fn mismatch(part: &ast::Expect, message: &str, context: &mut Context<'_>) -> Option<Expect> {
    context.push(
        Diagnostic::new(Code::TestIncomplete, part.span, message).help(
            "an action is expected as `accept`, `reject(CHECK)` or `malformed`, a text as `text \"…\"` or `malformed`",
        ),
    );
    None
}

fn check_name(check: &Ident, merged: &Merged<'_>, context: &mut Context<'_>) -> Option<Expect> {
    let known = || merged.check_names().chain([OFFERED]);
    if known().any(|known| known == check.text) {
        return Some(Expect::Reject {
            check: check.text.clone(),
        });
    }
    if !context.names.may_be_declared(&check.text) {
        let message = format!("there is no check `{}`", check.text);
        let diagnostic = Diagnostic::new(Code::UnknownName, check.span, message);
        context.push(match nearest(&check.text, known()) {
            Some(meant) => diagnostic.meant(check.span, meant),
            None => diagnostic.help(format!("there is {}", among(known()))),
        });
    }
    None
}

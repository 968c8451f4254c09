//! Warns of checks that can never pass or never fail, and of components whose condition never or always holds.
//!
//! In: a task's program and those of its variants. Every step and every count is tried, and what a point measures against
//! itself is known. Everything else may hold or not. A condition that a variant needs is in order.

use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use fab_grammar::Span;
use fab_program::exact::written;
use fab_program::measures::{Length, Number, PointMeasure};
use fab_program::{Condition, Program};

/// The most combinations of numbers that are tried for one condition.
const MAX_CASES: usize = 10_000;

/// A condition, and whether it holds.
type Assumed<'p> = (&'p Condition, bool);

/// Returns a warning for each condition of a task whose result is certain in the task and in its variants.
///
/// - `programs`: the task's, and then those of its variants.
pub(super) fn check(programs: &[Program], merged: &Merged<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let Some(program) = programs.first() else {
        return found;
    };
    let never = |assumed: &[Assumed<'_>]| programs.iter().all(|it| is_impossible(assumed, it));
    for check in &program.verify.checks {
        let Some(part) = merged.checks.get(&check.name) else {
            continue;
        };
        let name = format!("the check `{}`", check.name);
        let when = check.when.as_ref().map(|when| (when, true));
        let applies: Vec<Assumed<'_>> = when.into_iter().collect();
        let result = |passes| [&applies[..], &[(&check.holds, passes)]].concat();
        if let (Some((when, _)), Some(expr)) = (when, part.when())
            && never(&applies)
        {
            let help = "correct the condition after `when`, or remove the check";
            found.push(warning(
                format!("{name} never applies"),
                when,
                expr.span(),
                help,
                program,
            ));
        } else if let Some(expr) = part.condition() {
            let (what, help) = if never(&result(true)) {
                (
                    "pass",
                    "every answer would be refused; correct the condition, or remove the check",
                )
            } else if never(&result(false)) {
                (
                    "fail",
                    "no answer would be refused; correct the condition, or remove the check",
                )
            } else {
                continue;
            };
            let message = format!("{name} can never {what}");
            found.push(warning(message, &check.holds, expr.span(), help, program));
        }
    }
    for template in &program.templates {
        let component = merged.components.get(&template.name);
        let (Some(when), Some(expr)) = (&template.when, component.and_then(|it| it.when())) else {
            continue;
        };
        let (often, help) = if never(&[(when, true)]) {
            ("never", "correct the condition, or remove the component")
        } else if never(&[(when, false)]) {
            (
                "always",
                "correct the condition, or remove it together with `when`",
            )
        } else {
            continue;
        };
        let message = format!("the component `{}` is {often} said", template.name);
        found.push(warning(message, when, expr.span(), help, program));
    }
    found
}

fn warning(
    what: String,
    condition: &Condition,
    span: Span,
    help: &str,
    program: &Program,
) -> Diagnostic {
    let message = match reason(condition, program) {
        Some(reason) => format!("{what}: {reason}"),
        None => what,
    };
    Diagnostic::new(Code::CertainCondition, span, message).help(help)
}

/// Says why the first part of a condition that is certain by itself is so: "`step` is 1 to 2".
fn reason(condition: &Condition, program: &Program) -> Option<String> {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().find_map(|part| reason(part, program))
        }
        Condition::Not { of } => reason(of, program),
        part if [true, false]
            .iter()
            .all(|holds| !is_impossible(&[(part, *holds)], program)) =>
        {
            None
        }
        Condition::Number { left, .. } => {
            let [least, most] = ends(left, program)?;
            Some(if least == most {
                format!("`{left}` is always {least}")
            } else {
                format!("`{left}` is {least} to {most}")
            })
        }
        Condition::Lengths { left, right, .. } => {
            let measure = [left, right].into_iter().find_map(|side| match side {
                Length::OfPoints(measure) => Some(measure),
                Length::Constant { .. } | Length::Field { .. } => None,
            })?;
            let px = written(to_itself(measure)?.sqrt(), 1);
            Some(format!("`{measure}` is always {px}px"))
        }
        Condition::Angle { a, b, .. } => {
            Some(format!("the angle between `{a}` and `{b}` is always 0deg"))
        }
        _ => None,
    }
}

// ---- cases ---------------------------------------------------------------------------------------

/// What some numbers are.
type Case<'p> = Vec<(&'p Number, f64)>;

/// Returns whether conditions can never hold, or fail, together as assumed: no step and no counts allow it.
fn is_impossible(assumed: &[Assumed<'_>], program: &Program) -> bool {
    let mut numbers = Vec::new();
    for (condition, _) in assumed {
        add_numbers(condition, &mut numbers);
    }
    let mut cases: Vec<Case<'_>> = vec![Vec::new()];
    for number in numbers {
        let Some([least, most]) = ends(number, program) else {
            continue;
        };
        if cases.len().saturating_mul((most - least) as usize) > MAX_CASES {
            return false;
        }
        cases = (least..=most)
            .map(|value| (number, f64::from(value)))
            .flat_map(|value| cases.iter().map(move |case| [&case[..], &[value]].concat()))
            .collect();
    }
    let may_be = |case: &Case<'_>| {
        assumed
            .iter()
            .all(|(condition, holds)| decide(condition, case) != Some(!holds))
    };
    !cases.iter().any(may_be)
}

/// Collects the numbers that decide a condition.
fn add_numbers<'p>(condition: &'p Condition, numbers: &mut Vec<&'p Number>) {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().for_each(|part| add_numbers(part, numbers));
        }
        Condition::Not { of } => add_numbers(of, numbers),
        Condition::Number { left: number, .. } if !numbers.contains(&number) => {
            numbers.push(number);
        }
        Condition::Last if !numbers.contains(&&Number::Step) => numbers.push(&Number::Step),
        _ => {}
    }
}

/// Returns the least and the most that a whole number can be; `None` if the picture alone decides.
fn ends(number: &Number, program: &Program) -> Option<[u32; 2]> {
    match number {
        Number::Step => Some([1, program.horizon]),
        // None may be seen, and those out of the arm's reach are left out.
        Number::Count { keypoint } => {
            let extractor = &program.keypoint(keypoint)?.extractor;
            Some([0, extractor.most_points(&program.keypoints)?])
        }
        Number::Coverage { .. } => None,
    }
}

/// Returns whether a condition holds in a case; `None` if that depends on the scene or the answer.
fn decide(condition: &Condition, case: &Case<'_>) -> Option<bool> {
    let value = |number: &Number| {
        case.iter()
            .find(|(it, _)| *it == number)
            .map(|(_, value)| *value)
    };
    match condition {
        Condition::All { of } => all(of.iter().map(|part| decide(part, case))),
        Condition::Any { of } => {
            let fails = of.iter().map(|part| decide(part, case).map(|it| !it));
            all(fails).map(|it| !it)
        }
        Condition::Not { of } => decide(of, case).map(|it| !it),
        Condition::Number { left, is, limit } => Some(is.holds(value(left)?, *limit)),
        Condition::Lengths { left, is, right } => Some(is.holds(square(left)?, square(right)?)),
        Condition::Angle {
            a,
            b,
            is,
            limit_deg,
            ..
        } => (a == b).then(|| is.holds(0.0, *limit_deg)),
        // The first step has no action before it.
        Condition::Last => (value(&Number::Step)? == 1.0).then_some(false),
        Condition::Within { .. } | Condition::Word { .. } | Condition::Unreachable => None,
    }
}

/// Returns whether every part holds.
fn all(parts: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut all = Some(true);
    for part in parts {
        match part {
            Some(true) => {}
            Some(false) => return Some(false),
            None => all = None,
        }
    }
    all
}

/// Returns the square of a length that is the same in every scene: a constant, or how far a point is from itself.
fn square(length: &Length) -> Option<f64> {
    match length {
        Length::Constant { value } => Some(value * value),
        Length::OfPoints(measure) => to_itself(measure),
        Length::Field { .. } => None,
    }
}

/// Returns the square of what a measure is between a point and itself, if it is the same for every point.
fn to_itself(measure: &PointMeasure) -> Option<f64> {
    let [a, b] = measure.points() else {
        return None;
    };
    let [here, there] = [[0.0, 0.0], [7.0, 5.0]].map(|point| measure.square(&[point, point]));
    (a == b && here == there).then_some(here)
}

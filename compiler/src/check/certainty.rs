//! Warns of checks that can never pass or never fail, and of components whose condition never or always holds.
//!
//! In: a task's program and those of its variants. The fewest and the most steps and points are known, and what a point
//! measures against itself. Everything else may hold or not, and each comparison is judged by itself. A condition that a
//! variant needs is in order.

use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use fab_grammar::Span;
use fab_program::measures::{Length, Number};
use fab_program::{Condition, Program};

/// Returns a warning for each condition of a task whose result is certain in the task and in its variants.
///
/// - `programs`: the task's, and then those of its variants.
pub(super) fn check(programs: &[Program], merged: &Merged<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let Some(program) = programs.first() else {
        return found;
    };
    let certain = |condition: &Condition| {
        let result = decide(condition, program)?;
        let mut all = programs.iter().map(|it| decide(condition, it));
        all.all(|it| it == Some(result)).then_some(result)
    };
    let mut warn = |message: String, condition: &Condition, span: Span, help: &str| {
        let message = match reason(condition, program) {
            Some(reason) => format!("{message}: {reason}"),
            None => message,
        };
        found.push(Diagnostic::new(Code::CertainCondition, span, message).help(help));
    };
    for check in &program.verify.checks {
        let Some(part) = merged.checks.get(&check.name) else {
            continue;
        };
        let name = format!("the check `{}`", check.name);
        if let (Some(when), Some(expr)) = (&check.when, part.when())
            && certain(when) == Some(false)
        {
            let help = "correct the condition after `when`, or remove the check";
            warn(format!("{name} never applies"), when, expr.span(), help);
        } else if let (Some(passes), Some(expr)) = (certain(&check.holds), part.condition()) {
            let (what, which) = if passes {
                ("fail", "no")
            } else {
                ("pass", "every")
            };
            let help = format!(
                "{which} answer would be refused; correct the condition, or remove the check"
            );
            let message = format!("{name} can never {what}");
            warn(message, &check.holds, expr.span(), &help);
        }
    }
    for template in &program.templates {
        let component = merged.components.get(&template.name);
        let (Some(when), Some(expr)) = (&template.when, component.and_then(|it| it.when())) else {
            continue;
        };
        let (often, help) = match certain(when) {
            Some(true) => (
                "always",
                "correct the condition, or remove it together with `when`",
            ),
            Some(false) => ("never", "correct the condition, or remove the component"),
            None => continue,
        };
        let message = format!("the component `{}` is {often} said", template.name);
        warn(message, when, expr.span(), help);
    }
    found
}

/// Says why the first part of a condition that is certain by itself is so: "`step` is 1 to 2".
fn reason(condition: &Condition, program: &Program) -> Option<String> {
    match condition {
        Condition::All { of } | Condition::Any { of } => {
            of.iter().find_map(|part| reason(part, program))
        }
        Condition::Not { of } => reason(of, program),
        part if decide(part, program).is_none() => None,
        Condition::Number { left, .. } => Some(match ends(left, program)? {
            [least, most] if least == most => format!("`{left}` is always {least}"),
            [least, most] => format!("`{left}` is {least} to {most}"),
        }),
        _ => None,
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

/// Returns whether a condition holds in every step and for every count; `None` if that depends on the scene or the answer.
fn decide(condition: &Condition, program: &Program) -> Option<bool> {
    match condition {
        Condition::All { of } => all(of.iter().map(|part| decide(part, program))),
        Condition::Any { of } => {
            let fails = of.iter().map(|part| decide(part, program).map(|it| !it));
            all(fails).map(|it| !it)
        }
        Condition::Not { of } => decide(of, program).map(|it| !it),
        Condition::Number { left, is, limit } => {
            // What holds for both ends holds between them.
            let [least, most] = ends(left, program)?.map(|it| is.holds(f64::from(it), *limit));
            (least == most).then_some(least)
        }
        Condition::Lengths { left, is, right } => Some(is.holds(square(left)?, square(right)?)),
        Condition::Angle {
            a,
            b,
            is,
            limit_deg,
            ..
        } => (a == b).then(|| is.holds(0.0, *limit_deg)),
        // The first step has no action before it.
        Condition::Last => (program.horizon == 1).then_some(false),
        Condition::Within { .. } | Condition::Word { .. } | Condition::Unreachable => None,
    }
}

/// Returns whether every part holds.
fn all(parts: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let parts: Vec<Option<bool>> = parts.collect();
    if parts.contains(&Some(false)) {
        return Some(false);
    }
    parts.iter().all(Option::is_some).then_some(true)
}

/// Returns the square of a length that is the same in every scene: a constant, or how far a point is from itself.
fn square(length: &Length) -> Option<f64> {
    match length {
        Length::Constant { value } => Some(value * value),
        Length::OfPoints(measure) => {
            let [a, b] = measure.points() else {
                return None;
            };
            let points = [[0.0, 0.0], [7.0, 5.0]];
            let [here, there] = points.map(|point| measure.square(&[point, point]));
            (a == b && here == there).then_some(here)
        }
        Length::Field { .. } => None,
    }
}

//! What a value or a condition depends on: the action that is judged, the action before it.

use super::Context;
use crate::diag::{Code, Diagnostic};
use crate::source::Span;
use fab_program::{Condition, Heading, Length, Number, Point, Shown};

/// What something depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Uses {
    /// The proposed action.
    pub action: bool,
    /// The action before it.
    pub last: bool,
}

const ACTION: Uses = Uses {
    action: true,
    last: false,
};
const LAST: Uses = Uses {
    action: false,
    last: true,
};

impl Uses {
    fn and(self, other: Uses) -> Uses {
        Uses {
            action: self.action || other.action,
            last: self.last || other.last,
        }
    }

    pub fn of_point(point: &Point) -> Uses {
        match point {
            Point::Action { .. } => ACTION,
            Point::Keypoint { .. } => Uses::default(),
            Point::Last { .. } => LAST,
            Point::Mirror { of, about } => Uses::of_point(of).and(Uses::of_point(about)),
            Point::Carried { .. } => ACTION,
        }
    }

    fn of_length(length: &Length) -> Uses {
        match length {
            Length::Constant { .. } => Uses::default(),
            Length::Distance { a, b } | Length::Chebyshev { a, b } => {
                Uses::of_point(a).and(Uses::of_point(b))
            }
            Length::Field { .. } => ACTION,
        }
    }

    fn of_heading(heading: &Heading) -> Uses {
        match heading {
            Heading::Field { .. } => ACTION,
            Heading::Last { .. } => LAST,
            Heading::FromTo { from, to } => Uses::of_point(from).and(Uses::of_point(to)),
            Heading::Constant { .. } => Uses::default(),
        }
    }

    pub fn of_condition(condition: &Condition) -> Uses {
        match condition {
            Condition::All { of } | Condition::Any { of } => of
                .iter()
                .map(Uses::of_condition)
                .fold(Uses::default(), Uses::and),
            Condition::Not { of } => Uses::of_condition(of),
            Condition::Lengths { left, right, .. } => {
                Uses::of_length(left).and(Uses::of_length(right))
            }
            Condition::Angle { a, b, .. } => Uses::of_heading(a).and(Uses::of_heading(b)),
            Condition::Number { left, .. } => match left {
                Number::Count { .. } | Number::Step | Number::Coverage { .. } => Uses::default(),
            },
            Condition::Word { .. } => ACTION,
            Condition::Within { point, .. } => Uses::of_point(point),
            // Whether there was an action before is known in the first step too.
            Condition::Last | Condition::Unreachable => Uses::default(),
        }
    }

    pub fn of_shown(shown: &Shown) -> Uses {
        match shown {
            Shown::Text { .. }
            | Shown::Format
            | Shown::PointForm
            | Shown::Unreachable
            | Shown::Points { .. }
            | Shown::Number { .. }
            | Shown::Choices { .. } => Uses::default(),
            Shown::Point { point } => Uses::of_point(point),
            Shown::Length { length, .. } => Uses::of_length(length),
            Shown::Angle { a, b, .. } => Uses::of_heading(a).and(Uses::of_heading(b)),
            Shown::Field { .. } => ACTION,
            Shown::LastField { .. } => LAST,
            Shown::Nearest { to, .. } => Uses::of_heading(to),
        }
    }
}

/// Returns whether there was an action before wherever a condition holds.
pub(crate) fn implies_last(condition: &Condition) -> bool {
    match condition {
        Condition::Last => true,
        Condition::All { of } => of.iter().any(implies_last),
        Condition::Any { of } => !of.is_empty() && of.iter().all(implies_last),
        _ => false,
    }
}

/// Returns whether a condition asks what is out of reach.
pub(crate) fn asks_reach(condition: &Condition) -> bool {
    match condition {
        Condition::Unreachable => true,
        Condition::All { of } | Condition::Any { of } => of.iter().any(asks_reach),
        Condition::Not { of } => asks_reach(of),
        _ => false,
    }
}

/// Reports a dependence on the action before where there may be none.
pub(crate) fn needs_last(span: Span, guarded: &str, context: &mut Context<'_>) {
    let written = context.written(span);
    let message = format!("`{written}` is not known in the first step");
    context.push(
        Diagnostic::new(Code::NeedsLast, span, message)
            .help(format!("write `{guarded} when last`")),
    );
}

/// Reports a dependence on the action where none is proposed yet.
pub(crate) fn needs_action(span: Span, context: &mut Context<'_>) {
    let written = context.written(span);
    let message = format!("`{written}` is known only when an action is proposed");
    context.push(
        Diagnostic::new(Code::NotYetKnown, span, message)
            .help("fields of the action can be written in checks and their messages"),
    );
}

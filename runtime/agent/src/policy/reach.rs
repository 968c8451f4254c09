//! Refuses an accepted answer that the world cannot execute: its points are out of reach, or the manner is.
//!
//! In: a proposal that every other check accepts. Out: the refusal by the check `reachable`, which no task declares,
//! with the message for the model. Unreachable candidates were never offered, so this concerns points derived from a
//! direction and a distance, and picks of any pixel of a mask.

use super::StepView;
use crate::action::Action;
use fab_program::Proposal;
use fab_program::pointing::Notation;
use fab_program::verify::{REACHABLE, Verdict};
use fab_program::{PixelPoint, Program};

/// Returns the refusal, or `None` if the answer can be executed or yields no action at all.
pub(super) fn out_of_reach(
    view: StepView<'_>,
    notation: &Notation,
    proposal: &Proposal,
) -> Option<Verdict> {
    let StepView {
        program,
        reach,
        refuses,
        ..
    } = view;
    let action = Action::lower(program, proposal, view.scene, view.observation)?;
    let refused = |end: &str, at: PixelPoint, why: String, message: String| Verdict::Reject {
        check: REACHABLE.to_owned(),
        values: vec![
            (end.to_owned(), notation.written(at)),
            ("out of reach".to_owned(), why),
        ],
        message,
    };
    let stated = |end: &str, at: PixelPoint, why: String| {
        let message = format!(
            "The {end} point {} cannot be reached: {why}. Choose another one.",
            notation.written(at)
        );
        refused(end, at, why, message)
    };
    if let Some(why) = reach(&action.grip.pick) {
        return Some(stated("pick", action.pick_px, why));
    }
    let Some(why) = reach(&action.grip.place) else {
        let why = refuses(&action.grip.into())?;
        return Some(Verdict::Reject {
            check: REACHABLE.to_owned(),
            values: vec![("refused".to_owned(), why.clone())],
            message: format!("The cloth cannot be moved like this: {why}. Choose other values."),
        });
    };
    let place = action.place_px;
    if proposal.point("place").is_some() {
        return Some(stated("place", place, why));
    }
    let message = format!(
        "From {}, {} in the direction {} leads to {}, which cannot be reached: {why}. Choose another direction, a smaller distance or another point.",
        notation.written(action.pick_px),
        value(program, notation, proposal, "distance"),
        value(program, notation, proposal, "direction"),
        notation.written(place),
    );
    Some(refused("place", place, why, message))
}

fn value(program: &Program, notation: &Notation, proposal: &Proposal, field: &str) -> String {
    let declared = program.field(field).zip(proposal.get(field));
    declared.map_or(String::new(), |(field, value)| notation.value(field, value))
}

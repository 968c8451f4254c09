//! Judges answers and actions: what an answer means, and whether an action may run.
//!
//! Every policy's action is judged here, and again by the rollout before it is executed. An action that passes the
//! task's checks is refused by the check `reachable`, which no task declares, if the world cannot execute it.
//! Unreachable candidates were never offered, so this concerns points derived from a direction and a distance, and picks
//! of any pixel of a mask.

use super::{Accepted, Finding, StepView};
use crate::action::Action;
use crate::scene::Scene;
use fab_picture::observation::Observation;
use fab_program::facts::Facts;
use fab_program::pointing::Notation;
use fab_program::render::RenderError;
use fab_program::reply;
use fab_program::verify::{self, REACHABLE, Strictness, Verdict};
use fab_program::{Program, Proposal, Read, Stage};
use fab_world::{Reach, Refuses};

/// What an action is judged by, besides the facts of a prompt.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    /// The task.
    pub program: &'a Program,
    /// The keypoints found in the observation.
    pub scene: &'a Scene,
    /// The observation behind the scene.
    pub observation: &'a Observation,
    /// Tells what is out of the world's reach.
    pub reach: &'a Reach<'a>,
    /// Tells which motions the world refuses.
    pub refuses: &'a Refuses<'a>,
}

impl<'a> Ground<'a> {
    /// Makes the ground of a world that reaches everything and refuses nothing.
    pub fn of(program: &'a Program, scene: &'a Scene, observation: &'a Observation) -> Ground<'a> {
        Ground {
            program,
            scene,
            observation,
            reach: &fab_world::everywhere,
            refuses: &fab_world::nothing,
        }
    }

    /// Judges an action by the task's checks, and then by the world's reach.
    pub(crate) fn verdict(
        self,
        facts: Facts<'_>,
        proposal: &Proposal,
        strictness: Strictness,
    ) -> Result<Verdict, RenderError> {
        let verdict = verify::verdict(self.program, facts, proposal, strictness)?;
        if verdict != Verdict::Accept {
            return Ok(verdict);
        }
        let unreachable = self.unreachable(&facts.notation(self.program), proposal);
        Ok(unreachable.unwrap_or(Verdict::Accept))
    }

    /// Returns the refusal of an action that the world cannot execute; `None` too if the proposal yields no action.
    fn unreachable(self, notation: &Notation, proposal: &Proposal) -> Option<Verdict> {
        let action = Action::lower(self.program, proposal, self.scene, self.observation)?;
        let ends = [
            ("pick", action.grip.pick, action.pick_px),
            ("place", action.grip.place, action.place_px),
        ];
        let mut beyond = ends
            .into_iter()
            .filter_map(|(end, point, pixel)| Some((end, pixel, (self.reach)(&point)?)));
        let (values, message) = match beyond.next() {
            Some((end, pixel, why)) => {
                let at = notation.written(pixel);
                let message = if proposal.point(end).is_some() {
                    format!("The {end} point {at} cannot be reached: {why}. Choose another one.")
                } else {
                    let value = |name: &str| {
                        let declared = self.program.field(name).zip(proposal.get(name));
                        declared
                            .map_or(String::new(), |(field, value)| notation.value(field, value))
                    };
                    format!(
                        "From {}, {} in the direction {} leads to {at}, which cannot be reached: {why}. Choose another direction, a smaller distance or another point.",
                        notation.written(action.pick_px),
                        value("distance"),
                        value("direction"),
                    )
                };
                let values = vec![(end.to_owned(), at), ("out of reach".to_owned(), why)];
                (values, message)
            }
            None => {
                let why = (self.refuses)(&action.grip.into())?;
                let message =
                    format!("The cloth cannot be moved like this: {why}. Choose other values.");
                (vec![("refused".to_owned(), why)], message)
            }
        };
        Some(Verdict::Reject {
            check: REACHABLE.to_owned(),
            values,
            message,
        })
    }
}

/// Reads an answer and, if it proposes an action, lets the verifier judge it.
pub(super) fn judge(
    view: StepView<'_>,
    stage: &Stage,
    facts: Facts<'_>,
    text: &str,
) -> Result<Finding, RenderError> {
    match &stage.read {
        Read::Text {
            name,
            before,
            after,
        } => {
            let read = reply::read_text(before, after, text);
            Ok(read.map_or_else(Finding::Malformed, |mut read| {
                for stated in &mut read.stated {
                    stated.field.clone_from(name);
                }
                Finding::Text {
                    name: name.clone(),
                    value: read.value,
                    stated: read.stated,
                }
            }))
        }
        Read::Action => {
            let notation = facts.notation(view.program);
            match reply::read_action_in(view.program, &notation, text) {
                Err(error) => Ok(Finding::Malformed(error)),
                Ok(read) => Ok(Finding::Action {
                    verdict: view.verdict(facts, &read.value, Strictness::Full)?,
                    fields: read.value.fields,
                    stated: read.stated,
                }),
            }
        }
    }
}

/// Judges a decision before execution: no policy bypasses the checks.
pub(crate) fn is_accepted(
    view: StepView<'_>,
    proposal: &Proposal,
    accepted: &Accepted,
) -> Result<bool, RenderError> {
    let strictness = if accepted.without.is_empty() {
        Strictness::Full
    } else {
        Strictness::Relaxed
    };
    let verdict = view.verdict(view.facts(), proposal, strictness)?;
    Ok(verdict == Verdict::Accept)
}

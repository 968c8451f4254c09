//! Decides whether a proposed action may run.
//!
//! In: the program's checks, the facts, the action. Out: a [`Verdict`]. Rejection is an answer, not an
//! error: its message goes back to the model. Nothing here talks to a model.

use crate::data::actions::Proposal;
use crate::data::actions::{ActionField, Choices, Value};
use crate::data::program::Program;
use crate::data::uses::Depends;
use crate::data::verify::Check;
use crate::eval::{Eval, Notes};
use crate::facts::Facts;
use crate::pointing::Notation;
use crate::render::{self, RenderError};
use crate::scene::SceneView;
use crate::space;
use serde::{Deserialize, Serialize};

/// The name of the check that every task has: each field is one of the offered values.
pub const OFFERED: &str = "offered";

/// The name of the check that the host adds if some points are unreachable: the points of an accepted action must be
/// reachable. The runtime runs it after the declared checks, because only the runtime knows lengths on the table.
pub const REACHABLE: &str = "reachable";

/// Whether an action may run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// It may.
    Accept,
    /// It may not.
    Reject {
        /// The first check that fails.
        check: String,
        /// The value of each of its sides, in source order.
        values: Vec<(String, String)>,
        /// The message to the model.
        message: String,
    },
}

/// Which of the declared checks are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strictness {
    /// All.
    Full,
    /// All except those that the task names in `then without`.
    Relaxed,
}

/// Judges an action: first whether its fields were offered, then the declared checks in order.
///
/// Fails if a keypoint or a value is missing; the facts of the same program never lack one.
pub fn verdict(
    program: &Program,
    facts: Facts<'_>,
    proposal: &Proposal,
    strictness: Strictness,
) -> Result<Verdict, RenderError> {
    let notation = || facts.judging(proposal).notation(program);
    match unoffered(program, facts.scene, proposal, &notation)? {
        Some(refused) => Ok(refused),
        None => checks(program, facts, proposal, strictness),
    }
}

/// Judges an action by the declared checks alone, whether or not its values are offered.
///
/// Fails like [`verdict`].
pub fn checks(
    program: &Program,
    facts: Facts<'_>,
    proposal: &Proposal,
    strictness: Strictness,
) -> Result<Verdict, RenderError> {
    let facts = facts.judging(proposal);
    let relaxed = |check: &&Check| {
        strictness == Strictness::Relaxed && program.verify.relaxed.contains(&check.name)
    };
    for check in program.verify.checks.iter().filter(|check| !relaxed(check)) {
        if let Some(notes) = failure(program, facts, check)? {
            return Ok(Verdict::Reject {
                check: check.name.clone(),
                values: notes,
                message: render::correction(program, check, facts)?,
            });
        }
    }
    Ok(Verdict::Accept)
}

/// Returns the rejection of the first field whose value the scene does not offer.
///
/// - `notation`: how the message writes points; called only for a rejection.
///
/// Fails if the proposal lacks a field.
pub fn unoffered(
    program: &Program,
    scene: &dyn SceneView,
    proposal: &Proposal,
    notation: &dyn Fn() -> Notation,
) -> Result<Option<Verdict>, RenderError> {
    for field in &program.actions {
        let Some(value) = proposal.get(&field.name) else {
            return Err(RenderError::MissingFact {
                name: field.name.clone(),
            });
        };
        if !space::is_offered(field, value, scene) {
            let choices = space::choices(field, scene);
            return Ok(Some(not_offered(&notation(), field, value, &choices)));
        }
    }
    Ok(None)
}

/// Runs one check; if it fails, returns the values of its sides.
fn failure(
    program: &Program,
    facts: Facts<'_>,
    check: &Check,
) -> Result<Option<Notes>, RenderError> {
    let eval = Eval { program, facts };
    if let Some(when) = &check.when
        && !eval.holds(when, &mut Notes::new())?
    {
        return Ok(None);
    }
    let mut notes = Notes::new();
    let holds = eval.holds(&check.holds, &mut notes)?;
    Ok((!holds).then_some(notes))
}

/// Returns the values that a field offers, in the order in which a prompt lists them, each once.
pub fn offered(program: &Program, scene: &dyn SceneView, field: &str) -> Vec<Value> {
    program
        .field(field)
        .map_or(Vec::new(), |field| space::choices(field, scene))
}

/// Returns the keypoints without which an action cannot be judged: of each entry, one at least must be known.
///
/// A field that chooses among several lists of points has one entry. Keypoints that only messages show are left out.
pub fn keypoints(program: &Program) -> Vec<Vec<String>> {
    let fields = program.actions.iter();
    let of_fields = fields.filter_map(|field| match &field.choices {
        Choices::Points { keypoints } => Some(keypoints.clone()),
        Choices::Region { mask } => Some(vec![mask.clone()]),
        _ => None,
    });
    let checks = program.verify.checks.iter();
    let conditions = checks.flat_map(|check| check.when.iter().chain([&check.holds]));
    let of_checks = conditions.flat_map(|condition| condition.uses().keypoints);
    of_fields.chain(of_checks.map(|name| vec![name])).collect()
}

fn not_offered(
    notation: &Notation,
    field: &ActionField,
    value: &Value,
    choices: &[Value],
) -> Verdict {
    let listed = match &field.choices {
        Choices::Region { mask } => space::any_of(mask),
        _ => notation.shortened(field, choices),
    };
    let name = space::spoken(field);
    let text = notation.value(field, value);
    let message = match (&field.choices, value) {
        (Choices::Region { mask }, _) => format!(
            "The {name} point {text} is not on the {}. Choose {listed}.",
            mask.replace('_', " ")
        ),
        (_, Value::Point(_)) => format!(
            "The {name} point {text} is not one of the offered points. Choose one of these: {listed}."
        ),
        _ => format!(
            "The {name} {text} is not one of the offered values. Choose one of these: {listed}."
        ),
    };
    Verdict::Reject {
        check: OFFERED.to_owned(),
        values: vec![(field.name.clone(), text), ("offered".to_owned(), listed)],
        message,
    }
}

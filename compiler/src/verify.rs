//! Decides whether a proposed action may run.
//!
//! In: the program's checks, what the scene shows, the action. Out: a [`Verdict`]. Rejection is an answer,
//! not an error: its message goes back to the model. Nothing here talks to a model.

use crate::program::{Comparison, Expr, Length, PixelPoint, PointRef, Program};
use crate::render::{self, Bindings, RenderError};
use crate::reply::Proposal;
use serde::{Deserialize, Serialize};

/// The name of the check that every task has: each field is one of the offered points.
pub const OFFERED: &str = "offered";

/// The most offered points that a message lists.
const MAX_LISTED: usize = 30;

/// What an observation shows, as far as checks ask.
pub trait SceneView {
    /// Returns the points of a keypoint, one for a point; None for a mask or an unknown name.
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>>;

    /// Returns the distance from `point` to the nearest pixel of a mask, pixels, 0 on it; None for an unknown or empty mask.
    fn distance_to_mask_px(&self, mask: &str, point: PixelPoint) -> Option<f64>;
}

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
        /// What each side of it came to, in source order.
        values: Vec<(String, String)>,
        /// What the model is told.
        message: String,
    },
}

/// Judges an action: first whether its fields were offered, then the declared checks in order.
///
/// `bindings` holds the scene's points and what earlier stages read; the action's fields are added.
/// Fails where a keypoint or a value is missing, which a scene of the same program never lacks.
pub fn verdict(
    program: &Program,
    scene: &dyn SceneView,
    proposal: &Proposal,
    bindings: &Bindings,
) -> Result<Verdict, RenderError> {
    for field in &program.actions {
        let choices = offered(program, scene, &field.name);
        let Some(point) = proposal.get(&field.name) else {
            return Err(RenderError::MissingKeypoint {
                keypoint: field.name.clone(),
            });
        };
        if !choices.contains(&point) {
            return Ok(not_offered(&field.name, point, &choices));
        }
    }
    for check in &program.verify.checks {
        let mut judged = Judged {
            scene,
            proposal,
            values: Vec::new(),
        };
        if judged.holds(&check.holds)? {
            continue;
        }
        let mut bindings = bindings.clone();
        for (field, point) in &proposal.fields {
            bindings.point(field, *point);
        }
        let message = render::correction(program, check, &bindings)?;
        return Ok(Verdict::Reject {
            check: check.name.clone(),
            values: judged.values,
            message,
        });
    }
    Ok(Verdict::Accept)
}

/// Returns the points that a field may be, in the order in which a prompt lists them, each once.
pub fn offered(program: &Program, scene: &dyn SceneView, field: &str) -> Vec<PixelPoint> {
    let mut choices = Vec::new();
    let keypoints = program
        .actions
        .iter()
        .filter(|known| known.name == field)
        .flat_map(|known| &known.one_of);
    for point in keypoints
        .filter_map(|keypoint| scene.points(keypoint))
        .flatten()
    {
        if !choices.contains(&point) {
            choices.push(point);
        }
    }
    choices
}

fn not_offered(field: &str, point: PixelPoint, choices: &[PixelPoint]) -> Verdict {
    let mut listed = render::listed(&choices[..choices.len().min(MAX_LISTED)]);
    if choices.len() > MAX_LISTED {
        listed.push_str(&format!(" and {} more", choices.len() - MAX_LISTED));
    }
    let message = format!(
        "The {field} point {point} is not one of the offered points. Choose one of these: {listed}."
    );
    Verdict::Reject {
        check: OFFERED.to_owned(),
        values: vec![
            (field.to_owned(), point.to_string()),
            ("offered".to_owned(), listed),
        ],
        message,
    }
}

struct Judged<'a> {
    scene: &'a dyn SceneView,
    proposal: &'a Proposal,
    values: Vec<(String, String)>,
}

impl Judged<'_> {
    /// Evaluates a condition and notes what its sides came to; every part is evaluated, so that all are noted.
    fn holds(&mut self, condition: &Expr) -> Result<bool, RenderError> {
        match condition {
            Expr::All { of } => Ok(self.each(of)?.iter().all(|holds| *holds)),
            Expr::Any { of } => Ok(self.each(of)?.iter().any(|holds| *holds)),
            Expr::Not { of } => Ok(!self.holds(of)?),
            Expr::Compare { left, is, right } => {
                let (left, right) = (self.length(left)?, self.length(right)?);
                Ok(match is {
                    Comparison::Less => left < right,
                    Comparison::AtMost => left <= right,
                    Comparison::Greater => left > right,
                    Comparison::AtLeast => left >= right,
                })
            }
            Expr::Within {
                point,
                mask,
                margin_px,
            } => {
                let at = self.point(point)?;
                // A mask without pixels is infinitely far away.
                let distance_px = self
                    .scene
                    .distance_to_mask_px(mask, at)
                    .unwrap_or(f64::INFINITY);
                self.note(name(point).to_owned(), at.to_string());
                self.note(
                    format!("distance to {mask}"),
                    format!("{distance_px:.1} px"),
                );
                Ok(distance_px <= *margin_px)
            }
        }
    }

    fn each(&mut self, conditions: &[Expr]) -> Result<Vec<bool>, RenderError> {
        conditions
            .iter()
            .map(|condition| self.holds(condition))
            .collect()
    }

    fn length(&mut self, length: &Length) -> Result<f64, RenderError> {
        match length {
            Length::Pixels { px } => Ok(*px),
            Length::Distance { a, b } => {
                let distance_px = self.point(a)?.distance_px(self.point(b)?);
                self.note(
                    format!("distance({}, {})", name(a), name(b)),
                    format!("{distance_px:.1} px"),
                );
                Ok(distance_px)
            }
        }
    }

    fn point(&self, point: &PointRef) -> Result<PixelPoint, RenderError> {
        let found = match point {
            PointRef::Action { field } => self.proposal.get(field),
            PointRef::Keypoint { name } => self
                .scene
                .points(name)
                .and_then(|points| points.first().copied()),
        };
        found.ok_or_else(|| RenderError::MissingKeypoint {
            keypoint: name(point).to_owned(),
        })
    }

    fn note(&mut self, what: String, value: String) {
        if !self.values.iter().any(|(known, _)| *known == what) {
            self.values.push((what, value));
        }
    }
}

fn name(point: &PointRef) -> &str {
    match point {
        PointRef::Action { field } => field,
        PointRef::Keypoint { name } => name,
    }
}

//! The policy that follows the task's own demonstration.
//!
//! In: the folds that the task demonstrates, and the true positions of the cloth's particles. Out: the offered action
//! closest to each fold, through the same action space, checks and world as any other policy, so it shows what those
//! lose against the demonstration. It sees true particles, so it must not be compared with other policies.

use super::proposing::{Source, stop, until_accepted};
use super::{Decision, Description, Exchange, Kind, Policy, RunError, StepView};
use crate::action::{Action, combinations};
use crate::outcome::Outcome;
use fab_picture::SubpixelPoint;
use fab_picture::observation::Observation;
use fab_program::space;
use fab_program::{ActionField, Choices, Fold, PixelPoint, Program, Proposal, Subgoals, Value};
use fab_world::{WorldPoint, expert};

/// The fields besides points on which the motion depends.
const MOVING: [&str; 2] = ["direction", "distance"];

/// How many points of a field are tried, nearest first.
const NEAREST: usize = 12;

/// Follows the demonstration.
#[derive(Clone, Copy, Debug)]
pub struct Expert;

impl Policy for Expert {
    fn description(&self) -> Description {
        Description {
            kind: Kind::Expert,
            name: "expert policy".to_owned(),
            sees_particles: true,
            models: None,
            code: None,
        }
    }

    fn varies(&self) -> bool {
        false
    }

    fn prepare(&self, program: &Program) -> Result<(), RunError> {
        folds(program).map(|_| ())
    }

    fn decide(
        &mut self,
        step: &StepView<'_>,
        exchange: &mut Exchange<'_, '_>,
    ) -> Result<Decision, RunError> {
        let folds = folds(step.program)?;
        let aim = match folds.get(step.step as usize - 1) {
            Some(fold) => wanted(fold, step),
            None => Err(format!("the demonstration has {} folds", folds.len())),
        };
        until_accepted(step, exchange, &mut |refusals, _| {
            let refused = refusals.iter().filter_map(|it| it.proposal.as_ref());
            let refused: Vec<&Proposal> = refused.collect();
            let nearest = match &aim {
                Ok(aim) => nearest(step, *aim, &refused).ok_or("no other action is offered"),
                Err(why) => Err(why.as_str()),
            };
            Ok(match nearest {
                Ok((proposal, note)) => {
                    let source = Source {
                        note: Some(note),
                        ..Source::default()
                    };
                    (source, Ok(proposal))
                }
                Err(why) => (Source::default(), stop(Outcome::PolicyStopped, why)),
            })
        })
    }
}

/// Returns the folds that a task demonstrates.
fn folds(program: &Program) -> Result<&[Fold], RunError> {
    match &program.subgoals {
        Some(Subgoals::Demonstrate { folds }) => Ok(folds),
        _ => Err(RunError::Unfit(format!(
            "`{}` demonstrates no folds, so there is no expert for it: the expert policy follows `demonstrate` in `subgoals`",
            program.title()
        ))),
    }
}

/// Where a fold picks and places, pixels, `[column, row]`.
type Aim = [[f64; 2]; 2];

/// Returns where a fold picks and places on the cloth's current state.
fn wanted(fold: &Fold, step: &StepView<'_>) -> Result<Aim, String> {
    let truth = step.truth.ok_or("where the particles are is not known")?;
    let grip = expert::grip_of(fold, truth.start, truth.particles)
        .ok_or("the fold names a particle that the cloth does not have")?;
    let pixel = |point: WorldPoint, what: &str| {
        let Observation { camera, .. } = step.observation;
        camera
            .pixel_from_world(point)
            .ok_or_else(|| format!("the {what} point is behind the camera"))
    };
    Ok([pixel(grip.pick, "pick")?, pixel(grip.place, "place")?])
}

/// Returns the offered action closest to the aim that was not refused yet, with a note on its distance.
///
/// It looks at the nearest points, and at all directions and distances; any other field has the value that was refused
/// least often.
fn nearest(step: &StepView<'_>, aim: Aim, refused: &[&Proposal]) -> Option<(Proposal, String)> {
    let fields = step.program.actions.iter().map(|field| {
        let values = if field.is_point() || MOVING.contains(&field.name.as_str()) {
            candidates(step, field, aim)
        } else {
            least_refused(step, field, refused).into_iter().collect()
        };
        (field.name.clone(), values)
    });
    let fields: Vec<_> = fields.collect();
    let offered = combinations(&fields).filter(|proposal| !refused.contains(&proposal));
    let offered = offered.filter_map(|proposal| {
        let action = Action::lower(step.program, &proposal, step.scene, step.observation)?;
        let away = away_px(aim[0], action.pick_px) + away_px(aim[1], action.place_px);
        Some((away, proposal, action))
    });
    // Of equals, the first.
    let (_, proposal, action) = offered.reduce(|best, it| if it.0 < best.0 { it } else { best })?;
    let deviation = |what: &str, [u, v]: [f64; 2], offered: PixelPoint| {
        format!(
            "{what} wanted ({}, {}), nearest offered {offered}, {:.0} px away",
            u.floor(),
            v.floor(),
            away_px([u, v], offered)
        )
    };
    let note = format!(
        "{}; {}",
        deviation("pick", aim[0], action.pick_px),
        deviation("place", aim[1], action.place_px)
    );
    Some((proposal, note))
}

/// Returns the value of a field that was refused least often; of equals, that nearest to how the fold is demonstrated.
pub(super) fn least_refused(
    step: &StepView<'_>,
    field: &ActionField,
    refused: &[&Proposal],
) -> Option<Value> {
    let name = &field.name;
    let usual = step.program.manner.or_usual(name);
    let cost = |value: &Value| {
        let same = refused.iter().filter(|it| it.get(name) == Some(value));
        let away = usual.zip(field.metres(value));
        let away_m = away.map_or(0.0, |(usual, metres)| (metres - usual).abs());
        (same.count(), away_m)
    };
    let costs = space::choices(field, step.scene).into_iter();
    let costs = costs.map(|value| (cost(&value), value));
    let least = costs.reduce(|least, it| if it.0 < least.0 { it } else { least });
    least.map(|(_, value)| value)
}

fn candidates(step: &StepView<'_>, field: &ActionField, [pick, place]: Aim) -> Vec<Value> {
    let target = if field.name == "place" { place } else { pick };
    if let Choices::Region { mask } = &field.choices {
        let nearest = step.scene.nearest_in(mask, SubpixelPoint::at(target).pixel);
        return nearest.map(Value::Point).into_iter().collect();
    }
    let mut values = space::choices(field, step.scene);
    if field.is_point() {
        let away = |value: &Value| match value {
            Value::Point(point) => away_px(target, *point),
            _ => f64::INFINITY,
        };
        values.sort_by(|a, b| away(a).total_cmp(&away(b)));
        values.truncate(NEAREST);
    }
    values
}

/// Returns the distance from a point in the picture to the middle of a pixel.
fn away_px([u, v]: [f64; 2], pixel: PixelPoint) -> f64 {
    let [column, row] = fab_picture::camera::center_of(pixel);
    (u - column).hypot(v - row)
}

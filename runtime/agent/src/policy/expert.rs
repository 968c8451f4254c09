//! The policy that follows the task's own demonstration.
//!
//! In: the folds that the task demonstrates, and the true positions of the cloth's particles. Out: the offered action
//! closest to each fold, through the same action space, checks and world as any other policy, so it shows what those
//! lose against the demonstration. It sees true particles, so it must not be compared with other policies.

use super::proposing::{Source, stop, until_accepted};
use super::{Decision, Description, Exchange, Ground, Kind, Policy, RunError, StepView};
use crate::action::{Action, combinations};
use crate::outcome::Outcome;
use fab_picture::SubpixelPoint;
use fab_picture::observation::Observation;
use fab_program::scene::SceneView;
use fab_program::space;
use fab_program::{ActionField, Choices, Fold, PixelPoint, Program, Proposal, Subgoals, Value};
use fab_world::{Grip, WorldPoint, expert};

/// The fields besides points on which the motion depends.
const MOVING: [&str; 2] = ["direction", "distance"];

/// How many points of a field are tried, nearest first.
const NEAREST: usize = 12;

/// An offered point stands for the expert's point if closer than this share of the picture's side.
const NEAR: f64 = 0.05;

/// Follows the demonstration.
#[derive(Clone, Copy, Debug)]
pub struct Expert;

impl Policy for Expert {
    fn description(&self) -> Description {
        Description {
            sees_particles: true,
            ..Description::new(Kind::Expert, "expert policy".to_owned())
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
            Some(fold) => aim_of(fold, step),
            None => Err(format!("the demonstration has {} folds", folds.len())),
        };
        until_accepted(step, exchange, &mut |refusals, _| {
            let refused = refusals.iter().filter_map(|it| it.proposal.as_ref());
            let refused: Vec<&Proposal> = refused.collect();
            let mut source = Source::default();
            let answer = match &aim {
                Err(why) => stop(Outcome::PolicyStopped, why),
                Ok(aim) => match aim.nearest(step.ground, &refused) {
                    Some((proposal, action)) => {
                        source.note = Some(aim.note(&action));
                        Ok(proposal)
                    }
                    None => stop(Outcome::PolicyStopped, "no other action is offered"),
                },
            };
            Ok((source, answer))
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

/// Returns where a fold picks and places on the cloth's current state.
fn aim_of(fold: &Fold, step: &StepView<'_>) -> Result<Aim, String> {
    let truth = step.truth.ok_or("where the particles are is not known")?;
    let grip = expert::grip_of(fold, truth.start, truth.particles)
        .ok_or("the fold names a particle that the cloth does not have")?;
    Aim::of(grip, step.observation)
}

/// Where an expert picks and places, pixels, `[column, row]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim([[f64; 2]; 2]);

impl Aim {
    /// Returns where the camera sees both ends of an expert's grip; fails with the reason.
    pub(crate) fn of(grip: Grip, observation: &Observation) -> Result<Aim, String> {
        let pixel = |point: WorldPoint, what: &str| {
            let seen = observation.camera.pixel_from_world(point);
            seen.ok_or_else(|| format!("the {what} point is behind the camera"))
        };
        Ok(Aim([
            pixel(grip.pick, "pick")?,
            pixel(grip.place, "place")?,
        ]))
    }

    /// Returns how far the pick and the place of an action are from it, pixels.
    pub(crate) fn off_px(self, action: &Action) -> [f64; 2] {
        let Aim([pick, place]) = self;
        [
            away_px(pick, action.pick_px),
            away_px(place, action.place_px),
        ]
    }

    /// Returns which ends of the nearest action are too far away to stand for its own: `pick`, `place`.
    pub(crate) fn far_ends(self, program: &Program, action: &Action) -> Vec<&'static str> {
        let limit_px = NEAR * f64::from(program.camera.image_px);
        let ends = ["pick", "place"].into_iter().zip(self.off_px(action));
        let far = ends.filter(|(_, off_px)| *off_px > limit_px);
        far.map(|(end, _)| end).collect()
    }

    /// Returns a keypoint with a point that stands for an end, `pick` or `place`; else a mask that reaches it.
    pub(crate) fn keypoint_at(self, end: &str, at: Ground<'_>) -> Option<String> {
        let target = self.end(end);
        let limit_px = NEAR * f64::from(at.program.camera.image_px);
        let pixel = SubpixelPoint::at(target).pixel;
        let names = || at.program.keypoints.iter().map(|it| it.name.as_str());
        let is_near = |name: &&str| {
            let points = at.scene.points(name).unwrap_or_default();
            points.iter().any(|it| away_px(target, *it) <= limit_px)
        };
        let reaches = |name: &&str| {
            let away_px = at.scene.distance_px(name, pixel);
            away_px.is_some_and(|it| it <= limit_px)
        };
        let found = names().find(is_near).or_else(|| names().find(reaches));
        found.map(str::to_owned)
    }

    fn end(self, name: &str) -> [f64; 2] {
        let Aim([pick, place]) = self;
        if name == "place" { place } else { pick }
    }

    /// Returns the offered action closest to it that was not refused yet.
    ///
    /// It looks at the nearest points, and at all directions and distances; any other field has the value that was refused
    /// least often.
    pub(crate) fn nearest(
        self,
        at: Ground<'_>,
        refused: &[&Proposal],
    ) -> Option<(Proposal, Action)> {
        let offered = combinations(at.program, |field| {
            if field.is_point() || MOVING.contains(&field.name.as_str()) {
                self.candidates(at, field)
            } else {
                least_refused(at, field, refused).into_iter().collect()
            }
        });
        let offered = offered.filter(|proposal| !refused.contains(&proposal));
        let offered = offered.filter_map(|proposal| {
            let action = Action::lower(at.program, &proposal, at.scene, at.observation)?;
            let away: f64 = self.off_px(&action).iter().sum();
            Some((away, proposal, action))
        });
        // Of equals, the first.
        let nearest = offered.reduce(|best, it| if it.0 < best.0 { it } else { best });
        nearest.map(|(_, proposal, action)| (proposal, action))
    }

    fn candidates(self, at: Ground<'_>, field: &ActionField) -> Vec<Value> {
        let target = self.end(&field.name);
        if let Choices::Region { mask } = &field.choices {
            let nearest = at.scene.nearest_in(mask, SubpixelPoint::at(target).pixel);
            return nearest.map(Value::Point).into_iter().collect();
        }
        let mut values = space::choices(field, at.scene);
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

    /// Describes how far an action is from it.
    fn note(self, action: &Action) -> String {
        let ends = [("pick", action.pick_px), ("place", action.place_px)];
        let ends = ends.into_iter().zip(self.0).zip(self.off_px(action));
        let notes = ends.map(|(((what, offered), [u, v]), off_px)| {
            format!(
                "{what} wanted ({}, {}), nearest offered {offered}, {off_px:.0} px away",
                u.floor(),
                v.floor()
            )
        });
        notes.collect::<Vec<_>>().join("; ")
    }
}

/// Returns the value of a field that was refused least often; of equals, that nearest to how the fold is demonstrated.
pub(super) fn least_refused(
    at: Ground<'_>,
    field: &ActionField,
    refused: &[&Proposal],
) -> Option<Value> {
    let name = &field.name;
    let usual = at.program.manner.or_usual(name);
    let cost = |value: &Value| {
        let same = refused.iter().filter(|it| it.get(name) == Some(value));
        let away = usual.zip(field.metres(value));
        let away_m = away.map_or(0.0, |(usual, metres)| (metres - usual).abs());
        (same.count(), away_m)
    };
    let costs = space::choices(field, at.scene).into_iter();
    let costs = costs.map(|value| (cost(&value), value));
    let least = costs.reduce(|least, it| if it.0 < least.0 { it } else { least });
    least.map(|(_, value)| value)
}

/// Returns the distance from a point in the picture to the middle of a pixel.
fn away_px([u, v]: [f64; 2], pixel: PixelPoint) -> f64 {
    let [column, row] = fab_picture::camera::center_of(pixel);
    (u - column).hypot(v - row)
}

//! Removes unreachable candidate points from a scene, before anybody chooses among them.
//!
//! In: a scene, its observation, and the world's reach. Out: the scene without these points, with the reasons. Answers
//! that lead elsewhere, by a direction or to any pixel of a mask, are judged later (`policy/judge.rs`).

use super::{Extracted, Scene, SceneError};
use crate::action;
use fab_base::wording::quoted;
use fab_picture::observation::Observation;
use fab_program::scene::{SceneView, Unreachable};
use fab_program::space;
use fab_program::{ActionField, Choices, PixelPoint, Program};
use fab_world::Reach;

impl Scene {
    /// Returns the scene without unreachable candidate points.
    ///
    /// A candidate is a point of a keypoint that a field of the action offers. It is removed from that keypoint's list,
    /// and so from texts and layers. A single-point keypoint stays, since checks may measure from it, but is not
    /// offered. Fails if a field has nothing left to offer.
    pub fn within_reach(
        mut self,
        program: &Program,
        observation: &Observation,
        reach: &Reach<'_>,
    ) -> Result<Scene, SceneError> {
        let mut unreachable: Vec<Unreachable> = Vec::new();
        for field in &program.actions {
            for point in points(field).filter_map(|name| self.points(name)).flatten() {
                let is_known = unreachable.iter().any(|it| it.point == point);
                let on_table = action::candidate(&field.name, point, &self, observation);
                if let (false, Some(why)) = (is_known, on_table.and_then(|point| reach(&point))) {
                    unreachable.push(Unreachable { point, why });
                }
            }
        }
        if unreachable.is_empty() {
            return Ok(self);
        }
        let is_in_reach = |point: PixelPoint| unreachable.iter().all(|it| it.point != point);
        let is_offered =
            |name: &String| program.actions.iter().flat_map(points).any(|it| it == name);
        for (name, found) in &mut self.found {
            if let (true, Extracted::Points(points)) = (is_offered(name), found) {
                points.retain(|point| is_in_reach(point.pixel));
            }
        }
        self.unreachable = unreachable;
        for field in &program.actions {
            let keypoints: Vec<&String> = points(field).collect();
            if !keypoints.is_empty() && space::choices(field, &self).is_empty() {
                let points = self.unreachable.iter();
                let why: Vec<String> = points
                    .map(|it| format!("{}: {}", it.point, it.why))
                    .collect();
                return Err(SceneError::NoneInReach(quoted(keypoints), why.join("; ")));
            }
        }
        Ok(self)
    }
}

/// Returns the keypoints whose points a field offers.
fn points(field: &ActionField) -> impl Iterator<Item = &String> {
    match &field.choices {
        Choices::Points { keypoints } => keypoints.iter(),
        _ => [].iter(),
    }
}

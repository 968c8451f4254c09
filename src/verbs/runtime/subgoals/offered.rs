//! Checks whether a demonstration's points are among those that its actions offer.
//!
//! In: a program that demonstrates folds, and its steps while they are drawn. Out: a note for each pick and place that
//! no answer can name. Each step is analysed in the state in which a model would find it.

use crate::verbs::new::simulator::point_text;
use fab_agent::scene::Scene;
use fab_agent::subgoals::Demonstrated;
use fab_program::scene::SceneView;
use fab_program::{
    ActionField, Choices, Keypoint, KeypointShape, PixelPoint, Program, Value, space,
};

/// Largest distance of an offered point from a demonstrated one, pixels of a 224 px picture.
const NEAR_PX: f64 = 12.0;

/// Checks what is offered before each step of a demonstration.
pub struct Offered<'p> {
    program: &'p Program,
    first: Option<Scene>,
    /// The notes for the user.
    pub notes: Vec<String>,
}

impl<'p> Offered<'p> {
    /// Starts at a program's first step.
    pub fn of(program: &'p Program) -> Offered<'p> {
        Offered {
            program,
            first: None,
            notes: Vec::new(),
        }
    }

    /// Checks a step; ignores one in which nothing is found, since a run reports that better.
    pub fn look(&mut self, step: Demonstrated<'_>) {
        let program = self.program;
        let Ok(scene) = Scene::of(program, step.observation, self.first.as_ref()) else {
            return;
        };
        let points = [("pick", &step.fold.pick), ("place", &step.fold.place)];
        for ((name, point), at) in points.into_iter().zip(step.ends_px) {
            if let (Some(field), Some([u, v])) = (program.field(name), at) {
                let at = PixelPoint::new(u.floor() as i32, v.floor() as i32);
                let cure = cure(program, &scene, field, at);
                self.notes.extend(cure.map(|cure| {
                    let short = if name == "place" && step.fold.fraction != 1.0 {
                        "short of "
                    } else {
                        ""
                    };
                    let (number, point) = (step.number + 1, point_text(point));
                    format!(
                        "step {number} {name}s {short}{point} at ({}, {}); {cure}",
                        at.u, at.v
                    )
                }));
            }
        }
        self.first.get_or_insert(scene);
    }
}

/// Returns how far away the nearest offered point is and how to offer this one; `None` if it is offered.
///
/// - `at`: where the point is in the picture behind `scene`.
fn cure(program: &Program, scene: &Scene, field: &ActionField, at: PixelPoint) -> Option<String> {
    let limit_px = NEAR_PX * f64::from(program.camera.image_px) / 224.0;
    let name = &field.name;
    let (nearest_px, keypoints) = match &field.choices {
        Choices::Points { keypoints } => (nearest(space::choices(field, scene), at)?, keypoints),
        Choices::Region { mask } => (scene.distance_px(mask, at)?, &Vec::new()),
        _ => return None,
    };
    if nearest_px <= limit_px {
        return None;
    }
    let has_it = |keypoint: &&Keypoint| {
        let points = scene.points(&keypoint.name).unwrap_or_default();
        let nearest_px = nearest(points.into_iter().map(Value::Point).collect(), at);
        nearest_px.is_some_and(|distance_px| distance_px <= limit_px)
    };
    let is_mask_there = |keypoint: &&Keypoint| {
        let is_mask = keypoint.extractor.shape() == KeypointShape::Mask;
        is_mask && scene.distance_px(&keypoint.name, at) == Some(0.0)
    };
    let mut all = program.keypoints.iter();
    let help = if let Some(known) = all.clone().find(has_it) {
        let names: Vec<&str> = keypoints
            .iter()
            .chain([&known.name])
            .map(String::as_str)
            .collect();
        format!("offer it, `{name}: one of {}`", names.join(", "))
    } else if let Some(mask) = all.find(is_mask_there) {
        let mask = &mask.name;
        format!(
            "no keypoint of the task finds it: `{name}: any of {mask}` offers each point of the mask"
        )
    } else {
        "offer a keypoint that finds it".to_owned()
    };
    Some(format!(
        "the nearest offered `{name}` is {nearest_px:.0} px away, so that no answer can be that fold; {help}"
    ))
}

/// Returns the distance of the nearest of some points, pixels.
fn nearest(offered: Vec<Value>, at: PixelPoint) -> Option<f64> {
    let distances = offered.iter().filter_map(|value| match value {
        Value::Point(point) => Some(point.distance_px(at)),
        _ => None,
    });
    distances.reduce(f64::min)
}

//! Checks whether a demonstration's points are among those that its actions offer.
//!
//! In: a program that demonstrates folds, and its steps while they are drawn. Out: a note for each pick and place that
//! no answer can name. Each step is analysed in the state in which a model would find it.

use crate::verbs::new::simulator::point_text;
use fab_agent::scene::Scene;
use fab_agent::subgoals::Demonstrated;
use fab_program::scene::SceneView;
use fab_program::{
    ActionField, Choices, ClothPoint, Fold, KeypointShape, PixelPoint, Program, Value, space,
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
    pub fn look(&mut self, demonstrated: Demonstrated<'_>) {
        let Demonstrated {
            number,
            fold,
            observation,
            ends_px: [pick_px, place_px],
        } = demonstrated;
        let program = self.program;
        let Ok(scene) = Scene::of(program, observation, self.first.as_ref()) else {
            return;
        };
        let step = Step {
            program,
            number,
            fold,
            scene: &scene,
        };
        let ends = [
            ("pick", &fold.pick, pick_px),
            ("place", &fold.place, place_px),
        ];
        for (name, point, at) in ends {
            if let (Some(field), Some([u, v])) = (program.field(name), at) {
                let pixel = PixelPoint::new(u.floor() as i32, v.floor() as i32);
                self.notes.extend(step.note(field, point, pixel));
            }
        }
        self.first.get_or_insert(scene);
    }
}

/// One demonstrated step, before it is executed.
struct Step<'s> {
    program: &'s Program,
    /// Its number, from 0.
    number: usize,
    fold: &'s Fold,
    scene: &'s Scene,
}

impl Step<'_> {
    /// Returns a note if a demonstrated point is not offered.
    fn note(&self, field: &ActionField, point: &ClothPoint, at: PixelPoint) -> Option<String> {
        let limit_px = limit_px(self.program);
        let name = &field.name;
        let nearest_px = match &field.choices {
            Choices::Points { .. } => nearest(space::choices(field, self.scene), at)?,
            Choices::Region { mask } => self.scene.distance_px(mask, at)?,
            _ => return None,
        };
        if nearest_px <= limit_px {
            return None;
        }
        let place = if name == "place" && self.fold.fraction != 1.0 {
            format!("short of {}", point_text(point))
        } else {
            point_text(point)
        };
        Some(format!(
            "step {} {name}s {place} at ({}, {}); the nearest offered `{name}` is {nearest_px:.0} px away, so that no \
             answer can be that fold{}",
            self.number + 1,
            at.u,
            at.v,
            cure(self.program, self.scene, field, point, at)
        ))
    }
}

/// Returns how to offer the point, as the end of a sentence.
///
/// - `at`: where the point is in the picture behind `scene`.
fn cure(
    program: &Program,
    scene: &Scene,
    field: &ActionField,
    point: &ClothPoint,
    at: PixelPoint,
) -> String {
    let limit_px = limit_px(program);
    let Choices::Points { keypoints } = &field.choices else {
        return String::new();
    };
    let offer = |more: &str| format!("`{}: one of {}, {more}`", field.name, keypoints.join(", "));
    let has_it = |name: &&String| {
        let points = scene.points(name).unwrap_or_default();
        nearest(points.into_iter().map(Value::Point).collect(), at)
            .is_some_and(|distance_px| distance_px <= limit_px)
    };
    let mut names = program.keypoints.iter().map(|keypoint| &keypoint.name);
    if let Some(known) = names.find(has_it) {
        return format!(": offer it, {}", offer(known));
    }
    let is_middle = matches!(
        *point,
        ClothPoint::Particle { right, front } if [right, front].contains(&0.5)
            && [right, front].iter().any(|at| [0.0, 1.0].contains(at))
    );
    let has = |name: &str| program.keypoints.iter().any(|known| known.name == name);
    if is_middle && has("cloth") && !has("rim") && !has("sides") {
        return format!(
            ": offer it,\n    keypoints {{\n        rim = contour(cloth, tolerance: 4px)\n        \
             sides = edge_middles(rim)\n    }}\nand {}, and say `{{{{ sides }}}}` in a prompt",
            offer("sides")
        );
    }
    let masks = program.keypoints.iter().filter(|keypoint| {
        let is_mask = keypoint.extractor.shape() == KeypointShape::Mask;
        is_mask && scene.distance_px(&keypoint.name, at) == Some(0.0)
    });
    match masks.map(|keypoint| &keypoint.name).next() {
        Some(mask) => format!(
            "; no keypoint of the task finds it: `{}: any of {mask}` offers each point of the mask",
            field.name
        ),
        None => "; offer a keypoint that finds it".to_owned(),
    }
}

/// Returns how far an offered point may be from a demonstrated one, pixels.
fn limit_px(program: &Program) -> f64 {
    NEAR_PX * f64::from(program.camera.image_px) / 224.0
}

/// Returns the distance of the nearest of some points, pixels.
fn nearest(offered: Vec<Value>, at: PixelPoint) -> Option<f64> {
    let distances = offered.iter().filter_map(|value| match value {
        Value::Point(point) => Some(f64::from(point.u - at.u).hypot(f64::from(point.v - at.v))),
        _ => None,
    });
    distances.reduce(f64::min)
}

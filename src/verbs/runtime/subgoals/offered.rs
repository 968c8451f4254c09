//! Checks whether a demonstration's points are among those that its actions offer.
//!
//! In: a program that demonstrates folds, and its steps while they are drawn. Out: a note for each pick and place that
//! no answer can name. Each step is analysed in the state in which a model would find it.

use crate::verbs::new::simulator::point_text;
use fab_agent::scene::Scene;
use fab_agent::subgoals::Demonstrated;
use fab_program::scene::SceneView;
use fab_program::{Choices, KeypointShape, PixelPoint, Program, Value, space};

/// Largest distance of an offered point from a demonstrated one, pixels of a 224 px picture.
const NEAR_PX: f64 = 12.0;

/// Checks what is offered before each step of a demonstration.
pub struct Offered<'p> {
    program: &'p Program,
    first: Option<Scene>,
    pub notes: Vec<String>,
}

impl<'p> Offered<'p> {
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
            let (Some(field), Some([u, v])) = (program.field(name), at) else {
                continue;
            };
            let at = PixelPoint::new(u.floor() as i32, v.floor() as i32);
            let nearest_px = match &field.choices {
                Choices::Points { .. } => nearest(&space::choices(field, &scene), at),
                Choices::Region { mask } => scene.distance_px(mask, at),
                _ => None,
            };
            let mask = if let Choices::Region { .. } = field.choices {
                None
            } else {
                program
                    .keypoints
                    .iter()
                    .find(|it| it.extractor.shape() == KeypointShape::Mask)
            };
            let or_mask = mask.map(|mask| {
                let mask = &mask.name;
                format!(", or each point of a mask: `{name}: any of {mask}`")
            });
            let limit_px = NEAR_PX * f64::from(program.camera.image_px) / 224.0;
            let Some(nearest_px) = nearest_px.filter(|nearest_px| *nearest_px > limit_px) else {
                continue;
            };
            let is_short = name == "place" && step.fold.fraction != 1.0;
            let short = if is_short { "short of " } else { "" };
            let (number, point) = (step.number + 1, point_text(point));
            self.notes.push(format!(
                "step {number} {name}s {short}{point} at {at}; the nearest offered `{name}` is {nearest_px:.0} px away, \
                 so that no answer can be that fold; offer a keypoint that finds it{}",
                or_mask.unwrap_or_default()
            ));
        }
        self.first.get_or_insert(scene);
    }
}

/// Returns the distance of the nearest of some points, pixels.
fn nearest(offered: &[Value], at: PixelPoint) -> Option<f64> {
    let distances = offered.iter().filter_map(|value| match value {
        Value::Point(point) => Some(point.distance_px(at)),
        _ => None,
    });
    distances.reduce(f64::min)
}

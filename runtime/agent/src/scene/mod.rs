//! The scene: a program's keypoints, found in one observation.
//!
//! In: a program and an [`Observation`]. Out: a [`Scene`], a pure function of both and of the rollout's first scene. It
//! fills prompts, and checks are judged on it.

mod annotate;
mod extract;
mod reach;
#[cfg(test)]
mod tests;

use fab_picture::observation::Observation;
use fab_picture::{Mask, SubpixelPoint};
use fab_program::scene::{SceneView, Unreachable};
use fab_program::space;
use fab_program::{Choices, Keypoint, KeypointShape, Moment, PixelPoint, Program};
use fab_vision::VisionError;
use serde_json::{Map, Value, json};

/// The keypoints of one observation, in the program's order.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    found: Vec<(String, Extracted)>,
    /// The name of the cloth's mask.
    cloth: Option<String>,
    /// Candidate points removed as unreachable, in the order in which the action's fields list them.
    unreachable: Vec<Unreachable>,
}

/// An extractor's result.
#[derive(Clone, Debug)]
enum Extracted {
    Mask(Mask),
    Box([PixelPoint; 2]),
    Outline(Vec<PixelPoint>),
    Points(Vec<SubpixelPoint>),
    Point(SubpixelPoint),
}

impl Extracted {
    fn mask(&self) -> Option<&Mask> {
        match self {
            Extracted::Mask(mask) => Some(mask),
            _ => None,
        }
    }

    /// Returns the points: one for a single point, none for other shapes.
    fn points(&self) -> &[SubpixelPoint] {
        match self {
            Extracted::Points(points) => points,
            Extracted::Point(point) => std::slice::from_ref(point),
            _ => &[],
        }
    }
}

/// Why a picture gives no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A required mask is empty: the first one, which is the cloth, or one that something is taken from. What the picture
    /// shows instead ends the message, and may be empty.
    #[error(
        "no pixel of the picture belongs to `{0}`: the cloth is out of view, or the mask does not fit it{1}"
    )]
    OutOfView(String, String),
    /// A detector found nothing, so there is nothing to offer. What was searched ends the message, and may be empty.
    #[error("`{0}` finds no point in the picture, so there is nothing to choose from{1}")]
    NoCandidates(String, String),
    /// Detectors found points, but none that a field offers is in reach; says why for each point.
    #[error("no point of {0} is in reach: {1}")]
    NoneInReach(String, String),
    /// A layer needs something missing; happens only in a hand-edited program.
    #[error("an annotation cannot be drawn: {0}")]
    Missing(#[from] fab_program::scene::Missing),
    /// The detector itself failed.
    #[error(transparent)]
    Vision(#[from] VisionError),
}

impl Scene {
    /// Finds every keypoint of `program` in `observation`.
    ///
    /// Keypoints of the start are taken from `first`, the rollout's first scene; without one, this scene is the first.
    /// Fails if the first mask (the cloth) or one that something is taken from is empty, or a field has nothing to choose
    /// from.
    pub fn of(
        program: &Program,
        observation: &Observation,
        first: Option<&Scene>,
    ) -> Result<Scene, SceneError> {
        let mut scene = Scene::default();
        for keypoint in &program.keypoints {
            let kept = first
                .filter(|_| keypoint.moment == Moment::Start)
                .and_then(|first| first.get(&keypoint.name));
            let found = match kept {
                Some(found) => found.clone(),
                None => scene.extract(&keypoint.name, &keypoint.extractor, observation)?,
            };
            scene.add(keypoint, found);
        }
        for field in &program.actions {
            let (keypoints, searched) = match &field.choices {
                Choices::Region { mask } if scene.mask(mask)?.is_empty() => {
                    (mask.clone(), String::new())
                }
                Choices::Points { keypoints } if space::choices(field, &scene).is_empty() => {
                    (keypoints.join("`, `"), scene.searched())
                }
                _ => continue,
            };
            return Err(SceneError::NoCandidates(keypoints, searched));
        }
        Ok(scene)
    }

    /// Describes where detectors looked for points; ends a message.
    fn searched(&self) -> String {
        self.cloth().map_or(String::new(), |mask| {
            format!(
                "; the cloth's mask covers {} of its {} pixels, and a detector needs a whole cloth with background around it",
                mask.area_px(),
                u64::from(mask.width()) * u64::from(mask.height())
            )
        })
    }

    /// Finds the cloth alone, the mask that [`Scene::cloth`] returns; `None` if it is out of view.
    pub fn cloth_in(
        program: &Program,
        observation: &Observation,
    ) -> Result<Option<Mask>, SceneError> {
        let mut scene = Scene::default();
        let is_mask = |keypoint: &&Keypoint| keypoint.extractor.shape() == KeypointShape::Mask;
        for keypoint in program.keypoints.iter().filter(is_mask) {
            let (name, extractor) = (&keypoint.name, &keypoint.extractor);
            if scene.cloth.is_some() && extractor.refines() != scene.cloth.as_deref() {
                continue;
            }
            match scene.extract(name, extractor, observation) {
                Ok(found) => scene.add(keypoint, found),
                Err(SceneError::OutOfView(..)) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        Ok(scene.cloth().cloned())
    }

    /// Adds a result; the first mask is the cloth, and so is a cleaned version of it.
    fn add(&mut self, keypoint: &Keypoint, found: Extracted) {
        let is_cloth = match (&found, &self.cloth) {
            (Extracted::Mask(_), None) => true,
            (Extracted::Mask(_), Some(cloth)) => keypoint.extractor.refines() == Some(cloth),
            _ => false,
        };
        if is_cloth {
            self.cloth = Some(keypoint.name.clone());
        }
        self.found.push((keypoint.name.clone(), found));
    }

    fn get(&self, name: &str) -> Option<&Extracted> {
        let mut found = self.found.iter();
        found.find(|(known, _)| known == name).map(|(_, it)| it)
    }

    fn mask(&self, name: &str) -> Result<&Mask, SceneError> {
        let mask = self.get(name).and_then(Extracted::mask);
        mask.ok_or_else(|| out_of_view(name))
    }

    fn outline(&self, name: &str) -> Result<&[PixelPoint], SceneError> {
        match self.get(name) {
            Some(Extracted::Outline(points)) => Ok(points),
            _ => Err(out_of_view(name)),
        }
    }

    fn points_of(&self, name: &str) -> &[SubpixelPoint] {
        self.get(name).map_or(&[], Extracted::points)
    }

    fn corners_of(&self, name: &str) -> Result<[PixelPoint; 2], SceneError> {
        match self.get(name) {
            Some(Extracted::Box(corners)) => Ok(*corners),
            _ => Err(out_of_view(name)),
        }
    }

    /// Returns the mask of the cloth, on which a pick must land: the first one declared, or its version after `closed`
    /// and `largest`.
    pub fn cloth(&self) -> Option<&Mask> {
        self.mask(self.cloth.as_deref()?).ok()
    }

    /// Says that the cloth leaves the picture, where its mask reaches a border.
    pub fn beyond_the_picture(&self) -> Option<String> {
        let name = self.cloth.as_deref()?;
        let borders = self.mask(name).ok()?.reached_borders();
        let plural = if borders.len() > 1 { "s" } else { "" };
        (!borders.is_empty()).then(|| {
            format!(
                "`{name}` reaches the picture's {} border{plural}: its corners and center are those of its visible part",
                borders.join(", ")
            )
        })
    }

    /// Returns the pixel of a mask closest to another pixel; `None` for other keypoints and for an empty mask.
    pub(crate) fn nearest_in(&self, mask: &str, pixel: PixelPoint) -> Option<PixelPoint> {
        self.mask(mask).ok()?.nearest(pixel)
    }

    /// Returns the exact position of the point behind a pixel, `[column, row]`, pixels.
    ///
    /// Prompts name a point by its whole pixel; an answer that names the pixel means the point. If several points share
    /// a pixel, the first one declared counts.
    pub fn located(&self, pixel: PixelPoint) -> Option<[f64; 2]> {
        let mut points = self.found.iter().flat_map(|(_, found)| found.points());
        points.find(|point| point.pixel == pixel).map(|it| it.at)
    }

    /// Returns the pixels of each keypoint that is not a mask: points in their detector's order, the left-top and
    /// right-bottom pixels of a box, an outline's corners.
    pub fn keypoints(&self) -> Vec<(&str, Vec<PixelPoint>)> {
        let listed = self.found.iter().filter_map(|(name, found)| {
            let points = match found {
                Extracted::Mask(_) => return None,
                Extracted::Box(corners) => corners.to_vec(),
                Extracted::Outline(points) => points.clone(),
                Extracted::Points(_) | Extracted::Point(_) => pixels(found.points()),
            };
            Some((name.as_str(), points))
        });
        listed.collect()
    }

    /// Returns each keypoint that is a mask.
    pub fn masks(&self) -> Vec<(&str, &Mask)> {
        let found = self.found.iter();
        let masks = found.filter_map(|(name, found)| Some((name.as_str(), found.mask()?)));
        masks.collect()
    }

    /// Returns the points as JSON, `{name: [[u, v], …]}`; a mask is given as its number of pixels. Points out of reach
    /// are listed under `unreachable`, each with the reason, instead of in their keypoint's list.
    pub fn to_json(&self) -> Value {
        let mut object = Map::new();
        for (name, found) in &self.found {
            let value = match found {
                Extracted::Mask(mask) => json!({ "area_px": mask.area_px() }),
                Extracted::Box(corners) => json!({ "box": corners }),
                Extracted::Outline(points) => json!({ "outline": points }),
                Extracted::Points(_) | Extracted::Point(_) => json!(pixels(found.points())),
            };
            object.insert(name.clone(), value);
        }
        if !self.unreachable.is_empty() {
            let points = self.unreachable.iter();
            let points = points.map(|it| json!({ "point": it.point, "why": it.why }));
            object.insert("unreachable".to_owned(), points.collect());
        }
        Value::Object(object)
    }
}

/// Reports an empty mask when nothing more is known about the picture.
fn out_of_view(mask: &str) -> SceneError {
    SceneError::OutOfView(mask.to_owned(), String::new())
}

fn pixels(points: &[SubpixelPoint]) -> Vec<PixelPoint> {
    points.iter().map(|point| point.pixel).collect()
}

impl SceneView for Scene {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        match self.get(keypoint)? {
            found @ (Extracted::Points(_) | Extracted::Point(_)) => Some(pixels(found.points())),
            _ => None,
        }
    }

    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64> {
        match self.get(region)? {
            Extracted::Mask(mask) if mask.is_empty() => None,
            Extracted::Mask(mask) => Some(mask.distance_px(point)),
            Extracted::Box(corners) => Some(fab_vision::box_distance_px(point, *corners)),
            _ => None,
        }
    }

    fn area_px(&self, mask: &str) -> Option<f64> {
        Some(self.mask(mask).ok()?.area_px() as f64)
    }

    fn region_pixel(&self, mask: &str, number: u64) -> Option<PixelPoint> {
        let mut pixels = self.mask(mask).ok()?.pixels();
        pixels.nth(usize::try_from(number).ok()?)
    }

    fn unreachable(&self) -> &[Unreachable] {
        &self.unreachable
    }
}

//! Converts the pixels that a model chose to points on the table.
//!
//! In: an accepted proposal, the scene and the observation it was based on. Out: an [`Action`] in pixels and in world
//! points.

use crate::scene::Scene;
use fab_picture::SubpixelPoint;
use fab_picture::camera::center_of;
use fab_picture::observation::Observation;
use fab_program::facts::ExecutedAction;
use fab_program::{ActionField, Choices, PixelPoint, Program, Proposal, Value, space};
use fab_world::{Grip, WorldPoint};
use serde::{Deserialize, Serialize};

/// How far a keypoint may lie from the nearest cloth pixel and still be picked at its exact position, pixels: as far as
/// the detector may place a corner beside the cloth.
const BESIDE_PX: f64 = 3.5;

/// The most combinations of a step's choices that are compared; each is judged by all checks.
pub(crate) const MOST_COMBINATIONS: usize = 20_000;

/// What one gripper does, ready for execution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Action {
    /// The pixel that the model chose for the pick.
    pub pick_px: PixelPoint,
    /// The pixel actually picked: the nearest one on the cloth.
    pub pick_on_cloth_px: PixelPoint,
    /// The pixel that the model chose for the place.
    pub place_px: PixelPoint,
    /// Both points on the table, and how the cloth is carried between them.
    #[serde(flatten)]
    pub grip: Grip,
}

impl Action {
    /// Lowers a proposal to world points.
    ///
    /// A keypoint is taken at its exact position, any other pixel at its centre. A pick farther than `BESIDE_PX` from
    /// the cloth goes to the nearest cloth pixel (protocol, section 4 item 10). Returns `None` if a proposal lacks a
    /// field or the scene has no cloth, which the verifier has already refused, or if the camera does not look at the
    /// table.
    pub fn lower(
        program: &Program,
        proposal: &Proposal,
        scene: &Scene,
        observation: &Observation,
    ) -> Option<Action> {
        let pick_px = proposal.point("pick")?;
        let (pick_on_cloth_px, pick) = picked(pick_px, scene, observation)?;
        let (place_px, place) = match proposal.point("place") {
            Some(place_px) => (place_px, placed(place_px, scene, observation)?),
            None => carried(program, proposal, pick, observation)?,
        };
        Some(Action {
            pick_px,
            pick_on_cloth_px,
            place_px,
            grip: Grip::new(pick, place).with_manner(space::manner(program, proposal)?),
        })
    }

    /// Returns what later questions say about the action, once it is executed.
    pub fn executed(&self, proposal: Proposal) -> ExecutedAction {
        ExecutedAction {
            proposal,
            pick: self.pick_on_cloth_px,
            place: self.place_px,
        }
    }
}

/// Returns every combination of values of a task's fields; those of the last field follow each other.
pub(crate) fn combinations<F: Fn(&ActionField) -> Vec<Value>>(
    program: &Program,
    values: F,
) -> impl ExactSizeIterator<Item = Proposal> + use<F> {
    let fields = program.actions.iter();
    let fields: Vec<_> = fields.map(|it| (it.name.clone(), values(it))).collect();
    let counts = fields.iter().map(|(_, values)| values.len());
    let numbers = 0..counts.fold(1, usize::saturating_mul);
    numbers.map(move |mut number| {
        let chosen = fields.iter().rev().map(|(name, values)| {
            let value = values[number % values.len()].clone();
            number /= values.len();
            (name.clone(), value)
        });
        let mut fields: Vec<_> = chosen.collect();
        fields.reverse();
        Proposal { fields }
    })
}

/// Returns the table point of a field's pixel, as [`Action::lower`] computes it; `None` for a field that moves nothing,
/// or if there is no such point.
pub(crate) fn candidate(
    field: &str,
    pixel: PixelPoint,
    scene: &Scene,
    observation: &Observation,
) -> Option<WorldPoint> {
    match field {
        "pick" => picked(pixel, scene, observation).map(|(_, point)| point),
        "place" => placed(pixel, scene, observation),
        _ => None,
    }
}

/// Returns the cloth pixel actually picked, and its point on the table.
fn picked(
    pick_px: PixelPoint,
    scene: &Scene,
    observation: &Observation,
) -> Option<(PixelPoint, WorldPoint)> {
    let on_cloth_px = scene.cloth()?.nearest(pick_px)?;
    let on_cloth_at = center_of(on_cloth_px);
    let is_beside =
        |at: &[f64; 2]| (at[0] - on_cloth_at[0]).hypot(at[1] - on_cloth_at[1]) <= BESIDE_PX;
    let located = scene.located(pick_px).filter(is_beside);
    let point = point_on_surface(on_cloth_px, located.unwrap_or(on_cloth_at), observation)?;
    Some((on_cloth_px, point))
}

fn placed(place_px: PixelPoint, scene: &Scene, observation: &Observation) -> Option<WorldPoint> {
    let at = scene.located(place_px);
    point_on_surface(
        place_px,
        at.unwrap_or_else(|| center_of(place_px)),
        observation,
    )
}

/// Returns the world point reached from the picked point by a direction and a distance, at its height, and the pixel
/// that shows it.
///
/// Directions are those of the picture: the camera tells which table directions are its right and up. The pixel is
/// truncated (protocol, section 4 item 10).
fn carried(
    program: &Program,
    proposal: &Proposal,
    pick: WorldPoint,
    observation: &Observation,
) -> Option<(PixelPoint, WorldPoint)> {
    let Value::Direction { deg } = proposal.get("direction")? else {
        return None;
    };
    let Choices::Directions { choices } = &program.field("direction")?.choices else {
        return None;
    };
    let [right, down] = choices.iter().find(|choice| choice.deg == *deg)?.vector;
    let length_m = program
        .field("distance")?
        .metres(proposal.get("distance")?)?;
    let camera = &observation.camera;
    let way = camera.table_direction(camera.pixel_from_world(pick)?, [right, down])?;
    let place = pick + way * length_m;
    let pixel = SubpixelPoint::at(camera.pixel_from_world(place)?).pixel;
    Some((pixel, place))
}

/// Returns the world point at `at`, with the depth that `pixel` shows; without a depth reading, the table point there.
///
/// `None` if the camera does not look down at the table.
fn point_on_surface(
    pixel: PixelPoint,
    at: [f64; 2],
    observation: &Observation,
) -> Option<WorldPoint> {
    let camera = &observation.camera;
    let [column, row] =
        [pixel.u, pixel.v].map(|coordinate| u32::try_from(coordinate).unwrap_or(u32::MAX));
    let reading = observation
        .depth_m
        .get_pixel_checked(column, row)
        .map_or(0.0, |depth| f64::from(depth.0[0]));
    camera
        .world_from_pixel(at, reading)
        .or_else(|| camera.table_from_pixel(at))
}

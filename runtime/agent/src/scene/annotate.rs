//! Resolves a task's annotation layers to pixels, and draws them on the camera's picture.

use super::{Scene, SceneError};
use fab_program::eval;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::scene::{Missing, SceneView};
use fab_program::{Layer, Mark, PixelPoint, Point, Program, Spot};
use fab_vision::{DrawnLayer, DrawnShape};
use image::RgbImage;

impl Scene {
    /// Returns the camera's picture with the task's layers on it, later ones over earlier ones.
    ///
    /// A layer that needs the previous action is omitted if there is none. Fails if a keypoint is missing, which
    /// happens only in a hand-edited program.
    pub fn annotated(
        &self,
        program: &Program,
        rgb: &RgbImage,
        last: Option<&ExecutedAction>,
    ) -> Result<RgbImage, SceneError> {
        self.with_layers(program, &program.layers, rgb, last)
    }

    /// Draws some of the task's layers, as [`Scene::annotated`] does.
    pub(super) fn with_layers(
        &self,
        program: &Program,
        layers: &[Layer],
        rgb: &RgbImage,
        last: Option<&ExecutedAction>,
    ) -> Result<RgbImage, SceneError> {
        let pointing = Pointing::of_camera(&program.camera);
        let facts = Facts {
            last,
            ..Facts::of(self, 1, pointing)
        };
        let mut drawn = Vec::with_capacity(layers.len());
        for layer in layers {
            if last.is_some() || !layer.uses_last() {
                drawn.push(DrawnLayer {
                    rgb: layer.rgb,
                    shape: self.shape(program, &layer.mark, facts)?,
                });
            }
        }
        Ok(fab_vision::draw_layers(rgb, &drawn)?)
    }

    fn shape(
        &self,
        program: &Program,
        mark: &Mark,
        facts: Facts<'_>,
    ) -> Result<DrawnShape, SceneError> {
        let pixel = |point: &Point| eval::pixel(program, facts, point);
        let of_spot = |spot: &Spot| match spot {
            Spot::Points { keypoint } => self.points(keypoint).ok_or_else(|| Missing {
                name: keypoint.clone(),
            }),
            Spot::One { point } => Ok(vec![pixel(point)?]),
        };
        let pixels = |at: &[Spot]| -> Result<Vec<PixelPoint>, Missing> {
            Ok(at
                .iter()
                .map(of_spot)
                .collect::<Result<Vec<_>, _>>()?
                .concat())
        };
        Ok(match mark {
            Mark::Dot { at, radius_px } => DrawnShape::Dots {
                at: pixels(at)?,
                radius_px: *radius_px,
            },
            Mark::Ring {
                at,
                radius_px,
                width_px,
            } => DrawnShape::Rings {
                at: pixels(at)?,
                radius_px: *radius_px,
                width_px: *width_px,
            },
            Mark::Cross {
                at,
                radius_px,
                width_px,
            } => DrawnShape::Crosses {
                at: pixels(at)?,
                radius_px: *radius_px,
                width_px: *width_px,
            },
            Mark::Number { at } => DrawnShape::Numbers { at: pixels(at)? },
            Mark::Arrow { from, to, width_px } => DrawnShape::Arrow {
                from: pixel(from)?,
                to: pixel(to)?,
                width_px: *width_px,
            },
            Mark::Box { of, spacing_px } => DrawnShape::Box {
                corners: self.corners_of(of)?,
                spacing_px: *spacing_px,
            },
            Mark::Outline { of, width_px } => DrawnShape::Outline {
                points: self.outline(of)?.to_vec(),
                width_px: *width_px,
            },
        })
    }
}

//! Draws keypoints and a task's annotation layers on the camera's picture, all at once or one after the other.

use super::{Extracted, Scene, SceneError, pixels};
use fab_picture::mask_picture;
use fab_program::eval;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::scene::{Missing, SceneView};
use fab_program::{Layer, Mark, PixelPoint, Point, Program, Spot};
use fab_vision::{DrawnLayer, DrawnShape};
use image::{DynamicImage, RgbImage};

/// The colour of keypoints, rare among cloths, tables and layers.
const MAGENTA: [u8; 3] = [255, 0, 255];

/// Radius of a keypoint's dot, pixels; the paper's.
const DOT_PX: u32 = 3;

impl Scene {
    /// Returns the camera's picture with layers of the task on it, later ones over earlier ones.
    ///
    /// A layer that needs the previous action is omitted if there is none. Fails if a keypoint is missing, which
    /// happens only in a hand-edited program.
    pub fn annotated(
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

    /// Draws every keypoint, then every layer over the previous ones, each with its name; the last picture is what a model
    /// would get.
    ///
    /// A mask is white on black; other keypoints are drawn on the camera's picture, points numbered in their order. A
    /// layer that needs the previous action is omitted if there is none. Fails as [`Scene::annotated`] does.
    pub fn stages(
        &self,
        program: &Program,
        rgb: &RgbImage,
        last: Option<&ExecutedAction>,
    ) -> Result<Vec<(String, RgbImage)>, SceneError> {
        let mut stages = Vec::with_capacity(self.found.len() + program.layers.len());
        for (name, found) in &self.found {
            stages.push((name.clone(), drawn(found, rgb)?));
        }
        for (index, layer) in program.layers.iter().enumerate() {
            if last.is_some() || !layer.uses_last() {
                let layers = &program.layers[..=index];
                let picture = self.annotated(program, layers, rgb, last)?;
                stages.push((layer.name.clone(), picture));
            }
        }
        Ok(stages)
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
            let points = at.iter().map(of_spot);
            Ok(points.collect::<Result<Vec<_>, _>>()?.concat())
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

fn drawn(found: &Extracted, rgb: &RgbImage) -> Result<RgbImage, SceneError> {
    let dots = |at| DrawnShape::Dots {
        at,
        radius_px: DOT_PX,
    };
    let shapes = match found {
        Extracted::Mask(mask) => {
            return Ok(DynamicImage::from(mask_picture(mask)).into_rgb8());
        }
        Extracted::Box(corners) => vec![DrawnShape::Box {
            corners: *corners,
            spacing_px: 1,
        }],
        Extracted::Outline(points) => vec![DrawnShape::Outline {
            points: points.clone(),
            width_px: 1,
        }],
        Extracted::Points(points) => {
            let at = pixels(points);
            vec![dots(at.clone()), DrawnShape::Numbers { at }]
        }
        Extracted::Point(point) => vec![dots(vec![point.pixel])],
    };
    let layers = shapes.into_iter().map(|shape| DrawnLayer {
        rgb: MAGENTA,
        shape,
    });
    Ok(fab_vision::draw_layers(rgb, &layers.collect::<Vec<_>>())?)
}

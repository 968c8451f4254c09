//! Pictures of each keypoint and each layer, one after the other.
//!
//! In: a scene, its program, the camera's picture. Out: pictures of that size, in the order in which a step makes them.
//! Everything here is found and drawn as in a step.

use super::{Extracted, Scene, SceneError, pixels};
use fab_picture::Mask;
use fab_picture::mask_picture;
use fab_program::facts::ExecutedAction;
use fab_program::{PixelPoint, Program};
use fab_vision::{DrawnLayer, DrawnShape};
use image::{Luma, RgbImage};

/// The colour of keypoints, rare among cloths, tables and layers.
const MAGENTA: [u8; 3] = [255, 0, 255];

/// Radius of a keypoint's dot, pixels; the paper's.
const DOT_PX: u32 = 3;

/// One stage of the picture that a model sees.
#[derive(Clone, Debug)]
pub struct StagePicture {
    /// The keypoint or layer that it adds.
    pub name: String,
    /// A mask in white on black; a keypoint on the camera's picture, its points numbered in their order; or the
    /// picture with the layers up to this one.
    pub picture: RgbImage,
}

impl Scene {
    /// Draws every keypoint, then every layer over the previous ones; the last picture is [`Scene::annotated`].
    ///
    /// A layer that needs the previous action is omitted if there is none. Fails as [`Scene::annotated`] does.
    pub fn stages(
        &self,
        program: &Program,
        rgb: &RgbImage,
        last: Option<&ExecutedAction>,
    ) -> Result<Vec<StagePicture>, SceneError> {
        let mut stages = Vec::with_capacity(self.found.len() + program.layers.len());
        for (name, found) in &self.found {
            stages.push(StagePicture {
                name: name.clone(),
                picture: drawn(found, rgb)?,
            });
        }
        for (index, layer) in program.layers.iter().enumerate() {
            if last.is_some() || !layer.uses_last() {
                let layers = &program.layers[..=index];
                stages.push(StagePicture {
                    name: layer.name.clone(),
                    picture: self.with_layers(program, layers, rgb, last)?,
                });
            }
        }
        Ok(stages)
    }

    /// Returns the pixels of each keypoint that is not a mask: points in their detector's order, the left-top and
    /// right-bottom pixels of a box, an outline's corners.
    pub fn keypoints(&self) -> Vec<(&str, Vec<PixelPoint>)> {
        let listed = self.found.iter().filter_map(|(name, found)| {
            let points = match found {
                Extracted::Mask(_) => return None,
                Extracted::Box(corners) => corners.to_vec(),
                Extracted::Outline(points) => points.clone(),
                Extracted::Points(points) => pixels(points),
                Extracted::Point(point) => vec![point.pixel],
            };
            Some((name.as_str(), points))
        });
        listed.collect()
    }

    /// Returns each keypoint that is a mask.
    pub fn masks(&self) -> Vec<(&str, &Mask)> {
        let listed = self.found.iter().filter_map(|(name, found)| match found {
            Extracted::Mask(mask) => Some((name.as_str(), mask)),
            _ => None,
        });
        listed.collect()
    }
}

fn drawn(found: &Extracted, rgb: &RgbImage) -> Result<RgbImage, SceneError> {
    let numbered = |at: Vec<PixelPoint>| {
        let dots = DrawnShape::Dots {
            at: at.clone(),
            radius_px: DOT_PX,
        };
        vec![dots, DrawnShape::Numbers { at }]
    };
    let shapes = match found {
        Extracted::Mask(mask) => {
            let levels = mask_picture(mask);
            return Ok(RgbImage::from_fn(
                mask.width(),
                mask.height(),
                |column, row| {
                    let Luma([level]) = *levels.get_pixel(column, row);
                    image::Rgb([level; 3])
                },
            ));
        }
        Extracted::Box(corners) => vec![DrawnShape::Box {
            corners: *corners,
            spacing_px: 1,
        }],
        Extracted::Outline(points) => vec![DrawnShape::Outline {
            points: points.clone(),
            width_px: 1,
        }],
        Extracted::Points(points) => numbered(pixels(points)),
        Extracted::Point(point) => vec![DrawnShape::Dots {
            at: vec![point.pixel],
            radius_px: DOT_PX,
        }],
    };
    let layers: Vec<DrawnLayer> = shapes
        .into_iter()
        .map(|shape| DrawnLayer {
            rgb: MAGENTA,
            shape,
        })
        .collect();
    Ok(fab_vision::draw_layers(rgb, &layers)?)
}

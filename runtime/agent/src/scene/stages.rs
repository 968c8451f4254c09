//! Pictures of each keypoint and each layer, one after the other.
//!
//! In: a scene, its program, the camera's picture. Out: pictures of that size, in the order in which a step makes them.
//! Everything here is found and drawn as in a step.

use super::{Extracted, Scene, SceneError, pixels};
use fab_picture::{Mask, mask_picture};
use fab_program::facts::ExecutedAction;
use fab_program::{PixelPoint, Program};
use fab_vision::{DrawnLayer, DrawnShape};
use image::{DynamicImage, RgbImage};

/// The colour of keypoints, rare among cloths, tables and layers.
const MAGENTA: [u8; 3] = [255, 0, 255];

/// Radius of a keypoint's dot, pixels; the paper's.
const DOT_PX: u32 = 3;

impl Scene {
    /// Draws every keypoint, then every layer over the previous ones, each with its name; the last picture is
    /// [`Scene::annotated`].
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
                let picture = self.with_layers(program, layers, rgb, last)?;
                stages.push((layer.name.clone(), picture));
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

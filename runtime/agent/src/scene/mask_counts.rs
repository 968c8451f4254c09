//! Measures a picture that gives no scene, in words that end a message.

use super::{Extracted, Scene};
use fab_picture::DepthImage;
use fab_picture::depth_mask;
use fab_picture::observation::Observation;
use fab_program::{Extractor, Program};

/// Describes how the pixels of a picture differ from those that a mask selects.
pub(super) fn measured(extractor: &Extractor, observation: &Observation) -> String {
    match extractor {
        Extractor::DepthMask { below_m } => depths(&observation.depth_m, *below_m),
        Extractor::ColorMask {
            hue_deg,
            saturation,
            value,
        } => {
            const ANY_HUE: [f64; 2] = [0.0, 360.0];
            const ANY: [f64; 2] = [0.0, 1.0];
            let count = |hue, saturation, value| {
                fab_vision::color_mask(&observation.rgb, hue, saturation, value).area_px()
            };
            format!(
                "; of {} pixels {} have its hue ({} to {} deg), {} its saturation ({} to {}) and {} its value \
                 ({} to {}), and none all three",
                count(ANY_HUE, ANY, ANY),
                count(*hue_deg, ANY, ANY),
                hue_deg[0],
                hue_deg[1],
                count(ANY_HUE, *saturation, ANY),
                saturation[0],
                saturation[1],
                count(ANY_HUE, ANY, *value),
                value[0],
                value[1],
            )
        }
        Extractor::SplitMask {
            of,
            blur_px,
            contrast,
            ..
        } => match fab_vision::contrast_of(&observation.rgb, *of, *blur_px) {
            Some(found) => format!(
                "; the two sides of its best split are {found:.2} apart, and the mask asks for {contrast:.2}"
            ),
            None => "; all its pixels are alike".to_owned(),
        },
        _ => String::new(),
    }
}

fn depths(depth_m: &DepthImage, below_m: f64) -> String {
    // Beyond any camera's range, so this counts everything with a reading.
    let readings = depth_mask(depth_m, f64::INFINITY);
    let millimetres = readings
        .pixels()
        .map(|pixel| 1000.0 * f64::from(depth_m.get_pixel(pixel.u as u32, pixel.v as u32).0[0]));
    let [nearest, farthest] = millimetres.fold([f64::INFINITY, 0.0], |[nearest, farthest], mm| {
        [nearest.min(mm), farthest.max(mm)]
    });
    if readings.is_empty() {
        return "; the depth picture has no reading".to_owned();
    }
    format!(
        "; its {} readings are {nearest:.1} to {farthest:.1} mm from the camera, and the mask takes what is nearer \
         than {:.1} mm",
        readings.area_px(),
        1000.0 * below_m
    )
}

impl Scene {
    /// Describes how much of the picture the detectors of some keypoints searched.
    pub(super) fn looked_at(&self, program: &Program, keypoints: &[String]) -> String {
        let of_detector = |name: &String| match &program.keypoint(name)?.extractor {
            Extractor::Corners { mask, .. } => match self.get(mask)? {
                Extracted::Mask(pixels) => Some((mask.clone(), pixels)),
                _ => None,
            },
            _ => None,
        };
        let Some((mask, pixels)) = keypoints.iter().find_map(of_detector) else {
            return String::new();
        };
        let (width, height) = (pixels.width(), pixels.height());
        format!(
            "; `{mask}` covers {} of its {} pixels, and a detector needs a whole cloth with background around it",
            pixels.area_px(),
            u64::from(width) * u64::from(height)
        )
    }
}

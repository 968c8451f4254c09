//! What is found in each observation, and the choices that an action has among it.

use serde::{Deserialize, Serialize};

/// Something found in every observation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Keypoint {
    /// Its name in the task and in prompts.
    pub name: String,
    /// Which observation it is taken from.
    pub moment: Moment,
    /// How it is found.
    pub extractor: Extractor,
}

/// Which observation a keypoint is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moment {
    /// The latest.
    Now,
    /// The first of the rollout, kept until its end (the paper's cloth centre, protocol section 6).
    Start,
}

/// How a keypoint is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Extractor {
    /// The pixels nearer to the camera than a depth. Gives a mask.
    DepthMask {
        /// Depth limit along the optical axis, metres, exclusive.
        below_m: f64,
    },
    /// Corners of the masked depth image (OpenCV's goodFeaturesToTrack). Gives points.
    Corners {
        /// The mask's name.
        mask: String,
        /// Side of the square image that the detector sees, pixels of that image; results are scaled back.
        image_px: u32,
        /// The most corners kept, strongest first.
        max: u32,
        /// Least accepted response as a fraction of the strongest, `0 < quality <= 1`.
        quality: f64,
        /// Least distance between corners, pixels of the detector's image.
        spacing_px: f64,
        /// What counts as a strong response.
        response: Response,
    },
    /// The mean of a mask's pixels, truncated to whole pixels. Gives a point.
    Centroid {
        /// The mask's name.
        mask: String,
    },
}

/// What a corner detector takes for a strong response.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Response {
    /// Harris' measure.
    Harris {
        /// Its free parameter.
        k: f64,
    },
    /// The smaller eigenvalue.
    ShiTomasi,
}

/// What an extractor gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeypointShape {
    /// A set of pixels.
    Mask,
    /// A list of points.
    Points,
    /// One point.
    Point,
}

impl Extractor {
    /// Returns what this extractor gives.
    pub fn shape(&self) -> KeypointShape {
        match self {
            Extractor::DepthMask { .. } => KeypointShape::Mask,
            Extractor::Corners { .. } => KeypointShape::Points,
            Extractor::Centroid { .. } => KeypointShape::Point,
        }
    }
}

/// One field of an answer and what it may be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActionField {
    /// `pick` or `place`.
    pub name: String,
    /// The keypoints (points or a point) that are offered, in this order.
    pub one_of: Vec<String>,
}

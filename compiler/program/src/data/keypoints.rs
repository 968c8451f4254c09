//! What is found in each observation.

use crate::data::camera::PixelPoint;
use crate::data::shape::KeypointShape;
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
    /// The pixels whose colour lies within three ranges, both ends included. Gives a mask.
    ColorMask {
        /// Hue, degrees, 0 to 360; a range that ends below its beginning passes through 360.
        hue_deg: [f64; 2],
        /// Saturation, 0 to 1.
        saturation: [f64; 2],
        /// Value (brightness), 0 to 1.
        value: [f64; 2],
    },
    /// The pixels on one side of the level that best tells two kinds of pixels apart (Otsu's). Gives a mask.
    SplitMask {
        /// What is told apart.
        of: Channel,
        /// Which side is kept.
        keep: Side,
        /// Side of the square over which levels are averaged first, pixels, odd; 1 for none.
        blur_px: u32,
        /// How far the means of the two sides must lie apart, 0 to 1; where they do not, the mask is empty.
        contrast: f64,
    },
    /// A mask with its gaps filled: grown by a square and shrunk again. Gives a mask.
    Closed {
        /// The mask's name.
        mask: String,
        /// Side of the square, pixels.
        by_px: u32,
    },
    /// The largest piece of a mask. Gives a mask.
    Largest {
        /// The mask's name.
        mask: String,
    },
    /// Corners that a mask shows (OpenCV's goodFeaturesToTrack). Gives points.
    Corners {
        /// The mask's name.
        mask: String,
        /// What the detector looks at.
        of: Sight,
        /// A mask whose pixels are painted white in the picture before the detector sees it; none: it is as it is.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        white: Option<String>,
        /// The box in or near which corners are kept; none: all are.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inside: Option<Inside>,
        /// Side of the square image that the detector sees, pixels of that image; results are scaled back.
        image_px: u32,
        /// The most corners kept, strongest first.
        max: u32,
        /// Least accepted response as a fraction of the strongest, `0 < quality <= 1`.
        quality: f64,
        /// Least distance between corners, pixels of the detector's image.
        spacing_px: f64,
        /// Side of the square over which a response is averaged, pixels of the detector's image, odd.
        block_px: u32,
        /// What counts as a strong response.
        response: Response,
    },
    /// The mean of a mask's pixels, truncated to whole pixels. Gives a point.
    Centroid {
        /// The mask's name.
        mask: String,
    },
    /// The upright box around a mask. Gives a box.
    BoundingBox {
        /// The mask's name.
        mask: String,
    },
    /// The middle of a box: `floor((right - left) / 2) + left`, likewise for rows (protocol, section 4). Gives a point.
    BoxCenter {
        /// The box's name.
        of: String,
    },
    /// The middle of the picture, as that of a box around all of it. Gives a point.
    PictureCenter,
    /// The outline of a mask's largest piece as a polygon. Gives an outline.
    Contour {
        /// The mask's name.
        mask: String,
        /// How far the polygon may run beside the outline, pixels; 0 keeps every bend.
        tolerance_px: f64,
    },
    /// The middle of each side of an outline, in its order. Gives points.
    EdgeMiddles {
        /// The outline's name.
        outline: String,
    },
    /// Points at equal distances along an outline, from its first one on. Gives points.
    Along {
        /// The outline's name.
        outline: String,
        /// How many.
        count: u32,
    },
    /// Points moved towards another point. Gives points.
    Toward {
        /// The points' name.
        points: String,
        /// The name of the point that they move towards.
        to: String,
        /// By which share of their way to it, above 0 and below 1.
        share: f64,
    },
    /// Points that are always the same. Gives points.
    Fixed {
        /// The points.
        points: Vec<PixelPoint>,
    },
}

/// The box that corners are kept in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Inside {
    /// The box's name.
    pub of: String,
    /// How far beside it a corner may lie, pixels.
    pub margin_px: f64,
}

/// A number that each pixel of a picture has, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Its grey level.
    Brightness,
    /// How far its colour is from grey: three times its saturation, at most 1.
    Saturation,
}

/// One side of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// What is below it: dark, or grey.
    Low,
    /// What is above it: bright, or coloured.
    High,
}

/// What a corner detector looks at; outside of the mask all is black.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sight {
    /// The depth image (the paper's folding).
    Depth,
    /// The mask itself, white (the paper's smoothing).
    Mask,
    /// The camera's picture in grey.
    Picture,
    /// The same, its blue, green and red taken for hue, saturation and value: a mistake of the paper's code
    /// (protocol, section 4), only for comparisons with its recordings.
    MisreadPicture,
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

impl Extractor {
    /// Returns whether it needs the camera's depth and not its picture alone.
    pub fn needs_depth(&self) -> bool {
        match self {
            Extractor::DepthMask { .. } => true,
            Extractor::Corners { of, .. } => *of == Sight::Depth,
            _ => false,
        }
    }

    /// Returns the mask that this one is a cleaner form of; none where it is taken from the picture.
    pub fn refines(&self) -> Option<&str> {
        match self {
            Extractor::Closed { mask, .. } | Extractor::Largest { mask } => Some(mask),
            _ => None,
        }
    }

    /// Returns what this extractor gives.
    pub fn shape(&self) -> KeypointShape {
        match self {
            Extractor::DepthMask { .. }
            | Extractor::ColorMask { .. }
            | Extractor::SplitMask { .. }
            | Extractor::Closed { .. }
            | Extractor::Largest { .. } => KeypointShape::Mask,
            Extractor::BoundingBox { .. } => KeypointShape::Box,
            Extractor::Contour { .. } => KeypointShape::Outline,
            Extractor::Corners { .. }
            | Extractor::EdgeMiddles { .. }
            | Extractor::Along { .. }
            | Extractor::Toward { .. }
            | Extractor::Fixed { .. } => KeypointShape::Points,
            Extractor::Centroid { .. } | Extractor::BoxCenter { .. } | Extractor::PictureCenter => {
                KeypointShape::Point
            }
        }
    }
}

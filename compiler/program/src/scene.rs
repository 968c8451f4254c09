//! The interface to perception: what prompts and checks need to know about an observation.

use crate::data::camera::PixelPoint;

/// What an observation shows; implemented by the caller.
pub trait SceneView {
    /// Returns the points of a keypoint, one if it is a point; `None` for a mask, a box, an outline or an unknown
    /// name.
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>>;

    /// Returns the distance from `point` to the nearest pixel of a mask or box, pixels, 0 inside it; `None` for an
    /// unknown name or an empty mask.
    fn distance_px(&self, _region: &str, _point: PixelPoint) -> Option<f64> {
        None
    }

    /// Returns the number of a mask's pixels; `None` for an unknown name.
    fn area_px(&self, _mask: &str) -> Option<f64> {
        None
    }

    /// Returns a pixel of a mask by its number from 0, row by row; `None` beyond the last one, and if a scene does
    /// not know the pixels of its masks.
    fn region_pixel(&self, _mask: &str, _number: u64) -> Option<PixelPoint> {
        None
    }

    /// Returns the unreachable candidate points; none of them is offered.
    fn unreachable(&self) -> &[Unreachable] {
        &[]
    }
}

/// A missing keypoint, field or text. A scene of the same program never lacks one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is not known here")]
pub struct Missing {
    /// Its name.
    pub name: String,
}

impl Missing {
    /// Makes the error for a missing name.
    pub fn of(name: &str) -> Missing {
        Missing {
            name: name.to_owned(),
        }
    }
}

/// A point of the picture that cannot be picked from or placed on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreachable {
    /// The point.
    pub point: PixelPoint,
    /// The reason, as models are told it.
    pub why: String,
}

//! The interface to perception: what an observation shows, as far as prompts and checks need it.

use crate::data::camera::PixelPoint;

/// What an observation shows; implemented by the caller.
pub trait SceneView {
    /// Returns the points of a keypoint, one for a point; None for a mask, a box, an outline or an unknown name.
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>>;

    /// Returns the distance from `point` to the nearest pixel of a mask or box, pixels, 0 in it; None for an
    /// unknown name or an empty mask.
    fn distance_px(&self, region: &str, point: PixelPoint) -> Option<f64>;

    /// Returns the number of a mask's pixels; None for an unknown name.
    fn area_px(&self, mask: &str) -> Option<f64>;

    /// Returns a pixel of a mask by its number from 0, row by row; None beyond the last one, and where a scene
    /// does not know its masks' pixels.
    fn region_pixel(&self, _mask: &str, _number: u64) -> Option<PixelPoint> {
        None
    }

    /// Returns the candidate points that nothing can be done at, none of which is offered.
    fn unreachable(&self) -> &[Unreachable] {
        &[]
    }
}

/// A keypoint, a field or a text that is not there; a scene of the same program never lacks one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// Its name.
    pub name: String,
}

impl Missing {
    /// Names what is not there.
    pub fn of(name: &str) -> Missing {
        Missing {
            name: name.to_owned(),
        }
    }
}

impl std::fmt::Display for Missing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "`{}` is not known here", self.name)
    }
}

impl std::error::Error for Missing {}

/// A point of the picture that is out of reach of what picks and places there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreachable {
    /// The point.
    pub point: PixelPoint,
    /// Why, in words that a model is told.
    pub why: String,
}

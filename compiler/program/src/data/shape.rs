//! The shapes of keypoints.

/// The shape that an extractor gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum KeypointShape {
    /// A set of pixels.
    Mask,
    /// An upright rectangle.
    Box,
    /// A closed polygon.
    Outline,
    /// A list of points.
    Points,
    /// One point.
    Point,
}

impl KeypointShape {
    /// Returns its name in tables and messages, such as `a mask`.
    pub const fn words(self) -> &'static str {
        match self {
            KeypointShape::Mask => "a mask",
            KeypointShape::Box => "a box",
            KeypointShape::Outline => "an outline",
            KeypointShape::Points => "a list of points",
            KeypointShape::Point => "a point",
        }
    }

    /// Returns the same without its article.
    pub fn name(self) -> &'static str {
        self.words()
            .trim_start_matches("an ")
            .trim_start_matches("a ")
    }
}

//! What a keypoint is.

/// What an extractor gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

//! How points of a picture are written for a model, and read from its answers.
//!
//! In: pixels of the camera's picture; what a model's coordinates count, which of the two comes first, and the size
//! of the picture that the model works on. Out: texts such as `(41, 167)` or `[748, 185]`, and the pixels that such
//! numbers mean. No other code converts a coordinate. The runtime knows which model uses which frame.
//!
//! Pixel `(u, v)` is the square from `(u, v)` to `(u + 1, v + 1)`. A written point means the pixel's centre: in
//! fractions, percent and thousandths it is the centre's position between the picture's edges, in pixels the pixel of
//! the sent picture that contains it. A point that is read means the pixel that contains it.

mod frame;
mod notation;
mod scheme;

pub use frame::{CoordinateUnit, Frame, Order};
pub use notation::Notation;
pub use scheme::{Pointing, PointingError};

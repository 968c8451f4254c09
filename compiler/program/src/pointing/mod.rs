//! How points of a picture are written for a model, and read from it.
//!
//! In: pixels of the camera's picture; what a model's coordinates count, which of the two comes first, and the size of
//! the picture that the model works on. Out: texts such as `(41, 167)` or `[748, 185]`, and the pixels that such
//! numbers mean. No other code converts a coordinate. Which model uses which frame is known to the runtime.
//!
//! Pixel `(u, v)` is the square from `(u, v)` to `(u + 1, v + 1)`. What is written names its centre: in fractions,
//! percent and thousandths the centre's place between the picture's edges, in pixels the pixel of the sent picture
//! that holds it. What is read is the pixel that holds the place.

mod frame;
mod notation;
mod scheme;

pub use frame::{CoordinateUnit, Frame, Order};
pub use notation::Notation;
pub use scheme::{Pointing, PointingError};

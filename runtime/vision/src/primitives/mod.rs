//! The detectors below everything else: strong corners, corners between pixels, outlines, polygons with fewer vertices,
//! and smallest rectangles.
//!
//! In: grey pictures and points. Out: points and numbers. By default they are plain Rust, and give the same bits on
//! every machine and in WebAssembly. With the feature `opencv` OpenCV does the same work behind the same functions,
//! whose results are `Result`s because OpenCV may fail. Tests of that feature compare the two.

#[cfg(feature = "opencv")]
pub mod by_opencv;
pub mod own;

#[cfg(feature = "opencv")]
pub use by_opencv as chosen;
#[cfg(not(feature = "opencv"))]
pub use own as chosen;

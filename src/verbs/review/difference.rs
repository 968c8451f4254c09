//! The difference between two pictures, drawn and in words.
//!
//! Only data: `pictures.rs` compares, `sheets.rs` writes the drawing to a file.

/// The difference between two pictures.
pub struct Compared {
    /// Before, after and difference side by side, as a PNG file; `None` if nothing can be drawn.
    pub png: Option<Vec<u8>>,
    /// The difference in words.
    pub words: String,
    /// How many pixels differ, if known.
    pub n_changed: Option<u64>,
    /// Leftmost column, top row, rightmost column and bottom row of those, pixels.
    pub bounds: Option<[u32; 4]>,
}

//! Pictures as PNG files, bounded before they are decoded.

use crate::bounded;
use image::{ImageFormat, ImageReader, Limits, RgbImage};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The longest side of a picture that is read, pixels.
pub const MAX_SIDE_PX: u32 = 4096;
/// The largest file that is read, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Why a picture cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("cannot read `{path}`: {why}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        why: String,
    },
    /// The file is no PNG picture, or a damaged one.
    #[error("`{path}` is not a readable PNG picture: {why}")]
    NotAPicture {
        /// The file.
        path: PathBuf,
        /// What the decoder said.
        why: String,
    },
    /// The picture is too large.
    #[error("`{path}` is {found}; at most {MAX_SIDE_PX} by {MAX_SIDE_PX} pixels are read")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        found: String,
    },
}

/// Reads a PNG file.
pub fn load(path: &Path) -> Result<RgbImage, PictureError> {
    let unreadable = |why: String| PictureError::Unreadable {
        path: path.to_owned(),
        why,
    };
    let bytes = bounded::read(path, MAX_BYTES).map_err(unreadable)?;
    decode(&bytes, path)
}

/// Decodes the bytes of a PNG file; `path` names them in errors.
pub fn decode(bytes: &[u8], path: &Path) -> Result<RgbImage, PictureError> {
    let wrong = |why: String| PictureError::NotAPicture {
        path: path.to_owned(),
        why,
    };
    let size = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png).into_dimensions();
    let (width, height) = size.map_err(|error| wrong(error.to_string()))?;
    if width > MAX_SIDE_PX || height > MAX_SIDE_PX {
        return Err(PictureError::TooLarge {
            path: path.to_owned(),
            found: format!("{width} by {height} pixels"),
        });
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    reader.limits(limits);
    Ok(reader
        .decode()
        .map_err(|error| wrong(error.to_string()))?
        .into_rgb8())
}

/// Encodes a picture as PNG.
pub fn encode(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .expect("an RGB picture in memory can be encoded");
    bytes
}

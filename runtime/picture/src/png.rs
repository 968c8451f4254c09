//! Pictures as PNG files, bounded before they are decoded.

use crate::DepthImage;
use fab_base::files;
use image::{
    DynamicImage, GrayImage, ImageBuffer, ImageFormat, ImageReader, Limits, Luma, Pixel, Primitive,
    RgbImage,
};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The longest side of a picture accepted, pixels.
pub const MAX_SIDE_PX: u32 = 4096;
/// The largest file accepted, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Why a picture cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("cannot read `{path}`: {why}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        why: String,
    },
    /// The file is not a PNG picture, or is damaged.
    #[error("`{path}` is not a readable PNG picture: {why}")]
    NotAPicture {
        /// The file.
        path: PathBuf,
        /// The decoder's error.
        why: String,
    },
    /// A depth picture is not grey.
    #[error(
        "`{path}` is a picture in {found}, not a depth picture; those are grey, with 255 levels a metre in 8 bits or \
         with millimetres in 16"
    )]
    NotDepth {
        /// The file.
        path: PathBuf,
        /// Its colour type.
        found: String,
    },
    /// The picture is too large.
    #[error("`{path}` is {found}; at most {MAX_SIDE_PX} by {MAX_SIDE_PX} pixels are accepted")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        found: String,
    },
}

/// Reads a PNG file.
pub fn load(path: &Path) -> Result<RgbImage, PictureError> {
    decode(&read(path)?, path)
}

/// Reads a depth picture: 8-bit grey has 255 levels per metre, 16-bit grey is millimetres; 0 means no reading.
///
/// Returns metres. The recorded data and `fabc sim render --depth` have 8 bits; depth cameras write 16. Fails for
/// colour pictures, too.
pub fn load_depth(path: &Path) -> Result<DepthImage, PictureError> {
    let bytes = read(path)?;
    match decoded(&bytes, path)? {
        DynamicImage::ImageLuma8(levels) => Ok(metres(&levels, 255.0)),
        DynamicImage::ImageLuma16(levels) => Ok(metres(&levels, 1000.0)),
        other => Err(PictureError::NotDepth {
            path: path.to_owned(),
            found: format!("{:?}", other.color()),
        }),
    }
}

/// Converts grey levels to metres.
fn metres<T>(levels: &ImageBuffer<Luma<T>, Vec<T>>, levels_per_m: f32) -> DepthImage
where
    T: Primitive + Into<f32>,
    Luma<T>: Pixel<Subpixel = T>,
{
    DepthImage::from_fn(levels.width(), levels.height(), |column, row| {
        let level: f32 = levels.get_pixel(column, row).0[0].into();
        Luma([level / levels_per_m])
    })
}

fn read(path: &Path) -> Result<Vec<u8>, PictureError> {
    files::read(path, MAX_BYTES).map_err(|why| PictureError::Unreadable {
        path: path.to_owned(),
        why,
    })
}

/// Returns the width and height, pixels, from a PNG file's header; `None` if it is not a PNG file.
pub fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let (width, height) = reader.into_dimensions().ok()?;
    Some([width, height])
}

/// Decodes the bytes of a PNG file; `path` names them in errors.
pub fn decode(bytes: &[u8], path: &Path) -> Result<RgbImage, PictureError> {
    Ok(decoded(bytes, path)?.into_rgb8())
}

fn decoded(bytes: &[u8], path: &Path) -> Result<DynamicImage, PictureError> {
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
    reader.decode().map_err(|error| wrong(error.to_string()))
}

/// Encodes a picture as PNG.
pub fn encode(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .expect("an RGB picture in memory can be encoded");
    bytes
}

/// Encodes a grey picture as PNG.
pub fn encode_gray(picture: &GrayImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture
        .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
        .expect("a grey picture in memory can be encoded");
    bytes
}

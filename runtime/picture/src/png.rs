//! Pictures in files, as people see them; bounded before they are decoded. Writes PNG.
//!
//! In: a PNG or JPEG file; its content decides which, not its name. Out: the colours that a viewer shows: turned as Exif
//! says, and on white where the picture is transparent. A depth picture is a grey PNG, because JPEG changes its levels.

use crate::DepthImage;
use fab_base::files;
use fab_base::kinds::Kind;
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader};
use image::{PixelWithColorType, Rgb, RgbImage};
use std::fmt::Display;
use std::io::Cursor;
use std::path::Path;

/// The longest side of a picture accepted, pixels; phones take pictures of 8160.
pub const MAX_SIDE_PX: u32 = 8192;
/// The largest file accepted, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Why a picture cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct PictureError(String);

fn unusable(path: &Path, what: String) -> PictureError {
    PictureError(format!("`{}` {what}", path.display()))
}

/// Opens a PNG or JPEG file.
pub fn load(path: &Path) -> Result<RgbImage, PictureError> {
    opened(&read(path)?, path)
}

/// Opens the bytes of a PNG or JPEG file; `path` names them.
pub fn opened(bytes: &[u8], path: &Path) -> Result<RgbImage, PictureError> {
    let formats = [ImageFormat::Png, ImageFormat::Jpeg];
    decoded(bytes, path, &formats, CONVERTED).map(on_white)
}

/// Reads a depth picture: 8-bit grey has 255 levels per metre, 16-bit grey is millimetres; 0, and 65535 in 16 bits,
/// mean no reading.
///
/// Returns metres. The recorded data and `fabc sim render --depth` have 8 bits; depth cameras write 16. Fails for
/// colour pictures, too.
pub fn load_depth(path: &Path) -> Result<DepthImage, PictureError> {
    let picture = decoded(&read(path)?, path, &[ImageFormat::Png], GREY)?;
    let (width, height) = (picture.width(), picture.height());
    let metres: Vec<f32> = match picture {
        DynamicImage::ImageLuma8(levels) => {
            let levels = levels.into_raw().into_iter();
            levels.map(|level| f32::from(level) / 255.0).collect()
        }
        DynamicImage::ImageLuma16(levels) => {
            // The largest level is no distance: cameras write it where they read none.
            let levels = levels.into_raw().into_iter().map(|level| level % u16::MAX);
            levels.map(|level| f32::from(level) / 1000.0).collect()
        }
        other => {
            let found = other.color();
            let what = format!(
                "is a picture in {found:?}, not a depth picture; those are grey, with 255 levels a metre in 8 bits or \
                 with millimetres in 16"
            );
            return Err(unusable(path, what));
        }
    };
    Ok(DepthImage::from_raw(width, height, metres).expect("each pixel has a level"))
}

/// What helps if a picture is of another format.
const CONVERTED: &str = "PNG and JPEG are read, and ImageMagick converts it: `magick FILE out.png`";
const GREY: &str = "a depth picture is a grey PNG, of 8 or 16 bits, since a format for photographs changes distances: write it from the camera's readings";

fn read(path: &Path) -> Result<Vec<u8>, PictureError> {
    let bytes = files::read(path, MAX_BYTES);
    bytes.map_err(|why| PictureError(format!("cannot read `{}`: {why}", path.display())))
}

/// Returns the width and height, pixels, from a PNG file's header; `None` if it is not a PNG file.
pub fn size(bytes: &[u8]) -> Option<[u32; 2]> {
    let reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.into_dimensions().ok().map(Into::into)
}

/// Decodes a picture and turns it as its Exif data say.
fn decoded(
    bytes: &[u8],
    path: &Path,
    formats: &[ImageFormat],
    otherwise: &str,
) -> Result<DynamicImage, PictureError> {
    let wrong = |why: &dyn Display| {
        let what = format!("is not a readable picture in PNG or JPEG: {why}");
        unusable(path, what)
    };
    let guessed = image::guess_format(bytes).ok();
    let Some(format) = guessed.filter(|format| formats.contains(format)) else {
        let Some(kind) = Kind::of(bytes) else {
            return Err(wrong(&"it begins like no picture"));
        };
        let remedy = kind.remedy.unwrap_or(otherwise);
        return Err(unusable(path, format!("is {}; {remedy}", kind.name)));
    };
    // The decoder would fill up what is missing with grey.
    let has_end = || bytes.windows(2).any(|mark| mark == [0xff, 0xd9]);
    if format == ImageFormat::Jpeg && !has_end() {
        return Err(wrong(&"it is cut off, or lacks its end mark"));
    }
    let decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder();
    let mut decoder = decoder.map_err(|error| wrong(&error))?;
    let (width, height) = decoder.dimensions();
    if width > MAX_SIDE_PX || height > MAX_SIDE_PX {
        let what = format!(
            "is {width} by {height} pixels; at most {MAX_SIDE_PX} by {MAX_SIDE_PX} pixels are accepted: `magick FILE \
             -resize 4096x4096 out.png` makes it smaller"
        );
        return Err(unusable(path, what));
    }
    // Cameras store what the sensor saw, and every viewer turns it.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let picture = DynamicImage::from_decoder(decoder);
    let mut picture = picture.map_err(|error| wrong(&error))?;
    picture.apply_orientation(orientation);
    Ok(picture)
}

/// Puts a picture on white, as viewers do.
fn on_white(picture: DynamicImage) -> RgbImage {
    if !picture.color().has_alpha() {
        return picture.into_rgb8();
    }
    let picture = picture.into_rgba8();
    RgbImage::from_fn(picture.width(), picture.height(), |column, row| {
        let [red, green, blue, alpha] = picture.get_pixel(column, row).0.map(u32::from);
        Rgb([red, green, blue]
            .map(|level| ((level * alpha + 255 * (255 - alpha) + 127) / 255) as u8))
    })
}

/// Encodes a picture, in colour or grey, as PNG.
pub fn encode<P: PixelWithColorType<Subpixel = u8>>(picture: &ImageBuffer<P, Vec<u8>>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let written = picture.write_to(&mut bytes, ImageFormat::Png);
    written.expect("a picture in memory can be encoded");
    bytes.into_inner()
}

#[cfg(test)]
mod tests;

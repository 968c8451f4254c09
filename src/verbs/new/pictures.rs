//! Loads the user's pictures, or rejects them and says how to convert them.

use crate::exit::Failure;
use crate::verbs::new::shown;
use fab_agent::draft::NamedPicture;
use fab_picture::png;
use fab_picture::png::PictureError;
use image::ImageFormat;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// How many bytes of a file are read to recognize its format.
const HEAD_BYTES: u64 = 32;

/// Reads a PNG picture.
pub fn load(path: &Path) -> Result<NamedPicture, Failure> {
    let name = shown(path);
    match png::load(path) {
        Ok(picture) => Ok(NamedPicture { name, picture }),
        Err(error @ PictureError::TooLarge { .. }) => {
            Err(Failure::environment(error).saying(&conversion(&name)))
        }
        Err(error @ PictureError::NotAPicture { .. }) => Err(match other_format(path) {
            Some("empty") => {
                Failure::environment(format!("`{name}` is empty; right is a PNG picture"))
            }
            Some(format) => {
                Failure::environment(format!("`{name}` is a {format} picture; fabc reads PNG"))
                    .saying(&conversion(&name))
            }
            None => Failure::environment(error),
        }),
        Err(error) => Err(Failure::environment(error)),
    }
}

/// Returns the command that makes a picture square, small enough, and PNG.
pub fn conversion(name: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "._-/".contains(letter);
    let quoted = match name.chars().all(is_plain) {
        true => name.to_owned(),
        false => format!("'{}'", name.replace('\'', r"'\''")),
    };
    format!(
        "ImageMagick cuts it around its middle: `magick {quoted} -resize 480x480^ -gravity center -extent 480x480 out.png`"
    )
}

/// Names the format of a file that is not PNG; `empty` if it has no bytes.
fn other_format(path: &Path) -> Option<&'static str> {
    let mut head = Vec::new();
    let file = File::open(path).ok()?;
    file.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    if head.is_empty() {
        return Some("empty");
    }
    // Phones write this format.
    if head.get(4..8) == Some(b"ftyp") && matches!(head.get(8..11), Some(b"hei" | b"mif")) {
        return Some("HEIC");
    }
    match image::guess_format(&head).ok()? {
        ImageFormat::Jpeg => Some("JPEG"),
        ImageFormat::Gif => Some("GIF"),
        ImageFormat::WebP => Some("WebP"),
        ImageFormat::Tiff => Some("TIFF"),
        ImageFormat::Bmp => Some("BMP"),
        ImageFormat::Avif => Some("AVIF"),
        ImageFormat::Pnm => Some("PNM"),
        _ => None,
    }
}

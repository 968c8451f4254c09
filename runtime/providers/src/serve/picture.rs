//! Decodes the pictures of a request: PNG and JPEG in base64, each handed to the model as PNG.

use super::refusal::Refusal;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::Png;
use fab_picture::png;
use image::{ImageFormat, ImageReader};
use std::cell::Cell;
use std::io::Cursor;
use std::path::Path;

/// The longest side of a picture of a request, pixels.
const MAX_SIDE_PX: u32 = 4096;

/// The most pixels of all pictures of a request, two of the largest: models decode them into memory.
const MAX_PIXELS: u64 = 2 * (MAX_SIDE_PX as u64) * (MAX_SIDE_PX as u64);

/// How the address of a picture begins, and what it is then.
const KINDS: [(&str, &str, ImageFormat); 3] = [
    ("data:image/png;base64,", "PNG", ImageFormat::Png),
    ("data:image/jpeg;base64,", "JPEG", ImageFormat::Jpeg),
    ("data:image/jpg;base64,", "JPEG", ImageFormat::Jpeg),
];

/// The pictures of one request.
#[derive(Default)]
pub(super) struct Pictures {
    pixels: Cell<u64>,
}

impl Pictures {
    /// Decodes a picture from a `data:` address; `path` names it in refusals.
    pub(super) fn decode(&self, address: &str, path: &str) -> Result<Png, Refusal> {
        let wrong = |why: &str| Refusal::of(path, format!("`{path}` {why}"));
        let begins_with = |start: &str| {
            let found = address.get(..start.len());
            found.is_some_and(|found| found.eq_ignore_ascii_case(start))
        };
        if !begins_with("data:") {
            return Err(wrong(
                "leads elsewhere, and nothing is fetched: send the picture as a data: URL in base64",
            ));
        }
        let kind = KINDS.iter().find(|(start, ..)| begins_with(start));
        let Some((start, name, format)) = kind else {
            return Err(wrong(
                "is neither a PNG nor a JPEG in base64; it must begin with `data:image/png;base64,` or `data:image/jpeg;base64,`",
            ));
        };
        let bytes = STANDARD.decode(&address[start.len()..]);
        let bytes = bytes.map_err(|_| wrong("is not base64"))?;
        let size = ImageReader::with_format(Cursor::new(&bytes), *format).into_dimensions();
        let (width, height) = size.map_err(|_| wrong(&format!("is not a {name} picture")))?;
        if width.max(height) > MAX_SIDE_PX {
            return Err(wrong(&format!(
                "is {width} by {height} pixels; at most {MAX_SIDE_PX} by {MAX_SIDE_PX} are taken"
            )));
        }
        let pixels = self.pixels.get() + u64::from(width) * u64::from(height);
        if pixels > MAX_PIXELS {
            return Err(wrong(&format!(
                "is one too many: the pictures of a request may have {MAX_PIXELS} pixels together"
            )));
        }
        self.pixels.set(pixels);
        let opened = png::opened(&bytes, Path::new(path));
        let opened = opened.map_err(|error| Refusal::of(path, error.to_string()))?;
        // What a model sees is what a person sees, also where the picture is transparent.
        Ok(Png::new(match (format, opened.note) {
            (ImageFormat::Png, None) => bytes,
            _ => png::encode(&opened.rgb),
        }))
    }
}

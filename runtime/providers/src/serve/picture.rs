//! Decodes the pictures of a request: PNG and JPEG in base64, each handed to the model as PNG.

use super::refusal::Refusal;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::Png;
use fab_picture::png::{self, MAX_SIDE_PX};
use image::codecs::jpeg::JpegDecoder;
use image::{DynamicImage, ImageDecoder, ImageResult};
use std::cell::Cell;
use std::io::Cursor;

/// The most pixels of all pictures of a request, two of the largest: models decode them into memory.
const MAX_PIXELS: u64 = 2 * (MAX_SIDE_PX as u64) * (MAX_SIDE_PX as u64);

/// A kind of picture.
struct Kind {
    /// How its address begins.
    start: &'static str,
    name: &'static str,
    /// Width and height, from the file's head.
    size: fn(&[u8]) -> Option<[u32; 2]>,
    to_png: fn(Vec<u8>) -> ImageResult<Vec<u8>>,
}

const KINDS: [Kind; 3] = [
    Kind {
        start: "data:image/png;base64,",
        name: "PNG",
        size: png::size,
        to_png: Ok,
    },
    JPEG,
    Kind {
        start: "data:image/jpg;base64,",
        ..JPEG
    },
];

const JPEG: Kind = Kind {
    start: "data:image/jpeg;base64,",
    name: "JPEG",
    size: |bytes| {
        let (width, height) = JpegDecoder::new(Cursor::new(bytes)).ok()?.dimensions();
        Some([width, height])
    },
    to_png: |bytes| {
        let mut decoder = JpegDecoder::new(Cursor::new(bytes))?;
        // Cameras store the picture as the sensor saw it, and say how to turn it; programs show it turned.
        let orientation = decoder.orientation()?;
        let mut picture = DynamicImage::from_decoder(decoder)?;
        picture.apply_orientation(orientation);
        Ok(png::encode(&picture.into_rgb8()))
    },
};

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
        let Some(kind) = KINDS.iter().find(|kind| begins_with(kind.start)) else {
            return Err(wrong(
                "is neither a PNG nor a JPEG in base64; it must begin with `data:image/png;base64,` or `data:image/jpeg;base64,`",
            ));
        };
        let bytes = STANDARD.decode(&address[kind.start.len()..]);
        let bytes = bytes.map_err(|_| wrong("is not base64"))?;
        let not_one = || wrong(&format!("is not a {} picture", kind.name));
        let [width, height] = (kind.size)(&bytes).ok_or_else(not_one)?;
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
        let converted = (kind.to_png)(bytes);
        converted
            .map(Png::new)
            .map_err(|error| wrong(&format!("is not a readable {} picture: {error}", kind.name)))
    }
}

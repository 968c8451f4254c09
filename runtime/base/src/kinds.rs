//! What a file really is, by how it begins.
//!
//! In: the bytes of a file that its reader refused. Out: a [`Kind`], for a message that helps. No reader decides by this
//! table whether to read a file.

/// A kind of file that people bring by mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its name, such as `a JPEG picture`.
    pub name: &'static str,
    /// What to do about it; `None` for a picture, which a program for pictures converts.
    pub remedy: Option<&'static str>,
}

/// Where the bytes of a mark stand, the mark, the name, and what to do about it.
type Row = (usize, &'static [u8], &'static str, Option<&'static str>);

const LFS: &str = "a Git LFS pointer, not the file itself";
const PULL: Option<&str> = Some("`git lfs pull` fetches it");
const PAGE: Option<&str> = Some("download the file itself, not the page that shows it");
const ZIP: &str = "a zip archive, such as `.npz` or `.xlsx`";
const ARRAY: Option<&str> = Some("save the one array with `numpy.save`, or a table as CSV");
const PAINT: Option<&str> = Some("take the picture out of it");
const START: Option<&str> = Some("give it where positions are wanted");
const UTF_8: Option<&str> = Some("save it as UTF-8");

/// What text cannot be, although its bytes are text; in small letters.
const TEXTS: [Row; 4] = [
    (0, b"version https://git-lfs.", LFS, PULL),
    (0, b"<!doctype html", "a web page", PAGE),
    (0, b"<html", "a web page", PAGE),
    (0, b"<head", "a web page", PAGE),
];

const BINARIES: [Row; 29] = [
    (0, b"\x89PNG\r\n\x1a\n", "a PNG picture", None),
    (0, b"\xff\xd8\xff", "a JPEG picture", None),
    (8, b"WEBPVP8", "a WebP picture", None),
    (4, b"ftyphe", "a HEIC picture", None),
    (4, b"ftypmif", "a HEIC picture", None),
    (4, b"ftypavi", "an AVIF picture", None),
    (4, b"ftyp", "a video", PAINT),
    (4, b"JXL \r\n", "a JPEG XL picture", None),
    (0, b"GIF8", "a GIF picture", None),
    (0, b"II*\0", "a TIFF picture", None),
    (0, b"MM\0*", "a TIFF picture", None),
    (0, b"\x76\x2f\x31\x01", "an OpenEXR picture", None),
    (0, b"BM", "a BMP picture", None),
    (0, b"P5\n", "a PGM picture", None),
    (0, b"P6\n", "a PPM picture", None),
    (0, b"%PDF-", "a PDF document", PAINT),
    (0, b"\x93NUMPY", "an array of NumPy (`.npy`)", START),
    (0, b"PK\x03\x04", ZIP, ARRAY),
    (0, b"\xd0\xcf\x11\xe0", "a table of Excel", ARRAY),
    (0, b"\x89HDF", "an HDF5 file", ARRAY),
    (0, b"MATLAB 5", "a MATLAB file", ARRAY),
    (0, b"\x80\x02", "a Python pickle", ARRAY),
    (0, b"\x80\x03", "a Python pickle", ARRAY),
    (0, b"\x80\x04", "a Python pickle", ARRAY),
    (0, b"\x80\x05", "a Python pickle", ARRAY),
    (
        0,
        b"\x1f\x8b",
        "packed with gzip",
        Some("`gunzip` unpacks it"),
    ),
    (0, b"\xff\xfe", "text in UTF-16", UTF_8),
    (0, b"\xfe\xff", "text in UTF-16", UTF_8),
    (0, b"", "empty", Some("write or fetch it again")),
];

impl Kind {
    /// Returns what bytes are that should be something else; `None` if that is not known.
    pub fn of(bytes: &[u8]) -> Option<Kind> {
        let is_of = |(at, mark, ..): &&Row| {
            let is_there = bytes.get(*at..).is_some_and(|rest| rest.starts_with(mark));
            is_there && (!mark.is_empty() || bytes.is_empty())
        };
        Kind::of_text(bytes).or_else(|| BINARIES.iter().find(is_of).map(Kind::of_row))
    }

    /// Returns what bytes are that are text, but not the text of any file that is read here.
    pub(crate) fn of_text(bytes: &[u8]) -> Option<Kind> {
        let begin = without_mark(bytes).trim_ascii_start();
        let is_of = |(_, mark, ..): &&Row| {
            let found = begin.get(..mark.len());
            found.is_some_and(|found| found.eq_ignore_ascii_case(mark))
        };
        let utf_16 = Kind {
            name: "text in UTF-16",
            remedy: UTF_8,
        };
        let known = TEXTS.iter().find(is_of).map(Kind::of_row);
        known.or_else(|| is_utf_16(bytes).then_some(utf_16))
    }

    fn of_row(&(_, _, name, remedy): &Row) -> Kind {
        Kind { name, remedy }
    }

    /// Returns it as the end of a sentence: `it is a web page; download …`.
    pub fn sentence(&self) -> String {
        let remedy = self.remedy.map(|remedy| format!("; {remedy}"));
        format!("it is {}{}", self.name, remedy.unwrap_or_default())
    }
}

/// Returns whether every second byte at the beginning is zero, as in UTF-16 without its byte-order mark.
fn is_utf_16(bytes: &[u8]) -> bool {
    let begin = &bytes[..bytes.len().min(64) / 2 * 2];
    let are_zero = |first: usize| begin.iter().skip(first).step_by(2).all(|byte| *byte == 0);
    begin.len() >= 4 && are_zero(0) != are_zero(1)
}

/// Returns bytes without the byte-order mark of UTF-8, which editors of Windows write.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

#[cfg(test)]
mod tests;

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
    /// Where the bytes of its mark stand, and the mark.
    mark: (usize, &'static [u8]),
}

const fn row(at: usize, mark: &'static [u8], name: &'static str, remedy: &'static str) -> Kind {
    let remedy = if remedy.is_empty() {
        None
    } else {
        Some(remedy)
    };
    Kind {
        name,
        remedy,
        mark: (at, mark),
    }
}

const LFS: &str = "a Git LFS pointer, not the file itself";
const PAGE: &str = "download the file itself, not the page that shows it";
const ZIP: &str = "a zip archive, such as `.npz` or `.xlsx`";
const ARRAY: &str = "save the one array with `numpy.save`, or a table as CSV";
const UTF_16: Kind = row(0, b"\xff\xfe", "text in UTF-16", "save it as UTF-8");

/// What text cannot be, although its bytes are text; in small letters.
const TEXTS: [Kind; 3] = [
    row(
        0,
        b"version https://git-lfs.",
        LFS,
        "`git lfs pull` fetches it",
    ),
    row(0, b"<!doctype html", "a web page", PAGE),
    row(0, b"<html", "a web page", PAGE),
];

const BINARIES: [Kind; 12] = [
    row(0, b"\x89PNG\r\n\x1a\n", "a PNG picture", ""),
    row(0, b"\xff\xd8\xff", "a JPEG picture", ""),
    row(8, b"WEBPVP8", "a WebP picture", ""),
    row(4, b"ftyphe", "a HEIC picture", ""),
    row(0, b"GIF8", "a GIF picture", ""),
    row(0, b"II*\0", "a TIFF picture", ""),
    row(0, b"%PDF-", "a PDF document", "take the picture out of it"),
    row(
        0,
        b"\x93NUMPY",
        "an array of NumPy (`.npy`)",
        "give it where positions are wanted",
    ),
    row(0, b"PK\x03\x04", ZIP, ARRAY),
    row(0, b"\x80\x04", "a Python pickle", ARRAY),
    row(0, b"\x80\x05", "a Python pickle", ARRAY),
    UTF_16,
];

const EMPTY: Kind = row(0, b"", "empty", "write or fetch it again");

impl Kind {
    /// Returns what bytes are that should be something else; `None` if that is not known.
    pub fn of(bytes: &[u8]) -> Option<Kind> {
        let is_of = |kind: &&Kind| {
            let (at, mark) = kind.mark;
            bytes.get(at..).is_some_and(|rest| rest.starts_with(mark))
        };
        let binary = || BINARIES.iter().find(is_of).copied();
        let empty = bytes.is_empty().then_some(EMPTY);
        empty.or_else(|| Kind::of_text(bytes)).or_else(binary)
    }

    /// Returns what bytes are that are text, but not the text of any file that is read here.
    pub(crate) fn of_text(bytes: &[u8]) -> Option<Kind> {
        let begin = without_mark(bytes).trim_ascii_start();
        let is_of = |kind: &&Kind| {
            let found = begin.get(..kind.mark.1.len());
            found.is_some_and(|found| found.eq_ignore_ascii_case(kind.mark.1))
        };
        let known = TEXTS.iter().find(is_of).copied();
        known.or_else(|| is_utf_16(bytes).then_some(UTF_16))
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

//! The texts of a compilation, and places in them.

use std::ops::Range;

/// One file's name and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The name given to the loader.
    pub name: String,
    /// The text; it is read only once.
    pub text: String,
    /// Positions with known line and column, in order; the first is the beginning.
    marks: Vec<Mark>,
}

/// A position in a text: the beginning of a line, or of a piece of a long line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mark {
    byte: usize,
    line: usize,
    column: usize,
}

/// The most bytes between two marks, so that a lookup in a line of a megabyte is as fast as any other.
const MARK_EVERY: usize = 256;

/// Every file of one compilation, in the order in which they were first read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    list: Vec<Source>,
}

/// A file of a [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(usize);

impl FileId {
    /// The first file.
    pub const FIRST: FileId = FileId(0);

    /// Returns its index in its [`Sources`].
    pub fn index(self) -> usize {
        self.0
    }
}

/// A piece of one file, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// Makes the span of some bytes of a file.
    pub fn new(file: FileId, range: Range<usize>) -> Span {
        Span {
            file,
            start: range.start,
            end: range.end,
        }
    }

    /// Returns the range of bytes.
    pub fn range(self) -> Range<usize> {
        self.start..self.end
    }

    /// Returns whether all of another span is in it.
    pub fn contains(self, other: Span) -> bool {
        self.file == other.file && self.start <= other.start && other.end <= self.end
    }

    /// Returns whether they share a byte.
    pub fn overlaps(self, other: Span) -> bool {
        self.file == other.file && self.start.max(other.start) < self.end.min(other.end)
    }
}

impl Sources {
    /// Adds a file and returns its id.
    pub fn add(&mut self, name: String, text: String) -> FileId {
        let marks = marks(&text);
        self.list.push(Source { name, text, marks });
        FileId(self.list.len() - 1)
    }

    /// Returns a file.
    pub fn get(&self, file: FileId) -> &Source {
        &self.list[file.0]
    }

    /// Returns every file.
    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        self.list.iter()
    }

    /// Returns the text of a span.
    pub fn text(&self, span: Span) -> &str {
        &self.get(span.file).text[span.range()]
    }
}

impl Source {
    /// Returns line and column of a byte, both from 1; columns count characters.
    ///
    /// `byte` must be on a character boundary, at most at the end. The time does not grow with the text.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        let after = self.marks.partition_point(|mark| mark.byte <= byte);
        // The first mark is the beginning of the text, so a mark is at or before every byte.
        let mark = self.marks[after - 1];
        let characters = self.text[mark.byte..byte].chars().count();
        (mark.line, mark.column + characters)
    }
}

fn marks(text: &str) -> Vec<Mark> {
    let mut last = Mark {
        byte: 0,
        line: 1,
        column: 1,
    };
    let mut marks = vec![last];
    let (mut line, mut column) = (1, 1);
    for (byte, character) in text.char_indices() {
        if byte - last.byte >= MARK_EVERY {
            last = Mark { byte, line, column };
            marks.push(last);
        }
        if character == '\n' {
            line += 1;
            column = 1;
            last = Mark {
                byte: byte + 1,
                line,
                column,
            };
            marks.push(last);
        } else {
            column += 1;
        }
    }
    marks
}

/// Returns line and column of a byte, both from 1; columns count characters.
///
/// Counts from the beginning of the text; [`Source::line_and_column`] does not.
pub fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = &text[..byte];
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests;

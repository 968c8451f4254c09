//! The texts of a compilation, and places in them.

use std::ops::Range;

/// One file's name and text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The name given to the loader.
    pub name: String,
    /// The text; it is read only once.
    pub text: String,
    /// Where each line begins.
    lines: Vec<usize>,
}

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
}

impl Sources {
    /// Adds a file and returns its id.
    pub fn add(&mut self, name: String, text: String) -> FileId {
        let ends = text.match_indices('\n').map(|(end, _)| end + 1);
        let lines = std::iter::once(0).chain(ends).collect();
        self.list.push(Source { name, text, lines });
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
    /// `byte` must be on a character boundary, at most at the end.
    pub fn line_and_column(&self, byte: usize) -> (usize, usize) {
        // The first line begins at 0, so one begins at or before every byte.
        let line = self.lines.partition_point(|start| *start <= byte);
        let before = &self.text[self.lines[line - 1]..byte];
        (line, before.chars().count() + 1)
    }
}

#[cfg(test)]
mod tests;

//! JSON-lines journals, written one whole, synced line at a time.
//!
//! A crash loses at most the line being written. Bytes after the last newline are such a torn line: a [`Reader`]
//! ignores them, and the next appended line replaces them.

use crate::files::open_bounded;
use crate::kinds::{Kind, without_mark};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;
use std::time::Duration;

/// The longest line accepted, bytes.
pub const MAX_LINE_BYTES: usize = 16 << 20;

/// Serializes a value as one line, without the newline.
///
/// Fails if a map in the value has keys that are not strings.
pub fn text(line: &impl Serialize) -> io::Result<String> {
    Ok(serde_json::to_string(line)?)
}

// ---- writing -------------------------------------------------------------------------------------

/// How often a journal that is locked is tried, and how long to wait before each further try.
const LOCK_TRIES: u32 = 10;
const LOCK_WAIT: Duration = Duration::from_millis(20);

/// A journal open for appending.
#[derive(Debug)]
pub struct Appender {
    file: File,
    /// Bytes up to the end of the last line to be kept.
    whole_bytes: u64,
    /// Whether the file may hold bytes beyond these.
    has_tail: bool,
}

impl Appender {
    /// Opens a journal, creating it if necessary. The file does not change until a line is appended.
    ///
    /// All of its bytes are kept until [`Appender::keep`] says otherwise.
    pub fn open(path: &Path) -> io::Result<Appender> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        let whole_bytes = file.metadata()?.len();
        Ok(Appender {
            file,
            whole_bytes,
            has_tail: false,
        })
    }

    /// Likewise, but keeps only the whole lines of a journal of at most `max_bytes`; fails with the reason.
    pub fn open_after_whole_lines(path: &Path, max_bytes: u64) -> Result<Appender, String> {
        let mut appender = Appender::open(path).map_err(|error| error.to_string())?;
        let mut lines = Reader::open(path, max_bytes)?;
        while lines.next_line()?.is_some() {}
        appender.keep(lines.whole_bytes());
        Ok(appender)
    }

    /// Makes sure that no other process writes the journal; the system releases the lock when this process ends.
    ///
    /// Returns whether the journal was free. Some file systems have no locks; there the user has to take care.
    pub fn lock(&self) -> bool {
        // A program that is just being started holds the files of its parent for a moment, also those that were closed.
        (0..LOCK_TRIES).any(|tried| {
            if tried > 0 {
                std::thread::sleep(LOCK_WAIT);
            }
            !matches!(self.file.try_lock(), Err(TryLockError::WouldBlock))
        })
    }

    /// Sets how many bytes are kept; the next line replaces the rest.
    pub fn keep(&mut self, whole_bytes: u64) {
        self.whole_bytes = whole_bytes;
        self.has_tail = true;
    }

    /// Appends a line and waits until it is on disk.
    pub fn append(&mut self, line: &impl Serialize) -> io::Result<()> {
        self.append_text(text(line)?)
    }

    /// Appends an already serialized line and waits until it is on disk.
    pub fn append_text(&mut self, mut line: String) -> io::Result<()> {
        if self.has_tail {
            self.file.set_len(self.whole_bytes)?;
        }
        line.push('\n');
        // If this fails, a partial line may stay, which must not damage the next one.
        self.has_tail = true;
        self.file.write_all(line.as_bytes())?;
        self.file.sync_data()?;
        self.has_tail = false;
        self.whole_bytes += line.len() as u64;
        Ok(())
    }
}

// ---- reading -------------------------------------------------------------------------------------

/// Reads the whole lines of a journal, one at a time.
#[derive(Debug)]
pub struct Reader {
    file: BufReader<io::Take<File>>,
    line: Vec<u8>,
    number: usize,
    whole_bytes: u64,
}

impl Reader {
    /// Opens a journal of at most `max_bytes`; fails with the reason.
    pub fn open(path: &Path, max_bytes: u64) -> Result<Reader, String> {
        Ok(Reader {
            file: BufReader::new(open_bounded(path, max_bytes)?),
            line: Vec::new(),
            number: 0,
            whole_bytes: 0,
        })
    }

    /// Reads the next whole line that is not blank, without its newline; fails with the reason.
    pub fn next_line(&mut self) -> Result<Option<&[u8]>, String> {
        loop {
            self.line.clear();
            let mut limited = Read::take(&mut self.file, MAX_LINE_BYTES as u64);
            let length = limited
                .read_until(b'\n', &mut self.line)
                .map_err(|error| error.to_string())?;
            self.number += 1;
            if self.line.pop() != Some(b'\n') {
                return match length {
                    MAX_LINE_BYTES => Err(format!(
                        "line {} is longer than {MAX_LINE_BYTES} bytes",
                        self.number
                    )),
                    _ => Ok(None),
                };
            }
            self.whole_bytes += length as u64;
            if self.number == 1 {
                // An editor may have put a mark before the first line.
                let length = self.line.len() - without_mark(&self.line).len();
                self.line.drain(..length);
            }
            if !self.line.trim_ascii().is_empty() {
                return Ok(Some(&self.line));
            }
        }
    }

    /// Reads the next whole line as JSON; fails with the reason if it cannot be read or is damaged.
    pub fn read<T: DeserializeOwned>(&mut self) -> Result<Option<T>, String> {
        let Some(line) = self.next_line()? else {
            return Ok(None);
        };
        let kind = Kind::of(line);
        serde_json::from_slice(line)
            .map(Some)
            .map_err(|error| match kind {
                Some(kind) if self.number == 1 => kind.sentence(),
                _ => format!("line {} is damaged: {error}", self.number),
            })
    }

    /// Returns the number of the last line read, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Returns the bytes up to the end of the last whole line read.
    pub fn whole_bytes(&self) -> u64 {
        self.whole_bytes
    }
}

#[cfg(test)]
#[path = "tests/jsonl.rs"]
mod tests;

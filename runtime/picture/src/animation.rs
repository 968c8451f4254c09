//! Animated pictures as GIF files, written picture by picture.
//!
//! In: pictures of one size, each with how long it is shown. Out: a file that appears under its name once it is whole.
//! Pixels that stay as they were are transparent, and one [`Palette`] serves all pictures. Memory does not grow with
//! the number of pictures. What is drawn, and when, is the caller's business.

use fab_base::files::NewFile;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use image::RgbImage;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The most colours of a palette; one more number means "as before".
pub const MAX_COLOURS: usize = 255;
/// The number of pixels that stay as they were.
const SAME: u8 = 255;

/// Why an animation cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum AnimationError {
    /// The file cannot be written.
    #[error("cannot write `{path}`: {why}")]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        why: String,
    },
    /// A picture has another size than the first one.
    #[error("a picture of {found:?} pixels does not fit an animation of {expected:?}")]
    Size {
        /// Width and height of the picture.
        found: [u32; 2],
        /// Width and height of the first one.
        expected: [u32; 2],
    },
}

/// The colours of an animation.
#[derive(Clone, Debug)]
pub struct Palette {
    colours: Vec<[u8; 3]>,
    /// The number of the nearest colour, of every colour looked up so far.
    nearest: HashMap<[u8; 3], u8>,
}

impl Palette {
    /// Takes the first [`MAX_COLOURS`] colours; black, if there is none.
    pub fn new(colours: impl IntoIterator<Item = [u8; 3]>) -> Palette {
        let mut colours: Vec<[u8; 3]> = colours.into_iter().take(MAX_COLOURS).collect();
        if colours.is_empty() {
            colours.push([0; 3]);
        }
        Palette {
            colours,
            nearest: HashMap::new(),
        }
    }

    /// Returns the number of the nearest colour; of equally near ones, the first.
    fn number(&mut self, colour: [u8; 3]) -> u8 {
        let colours = &self.colours;
        *self.nearest.entry(colour).or_insert_with(|| {
            let distance = |other: &[u8; 3]| -> u32 {
                let off = |channel: usize| u32::from(other[channel].abs_diff(colour[channel]));
                (0..3).map(|channel| off(channel).pow(2)).sum()
            };
            let numbered = (0_u8..).zip(colours);
            let nearest = numbered.min_by_key(|(_, other)| distance(other));
            nearest.map_or(0, |(number, _)| number)
        })
    }

    /// Returns 256 colours as a GIF file has them.
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.colours.concat();
        bytes.resize(3 * 256, 0);
        bytes
    }
}

/// An animation that is being written; dropping it before [`Animation::finish`] leaves no file.
pub struct Animation {
    encoder: Encoder<Counted>,
    palette: Palette,
    path: PathBuf,
    size: [u32; 2],
    /// What a viewer shows before the waiting picture.
    shown: Option<Vec<u8>>,
    /// The picture whose time is not over yet.
    waiting: Option<Waiting>,
    pictures: u32,
    shown_cs: u64,
}

/// A picture that is not written yet.
struct Waiting {
    numbers: Vec<u8>,
    delay_cs: u32,
}

/// A finished animation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub path: PathBuf,
    /// Pictures in it.
    pub pictures: u32,
    /// How long they are shown together, hundredths of a second.
    pub shown_cs: u64,
    /// Its size.
    pub bytes: u64,
}

/// Counts what goes into a file.
struct Counted {
    file: io::BufWriter<NewFile>,
    bytes: u64,
}

impl Write for Counted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Animation {
    /// Begins an animation that repeats for ever.
    ///
    /// - `size`: width and height of its pictures, pixels, at most 65,535.
    pub fn create(
        path: &Path,
        size: [u32; 2],
        palette: Palette,
    ) -> Result<Animation, AnimationError> {
        let unwritable = |why: String| AnimationError::Unwritable {
            path: path.to_owned(),
            why,
        };
        let [width, height] = size.map(|side| u16::try_from(side).unwrap_or(u16::MAX));
        let file = NewFile::create(path).map_err(|error| unwritable(error.to_string()))?;
        let counted = Counted {
            file: io::BufWriter::new(file),
            bytes: 0,
        };
        let begun =
            Encoder::new(counted, width, height, &palette.bytes()).and_then(|mut encoder| {
                encoder.set_repeat(Repeat::Infinite)?;
                Ok(encoder)
            });
        Ok(Animation {
            encoder: begun.map_err(|error| unwritable(error.to_string()))?,
            palette,
            path: path.to_owned(),
            size,
            shown: None,
            waiting: None,
            pictures: 0,
            shown_cs: 0,
        })
    }

    /// Returns the bytes written so far, without the picture whose time is not over yet.
    pub fn bytes(&self) -> u64 {
        self.encoder.get_ref().bytes
    }

    /// Adds a picture, to be shown for no time until [`Animation::hold`] gives it some.
    ///
    /// A picture equal to the one before is that one. Returns whether it differs.
    pub fn show(&mut self, picture: &RgbImage) -> Result<bool, AnimationError> {
        let found = [picture.width(), picture.height()];
        if found != self.size {
            return Err(AnimationError::Size {
                found,
                expected: self.size,
            });
        }
        // Neighbours are mostly equal, so most pixels need no lookup.
        let mut last = ([0; 3], self.palette.number([0; 3]));
        let mut numbers = Vec::with_capacity(picture.as_raw().len() / 3);
        for pixel in picture.pixels() {
            if pixel.0 != last.0 {
                last = (pixel.0, self.palette.number(pixel.0));
            }
            numbers.push(last.1);
        }
        if self
            .waiting
            .as_ref()
            .is_some_and(|waiting| waiting.numbers == numbers)
        {
            return Ok(false);
        }
        self.write_waiting()?;
        self.waiting = Some(Waiting {
            numbers,
            delay_cs: 0,
        });
        Ok(true)
    }

    /// Shows the last picture for longer, hundredths of a second; nothing without one.
    pub fn hold(&mut self, longer_cs: u32) {
        if let Some(waiting) = &mut self.waiting {
            waiting.delay_cs += longer_cs;
        }
    }

    /// Ends the file and gives it its name; `None`, and no file, if it has no picture.
    pub fn finish(mut self) -> Result<Option<Written>, AnimationError> {
        self.write_waiting()?;
        if self.pictures == 0 {
            return Ok(None);
        }
        let path = self.path;
        let unwritable = |why: String| AnimationError::Unwritable {
            path: path.clone(),
            why,
        };
        let counted = self
            .encoder
            .into_inner()
            .map_err(|error| unwritable(error.to_string()))?;
        let file = counted
            .file
            .into_inner()
            .map_err(|error| unwritable(error.to_string()))?;
        file.finish()
            .map_err(|error| unwritable(error.to_string()))?;
        Ok(Some(Written {
            path,
            pictures: self.pictures,
            shown_cs: self.shown_cs,
            bytes: counted.bytes,
        }))
    }

    /// Writes the waiting picture.
    fn write_waiting(&mut self) -> Result<(), AnimationError> {
        let Some(Waiting { numbers, delay_cs }) = self.waiting.take() else {
            return Ok(());
        };
        // A viewer takes a delay of 0 for one of its own choice.
        let delay = u16::try_from(delay_cs.max(2)).unwrap_or(u16::MAX);
        let [width, height] = self
            .size
            .map(|side| u16::try_from(side).unwrap_or(u16::MAX));
        let changes = match &self.shown {
            Some(shown) => {
                let both = numbers.iter().zip(shown);
                both.map(|(new, old)| if new == old { SAME } else { *new })
                    .collect()
            }
            None => numbers.clone(),
        };
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent: self.shown.is_some().then_some(SAME),
            width,
            height,
            buffer: Cow::Owned(changes),
            ..Frame::default()
        };
        let written = self.encoder.write_frame(&frame);
        written.map_err(|error: EncodingError| AnimationError::Unwritable {
            path: self.path.clone(),
            why: error.to_string(),
        })?;
        self.pictures += 1;
        self.shown_cs += u64::from(delay);
        self.shown = Some(numbers);
        Ok(())
    }
}

#[cfg(test)]
#[path = "tests/animation.rs"]
mod tests;

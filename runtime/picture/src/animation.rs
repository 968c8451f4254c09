//! Animated pictures as GIF.
//!
//! In: pictures of one size, each with how long it is shown. Out: the bytes of a GIF file. Pixels that stay as they were
//! are transparent, and one list of colours serves all pictures. What is drawn, and when, is the caller's business.

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use image::RgbImage;
use std::collections::HashMap;

/// The most colours of an animation; one more number means "as before".
pub const MAX_COLOURS: usize = 255;
/// The number of pixels that stay as they were.
const SAME: u8 = 255;

const INVARIANT: &str = "pictures of one size are encoded in memory";

/// An animation under construction.
pub struct Animation {
    encoder: Encoder<Vec<u8>>,
    size: [u16; 2],
    colours: Vec<[u8; 3]>,
    /// The number of the nearest colour, of every colour looked up so far.
    nearest: HashMap<[u8; 3], u8>,
    /// What a viewer shows before the waiting picture; empty before the first.
    shown: Vec<u8>,
    /// The picture whose time is not over yet, and how long it is shown, hundredths of a second.
    waiting: Option<(Vec<u8>, u32)>,
    /// What is written; the bytes are with the encoder until the end.
    written: Written,
}

/// A finished animation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// The file's bytes.
    pub bytes: Vec<u8>,
    /// Pictures in it.
    pub pictures: u32,
    /// How long they are shown together, hundredths of a second.
    pub shown_cs: u64,
}

impl Animation {
    /// Begins an animation that repeats for ever.
    ///
    /// - `size`: width and height of its pictures, pixels.
    /// - `colours`: at least one; those after [`MAX_COLOURS`] are not used.
    pub fn new(size: [u16; 2], mut colours: Vec<[u8; 3]>) -> Animation {
        colours.truncate(MAX_COLOURS);
        let mut table = colours.concat();
        table.resize(3 * 256, 0);
        let mut encoder = Encoder::new(Vec::new(), size[0], size[1], &table).expect(INVARIANT);
        encoder.set_repeat(Repeat::Infinite).expect(INVARIANT);
        Animation {
            encoder,
            size,
            colours,
            nearest: HashMap::new(),
            shown: Vec::new(),
            waiting: None,
            written: Written::default(),
        }
    }

    /// Returns the bytes so far, without the picture whose time is not over yet.
    pub fn bytes(&self) -> usize {
        self.encoder.get_ref().len()
    }

    /// Adds a picture of the animation's size, to be shown for no time until [`Animation::hold`] gives it some.
    ///
    /// A picture equal to the one before is that one. Returns whether it differs.
    pub fn show(&mut self, picture: &RgbImage) -> bool {
        let numbers: Vec<u8> = picture.pixels().map(|pixel| self.number(pixel.0)).collect();
        if matches!(&self.waiting, Some((last, _)) if *last == numbers) {
            return false;
        }
        self.write_waiting();
        self.waiting = Some((numbers, 0));
        true
    }

    /// Returns the number of the nearest colour; of equally near ones, the first.
    fn number(&mut self, colour: [u8; 3]) -> u8 {
        *self.nearest.entry(colour).or_insert_with(|| {
            let distance = |other: &[u8; 3]| -> u32 {
                let off = [0, 1, 2].map(|at| u32::from(other[at].abs_diff(colour[at])));
                off.map(|off| off * off).iter().sum()
            };
            let numbered = (0_u8..).zip(&self.colours);
            let nearest = numbered.min_by_key(|(_, other)| distance(other));
            nearest.map_or(0, |(number, _)| number)
        })
    }

    /// Shows the last picture for longer, hundredths of a second; nothing without one.
    pub fn hold(&mut self, longer_cs: u32) {
        if let Some((_, delay_cs)) = &mut self.waiting {
            *delay_cs += longer_cs;
        }
    }

    /// Ends the animation; `None` if it has no picture.
    pub fn finish(mut self) -> Option<Written> {
        self.write_waiting();
        (self.written.pictures > 0).then(|| Written {
            bytes: self.encoder.into_inner().expect(INVARIANT),
            ..self.written
        })
    }

    fn write_waiting(&mut self) {
        let Some((numbers, delay_cs)) = self.waiting.take() else {
            return;
        };
        // A viewer takes a delay of 0 for one of its own choice.
        let delay = u16::try_from(delay_cs.max(2)).unwrap_or(u16::MAX);
        let transparent = (self.written.pictures > 0).then_some(SAME);
        let mut buffer = numbers.clone();
        for (new, old) in buffer.iter_mut().zip(&self.shown) {
            if new == old {
                *new = SAME;
            }
        }
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent,
            width: self.size[0],
            height: self.size[1],
            buffer: buffer.into(),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame).expect(INVARIANT);
        self.written.pictures += 1;
        self.written.shown_cs += u64::from(delay);
        self.shown = numbers;
    }
}

#[cfg(test)]
#[path = "tests/animation.rs"]
mod tests;

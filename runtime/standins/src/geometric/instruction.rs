//! One fold in words, written and read.
//!
//! In and out: an [`Instruction`] and its sentence, such as `pick 0-8, place center, in eighths along the long sides to
//! the right and across them; bare 8-8`. Its numbers count eighths of the rectangle around the cloth, so it also holds
//! for a cloth that lies turned or is larger. `super::frame` locates the rectangle.

use std::f64::consts::FRAC_PI_4;
use std::fmt;

/// Eighths along the heading and across it, each 0 to 8; `None` is the middle of the whole cloth.
pub type Spot = Option<[u8; 2]>;

/// The directions that a heading may have, counter-clockwise in steps of 45 degrees, from below the picture's right.
const HEADINGS: [&str; 4] = ["lower-right", "right", "upper-right", "top"];

/// The corners of the rectangle, counter-clockwise from the start of the heading.
pub const CORNERS: [[u8; 2]; 4] = [[0, 0], [8, 0], [8, 8], [0, 8]];

/// One fold: its pick, its place, and how to identify the sides of the cloth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// The point to pick.
    pub pick: Spot,
    /// The point to place it on.
    pub place: Spot,
    /// The direction in the picture that counts as `along`, of [`HEADINGS`].
    pub heading: usize,
    /// Whether the heading runs along a long side; otherwise all sides count as equal.
    pub is_long: bool,
    /// Corners of the rectangle that the cloth does not reach.
    pub bare: [bool; 4],
}

impl fmt::Display for Instruction {
    /// Writes one sentence without a full stop.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let spot = |spot: Spot| match spot {
            Some([along, across]) => format!("{along}-{across}"),
            None => "center".to_owned(),
        };
        write!(
            f,
            "pick {}, place {}, in eighths along the {} to the {} and across them",
            spot(self.pick),
            spot(self.place),
            if self.is_long { "long sides" } else { "sides" },
            HEADINGS[self.heading]
        )?;
        let bare = CORNERS.into_iter().zip(self.bare);
        let bare = bare.filter(|(_, is_bare)| *is_bare);
        let bare: Vec<String> = bare.map(|(corner, _)| spot(Some(corner))).collect();
        if bare.is_empty() {
            return Ok(());
        }
        write!(f, "; bare {}", bare.join(" "))
    }
}

impl Instruction {
    /// Returns the angle of the heading, radians counter-clockwise from the picture's right.
    pub fn heading_rad(&self) -> f64 {
        (self.heading as f64 - 1.0) * FRAC_PI_4
    }

    /// Reads the sentence in a line; `None` if it has none.
    pub fn read(line: &str) -> Option<Instruction> {
        let (_, sentence) = line.split_once("pick ")?;
        let is_break = |letter: char| letter.is_whitespace() || ",;.".contains(letter);
        let words: Vec<&str> = sentence.split(is_break).collect();
        let spot = |word: &str| -> Option<Spot> {
            if word == "center" {
                return Some(None);
            }
            let (along, across) = word.split_once('-')?;
            let eighths = |number: &str| number.parse().ok().filter(|eighths| *eighths <= 8);
            Some(Some([eighths(along)?, eighths(across)?]))
        };
        let after = |name| words.iter().skip_while(move |word| **word != name).skip(1);
        let bare: Vec<Spot> = after("bare").map_while(|word| spot(word)).collect();
        Some(Instruction {
            pick: spot(words.first()?)?,
            place: spot(after("place").next()?)?,
            heading: HEADINGS
                .iter()
                .position(|heading| words.contains(heading))?,
            is_long: words.contains(&"long"),
            bare: CORNERS.map(|corner| bare.contains(&Some(corner))),
        })
    }
}

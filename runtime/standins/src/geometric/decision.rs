//! An action that the stand-in has decided on, before it is put into words.
//!
//! In: the points and values of a question. Out: the lines of an answer, in the form that the prompt asks for. Another
//! stand-in may change a decision before it is worded.

use super::prompt::{self, Choice};
use fab_program::PixelPoint;

/// An action, and what the question offered.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    pub pick: PixelPoint,
    pub end: End,
    /// The listed corners.
    pub picks: Vec<PixelPoint>,
    /// The point that the question calls the center.
    pub center: Option<PixelPoint>,
    /// The question's words.
    pub question: String,
    /// How many answers to it were refused before.
    pub corrections: usize,
    /// The reason, one sentence.
    pub why: String,
}

/// Where a picked point goes, and what was offered.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// To a point.
    Place {
        at: PixelPoint,
        offered: Vec<PixelPoint>,
    },
    /// In a direction, degrees counter-clockwise from the picture's right, over a distance, multiples of the cloth's side.
    Pull {
        direction: Choice,
        distance: Choice,
        offered: Vec<Choice>,
    },
}

impl Decision {
    /// Writes the answer; `asked` is everything that was said in the conversation.
    pub fn worded(&self, asked: &str) -> String {
        let quadrant = |center| prompt::quadrant_line(asked, self.pick, center);
        let mut lines: Vec<String> = self.center.and_then(quadrant).into_iter().collect();
        lines.push(format!("Pick Point = {}", self.pick));
        match &self.end {
            End::Place { at, .. } => lines.push(format!("Place Point = {at}")),
            End::Pull {
                direction,
                distance,
                ..
            } => lines.extend([
                format!("Direction = {}", direction.words),
                format!("Distance = {}", distance.words),
            ]),
        }
        lines.push(self.why.clone());
        lines.extend(prompt::manner_lines(asked));
        lines.join("\n")
    }
}

//! An action that the stand-in has decided on, before it is put into words.
//!
//! In: the points and values of a question. Out: the lines of an answer, in the form that the prompt asks for. Another
//! stand-in may change a decision before it is worded.

use super::prompt::{self, AnswerLine, Choice};
use fab_program::PixelPoint;

/// An action, and what the question offered.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// The point to pick.
    pub pick: PixelPoint,
    /// Where it goes.
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

/// Where a picked point goes.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// To a listed point.
    Place {
        /// The point.
        at: PixelPoint,
        /// All listed points.
        offered: Vec<PixelPoint>,
    },
    /// Some way in a direction.
    Pull {
        /// The direction, degrees counter-clockwise from the picture's right.
        direction: Choice,
        /// The distance, multiples of the cloth's side.
        distance: Choice,
        /// All offered directions.
        offered: Vec<Choice>,
    },
}

impl Decision {
    /// Writes the answer; `asked` is everything that was said in the conversation.
    pub fn worded(&self, asked: &str) -> String {
        let point = |field, at| AnswerLine::asked_for(field, asked).with(at);
        let quadrant = self
            .center
            .and_then(|center| prompt::quadrant_line(asked, self.pick, center));
        let end = match &self.end {
            End::Place { at, .. } => vec![point("place", *at)],
            End::Pull {
                direction,
                distance,
                ..
            } => vec![
                format!("Direction = {}", direction.words),
                format!("Distance = {}", distance.words),
            ],
        };
        let lines = quadrant.into_iter().chain([point("pick", self.pick)]);
        let lines = lines.chain(end).chain([self.why.clone()]);
        lines.collect::<Vec<_>>().join("\n")
    }
}

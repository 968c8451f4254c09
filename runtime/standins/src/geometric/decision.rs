//! An action that the stand-in has decided on, before it is put into words.
//!
//! In: the points and values of a question. Out: the lines of an answer, in the form that the prompt asks for. Another
//! stand-in may change a decision before it is worded.

use super::prompt::{self, Choice};
use super::spoken;
use fab_model::{Message, Speaker};
use fab_program::PixelPoint;

/// An action, and what the question offered.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    pub action: Action,
    /// The points to pick: the listed corners, and what else the question offers.
    pub picks: Vec<PixelPoint>,
    /// The points to place on, if an action ends on a point.
    pub places: Vec<PixelPoint>,
    /// The directions, if an action is a pull.
    pub directions: Vec<Choice>,
    /// The point that the question calls the center.
    pub center: Option<PixelPoint>,
    /// The question's words.
    pub question: String,
    /// How many answers to it were refused before.
    pub corrections: usize,
    /// The reason, one sentence.
    pub why: String,
}

/// A point to pick, and where it goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    pub pick: PixelPoint,
    pub end: End,
}

/// Where a picked point goes.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// To a point.
    Place(PixelPoint),
    /// In a direction, degrees counter-clockwise from the picture's right, over a distance, multiples of the cloth's side.
    Pull(Choice, Choice),
}

impl Action {
    /// Writes the lines that state it.
    fn stated(&self) -> String {
        let end = match &self.end {
            End::Place(at) => format!("Place Point = {at}"),
            End::Pull(direction, distance) => {
                let [direction, distance] = [direction, distance].map(|it| it.words.as_str());
                format!("Direction = {direction}\nDistance = {distance}")
            }
        };
        format!("Pick Point = {}\n{end}", self.pick)
    }
}

/// Returns the first action that no refused answer states, and how many answers to the first of these turns were refused:
/// those before a user's turn.
pub fn first_new(
    turns: &[Message],
    mut actions: impl Iterator<Item = Action>,
) -> (Option<Action>, usize) {
    let is_refused = |pair: &&[Message]| {
        pair[0].speaker == Speaker::Assistant && pair[1].speaker == Speaker::User
    };
    let refused = turns.windows(2).filter(is_refused);
    let refused: Vec<String> = refused.map(|pair| spoken(&pair[0])).collect();
    let is_new = |action: &Action| {
        let stated = action.stated();
        !refused.iter().any(|answer| answer.contains(&stated))
    };
    (actions.find(is_new), refused.len())
}

impl Decision {
    /// Writes the answer; `asked` is everything that was said in the conversation.
    pub fn worded(&self, asked: &str) -> String {
        let quadrant = |center| prompt::quadrant_line(asked, self.action.pick, center);
        let mut lines: Vec<String> = self.center.and_then(quadrant).into_iter().collect();
        lines.push(self.action.stated());
        lines.push(self.why.clone());
        lines.extend(prompt::manner_lines(asked));
        lines.join("\n")
    }
}

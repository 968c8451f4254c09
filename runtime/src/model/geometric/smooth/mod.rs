//! Smoothing: answers a prompt for a pick point, a direction and a distance.
//!
//! In: a conversation whose opening question shows the cloth and lists its corners. Out: an answer in the asked
//! form. Where the cloth lies and which way its faces show is read from the picture ([`view`]), the choices, the
//! scale and the limits from the words ([`brief`]); [`pulls`] says what each choice promises, and [`refused`] which of
//! them a correction has ruled out. It knows no state of the cloth besides.

mod brief;
mod pulls;
mod refused;
mod tip;
mod view;

#[cfg(test)]
mod tests;

use super::frame::Point;
use super::{prompt, spoken};
use crate::model::{Message, Part, Speaker};
use brief::Brief;
use compiler::program::PixelPoint;
use pulls::Pull;
use view::View;

/// Tells whether a prompt states a format with a direction and a distance to choose.
pub fn is_asked(text: &str) -> bool {
    ["direction", "distance"]
        .iter()
        .all(|field| !brief::choices(text, field).is_empty())
}

/// Answers a conversation; where that cannot be done, says why in words that hold no action.
pub fn answer(messages: &[Message]) -> String {
    match choose(messages) {
        Ok(text) => text,
        Err(why) => format!("I cannot choose a pull: {why}."),
    }
}

fn choose(messages: &[Message]) -> Result<String, String> {
    let question = messages.iter().rposition(lists_corners);
    let question = question.ok_or("no corners are listed beside a picture")?;
    let (opening, later) = messages.split_at(question + 1);
    let words: Vec<String> = opening.iter().map(spoken).collect();
    let words = words.join("\n");
    let brief = Brief::read(&words)?;
    let shown = opening[question].parts.iter().find_map(|part| match part {
        Part::Image(png) => Some(png),
        Part::Text(_) => None,
    });
    let view = View::decode(shown.ok_or("there is no picture")?.bytes())?;
    let pulls = pulls::ranked(&brief, &view);
    let left = |pull: &&Pull| refused::leaves(later, &brief, pull);
    let best = pulls.iter().find(left);
    let best = best.ok_or("every pull that the rules allow was refused")?;
    Ok(format!(
        "{}\nDirection = {}\nDistance = {}\nOf the listed corners this one looks {}, and the pull widens the \
         cloth's outline by about {:.0} percent of its flat area.",
        prompt::AnswerLine::asked_for("pick", &words).with(best.pick),
        brief.directions[best.direction].words,
        brief.distances[best.distance].words,
        if best.is_sharp {
            "like one of the cloth's own"
        } else {
            "the most promising"
        },
        best.widened * 100.0,
    ))
}

/// Tells whether a turn is a question with a list of corners and a picture.
fn lists_corners(message: &Message) -> bool {
    let is_image = |part: &Part| matches!(part, Part::Image(_));
    message.speaker == Speaker::User
        && message.parts.iter().any(is_image)
        && !prompt::corners(&spoken(message)).is_empty()
}

/// The middle of a pixel.
fn middle_of(pixel: PixelPoint) -> Point {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}

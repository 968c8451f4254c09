//! Smoothing: answers a prompt for a pick point, a direction and a distance.
//!
//! In: a conversation whose opening question shows the cloth and may list its corners. Out: an answer in the asked
//! form. Where the cloth lies and which way its faces show is read from the picture ([`view`]), the choices, the
//! scale and the limits from the words ([`brief`]). What each choice looks like is put into numbers ([`features`]) and
//! its gain estimated from them ([`estimate`]); [`pulls`] are ordered by that, and [`corrections`] says which of them a
//! correction has ruled out. It knows no state of the cloth besides.

mod brief;
mod corrections;
mod estimate;
mod features;
mod pulls;
mod rim;
mod view;

#[cfg(test)]
mod tests;

use super::{prompt, spoken};
use brief::Brief;
use fab_model::{Message, Part, Speaker};
use fab_picture::hull::Point;
use fab_program::PixelPoint;
pub use features::NAMES as FEATURES;
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

/// A pull that a prompt offers, as the stand-in sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// Where it begins, pixels of the shown picture.
    pub pick: PixelPoint,
    /// Degrees, against the clock from the picture's right.
    pub direction_deg: f64,
    /// In sides of the cloth.
    pub distance: f64,
    /// What it looks like, in the order of [`FEATURES`].
    pub features: [f64; FEATURES.len()],
    /// The gain of coverage that is expected of it, as a share of the flat cloth.
    pub gain: f64,
}

/// Returns the pulls that a conversation's rules and corrections leave, the most promising first, so that the estimate
/// can be fitted to what they gain; says why it cannot.
pub fn offers(messages: &[Message]) -> Result<Vec<Offer>, String> {
    let Question { brief, pulls, .. } = Question::read(messages)?;
    let offer = |pull: Pull| Offer {
        pick: pull.pick,
        direction_deg: brief.directions[pull.direction].value,
        distance: brief.distances[pull.distance].value,
        features: pull.features,
        gain: pull.gain,
    };
    Ok(pulls.into_iter().map(offer).collect())
}

/// A question that was read and looked at.
struct Question {
    /// Everything that was said up to it.
    words: String,
    brief: Brief,
    /// What its rules and the corrections after it leave, the most promising first; never empty.
    pulls: Vec<Pull>,
}

impl Question {
    /// Reads the last turn that lists corners beside a picture, or, where none does, the last with a picture.
    fn read(messages: &[Message]) -> Result<Question, String> {
        let question = messages.iter().rposition(lists_corners);
        let question = question.or_else(|| messages.iter().rposition(shows_picture));
        let (opening, later) = messages.split_at(question.ok_or("there is no picture")? + 1);
        let words: Vec<String> = opening.iter().map(spoken).collect();
        let words = words.join("\n");
        let shown = opening
            .last()
            .into_iter()
            .flat_map(|message| &message.parts);
        let mut pictures = shown.filter_map(|part| match part {
            Part::Image(png) => Some(png),
            Part::Text(_) => None,
        });
        let mut brief = Brief::read(&words)?;
        let view = View::decode(pictures.next().ok_or("there is no picture")?.bytes())?;
        if brief.corners.is_empty() {
            brief.corners = rim::corners(&view, brief.edge_px);
        }
        let mut pulls = pulls::ranked(&brief, &view);
        if pulls.is_empty() {
            return Err("no pull leads outward and ends where the rules allow".to_owned());
        }
        pulls.retain(|pull| corrections::leaves(later, &brief, pull));
        if pulls.is_empty() {
            return Err("every pull that the rules allow was refused".to_owned());
        }
        Ok(Question {
            words,
            brief,
            pulls,
        })
    }
}

fn choose(messages: &[Message]) -> Result<String, String> {
    let question = Question::read(messages)?;
    let (brief, best) = (&question.brief, &question.pulls[0]);
    Ok(format!(
        "{}\nDirection = {}\nDistance = {}\nOf the corners this one looks {}, and I expect that the pull uncovers \
         about {:.0} percent of the cloth's flat area.",
        prompt::AnswerLine::asked_for("pick", &question.words).with(best.pick),
        brief.directions[best.direction].words,
        brief.distances[best.distance].words,
        if best.is_sharp {
            "like one of the cloth's own"
        } else {
            "the most promising"
        },
        best.gain.max(0.0) * 100.0,
    ))
}

/// Tells whether a turn is a question with a list of corners and a picture.
fn lists_corners(message: &Message) -> bool {
    shows_picture(message) && !prompt::corners(&spoken(message)).is_empty()
}

fn shows_picture(message: &Message) -> bool {
    let is_image = |part: &Part| matches!(part, Part::Image(_));
    message.speaker == Speaker::User && message.parts.iter().any(is_image)
}

/// The middle of a pixel.
fn middle_of(pixel: PixelPoint) -> Point {
    [f64::from(pixel.u) + 0.5, f64::from(pixel.v) + 0.5]
}

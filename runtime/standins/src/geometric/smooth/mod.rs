//! Smoothing: answers a prompt for a pick point, a direction and a distance.
//!
//! In: a conversation whose opening question shows the cloth and may list its corners. Out: an answer in the requested
//! form. The cloth's pose and visible faces come from the picture ([`view`]); the choices, the scale and the limits
//! from the words ([`parsed_prompt`]). Each choice is described by numbers ([`features`]) and by the picture around the
//! pick ([`window`]), and its gain is estimated from both ([`estimate`]); [`pulls`] ranks the choices, and
//! [`corrections`] removes those ruled out by corrections. It knows nothing else about the cloth.

mod corrections;
mod estimate;
mod features;
mod parsed_prompt;
mod pulls;
mod rim;
mod view;
mod window;

#[cfg(test)]
mod tests;

use super::{prompt, spoken};
use fab_model::{Message, Part, Speaker};
use fab_picture::hull::Point;
use fab_program::PixelPoint;
pub use features::NAMES as FEATURES;
use parsed_prompt::ParsedPrompt;
use pulls::Pull;
use view::View;

/// Returns whether a prompt's format has a direction and a distance to choose.
pub fn is_asked(text: &str) -> bool {
    ["direction", "distance"]
        .iter()
        .all(|field| !parsed_prompt::choices(text, field).is_empty())
}

/// Answers a conversation; if that is impossible, says why in words without an action.
pub fn answer(messages: &[Message]) -> String {
    match choose(messages) {
        Ok(text) => text,
        Err(why) => format!("I cannot choose a pull: {why}."),
    }
}

/// A pull offered by a prompt, as the stand-in sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// Where it begins, pixels of the shown picture.
    pub pick: PixelPoint,
    /// Degrees, counter-clockwise from the picture's right.
    pub direction_deg: f64,
    /// In sides of the cloth.
    pub distance: f64,
    /// Its features, in the order of [`FEATURES`].
    pub features: [f64; FEATURES.len()],
    /// The picture around its pick by channel, row and column, `[3][24][24]`: shares of each cell that show the grasped
    /// face, the other face, and lost light.
    pub window: Vec<f32>,
    /// Its expected gain of coverage, as a share of the flat cloth.
    pub gain: f64,
}

/// Returns the pulls permitted by a conversation's rules and corrections, most promising first, for fitting the
/// estimate to their gains; fails with the reason.
pub fn offers(messages: &[Message]) -> Result<Vec<Offer>, String> {
    let Question { parsed, pulls, .. } = Question::read(messages)?;
    let offer = |pull: Pull| Offer {
        pick: pull.pick,
        direction_deg: parsed.directions[pull.direction].value,
        distance: parsed.distances[pull.distance].value,
        features: pull.features,
        window: pull.window.as_flattened().as_flattened().to_vec(),
        gain: pull.gain,
    };
    Ok(pulls.into_iter().map(offer).collect())
}

/// A question with its analysed picture.
struct Question {
    /// All text up to it.
    words: String,
    parsed: ParsedPrompt,
    /// The pulls permitted by its rules and later corrections, most promising first; never empty.
    pulls: Vec<Pull>,
}

impl Question {
    /// Reads the last turn with a list of corners and a picture, or, if there is none, the last turn with a picture.
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
        let mut parsed = ParsedPrompt::read(&words)?;
        let view = View::decode(pictures.next().ok_or("there is no picture")?.bytes())?;
        if parsed.corners.is_empty() {
            parsed.corners = rim::corners(&view, parsed.edge_px);
        }
        let mut pulls = pulls::ranked(&parsed, &view);
        if pulls.is_empty() {
            return Err("no pull leads outward and ends where the rules allow".to_owned());
        }
        pulls.retain(|pull| corrections::leaves(later, &parsed, pull));
        if pulls.is_empty() {
            return Err("every pull that the rules allow was refused".to_owned());
        }
        Ok(Question {
            words,
            parsed,
            pulls,
        })
    }
}

fn choose(messages: &[Message]) -> Result<String, String> {
    let question = Question::read(messages)?;
    let (parsed, best) = (&question.parsed, &question.pulls[0]);
    Ok(format!(
        "{}\nDirection = {}\nDistance = {}\nThis corner looks {}, and I expect that the pull uncovers about {:.0} percent \
         of the cloth's flat area.",
        prompt::AnswerLine::asked_for("pick", &question.words).with(best.pick),
        parsed.directions[best.direction].words,
        parsed.distances[best.distance].words,
        if best.is_sharp {
            "like one of the cloth's own"
        } else {
            "the most promising"
        },
        best.gain.max(0.0) * 100.0,
    ))
}

/// Returns whether a turn is a question with a list of corners and a picture.
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

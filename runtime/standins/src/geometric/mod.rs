//! `geometric`: an offline stand-in for a vision-language model.
//!
//! In: the same [`Request`] that a remote model would get, and nothing else. Out: a [`Reply`] in the form that the
//! prompt asks for. With pictures, it describes their step in words; without, it reads such words and a list of points
//! and picks two of them. It is a program about outlines and rectangles, not a model: it is called a stand-in wherever
//! its results appear, and its scores say nothing about models.
//!
//! It knows no task. If it cannot understand a prompt, it answers with words that hold no instruction and no point,
//! which the caller reports like any other unusable answer. A question for anything other than a pick point with a place
//! point, or with a direction and a distance, is a model error.

mod decision;
mod frame;
mod plan;
mod prompt;
mod see;
mod smooth;
mod words;

#[cfg(test)]
mod tests;

pub(crate) use decision::{Decision, End};
use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Part, Reply, Request, Speaker};
use fab_picture::hull;
use fab_program::PixelPoint;
pub(crate) use prompt::points;

use frame::Frame;
use plan::{Candidate, ListedPoints};
use prompt::Choice;
use see::Sighting;
use words::{Compass, Instruction, Sides, Spot};

/// The stand-in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geometric;

impl Model for Geometric {
    fn name(&self) -> &str {
        "geometric"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn varies(&self) -> bool {
        false
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let answer = answer(request)?;
        Ok(Reply::text(answer.worded(&request.messages)))
    }
}

/// An answer before it is put into words.
pub(crate) enum Answer {
    /// Words alone.
    Words(String),
    /// An action.
    Action(Box<Decision>),
}

impl Answer {
    /// Writes the answer to a conversation, with the lines for the other fields that its format asks for.
    pub fn worded(&self, messages: &[Message]) -> String {
        let asked = all_words(messages);
        let text = match self {
            Answer::Words(text) => text.clone(),
            Answer::Action(decision) => decision.worded(&asked),
        };
        let lines = [text].into_iter().chain(prompt::manner_lines(&asked));
        lines.collect::<Vec<_>>().join("\n")
    }
}

/// Answers a question.
pub(crate) fn answer(request: &Request) -> Result<Answer, ModelError> {
    let messages = &request.messages;
    let asked = all_words(messages);
    let decided = |decided: Result<Decision, String>, what: &str| match decided {
        Ok(decision) => Answer::Action(Box::new(decision)),
        Err(why) => Answer::Words(format!("I cannot choose {what}: {why}.")),
    };
    if smooth::is_asked(&asked) {
        return Ok(decided(smooth::choose(messages), "a pull"));
    }
    if let Some(more) = prompt::asks_for_more(&asked) {
        return Err(ModelError::Unsupported {
            model: Geometric.name().to_owned(),
            why: format!(
                "it can only answer with a pick point and a place point, and the prompt asks {more}; a model, `random` and `--policy expert` can"
            ),
        });
    }
    Ok(match describe(messages) {
        Some(description) => Answer::Words(description),
        None => decided(choose(messages), "points"),
    })
}

/// Describes the pictures of the last turn that has any; `None` if there are no pictures at all.
fn describe(messages: &[Message]) -> Option<String> {
    let pictures = |message: &Message| {
        let parts = message.parts.iter();
        let bytes = parts.filter_map(|part| match part {
            Part::Image(png) => Some(png.clone()),
            Part::Text(_) => None,
        });
        bytes.collect::<Vec<_>>()
    };
    let users = messages
        .iter()
        .filter(|message| message.speaker == Speaker::User);
    let shown = users.map(pictures).rfind(|pictures| !pictures.is_empty())?;
    let encoded: Vec<&[u8]> = shown.iter().map(fab_model::Png::bytes).collect();
    let middle = if prompt::centers_cloth_in_picture(&all_words(messages)) {
        Middle::OfPicture
    } else {
        Middle::OfOutline
    };
    Some(
        match see::see(&encoded).and_then(|seen| put_into_words(&seen, middle)) {
            Ok((instruction, sides)) => format!(
                "Instructions: {instruction}.\n\
             Explanation: The black arrow on the first picture runs from the first of these points to the \
             second; the cloth there has {sides}."
            ),
            Err(why) => format!("I cannot describe this step: {why}."),
        },
    )
}

/// Corners of the rectangle that the cloth misses by this fraction of the short side are mentioned.
const BARE_FROM: f64 = 0.3;

/// A point deeper inside the outline than this fraction of the short side is not on any side of the cloth.
const INSIDE_FROM: f64 = 0.15;

/// How far a point inside may be from the middle of the rectangle and still count as the center, as a fraction of the
/// short side. Folds towards the center may end a tenth of their length early.
const CENTER_WITHIN: f64 = 0.3;

/// The same if the prompt says where the center is.
const TOLD_CENTER_WITHIN: f64 = 0.1;

/// Where to look for the center of the cloth.
///
/// A folded cloth's center need not be in the middle of its outline.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Middle {
    /// In the middle of the picture, because the prompt says so.
    OfPicture,
    /// In the middle of the rectangle around the cloth.
    OfOutline,
}

fn put_into_words(seen: &Sighting, middle: Middle) -> Result<(Instruction, &'static str), String> {
    let fitted = Frame::fit(&seen.outline).ok_or("the cloth has no area")?;
    let heading = Compass::nearest(fitted.angle());
    let (heading, frame) = if heading.is_in_reading_order() {
        (heading, fitted)
    } else {
        (heading.opposite(), fitted.turned(2))
    };
    let is_center = |point| match middle {
        Middle::OfPicture => {
            hull::distance(point, seen.middle) <= TOLD_CENTER_WITHIN * frame.long_side()
        }
        Middle::OfOutline => {
            let depth = hull::distance_to_outline(&seen.outline, point) / frame.short_side();
            let is_inside = hull::is_inside(&seen.outline, point) && depth > INSIDE_FROM;
            let off = hull::distance(point, frame.point_at([0.5, 0.5])) / frame.short_side();
            is_inside && off <= CENTER_WITHIN
        }
    };
    let spot = |point| {
        if is_center(point) {
            return Spot::Center;
        }
        let share = frame.share_of(point);
        let [along, across] = share.map(|share| (share * 8.0).round().clamp(0.0, 8.0) as u8);
        Spot::At { along, across }
    };
    let (pick, place) = (spot(seen.tail), spot(seen.tip));
    if pick == place {
        return Err("the arrow is too short to tell its two ends apart".to_owned());
    }
    let (sides, sides_in_words) = if frame.has_long_sides() {
        (Sides::Long, "long sides and short ones")
    } else {
        (Sides::Equal, "sides of about the same length")
    };
    let bare = frame.corner_gaps(&seen.outline).map(|gap| gap >= BARE_FROM);
    Ok((
        Instruction {
            pick,
            place,
            heading,
            sides,
            bare,
        },
        sides_in_words,
    ))
}

/// Picks two points according to the last prompt that lists corners.
fn choose(messages: &[Message]) -> Result<Decision, String> {
    let asked = |message: &Message| {
        let text = spoken(message);
        let instruction = prompt::instruction_lines(&text).find_map(Instruction::read)?;
        (message.speaker == Speaker::User).then_some((text, instruction))
    };
    let mut found = messages
        .iter()
        .enumerate()
        .filter_map(|(at, message)| Some((at, asked(message)?)));
    let (at, (text, instruction)) = found
        .next_back()
        .ok_or("no line names a point of the cloth to pick and one to place it on")?;
    let corners = prompt::corners(&text);
    if corners.is_empty() {
        return Err("no corners are listed".to_owned());
    }
    let listed = ListedPoints {
        corners,
        others: prompt::other_points(&text),
        center: prompt::center(&text),
    };
    let plan = plan::plan(&instruction, &listed).map_err(|why| why.to_string())?;
    let refused = Refused::read(&messages[at..]);
    let chosen = plan
        .candidates
        .iter()
        .find(|candidate| refused.leaves(candidate))
        .ok_or("every likely pair of listed points was refused")?;
    let again = if refused.is_empty() {
        ""
    } else {
        " that was not refused"
    };
    let places = listed.corners.iter().chain(&listed.others);
    Ok(Decision {
        pick: chosen.pick,
        end: End::Place {
            at: chosen.place,
            offered: places.chain(&listed.center).copied().collect(),
        },
        picks: listed.corners,
        center: listed.center,
        question: text,
        corrections: refused.0.len(),
        why: format!(
            "The rectangle around the listed corners lies turned by about {:.0} degrees against the words; \
             in it, these are the listed points nearest to the two that the words name{again}.",
            plan.turn.to_degrees(),
        ),
    })
}

/// The text of a message, one part per line.
pub(crate) fn spoken(message: &Message) -> String {
    let parts = message.parts.iter();
    let texts = parts.filter_map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// The text of all messages.
fn all_words(messages: &[Message]) -> String {
    let texts: Vec<String> = messages.iter().map(spoken).collect();
    texts.join("\n")
}

/// Earlier answers of a conversation that were refused, each with its correction in small letters.
struct Refused(Vec<(String, String)>);

impl Refused {
    /// Collects the answers followed by a user's turn.
    fn read(turns: &[Message]) -> Refused {
        let pairs = turns.windows(2).filter(|pair| {
            pair[0].speaker == Speaker::Assistant && pair[1].speaker == Speaker::User
        });
        let pairs = pairs.map(|pair| {
            let words = spoken(&pair[1]).to_lowercase();
            let words: Vec<&str> = words.split_whitespace().collect();
            (spoken(&pair[0]), words.join(" "))
        });
        Refused(pairs.collect())
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns whether a pick and a place may still be right: a correction that mentions one of the two blames it alone.
    fn leaves(&self, candidate: &Candidate) -> bool {
        self.0.iter().all(|(answer, correction)| {
            let points = ["pick", "place"].map(|field| prompt::answered(field, answer));
            let [Some(pick), Some(place)] = points else {
                return true;
            };
            match (correction.contains("pick"), correction.contains("place")) {
                (true, false) => candidate.pick != pick,
                (false, true) => candidate.place != place,
                _ => (candidate.pick, candidate.place) != (pick, place),
            }
        })
    }

    /// Returns whether a pull may still be right: a correction may ask for another corner, name a direction, or ask for
    /// a smaller distance.
    fn leaves_pull(&self, pick: PixelPoint, direction: &Choice, distance: &Choice) -> bool {
        self.0.iter().all(|(answer, correction)| {
            if prompt::answered("pick", answer) != Some(pick) {
                return true;
            }
            let stated = |field| prompt::choices(answer, field).into_iter().next();
            let is_direction = stated("direction").as_ref() == Some(direction);
            if let Some((_, named)) = correction.rsplit_once("in the direction ")
                && !correction.contains("smaller distance")
            {
                return named.starts_with(&direction.words.to_lowercase());
            }
            if correction.contains("smaller distance") {
                let is_smaller =
                    stated("distance").is_some_and(|longer| distance.value < longer.value);
                return !is_direction || is_smaller;
            }
            let is_same = is_direction && stated("distance").as_ref() == Some(distance);
            !correction.contains("choose a corner") && !is_same
        })
    }
}

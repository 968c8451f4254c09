//! `geometric`: an offline stand-in for a vision-language model.
//!
//! In: the same [`Request`] that a remote model would get, and nothing else. Out: a [`Reply`] in the form that the
//! prompt asks for. With pictures, it describes their step in words; without, it reads such words and a list of points
//! and picks two of them. It is a program about outlines and rectangles, not a model: it is called a stand-in wherever
//! its results appear, and its scores say nothing about models.
//!
//! It knows no task. If it cannot understand a prompt, it answers with words that hold no instruction and no point,
//! which the caller reports like any other unusable answer. A question for anything other than a pick point and a place
//! point is a model error.

mod frame;
mod plan;
mod prompt;
mod see;
mod smooth;
mod words;

#[cfg(test)]
mod tests;

use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Part, Reply, Request, Speaker};
use fab_picture::hull;
use fab_program::PixelPoint;
pub use smooth::{FEATURES, Offer, offers};

use frame::Frame;
use plan::{Candidate, ListedPoints};
use prompt::AnswerLine;
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
        let asked = all_words(&request.messages);
        let carried = |text: String| {
            let lines = [text].into_iter().chain(prompt::manner_lines(&asked));
            Reply::text(lines.collect::<Vec<_>>().join("\n"))
        };
        if smooth::is_asked(&asked) {
            return Ok(carried(smooth::answer(&request.messages)));
        }
        if let Some(more) = prompt::asks_for_more(&asked) {
            return Err(ModelError::Unsupported {
                model: self.name().to_owned(),
                why: format!(
                    "it can only answer with a pick point and a place point, and the prompt asks {more}; a model, `random` and `--policy expert` can"
                ),
            });
        }
        let text = match describe(&request.messages) {
            Some(description) => description,
            None => choose(&request.messages),
        };
        Ok(carried(text))
    }
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
        match see::see(&encoded)
            .map_err(|unseen| unseen.to_string())
            .and_then(|seen| put_into_words(&seen, middle))
        {
            Ok((instruction, sides)) => format!(
                "Instructions: {instruction}.\n\
             Explanation: The black arrow on the first picture runs from the first of these points to the \
             second; the cloth there has {sides}, and on the second picture it has left the arrow's tail."
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
fn choose(messages: &[Message]) -> String {
    match choice(messages) {
        Ok(text) => text,
        Err(why) => format!("I cannot choose points: {why}."),
    }
}

fn choice(messages: &[Message]) -> Result<String, String> {
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
    let whole = all_words(messages);
    let [pick, place] = ["pick", "place"].map(|field| AnswerLine::asked_for(field, &whole));
    let quadrant = listed
        .center
        .and_then(|center| prompt::quadrant_line(&whole, chosen.pick, center))
        .map_or(String::new(), |line| format!("{line}\n"));
    let again = if refused.is_empty() {
        ""
    } else {
        " that was not refused"
    };
    Ok(format!(
        "{quadrant}{}\n{}\nThe rectangle around the listed corners lies turned by about {:.0} degrees against the words; \
         in it, these are the listed points nearest to the two that the words name{again}.",
        pick.with(chosen.pick),
        place.with(chosen.place),
        plan.turn.to_degrees(),
    ))
}

/// The text of a message, one part per line.
fn spoken(message: &Message) -> String {
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

/// Earlier answers of a conversation that were refused.
struct Refused(Vec<Refusal>);

struct Refusal {
    pick: PixelPoint,
    place: PixelPoint,
    blamed: Criticism,
}

/// What a correction criticises.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Criticism {
    Pick,
    Place,
    Pair,
}

impl Refused {
    /// Collects the answers followed by a user's turn.
    fn read(turns: &[Message]) -> Refused {
        let pairs = turns.windows(2).filter(|pair| {
            pair[0].speaker == Speaker::Assistant && pair[1].speaker == Speaker::User
        });
        let refusals = pairs.filter_map(|pair| {
            let answer = spoken(&pair[0]);
            let correction = spoken(&pair[1]).to_lowercase();
            let blamed = match (correction.contains("pick"), correction.contains("place")) {
                (true, false) => Criticism::Pick,
                (false, true) => Criticism::Place,
                _ => Criticism::Pair,
            };
            let pick = prompt::answered("pick", &answer)?;
            Some(Refusal {
                pick,
                place: prompt::answered("place", &answer)?,
                blamed,
            })
        });
        Refused(refusals.collect())
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn leaves(&self, candidate: &Candidate) -> bool {
        self.0.iter().all(|refusal| match refusal.blamed {
            Criticism::Pick => candidate.pick != refusal.pick,
            Criticism::Place => candidate.place != refusal.place,
            Criticism::Pair => (candidate.pick, candidate.place) != (refusal.pick, refusal.place),
        })
    }
}

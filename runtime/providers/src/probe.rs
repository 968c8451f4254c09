//! Probes how a model states positions, and what its interface refuses, before money is spent on rollouts.
//!
//! In: a model, which gets points as its [`Lowering`] says. Out: [`Findings`]: the pixel distances between dots at known
//! positions and the positions in the answers, interpreted in the stated convention and in every other one; the facts
//! that they and a few short questions show, also as an entry of a file. Pictures are drawn here, and sent as in
//! rollouts.

use crate::catalogue::{Date, Facts, PositionFormat, Profile};
use fab_base::chance::Chance;
use fab_model::calls::{Calls, Fault};
use fab_model::lowering::{Lowering, Points};
use fab_model::{Message, Model, ModelError, ModelRole, Part, Png, Reasoning, Request, Speaker};
use fab_picture::png;
use fab_program::pointing::{CoordinateUnit, Frame, Order};
use image::{Rgb, RgbImage};
use interface::Prober;
use serde::Serialize;
use std::num::NonZeroU32;

mod interface;
mod reading;
#[cfg(test)]
mod tests;

/// The most questions that [`probe`] asks.
pub const MOST_QUESTIONS: u64 = interface::MOST_QUESTIONS + SIDES_PX.len() as u64;

/// Makes the model as if these facts were known of it.
pub type Under<'a> = dyn Fn(&Facts) -> Result<Box<dyn Model>, ModelError> + 'a;

/// Names and colours of the dots.
const DOTS: [(&str, [u8; 3]); 6] = [
    ("red", [220, 30, 30]),
    ("green", [20, 150, 40]),
    ("blue", [30, 60, 220]),
    ("yellow", [235, 205, 20]),
    ("black", [15, 15, 15]),
    ("magenta", [215, 40, 200]),
];
/// The background colour.
const GROUND: [u8; 3] = [225, 225, 225];
/// Sides of the square pictures before they are resized, pixels: those of the shipped tasks' cameras.
pub const SIDES_PX: [u32; 2] = [224, 720];
/// The longest answer, tokens; six lines have about 60, and models that think first need far more.
const MAX_TOKENS: u32 = 4000;
/// How much worse than the best the next convention must fit to be ruled out.
const CLEARLY: f64 = 2.0;
/// The largest mean error of a model that sees the dots, as a part of the smaller picture's side.
const MOST_ERROR: f64 = 0.1;
/// Qwen2.5-VL resizes pictures to multiples of this many pixels, and answers in pixels of the result.
const MULTIPLES_OF_PX: NonZeroU32 = NonZeroU32::new(28).expect("28 is not 0");

/// What a probe found out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// The facts that were found; others are `None`.
    pub facts: Facts,
    /// What was seen besides, or left open, in words.
    pub notes: Vec<String>,
    /// How it states positions; `None`: it takes no pictures.
    pub dots: Option<Dots>,
}

/// A model's answers compared with what was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dots {
    /// The lowering used in the questions.
    pub asked: Lowering,
    /// The errors under every convention tried, best first; none if no answer could be read.
    pub tried: Vec<Tried>,
    /// Number of dots drawn.
    pub drawn: usize,
    /// Number of dots with a position in an answer.
    pub read: usize,
    /// The answers.
    pub replies: Vec<String>,
}

/// How far answers are from the dots if they are read in one convention.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// The lowering of a model that answers so.
    pub lowering: Lowering,
    /// Mean distance, pixels of the picture before it was resized, that is, the camera's.
    pub error_px: f64,
}

/// A dot that an answer names.
struct Named {
    /// Side of its picture before that was resized, pixels.
    side_px: u32,
    /// Its middle: column and row.
    at: [u32; 2],
    /// The two numbers of the answer, in order.
    stated: [f64; 2],
}

impl Dots {
    /// Returns the best-fitting lowering; `None` if no answer could be read.
    ///
    /// The stated one wins ties.
    pub fn best(&self) -> Option<Lowering> {
        self.tried.first().map(|best| best.lowering)
    }

    /// Returns whether the stated convention fits better than any other, and each dot was named.
    pub fn agrees(&self) -> bool {
        self.read == self.drawn && self.best() == Some(self.asked)
    }

    /// Returns how the model states positions, if each dot was named and one unit and order fits clearly best.
    pub fn coordinates(&self) -> Option<PositionFormat> {
        let best = self.tried.first()?;
        if self.read < self.drawn || best.error_px > MOST_ERROR * f64::from(SIDES_PX[0]) {
            return None;
        }
        let fits = |tried: &&Tried| tried.error_px < best.error_px.max(0.5) * CLEARLY;
        let form = |lowering: Lowering| (lowering.unit, lowering.order);
        let is_same = |tried: &&Tried| form(tried.lowering) == form(best.lowering);
        let mut others = self.tried.iter().filter(|tried| !is_same(tried));
        if others.any(|tried| fits(&tried)) {
            return None;
        }
        // Sizes that were hardly changed fit nearly as well: then the picture as sent is assumed.
        let mut fitting = self.tried.iter().filter(is_same).filter(fits);
        let is_resized = fitting.all(|tried| tried.lowering.multiples_of_px.is_some());
        Some(PositionFormat {
            unit: best.lowering.unit,
            order: best.lowering.order,
            multiples_of_px: best.lowering.multiples_of_px.filter(|_| is_resized),
        })
    }
}

/// Asks what a model's interface refuses, and shows it dots at seeded positions: up to [`MOST_QUESTIONS`] questions.
///
/// - `under`: makes the model.
/// - `reasoning`: how much it thinks about the dots.
///
/// Fails if a call is not sent, the first question gets no answer, or the model gives none about the dots.
pub fn probe(
    profile: &Profile,
    under: &Under<'_>,
    seed: u64,
    reasoning: Option<Reasoning>,
    calls: &mut dyn Calls,
) -> Result<Findings, ModelError> {
    let mut prober = Prober {
        profile,
        under,
        calls,
        found: Facts::default(),
        notes: Vec::new(),
    };
    prober.run()?;
    let model = under(&prober.assumed())?;
    let (mut facts, mut notes) = (prober.found, prober.notes);
    let dots = match dots(model.as_ref(), seed, reasoning, prober.calls) {
        Err(ModelError::Failed {
            fault: Fault::BadRequest,
            why,
            ..
        }) => {
            facts.vision = Some(false);
            notes.push(format!("the server refuses pictures: {why}"));
            None
        }
        dots => Some(dots?),
    };
    if let Some(dots) = &dots {
        facts.coordinates = dots.coordinates();
        if facts.coordinates.is_some() {
            // A model that says where dots are has seen them.
            facts.vision = Some(true);
        } else {
            let open = "how it states positions is open: no unit and order fits clearly best";
            notes.push(open.to_owned());
        }
    }
    Ok(Findings { facts, notes, dots })
}

impl Findings {
    /// Writes the entry of a file of facts, ready to paste; notes are comments.
    pub fn toml(&self, profile: &Profile, today: Date) -> String {
        let facts = toml::Table::try_from(&self.facts);
        let facts = facts.expect("facts are tables, texts, finite numbers and truth values");
        let text = |text: &str| toml::Value::from(text);
        let head = [
            ("provider", text(&profile.provider.name)),
            ("id", text(&profile.id)),
            ("as_of", text(&today.to_string())),
            ("source", text("fabc probe")),
        ];
        let head = head.map(|(name, value)| (name.to_owned(), value));
        let fields = head.into_iter().chain(facts);
        let fields = fields.map(|(name, value)| format!("{name} = {value}"));
        // What a server wrote must not end the comment.
        let notes = self
            .notes
            .iter()
            .map(|note| note.replace(char::is_control, " "));
        let lines = std::iter::once("[[model]]".to_owned()).chain(fields);
        let lines: Vec<String> = lines.chain(notes.map(|note| format!("# {note}"))).collect();
        lines.join("\n")
    }
}

/// Asks one question for each of [`SIDES_PX`], always for coordinates, even if rollouts use numbered points.
fn dots(
    model: &dyn Model,
    seed: u64,
    reasoning: Option<Reasoning>,
    calls: &mut dyn Calls,
) -> Result<Dots, ModelError> {
    let asked = Lowering {
        points: Points::Coordinates,
        ..model.lowering()
    };
    let mut chance = Chance::seeded(seed);
    let (mut named, mut replies) = (Vec::new(), Vec::new());
    for side_px in SIDES_PX {
        let places = places(side_px, &mut chance);
        let request = Request {
            reasoning,
            ..question(side_px, &places, asked)
        };
        let reply = model.ask(&request, calls)?.text;
        let stated = reading::pairs(&reply, &DOTS.map(|(colour, _)| colour));
        named.extend(places.into_iter().zip(stated).filter_map(|(at, stated)| {
            let stated = stated?;
            Some(Named {
                side_px,
                at,
                stated,
            })
        }));
        replies.push(reply);
    }
    let tried = lowerings(asked).into_iter().map(|lowering| Tried {
        lowering,
        error_px: error_px(lowering, asked, &named),
    });
    let mut tried: Vec<Tried> = tried.filter(|_| !named.is_empty()).collect();
    // The sort is stable and the stated convention comes first, so it wins ties.
    tried.sort_by(|one, other| one.error_px.total_cmp(&other.error_px));
    Ok(Dots {
        asked,
        tried,
        drawn: DOTS.len() * SIDES_PX.len(),
        read: named.len(),
        replies,
    })
}

/// Returns every known convention of models, the stated one first.
fn lowerings(asked: Lowering) -> Vec<Lowering> {
    let mut lowerings = vec![asked];
    for multiples_of_px in [asked.multiples_of_px, Some(MULTIPLES_OF_PX)] {
        for unit in CoordinateUnit::ALL {
            for order in Order::ALL {
                let lowering = Lowering {
                    unit,
                    order,
                    multiples_of_px,
                    ..asked
                };
                let exists =
                    unit == CoordinateUnit::Pixels || multiples_of_px == asked.multiples_of_px;
                if exists && !lowerings.contains(&lowering) {
                    lowerings.push(lowering);
                }
            }
        }
    }
    lowerings
}

/// Returns the mean distance between dots and answers that are read in a convention.
fn error_px(tried: Lowering, asked: Lowering, named: &[Named]) -> f64 {
    let distances = named.iter().map(|dot| {
        let size = [dot.side_px; 2];
        let frame = Frame {
            // The model got the picture in the stated size, and may have resized it again.
            sent: tried.sent(asked.sent(size)),
            ..*tried.pointing(size).frame()
        };
        let [first, second] = dot.stated;
        let [x, y] = match frame.order {
            Order::Xy => frame.read(first, second),
            Order::Yx => frame.read(second, first),
        };
        let [column, row] = dot.at.map(|at| f64::from(at) + 0.5);
        (x - column).hypot(y - row)
    });
    distances.sum::<f64>() / named.len() as f64
}

/// Draws a position for each dot: clear of the edges and of each other.
fn places(side_px: u32, chance: &mut Chance) -> Vec<[u32; 2]> {
    // The picture in three columns and two rows, a dot in each, within its middle two thirds.
    let cell = [side_px / 3, side_px / 2];
    let mut cells: Vec<[u32; 2]> = (0..6).map(|cell| [cell % 3, cell / 3]).collect();
    let mut places = Vec::with_capacity(cells.len());
    while !cells.is_empty() {
        let at = cells.swap_remove(chance.below(cells.len()));
        places.push([0, 1].map(|axis| {
            let within = chance.below((cell[axis] * 2 / 3) as usize) as u32;
            at[axis] * cell[axis] + cell[axis] / 6 + within
        }));
    }
    places
}

fn question(side_px: u32, places: &[[u32; 2]], asked: Lowering) -> Request {
    let radius = f64::from(side_px / 45).max(4.0);
    let drawn = RgbImage::from_fn(side_px, side_px, |x, y| {
        let is_here = |at: &[u32; 2]| {
            let [dx, dy] = [(x, at[0]), (y, at[1])].map(|(a, b)| f64::from(a) - f64::from(b));
            dx * dx + dy * dy <= radius * radius
        };
        let dot = places.iter().position(is_here);
        Rgb(dot.map_or(GROUND, |dot| DOTS[dot].1))
    });
    let colours = DOTS.map(|(colour, _)| colour);
    let pointing = asked.pointing([side_px; 2]);
    let lines = colours.map(|colour| format!("{colour}: {}", pointing.form()));
    let text = format!(
        "The picture shows six dots: {}. Say where the middle of each dot is.\n{}\nAnswer with these six lines and \
         nothing else, with numbers for the letters:\n{}",
        colours.join(", "),
        pointing.sentence(),
        lines.join("\n")
    );
    let mut message = Message::text(Speaker::User, text);
    message
        .parts
        .push(Part::Image(Png::new(png::encode(&asked.resized(&drawn)))));
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    request.max_tokens = Some(MAX_TOKENS);
    request
}

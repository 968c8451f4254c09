//! Probes how a model states positions and what its interface takes, before money is spent on rollouts.
//!
//! In: a model, which gets points as its [`Lowering`] says. Out: a [`Probe`]: the pixel distances between dots at known
//! positions and the positions in the answers, interpreted in the stated convention and in every other one. Pictures
//! are drawn here, and sent as in rollouts. [`abilities()`] asks about parameters, schema and pictures; [`entry`] writes
//! the facts that both show.

use fab_base::chance::Chance;
use fab_model::calls::{Calls, Usage, Usd};
use fab_model::lowering::{Lowering, Points, Resize};
use fab_model::{Message, Model, ModelError, ModelRole, Part, Png, Reasoning, Request, Speaker};
use fab_picture::png;
use fab_program::pointing::{CoordinateUnit, Frame, Order};
use image::{Rgb, RgbImage};
use serde::Serialize;
use std::num::NonZeroU32;

pub mod abilities;
pub mod entry;

mod reading;
#[cfg(test)]
mod tests;

pub use abilities::{Abilities, MOST_QUESTIONS, Subject, abilities};

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
/// Qwen2.5-VL resizes pictures to multiples of this many pixels, and answers in pixels of the result.
const MULTIPLES_OF_PX: NonZeroU32 = NonZeroU32::new(28).expect("28 is not 0");

/// A model's answers compared with what was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// The model's name.
    pub model: String,
    /// The lowering used in the questions.
    pub asked: Lowering,
    /// The errors under that lowering; `None` if no answer could be read.
    pub error: Option<ErrorPx>,
    /// The errors under every convention tried, best first.
    pub tried: Vec<Tried>,
    /// Number of dots drawn.
    pub dots: usize,
    /// Number of dots with a position in an answer.
    pub read: usize,
    /// Question and answer for each picture.
    pub pictures: Vec<ProbeAnswer>,
    /// Total usage as reported by the provider, if any.
    pub usage: Option<Usage>,
    /// Total cost, if known.
    pub cost: Option<Usd>,
    /// Whether it thinks before it answers; `None`: its answers do not tell.
    pub reasons: Option<bool>,
}

/// The errors of answers interpreted in one convention.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// The lowering of a model that answers so.
    pub lowering: Lowering,
    /// The distances.
    pub error: ErrorPx,
}

/// Distances between dots and answers, pixels of the picture before it was resized, that is, the camera's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorPx {
    /// Their mean.
    pub mean: f64,
    /// Their median; of an even number, the mean of the middle two.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

/// One picture, and the model's answer about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeAnswer {
    /// Side of the picture before it was resized, pixels.
    pub side_px: u32,
    /// Position of each dot in it, column and row.
    pub dots: Vec<Dot>,
    /// The answer.
    pub reply: String,
}

/// A dot, and the answer about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dot {
    /// Its colour.
    pub colour: &'static str,
    /// Its middle: column and row.
    pub at: [u32; 2],
    /// The two numbers of the answer, in order.
    pub said: Option<[f64; 2]>,
}

impl Probe {
    /// Returns the best-fitting lowering; `None` if no answer could be read.
    ///
    /// The stated one wins ties.
    pub fn best(&self) -> Option<Lowering> {
        self.tried.first().map(|best| best.lowering)
    }

    /// Returns whether the stated convention fits better than any other, and each dot was named.
    pub fn agrees(&self) -> bool {
        self.read == self.dots && self.best() == Some(self.asked)
    }
}

/// Shows a model dots at seeded positions and compares its answers.
///
/// Asks one question for each of [`SIDES_PX`], always for coordinates, even if rollouts use numbered points. Fails if
/// the model gives no answer to one.
pub fn probe(
    model: &dyn Model,
    seed: u64,
    reasoning: Option<Reasoning>,
    calls: &mut dyn Calls,
) -> Result<Probe, ModelError> {
    let asked = Lowering {
        points: Points::Coordinates,
        ..model.lowering()
    };
    let mut chance = Chance::seeded(seed);
    let mut pictures = Vec::with_capacity(SIDES_PX.len());
    let (mut usage, mut cost) = (Some(Usage::default()), Some(Usd::ZERO));
    let mut reasons: Option<bool> = None;
    for side_px in SIDES_PX {
        let places = places(side_px, &mut chance);
        let request = Request {
            reasoning,
            ..question(side_px, &places, asked)
        };
        let reply = model.ask(&request, calls)?;
        usage = usage.zip(reply.usage).map(|(sum, more)| sum + more);
        cost = cost.zip(reply.cost).map(|(sum, more)| sum + more);
        reasons = abilities::reasons(&reply).max(reasons);
        let said = reading::pairs(&reply.text, &DOTS.map(|(colour, _)| colour));
        let dots = DOTS.iter().zip(&places).zip(said);
        pictures.push(ProbeAnswer {
            side_px,
            dots: dots
                .map(|(((colour, _), at), said)| Dot {
                    colour,
                    at: *at,
                    said,
                })
                .collect(),
            reply: reply.text,
        });
    }
    let mut tried: Vec<Tried> = lowerings(asked)
        .into_iter()
        .filter_map(|lowering| {
            let error = error_of(lowering, asked, &pictures)?;
            Some(Tried { lowering, error })
        })
        .collect();
    // The sort is stable and the stated convention comes first, so it wins ties.
    tried.sort_by(|one, other| one.error.mean.total_cmp(&other.error.mean));
    let all = || pictures.iter().flat_map(|picture| &picture.dots);
    Ok(Probe {
        model: model.name().to_owned(),
        asked,
        error: tried
            .iter()
            .find(|it| it.lowering == asked)
            .map(|it| it.error),
        tried,
        dots: all().count(),
        read: all().filter(|dot| dot.said.is_some()).count(),
        pictures,
        usage,
        cost,
        reasons,
    })
}

/// Returns every known convention of models, the stated one first.
fn lowerings(asked: Lowering) -> Vec<Lowering> {
    let plain = CoordinateUnit::ALL
        .into_iter()
        .flat_map(|unit| Order::ALL.map(|order| (unit, order, asked.resize)));
    let of_px = MULTIPLES_OF_PX;
    let resized =
        Order::ALL.map(|order| (CoordinateUnit::Pixels, order, Resize::Multiples { of_px }));
    let mut lowerings = vec![asked];
    for (unit, order, resize) in plain.chain(resized) {
        let lowering = Lowering {
            unit,
            order,
            resize,
            ..asked
        };
        if !lowerings.contains(&lowering) {
            lowerings.push(lowering);
        }
    }
    lowerings
}

fn error_of(tried: Lowering, asked: Lowering, pictures: &[ProbeAnswer]) -> Option<ErrorPx> {
    let mut distances: Vec<f64> = Vec::new();
    for picture in pictures {
        let size = [picture.side_px; 2];
        let frame = Frame {
            // The model got the picture in the stated size, and may have resized it again.
            sent: tried.sent(asked.sent(size)),
            ..*tried.pointing(size).frame()
        };
        for dot in &picture.dots {
            let Some([first, second]) = dot.said else {
                continue;
            };
            let [x, y] = match frame.order {
                Order::Xy => frame.read(first, second),
                Order::Yx => frame.read(second, first),
            };
            let [column, row] = dot.at.map(|at| f64::from(at) + 0.5);
            distances.push((x - column).hypot(y - row));
        }
    }
    distances.sort_by(f64::total_cmp);
    let middle = distances.len() / 2;
    let max = *distances.last()?;
    let median = if distances.len().is_multiple_of(2) {
        (distances[middle - 1] + distances[middle]) / 2.0
    } else {
        distances[middle]
    };
    Some(ErrorPx {
        mean: distances.iter().sum::<f64>() / distances.len() as f64,
        median,
        max,
    })
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
    let mut drawn = RgbImage::from_pixel(side_px, side_px, Rgb(GROUND));
    let radius = i64::from(side_px / 45).max(4);
    let around = |middle: u32| {
        let least = i64::from(middle) - radius;
        (least.max(0)..=least + 2 * radius).filter_map(|at| u32::try_from(at).ok())
    };
    for ((_, colour), [column, row]) in DOTS.iter().zip(places) {
        for (x, y) in around(*row).flat_map(|y| around(*column).map(move |x| (x, y))) {
            let (dx, dy) = (
                i64::from(x) - i64::from(*column),
                i64::from(y) - i64::from(*row),
            );
            if dx * dx + dy * dy <= radius * radius && x < side_px && y < side_px {
                drawn.put_pixel(x, y, Rgb(*colour));
            }
        }
    }
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

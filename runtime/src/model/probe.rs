//! Finds out how a model says where something is, before money is spent on rollouts.
//!
//! In: a model, and the habit that it is believed to have. Out: a [`Probe`], the distances in pixels between dots
//! whose places are known and the places that the answers name, under that habit and under every other. Pictures are
//! drawn here, and asked for in the words of the habit; what is to be believed afterwards is left to the user.

use super::catalogue::{Habit, Order, Unit};
use super::{Message, Model, ModelError, ModelRole, Part, Png, Request, Speaker};
use crate::calls::{Calls, Usage, Usd};
use crate::chance::Chance;
use crate::picture;
use image::{Rgb, RgbImage};
use serde::Serialize;

mod reading;
#[cfg(test)]
mod tests;

/// What the dots are called, and their colours.
const DOTS: [(&str, [u8; 3]); 6] = [
    ("red", [220, 30, 30]),
    ("green", [20, 150, 40]),
    ("blue", [30, 60, 220]),
    ("yellow", [235, 205, 20]),
    ("black", [15, 15, 15]),
    ("magenta", [215, 40, 200]),
];
/// The colour of what lies between them.
const GROUND: [u8; 3] = [225, 225, 225];
/// Sides of the square pictures, pixels: those of the shipped tasks' cameras.
pub const SIDES_PX: [u32; 2] = [224, 720];
/// The longest answer, tokens; six lines have about 60, and models that think aloud need more.
const MAX_TOKENS: u32 = 1000;

/// What a model answered, held against what was drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// The model's name.
    pub model: String,
    /// The habit whose words the questions used.
    pub asked: Habit,
    /// The errors under that habit; None where no answer could be read.
    pub error: Option<ErrorPx>,
    /// Under every habit, the best first.
    pub habits: Vec<HabitError>,
    /// Dots that were drawn.
    pub dots: usize,
    /// Those of them that an answer named a place for.
    pub read: usize,
    /// What was asked and answered, a picture each.
    pub pictures: Vec<Asked>,
    /// What the provider says that all questions used, where it said so.
    pub usage: Option<Usage>,
    /// What they cost, where that is known.
    pub cost: Option<Usd>,
}

/// The errors under one habit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HabitError {
    /// The habit.
    pub habit: Habit,
    /// The distances.
    pub error: ErrorPx,
}

/// Distances between dots and answers, pixels of the picture that was sent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorPx {
    /// Their mean.
    pub mean: f64,
    /// The one in the middle; of an even number the mean of both.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

/// One picture, and what the model said of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Asked {
    /// Side of the picture, pixels.
    pub side_px: u32,
    /// Where each dot is, column and row.
    pub dots: Vec<Dot>,
    /// The answer.
    pub reply: String,
}

/// A dot, and what was said of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Dot {
    /// Its colour.
    pub colour: &'static str,
    /// Its middle: column and row.
    pub at: [u32; 2],
    /// The two numbers of the answer, in their order.
    pub said: Option<[f64; 2]>,
}

impl Probe {
    /// Returns the habit that fits best; None where no answer could be read.
    ///
    /// Of equally good ones it is the one that was asked for.
    pub fn best(&self) -> Option<Habit> {
        self.habits.first().map(|best| best.habit)
    }

    /// Returns whether the answers fit the habit that was asked for better than any other, and each dot was named.
    pub fn agrees(&self) -> bool {
        self.read == self.dots && self.best() == Some(self.asked)
    }
}

/// Shows a model dots at seeded places and compares what it says of them.
///
/// Asks one question for each of [`SIDES_PX`]. Fails where the model gives no answer to one.
pub fn probe(
    model: &dyn Model,
    asked: Habit,
    seed: u64,
    calls: &mut dyn Calls,
) -> Result<Probe, ModelError> {
    let mut chance = Chance::seeded(seed);
    let mut pictures = Vec::with_capacity(SIDES_PX.len());
    let (mut usage, mut cost) = (Some(Usage::default()), Some(Usd::ZERO));
    for side_px in SIDES_PX {
        let places = places(side_px, &mut chance);
        let reply = model.ask(&question(side_px, &places, asked), calls)?;
        usage = usage.zip(reply.usage).map(|(sum, more)| sum + more);
        cost = cost.zip(reply.cost).map(|(sum, more)| sum + more);
        let said = reading::pairs(&reply.text, &DOTS.map(|(colour, _)| colour));
        let dots = DOTS.iter().zip(&places).zip(said);
        pictures.push(Asked {
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
    let mut habits: Vec<HabitError> = all_habits(asked)
        .into_iter()
        .filter_map(|habit| error_under(habit, &pictures).map(|error| HabitError { habit, error }))
        .collect();
    // A stable sort: the habit that was asked for is the first one, and stays so among equals.
    habits.sort_by(|one, other| one.error.mean.total_cmp(&other.error.mean));
    let all = || pictures.iter().flat_map(|picture| &picture.dots);
    Ok(Probe {
        model: model.name().to_owned(),
        asked,
        error: habits
            .iter()
            .find(|it| it.habit == asked)
            .map(|it| it.error),
        habits,
        dots: all().count(),
        read: all().filter(|dot| dot.said.is_some()).count(),
        pictures,
        usage,
        cost,
    })
}

/// Returns every habit that models are known to have, the one that was asked for first.
fn all_habits(asked: Habit) -> Vec<Habit> {
    let orders = [Order::Xy, Order::Yx];
    let plain = Unit::ALL
        .into_iter()
        .flat_map(|unit| orders.map(|order| (unit, order, None)));
    let resized = orders.map(|order| (Unit::Pixels, order, Some(28)));
    let others = plain
        .chain(resized)
        .map(|(unit, order, multiples_of_px)| Habit {
            unit,
            order,
            multiples_of_px,
        });
    std::iter::once(asked)
        .chain(others.filter(|habit| *habit != asked))
        .collect()
}

fn error_under(habit: Habit, pictures: &[Asked]) -> Option<ErrorPx> {
    let mut distances: Vec<f64> = Vec::new();
    for picture in pictures {
        for dot in &picture.dots {
            let Some(said) = dot.said else { continue };
            let [x, y] = habit.pixel_from(said, [picture.side_px; 2]);
            distances.push((x - f64::from(dot.at[0])).hypot(y - f64::from(dot.at[1])));
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

/// Draws a place for each dot: clear of the edges and of each other.
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

fn question(side_px: u32, places: &[[u32; 2]], habit: Habit) -> Request {
    let mut drawn = RgbImage::from_pixel(side_px, side_px, Rgb(GROUND));
    let radius = i64::from(side_px / 45).max(4);
    for ((_, colour), [column, row]) in DOTS.iter().zip(places) {
        for (x, y, pixel) in drawn.enumerate_pixels_mut() {
            let (dx, dy) = (
                i64::from(x) - i64::from(*column),
                i64::from(y) - i64::from(*row),
            );
            if dx * dx + dy * dy <= radius * radius {
                *pixel = Rgb(*colour);
            }
        }
    }
    let colours = DOTS.map(|(colour, _)| colour);
    let lines = colours.map(|colour| match habit.order {
        Order::Xy => format!("{colour}: (x, y)"),
        Order::Yx => format!("{colour}: [y, x]"),
    });
    let text = format!(
        "The picture shows six dots: {}. Say where the middle of each dot is.\n{}\nAnswer with these six lines and \
         nothing else, with numbers for the letters:\n{}",
        colours.join(", "),
        frame_words(habit, side_px),
        lines.join("\n")
    );
    let mut message = Message::text(Speaker::User, text);
    message
        .parts
        .push(Part::Image(Png::new(picture::encode(&drawn))));
    let mut request = Request::new(ModelRole::Vision, vec![message]);
    request.max_tokens = Some(MAX_TOKENS);
    request
}

/// Says what the numbers are to count.
fn frame_words(habit: Habit, side_px: u32) -> String {
    let unit = match habit.unit {
        Unit::Pixels => {
            let seen = habit.seen(side_px);
            format!("in pixels of the picture, which is {seen} wide and {seen} high")
        }
        Unit::Fraction => "as a share of the picture's width and height, from 0 to 1".to_owned(),
        Unit::Percent => "in percent of the picture's width and height, from 0 to 100".to_owned(),
        Unit::PerMille => {
            "in thousandths of the picture's width and height, from 0 to 1000".to_owned()
        }
    };
    format!(
        "A place is written {unit}: x grows to the right, y grows downwards, and 0, 0 is the top left."
    )
}

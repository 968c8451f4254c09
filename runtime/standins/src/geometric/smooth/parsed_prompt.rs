//! Reads smoothing prompts, independent of their exact wording.
//!
//! In: the words of a question. Out: a [`ParsedPrompt`]. Sentences are recognised by their content, such as `px` beside
//! `edge` for the scale; nothing is assumed that no sentence states.

use super::super::prompt;
use fab_program::PixelPoint;
use std::collections::BTreeSet;

/// The contents of a prompt for a pick, a direction and a distance.
#[derive(Clone, Debug, PartialEq)]
pub struct ParsedPrompt {
    /// The corners to pick from; empty if the prompt lists none.
    pub corners: Vec<PixelPoint>,
    /// The cloth's center, if the prompt states it.
    pub center: Option<PixelPoint>,
    /// The offered directions, degrees counter-clockwise from the picture's right; never empty.
    pub directions: Vec<Choice>,
    /// The offered distances, multiples of the cloth's side; never empty.
    pub distances: Vec<Choice>,
    /// The cloth's side in the picture, pixels, above zero.
    pub edge_px: f64,
    /// Points to avoid, each with a minimum distance, pixels.
    pub avoided: Vec<(PixelPoint, f64)>,
    /// A point and the greatest distance from it at which a corner may be placed, pixels.
    pub bound: Option<(PixelPoint, f64)>,
}

/// One of the values that an answer's line offers.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// As written.
    pub words: String,
    /// As a number.
    pub value: f64,
}

/// The most values of one field that are read.
const MAX_CHOICES: usize = 64;

/// The most corners considered; a detector keeps fifteen.
const MAX_CORNERS: usize = 100;

/// Valid lengths in a picture, pixels.
const PIXELS: std::ops::RangeInclusive<f64> = 1.0..=8192.0;

/// The largest number of degrees or sides that is read, of either sign.
const MAX_VALUE: f64 = 1e4;

impl ParsedPrompt {
    /// Reads a prompt; fails with what is missing.
    pub fn read(text: &str) -> Result<ParsedPrompt, String> {
        // A sentence about points to avoid may mention corners, too.
        let is_listing =
            |line: &&str| !line.contains("away from") && !line.contains("farther than");
        let listing = text
            .lines()
            .filter(is_listing)
            .collect::<Vec<_>>()
            .join("\n");
        let mut corners = prompt::corners(&listing);
        let mut seen = BTreeSet::new();
        corners.retain(|corner| seen.insert(*corner));
        corners.truncate(MAX_CORNERS);
        let directions = choices(text, "direction");
        let distances = choices(text, "distance");
        if directions.is_empty() || distances.is_empty() {
            return Err("no directions or no distances are offered".to_owned());
        }
        let unit = |choice: &Choice| choice.words.split_whitespace().nth(1).map(str::to_owned);
        if let Some(unit) = distances
            .iter()
            .filter_map(unit)
            .find(|unit| unit != "edge")
        {
            return Err(format!(
                "distances are offered in `{unit}`, and it understands multiples of an `edge` alone"
            ));
        }
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let said = |words: &[&str]| {
            let holds = |sentence: &&str| {
                let sentence = sentence.to_lowercase();
                words.iter().all(|word| sentence.contains(word)) && pixels(&sentence).is_some()
            };
            let found = flat.split(". ").filter(holds).last()?;
            Some((prompt::points(found), pixels(found)?))
        };
        let (_, edge_px) = said(&["edge"]).ok_or("no sentence says how many px an edge is")?;
        let avoided = said(&["away from"]).map(|(points, px)| {
            let each = points.into_iter().map(move |point| (point, px));
            each.collect::<Vec<_>>()
        });
        let bound =
            said(&["farther than", "middle"]).and_then(|(points, px)| Some((*points.first()?, px)));
        Ok(ParsedPrompt {
            center: prompt::center(text),
            corners,
            directions,
            distances,
            edge_px,
            avoided: avoided.unwrap_or_default(),
            bound,
        })
    }
}

/// Returns the values of a line such as `Direction = 0 deg | 45 deg`; empty if there is none.
pub fn choices(text: &str, field: &str) -> Vec<Choice> {
    let listed = text.lines().rev().find_map(|line| {
        let (name, values) = line.split_once('=')?;
        name.trim().eq_ignore_ascii_case(field).then_some(values)
    });
    let values = listed.into_iter().flat_map(|values| values.split('|'));
    let choices = values.filter_map(|words| {
        let words = words.trim();
        let value: f64 = words.split_whitespace().next()?.parse().ok()?;
        (value.abs() <= MAX_VALUE).then(|| Choice {
            words: words.to_owned(),
            value,
        })
    });
    choices.take(MAX_CHOICES).collect()
}

/// The first number before `px` in a sentence, if it is a valid length.
fn pixels(sentence: &str) -> Option<f64> {
    let words: Vec<&str> = sentence.split_whitespace().collect();
    let number = words
        .windows(2)
        .find(|pair| pair[1].starts_with("px"))
        .and_then(|pair| pair[0].parse::<f64>().ok());
    number.filter(|px| PIXELS.contains(px))
}

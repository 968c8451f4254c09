//! Generates values that are not offered: between choices, one pixel off, other words, none, far too large.

use fab_program::exact::normalised_deg;
use fab_program::reply::SAME_DEG;
use fab_program::space;
use fab_program::{ActionField, PixelPoint, Program, Value};

/// The most pairs of neighbouring choices per field between which values are tried.
const MAX_BETWEEN: usize = 2;

/// How much writing an angle may change it, degrees.
const MOST_ROUNDED_DEG: f64 = 1e-3;

/// Returns values that a field does not offer, as an answer would state them.
///
/// - `texts`: the offered values as prompts write them.
pub(super) fn of(field: &ActionField, offered: &[Value], texts: &[String]) -> Vec<String> {
    let mut others = vec![String::new(), "9".repeat(400)];
    let mut numbers: Vec<f64> = Vec::new();
    for value in spread(offered, MAX_BETWEEN) {
        match value {
            Value::Point(point) => {
                others.push(PixelPoint::new(point.u.saturating_add(1), point.v).to_string());
                others.push(PixelPoint::new(point.u, point.v.saturating_sub(1)).to_string());
            }
            // The reader finds an offered word inside a phrase, and reports that.
            Value::Word(word) if word.contains([' ', '-', '_']) => {}
            Value::Word(word) => {
                let shorter = &word[..word.char_indices().last().map_or(0, |(at, _)| at)];
                others.extend([
                    format!("{word}z"),
                    format!("non-{word}"),
                    shorter.to_owned(),
                ]);
            }
            Value::Direction { deg: number } | Value::Length { length: number } => {
                numbers.push(*number);
            }
        }
    }
    numbers.sort_by(f64::total_cmp);
    let between = numbers.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
    let beyond = numbers.last().map(|last| last / 2.0 + 175.3);
    let stated = |number: f64| {
        let value = match offered.first() {
            Some(Value::Direction { .. }) => Value::Direction { deg: number },
            _ => Value::Length { length: number },
        };
        space::text(field, &value)
    };
    let below = numbers.first().map(|first| -1.0 - first);
    // Where directions lie close together, the reader takes the angle between two as one of them.
    let is_read_as_offered = |number: f64| {
        offered.iter().any(|value| match value {
            Value::Direction { deg } => {
                let apart = normalised_deg(deg - number);
                apart.min(360.0 - apart) <= SAME_DEG + MOST_ROUNDED_DEG
            }
            _ => false,
        })
    };
    let numbers = between.chain(beyond).chain(below);
    others.extend(
        numbers
            .filter(|number| !is_read_as_offered(*number))
            .map(stated),
    );
    if let [first, .., last] = texts {
        others.push(format!("{first} or {last}"));
    }
    let plain = |text: &str| text.to_lowercase().replace(['_', '-'], " ");
    let known: Vec<String> = texts.iter().map(|text| plain(text)).collect();
    let is_offered = |other: &String| {
        let turned = match (offered.first(), other.trim_end_matches(" deg").parse()) {
            // Directions that differ by whole turns are the same.
            (Some(Value::Direction { .. }), Ok(stated)) => {
                let deg = normalised_deg(stated);
                Some(space::text(field, &Value::Direction { deg }))
            }
            _ => None,
        };
        let other = plain(turned.as_ref().unwrap_or(other));
        known.contains(&other)
    };
    others.retain(|other| !is_offered(other));
    others
}

/// Returns values that a field with every pixel of the picture does not offer.
pub(super) fn beside(program: &Program, texts: &[String]) -> Vec<String> {
    let side = i32::try_from(program.camera.image_px).unwrap_or(i32::MAX);
    let mut others = vec![String::new(), "9".repeat(400)];
    let outside = [[-1, 0], [0, -1], [side, 0], [0, side]];
    others.extend(outside.map(|pixel| PixelPoint::from(pixel).to_string()));
    if let [first, .., last] = texts {
        others.push(format!("{first} or {last}"));
    }
    others
}

/// Returns neighbouring values from up to `most` places, spread over the list.
fn spread(values: &[Value], most: usize) -> impl Iterator<Item = &Value> {
    let step = values.len().div_ceil(most).max(1);
    values
        .iter()
        .enumerate()
        .filter(move |(index, _)| index % step == 0 || index % step == 1)
        .take(2 * most)
        .map(|(_, value)| value)
}

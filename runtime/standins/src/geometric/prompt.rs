//! Reads planning prompts, independent of their exact wording.
//!
//! In: the lines of a prompt. Out: points, and the form of the answer. Lines are recognised by their content: one with
//! `corner` and points lists the corners, one with `cent` and a point gives the center, and any other line with a
//! label, a colon and points lists additional points.

use fab_program::measures::{QUADRANTS, quadrant};
use fab_program::units;
use fab_program::{Manner, PixelPoint};

/// The most points read from one prompt.
const MAX_POINTS: usize = 1000;

/// Returns the points of the last list of corners in a text, in order; empty if it has none.
///
/// A list may continue on lines with nothing but points.
pub fn corners(text: &str) -> Vec<PixelPoint> {
    let mut found = Vec::new();
    let mut is_open = false;
    for line in text.lines() {
        let listed = match after_word(line, "corner") {
            Some(rest) => {
                is_open = !points(rest).is_empty();
                if is_open {
                    found.clear();
                }
                rest
            }
            None => {
                is_open &= !line.chars().any(char::is_alphabetic);
                line
            }
        };
        if is_open {
            found.extend(points(listed));
        }
    }
    found.truncate(MAX_POINTS);
    found
}

/// Returns the last point that a line calls the center.
pub fn center(text: &str) -> Option<PixelPoint> {
    let lines = text
        .lines()
        .filter(|line| after_word(line, "corner").is_none());
    lines
        .filter_map(|line| points(after_word(line, "cent")?).first().copied())
        .next_back()
}

/// Returns the points of all lists other than corners and center, in order.
pub fn other_points(text: &str) -> Vec<PixelPoint> {
    let is_other = |label: &str| {
        let names = |word| after_word(label, word).is_some();
        !names("corner") && !names("cent") && !label.contains(['(', '['])
    };
    let lists = text.lines().filter_map(|line| {
        let (label, list) = line.split_once(':')?;
        (is_other(label) && !list.contains(char::is_alphabetic)).then(|| points(list))
    });
    let mut found: Vec<PixelPoint> = lists.flatten().collect();
    found.truncate(MAX_POINTS);
    found
}

/// Returns whether a prompt says that the unfolded cloth is centred in the picture.
pub fn centers_cloth_in_picture(text: &str) -> bool {
    let names_both = |sentence: &str| {
        let names = |words: &[&str]| words.iter().any(|word| sentence.contains(word));
        let middles = sentence.matches("middle").count() + sentence.matches("cent").count();
        middles >= 2 && names(&["cloth", "fabric"]) && names(&["picture", "image"])
    };
    // A sentence may span lines.
    let text = text
        .to_lowercase()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    text.split(['.', ':', ';']).any(names_both)
}

/// Returns the lines that may hold the instruction, most likely ones first.
pub fn instruction_lines(text: &str) -> impl Iterator<Item = &str> {
    let is_likely = |line: &&str| {
        ["instruction", "folding", "method", "step"]
            .iter()
            .any(|word| after_word(line, word).is_some())
    };
    let likely = text.lines().filter(move |line| is_likely(line));
    likely.chain(text.lines().filter(move |line| !is_likely(line)))
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

/// The largest number of degrees, sides or pixels that is read.
const MAX_VALUE: f64 = 1e4;

/// Returns for each sentence with a word and a length in `px` the points that it names and that length, pixels.
pub fn lengths(text: &str, word: &str) -> impl Iterator<Item = (Vec<PixelPoint>, f64)> {
    let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let sentences: Vec<String> = flat.split(". ").map(str::to_owned).collect();
    sentences.into_iter().filter_map(move |sentence| {
        let words: Vec<&str> = sentence.split(' ').collect();
        let mut pairs = words.windows(2).filter(|pair| pair[1].starts_with("px"));
        let px: f64 = pairs.find_map(|pair| pair[0].parse().ok())?;
        let is_it = sentence.to_lowercase().contains(word) && (1.0..=MAX_VALUE).contains(&px);
        is_it.then(|| (points(&sentence), px))
    })
}

/// The line of an answer that gives one point: the text before and after the point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerLine {
    before: String,
    after: String,
}

impl AnswerLine {
    /// Finds the line in which a prompt asks for a point, such as `Pick Point = (x, y)`.
    ///
    /// `field` is `pick` or `place`. Without such a line, the paper's form is used.
    pub fn asked_for(field: &str, prompt: &str) -> AnswerLine {
        prompt
            .lines()
            .rev()
            .find_map(|line| AnswerLine::read(field, line))
            .unwrap_or_else(|| {
                let (initial, rest) = field.split_at(1);
                let name = format!("{}{rest}", initial.to_uppercase());
                AnswerLine {
                    before: format!("{name} Point = ("),
                    after: ")".to_owned(),
                }
            })
    }

    fn read(field: &str, line: &str) -> Option<AnswerLine> {
        let line = line.trim();
        after_word(line, field)?;
        let (before, after) = line.split_once("x, y").or_else(|| line.split_once("x,y"))?;
        let opens = before.ends_with(['(', '['])
            && before.trim_end_matches(['(', '[']).contains(['=', ':']);
        opens.then(|| AnswerLine {
            before: before.to_owned(),
            after: after.to_owned(),
        })
    }

    /// Writes the line with a point in it.
    pub fn with(&self, point: PixelPoint) -> String {
        format!("{}{}, {}{}", self.before, point.u, point.v, self.after)
    }
}

/// Returns what else a prompt's format asks for besides a pick point and a place point.
///
/// A format that lists values, `Direction = 0 deg | 90 deg`, asks for that field; a format with only a pick point asks
/// for something instead of a place point.
pub fn asks_for_more(prompt: &str) -> Option<String> {
    let listed = prompt.lines().find_map(|line| {
        let (name, values) = line.split_once('=')?;
        let is_name = !name.trim().is_empty() && name.split_whitespace().count() <= 3;
        let is_other = is_name
            && !Manner::USUAL
                .stated()
                .any(|(known, _)| is_field(name, known));
        (is_other && values.contains(" | ") && !are_quadrants(values))
            .then(|| format!("for `{}`", name.trim()))
    });
    let stated = |field: &str| {
        prompt
            .lines()
            .any(|line| AnswerLine::read(field, line).is_some())
    };
    let alone = (stated("pick") && !stated("place")).then(|| "for a pick point alone".to_owned());
    listed.or(alone)
}

/// Returns whether the values that a format lists all say where a point lies.
fn are_quadrants(values: &str) -> bool {
    values
        .split('|')
        .all(|value| QUADRANTS.as_flattened().contains(&value.trim()))
}

/// Returns the line of an answer that says where the pick point lies, seen from the center, if the prompt asks for it.
pub fn quadrant_line(prompt: &str, pick: PixelPoint, center: PixelPoint) -> Option<String> {
    let mut asked = prompt.lines().filter_map(|line| line.split_once('='));
    let (name, _) = asked.find(|(_, values)| are_quadrants(values))?;
    let [pick, center] = [pick, center].map(|it| [it.u, it.v].map(f64::from));
    Some(format!("{} = {}", name.trim(), quadrant(pick, center)))
}

/// Returns whether a line's name is that of a field, such as `- Release height`.
fn is_field(name: &str, field: &str) -> bool {
    let name = name.trim_start_matches(['-', '*', ' ']).trim_end();
    name.replace(' ', "_").eq_ignore_ascii_case(field)
}

/// Returns the lines of an answer that say how to carry the cloth, one for each that the prompt's format asks for: of
/// the listed values, the one nearest to the usual.
pub fn manner_lines(prompt: &str) -> Vec<String> {
    let line = |(field, usual): (&str, f64)| {
        let asked = prompt.lines().rev().filter_map(|line| line.split_once('='));
        let (name, values) = asked.into_iter().find(|(name, _)| is_field(name, field))?;
        let off = |value: &&str| {
            let (number, unit) = value.split_once(' ').unwrap_or((value, ""));
            let number: f64 = number.parse().unwrap_or(f64::NAN);
            (units::base((number, unit)) - usual).abs()
        };
        let values = values.split('|').map(str::trim);
        let nearest = values.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some(format!("{} = {nearest}", name.trim()))
    };
    Manner::USUAL.stated().filter_map(line).collect()
}

/// Returns the point given for `field`, `pick` or `place`, in an answer.
pub fn answered(field: &str, answer: &str) -> Option<PixelPoint> {
    answer
        .lines()
        .find_map(|line| points(after_word(line, field)?).first().copied())
}

/// The rest of a line after a word or word prefix, ignoring case.
fn after_word<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let at = line.to_ascii_lowercase().find(word)?;
    line.get(at + word.len()..)
}

/// Returns the points `(x, y)` or `[x, y]` of a text in order.
pub fn points(text: &str) -> Vec<PixelPoint> {
    let mut found = Vec::new();
    let openings = text.match_indices(['(', '[']);
    for (at, _) in openings {
        let inside = text[at + 1..]
            .split([')', ']', '(', '['])
            .next()
            .unwrap_or_default();
        let mut numbers = inside.split(',').map(|number| number.trim().parse::<i32>());
        if let (Some(Ok(u)), Some(Ok(v)), None) = (numbers.next(), numbers.next(), numbers.next()) {
            found.push(PixelPoint::new(u, v));
        }
        if found.len() == MAX_POINTS {
            break;
        }
    }
    found
}

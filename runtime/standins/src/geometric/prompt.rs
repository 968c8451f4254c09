//! Reads planning prompts, independent of their exact wording.
//!
//! In: the lines of a prompt. Out: points, lengths, and the form of the answer. Lines are recognised by their content: a
//! list after `corner` has the corners, a point after `cent` is the center, and any other line of a label, a colon and
//! points lists more points. A line `NAME = A | B` asks for a field and offers its values.

use fab_program::measures::{QUADRANTS, quadrant};
use fab_program::units;
use fab_program::{Manner, PixelPoint};

/// The points that a prompt lists.
#[derive(Clone, Debug, Default)]
pub struct Listed {
    /// Current corners of the cloth; they can be picked, and show the cloth's pose.
    pub corners: Vec<PixelPoint>,
    /// Other points that can be placed on, each with its list's name in lower case.
    pub others: Vec<(String, PixelPoint)>,
    /// The initial position of the cloth's center.
    pub center: Option<PixelPoint>,
}

impl Listed {
    /// Returns all points that can be placed on.
    pub fn places(&self) -> Vec<PixelPoint> {
        let others = self.others.iter().map(|(_, point)| point);
        let corners = self.corners.iter().chain(others);
        corners.chain(&self.center).copied().collect()
    }

    /// Returns all points that can be picked: the corners, and those of lists that a sentence names as such, for example
    /// `Choose the pick point from the listed corners or the listed side points.`
    pub fn picks(&self, asked: &str) -> Vec<PixelPoint> {
        let asked = flat(asked).to_lowercase();
        let offers = |name: &str| {
            let mut sentences = asked.split(". ");
            sentences.any(|it| it.contains("pick point from") && it.contains(name))
        };
        let others = self.others.iter().filter(|(name, _)| offers(name));
        let others = others.map(|(_, point)| point);
        self.corners.iter().chain(others).copied().collect()
    }
}

/// Returns the points of a prompt; of several lists of corners and several centers, the last.
///
/// Points beside a length in `px` belong to a rule, not to a list.
pub fn listed(text: &str) -> Listed {
    let mut listed = Listed::default();
    for line in text.lines() {
        let (label, list) = line.split_at(line.find(['(', '[']).unwrap_or(line.len()));
        let (label, found) = (label.trim_end().to_lowercase(), points(list));
        if found.is_empty() || label.contains(" px ") {
            continue;
        }
        if label.contains("corner") {
            listed.corners = found;
        } else if label.contains("cent") {
            listed.center = Some(found[0]);
        } else if let Some(name) = label.strip_suffix(':')
            && !list.contains(char::is_alphabetic)
        {
            let name = name.trim_start_matches(['-', '*', ' ']);
            let found = found.into_iter().map(|point| (name.to_owned(), point));
            listed.others.extend(found);
        }
    }
    listed
}

/// Returns for each sentence with a word and a length in `px` the points that it names and that length, pixels.
pub fn lengths(text: &str, word: &str) -> Vec<(Vec<PixelPoint>, f64)> {
    let of = |sentence: &str| {
        let words: Vec<&str> = sentence.split(' ').collect();
        let mut pairs = words.windows(2).filter(|pair| pair[1].starts_with("px"));
        let px: f64 = pairs.find_map(|pair| pair[0].parse().ok())?;
        let is_it = sentence.to_lowercase().contains(word) && px >= 1.0;
        is_it.then(|| (points(sentence), px))
    };
    flat(text).split(". ").filter_map(of).collect()
}

/// Joins the lines of a text, since a sentence may span them.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// One of the values that an answer's line offers.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// As written.
    pub words: String,
    /// As a number.
    pub value: f64,
}

/// Returns the numbers that the last line of a field offers, such as `Direction = 0 deg | 45 deg`; empty if there is
/// none.
pub fn choices(text: &str, field: &str) -> Vec<Choice> {
    let fields = fields(text).rev();
    let mut listed = fields.filter(|(name, _)| name.eq_ignore_ascii_case(field));
    let choices = listed.next().into_iter().flat_map(|(_, values)| values);
    let choices = choices.filter_map(|words| {
        let value: f64 = words.split_whitespace().next()?.parse().ok()?;
        let words = words.to_owned();
        Some(Choice { words, value })
    });
    choices.collect()
}

/// Returns the line of an answer that says where the pick point lies, seen from the center, if the prompt asks for it.
pub fn quadrant_line(prompt: &str, pick: PixelPoint, center: PixelPoint) -> Option<String> {
    let is_quadrant = |value: &&str| QUADRANTS.as_flattened().contains(value);
    let (name, _) = fields(prompt).find(|(_, values)| values.iter().all(is_quadrant))?;
    let [pick, center] = [pick, center].map(|it| [it.u, it.v].map(f64::from));
    Some(format!("{name} = {}", quadrant(pick, center)))
}

/// Returns the lines of an answer that say how to carry the cloth, one for each that the prompt's format asks for: of
/// the listed values, the one nearest to the usual.
pub fn manner_lines(prompt: &str) -> Vec<String> {
    let line = |(field, usual): (&str, f64)| {
        let is_it = |name: &str| name.replace(' ', "_").eq_ignore_ascii_case(field);
        let (name, values) = fields(prompt).rev().find(|(name, _)| is_it(name))?;
        let off = |value: &&str| {
            let (number, unit) = value.split_once(' ').unwrap_or((value, ""));
            let number: f64 = number.parse().unwrap_or(f64::NAN);
            (units::base((number, unit)) - usual).abs()
        };
        let nearest = values
            .into_iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some(format!("{name} = {nearest}"))
    };
    Manner::USUAL.stated().filter_map(line).collect()
}

/// Returns the names and values of lines such as `- Release height = 0 mm | 40 mm`.
fn fields(text: &str) -> impl DoubleEndedIterator<Item = (&str, Vec<&str>)> {
    text.lines().filter_map(|line| {
        let (name, values) = line.split_once('=')?;
        let name = name.trim_start_matches(['-', '*', ' ']).trim_end();
        Some((name, values.split(" | ").map(str::trim).collect()))
    })
}

/// Returns the points `(x, y)` or `[x, y]` of a text in order.
pub fn points(text: &str) -> Vec<PixelPoint> {
    let insides = text.split(['(', '[']).skip(1);
    let points = insides.filter_map(|inside| {
        let inside = inside.split([')', ']']).next()?;
        let (u, v) = inside.split_once(',')?;
        let number = |text: &str| text.trim().parse().ok();
        Some(PixelPoint::new(number(u)?, number(v)?))
    });
    points.collect()
}

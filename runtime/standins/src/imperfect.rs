//! `imperfect`: a stand-in that errs at a stated rate, to show the value of verification.
//!
//! In: a [`Request`]. Out: the answer of `geometric`, or with the stated probability a wrong one. A quarter of the
//! errors each are a pick near the last place point, the opposite direction (pick and place swapped if there is none),
//! an unlisted point, and unreadable words. Each question for an action draws by its own content, its step, its
//! repetition and the seed; questions for words are passed on. It shows how many such errors the checks catch, and
//! nothing about the errors of a vision-language model.
//!
//! Two other [`Errors`] are harder to catch by asking again: a wrong answer that persists in its scene, and a point
//! beside the right one.

use super::Geometric;
use super::choices::{self, Field};
use fab_base::chance::Chance;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Part, Reply, Request, Speaker};
use fab_program::PixelPoint;

/// Distance of an unlisted point from the right one, pixels.
const ASTRAY_PX: i32 = 29;

/// The stand-in.
#[derive(Clone, Debug)]
pub struct Imperfect {
    name: String,
    rate: f64,
    seed: u64,
    errors: Errors,
}

/// How the stand-in errs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Errors {
    /// In four ways, drawn anew for every question.
    #[default]
    Mixed,
    /// With an offered value in one of two ways: a pick near the last place point, or the opposite direction. Drawn by
    /// the offered values alone, so that every question about one scene gets the same wrong answer.
    Persistent,
    /// With the offered point that is nearest to the right one, as pick or as place. Drawn anew for every question.
    Neighbour,
}

impl Errors {
    /// The words for errors other than the mixed ones.
    pub const WORDS: [(&'static str, Errors); 2] = [
        ("persistent", Errors::Persistent),
        ("neighbour", Errors::Neighbour),
    ];

    /// Returns the errors that a word means.
    pub fn from_word(word: &str) -> Option<Errors> {
        let mut words = Errors::WORDS.iter();
        words
            .find(|(known, _)| *known == word)
            .map(|(_, errors)| *errors)
    }
}

/// A kind of error in an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AnswerMistake {
    NearLastPlace,
    Opposite,
    OffTheList,
    Malformed,
    Neighbour,
}

impl Imperfect {
    /// Makes the stand-in that errs with probability `rate`; its name is `imperfect:RATE:SEED`.
    ///
    /// `None` unless the rate is from 0 to 1.
    pub fn new(rate: f64, seed: u64) -> Option<Imperfect> {
        Imperfect::with_errors(rate, seed, Errors::Mixed)
    }

    /// Makes the stand-in with errors of another kind; its name ends with their word.
    ///
    /// `None` unless the rate is from 0 to 1.
    pub fn with_errors(rate: f64, seed: u64, errors: Errors) -> Option<Imperfect> {
        let mut words = Errors::WORDS.iter();
        let word = words.find(|(_, known)| *known == errors);
        let word = word.map_or(String::new(), |(word, _)| format!(":{word}"));
        (0.0..=1.0).contains(&rate).then(|| Imperfect {
            name: format!("imperfect:{rate}:{seed}{word}"),
            rate,
            seed,
            errors,
        })
    }

    /// Returns what the draws for a question depend on, beside the seed.
    fn draw(&self, request: &Request, fields: &[Field]) -> Chance {
        Chance::of(&match self.errors {
            Errors::Mixed => format!("imperfect {} {}", self.seed, request.key()),
            Errors::Neighbour => format!("imperfect neighbour {} {}", self.seed, request.key()),
            Errors::Persistent => {
                let offered: Vec<_> = fields.iter().map(|it| (&it.name, &it.values)).collect();
                format!("imperfect persistent {} {offered:?}", self.seed)
            }
        })
    }
}

impl Model for Imperfect {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, calls: &mut dyn Calls) -> Result<Reply, ModelError> {
        let right = Geometric.ask(request, calls)?;
        let fields = choices::fields(request);
        let mut chance = self.draw(request, &fields);
        if fields.is_empty() || chance.fraction() >= self.rate {
            return Ok(right);
        }
        let slips: &[AnswerMistake] = match self.errors {
            Errors::Mixed => &[
                AnswerMistake::NearLastPlace,
                AnswerMistake::Opposite,
                AnswerMistake::OffTheList,
                AnswerMistake::Malformed,
            ],
            Errors::Persistent => &[AnswerMistake::NearLastPlace, AnswerMistake::Opposite],
            Errors::Neighbour => &[AnswerMistake::Neighbour],
        };
        let slip = slips[chance.below(slips.len())];
        let wrong = Answer::read(&right.text, fields)
            .and_then(|answer| answer.spoilt(slip, request, &mut chance));
        // An unreadable right answer cannot be spoilt either, but an error was drawn.
        let text = wrong.unwrap_or_else(|| "I would pull it a little to the side.".to_owned());
        Ok(Reply::text(text))
    }
}

/// A right answer: each field with its value.
struct Answer(Vec<(Field, String)>);

impl Answer {
    /// Finds for each field the longest offered value in a line that names it.
    fn read(text: &str, fields: Vec<Field>) -> Option<Answer> {
        let found = fields.into_iter().map(|field| {
            let name = field.name.replace('_', " ");
            let lines = text
                .lines()
                .filter(|line| line.to_lowercase().contains(&name));
            let values =
                lines.flat_map(|line| field.values.iter().filter(|value| line.contains(*value)));
            let longest = values.max_by_key(|value| value.len()).cloned();
            longest.map(|value| (field, value))
        });
        found.collect::<Option<Vec<_>>>().map(Answer)
    }

    /// Returns the answer with an error in it; `None` for the unreadable kind.
    fn spoilt(
        mut self,
        slip: AnswerMistake,
        request: &Request,
        chance: &mut Chance,
    ) -> Option<String> {
        let mut points = self.0.iter().enumerate();
        let pick = points.position(|(_, (_, value))| choices::point(value).is_some())?;
        match slip {
            AnswerMistake::Malformed => return None,
            AnswerMistake::NearLastPlace => {
                let (field, value) = &self.0[pick];
                self.0[pick].1 = near_last_place(field, value, request, chance)?;
            }
            AnswerMistake::OffTheList => {
                let (field, value) = &self.0[pick];
                self.0[pick].1 = off_the_list(field, value, chance)?;
            }
            AnswerMistake::Opposite => self.turn_round(pick),
            AnswerMistake::Neighbour => self.move_beside(chance)?,
        }
        let values = self.0.into_iter().map(|(field, value)| (field.name, value));
        Some(choices::answer(request, values.collect()))
    }

    /// Replaces one of its points by the nearest other one that the field offers; `None` if there is none.
    fn move_beside(&mut self, chance: &mut Chance) -> Option<()> {
        let points = self.0.iter().enumerate();
        let points = points.filter(|(_, (_, value))| choices::point(value).is_some());
        let points: Vec<usize> = points.map(|(index, _)| index).collect();
        let (field, value) = &self.0[points[chance.below(points.len())]];
        let right = choices::point(value)?;
        let away = |text: &&String| {
            choices::point(text).map_or(f64::MAX, |point| point.distance_px(right))
        };
        let others = field.values.iter().filter(|text| *text != value);
        let nearest = others.min_by(|a, b| away(a).total_cmp(&away(b)))?.clone();
        let name = field.name.clone();
        let mut fields = self.0.iter_mut();
        let moved = fields.find(|(field, _)| field.name == name)?;
        moved.1 = nearest;
        Some(())
    }

    fn turn_round(&mut self, pick: usize) {
        let direction = self
            .0
            .iter_mut()
            .find(|(_, value)| degrees(value).is_some());
        if let Some((field, value)) = direction {
            let Some(wanted) = degrees(value).map(|deg| deg + 180.0) else {
                return;
            };
            let off = |text: &&String| {
                let apart = degrees(text).map_or(360.0, |deg| (deg - wanted).rem_euclid(360.0));
                apart.min(360.0 - apart)
            };
            if let Some(opposite) = field.values.iter().min_by(|a, b| off(a).total_cmp(&off(b))) {
                *value = opposite.clone();
            }
            return;
        }
        let mut others = (0..self.0.len()).filter(|index| *index != pick);
        let place = others.find(|index| choices::point(&self.0[*index].1).is_some());
        if let Some(place) = place {
            let value = self.0[place].1.clone();
            self.0[place].1 = std::mem::replace(&mut self.0[pick].1, value);
        }
    }
}

/// Returns the listed point nearest to the last place point according to the prompt, but not the right one; any other
/// listed point if the prompt does not state it.
fn near_last_place(
    field: &Field,
    right: &str,
    request: &Request,
    chance: &mut Chance,
) -> Option<String> {
    let others: Vec<&String> = field
        .values
        .iter()
        .filter(|value| *value != right)
        .collect();
    let Some(last) = last_place(field, request) else {
        return (!others.is_empty()).then(|| others[chance.below(others.len())].clone());
    };
    let away = |text: &&&String| choices::point(text).map_or(f64::MAX, |it| it.distance_px(last));
    let nearest = others.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map(|text| (*text).clone())
}

/// Returns an unlisted point near the right one.
fn off_the_list(field: &Field, right: &str, chance: &mut Chance) -> Option<String> {
    let right = choices::point(right)?;
    let first = chance.below(4);
    let astray = (0..4).map(|turn| {
        let (du, dv) = [(1, 1), (-1, 1), (-1, -1), (1, -1)][(first + turn) % 4];
        let point = PixelPoint::new(right.u + du * ASTRAY_PX, right.v + dv * ASTRAY_PX);
        format!("({}, {})", point.u, point.v)
    });
    let mut unlisted = astray.filter(|text| !field.values.contains(text));
    unlisted.next()
}

/// How many lines after a mention of the last action may give its point.
const LINES_ON: usize = 2;

/// Reads the last place point: the first point at or after a line that mentions the last or previous action.
///
/// The question is the longest user turn that names every listed point; corrections and examples name others.
fn last_place(field: &Field, request: &Request) -> Option<PixelPoint> {
    let users = request
        .messages
        .iter()
        .filter(|it| it.speaker == Speaker::User);
    let texts = users.map(|message| {
        let parts = message.parts.iter().filter_map(|part| match part {
            Part::Text(text) => Some(text.as_str()),
            Part::Image(_) => None,
        });
        parts.collect::<Vec<_>>().join("\n")
    });
    let questions = texts.filter(|text| field.values.iter().all(|value| text.contains(value)));
    let question = questions.max_by_key(String::len)?;
    let lines: Vec<&str> = question.lines().collect();
    let about = |line: &str| {
        let line = line.to_lowercase();
        line.contains("last") || line.contains("previous")
    };
    let windows = lines.iter().enumerate().filter(|(_, line)| about(line));
    let mut points = windows.filter_map(|(at, _)| {
        let end = lines.len().min(at + 1 + LINES_ON);
        lines[at..end].iter().find_map(|line| first_point(line))
    });
    points.next()
}

fn first_point(line: &str) -> Option<PixelPoint> {
    let mut rest = line;
    while let Some(at) = rest.find('(') {
        rest = &rest[at..];
        let end = rest.find(')')?;
        if let Some(point) = choices::point(&rest[..=end]) {
            return Some(point);
        }
        rest = &rest[1..];
    }
    None
}

/// Reads a direction such as `135 deg`.
fn degrees(text: &str) -> Option<f64> {
    text.strip_suffix(" deg")?.trim().parse().ok()
}

#[cfg(test)]
#[path = "imperfect/tests.rs"]
mod tests;

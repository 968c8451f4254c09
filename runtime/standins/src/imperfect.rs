//! `imperfect`: a stand-in that errs at a stated rate, to show the value of verification.
//!
//! In: a [`Request`]. Out: the answer of `geometric`, or with the stated probability a wrong one. A quarter of the
//! errors each are a pick near the last place point, the opposite direction (pick and place swapped if there is none),
//! an unlisted point, and unreadable words. An error changes what `geometric` decided, before that is put into words;
//! answers in words alone are passed on. The seed, the start, the repetition, the action and the number of corrections
//! determine the draws, and the prompt's words do not: two variants of a task meet the same errors. It shows how many
//! such errors the checks catch, and nothing about the errors of a vision-language model.
//!
//! Two other [`Errors`] are harder to catch by asking again: a wrong answer that persists, and a point beside the right
//! one.

use super::geometric::{self, Action, Choice, Decision, End};
use fab_base::chance::Chance;
use fab_model::calls::Calls;
use fab_model::{Model, ModelError, ModelKind, Reply, Request};
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Errors {
    /// In four ways, drawn anew for every question.
    Mixed,
    /// With an offered value in one of two ways: a pick near the last place point, or the opposite direction. Drawn once
    /// for an action, so that every question about it gets the same wrong answer.
    Persistent,
    /// With the offered point that is nearest to the right one, as pick or as place. Drawn anew for every question.
    Neighbour,
}

impl Errors {
    /// The words in a model's name for errors that are not mixed.
    pub const WORDS: [(&str, Errors); 2] = [
        ("persistent", Errors::Persistent),
        ("neighbour", Errors::Neighbour),
    ];

    fn mistakes(self) -> &'static [Mistake] {
        use Mistake::{Malformed, NearLastPlace, Neighbour, OffTheList, Opposite};
        match self {
            Errors::Mixed => &[NearLastPlace, Opposite, OffTheList, Malformed],
            Errors::Persistent => &[NearLastPlace, Opposite],
            Errors::Neighbour => &[Neighbour],
        }
    }
}

/// A kind of error in an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    NearLastPlace,
    Opposite,
    OffTheList,
    Malformed,
    Neighbour,
}

impl Imperfect {
    /// Makes the stand-in `imperfect:RATE:SEED:ERRORS`; `None` unless the rate is from 0 to 1.
    pub fn new(rate: f64, seed: u64, errors: Errors) -> Option<Imperfect> {
        let mut words = Errors::WORDS.iter().filter(|(_, it)| *it == errors);
        let word = words.next().map(|(word, _)| format!(":{word}"));
        (0.0..=1.0).contains(&rate).then(|| Imperfect {
            name: format!("imperfect:{rate}:{seed}{}", word.unwrap_or_default()),
            rate,
            seed,
            errors,
        })
    }

    /// Returns the draws for a question whose answer was refused this often.
    fn draws(&self, request: &Request, corrections: usize) -> Chance {
        let Imperfect { seed, errors, .. } = self;
        let action = format!(
            "imperfect {errors:?} {seed} {} {} {}",
            request.start.unwrap_or(0),
            request.repetition,
            request.step
        );
        if *errors == Errors::Persistent {
            return Chance::of(&action);
        }
        Chance::of(&format!("{action} {} {corrections}", request.candidate))
    }
}

impl Model for Imperfect {
    fn name(&self) -> &str {
        &self.name
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let answer = geometric::answer(request).and_then(|mut decision| {
            let mut chance = self.draws(request, decision.corrections);
            if chance.fraction() < self.rate {
                let mistakes = self.errors.mistakes();
                let mistake = mistakes[chance.below(mistakes.len())];
                spoil(&mut decision, mistake, &mut chance)
                    .ok_or("I would pull it a little to the side.")?;
            }
            Ok(decision.worded(&geometric::all_words(&request.messages)))
        });
        Ok(Reply::text(answer.unwrap_or_else(|words| words)))
    }
}

/// Puts an error into a decision; `None` for the unreadable kind, and if nothing else is offered.
fn spoil(decision: &mut Decision, mistake: Mistake, chance: &mut Chance) -> Option<()> {
    let Action { pick, end } = &mut decision.action;
    let right = *pick;
    match mistake {
        Mistake::Malformed => return None,
        Mistake::NearLastPlace => {
            *pick = match last_place(&decision.question) {
                Some(last) => nearest(&decision.picks, right, last)?,
                None => {
                    let mut others = decision.picks.clone();
                    others.retain(|point| *point != right);
                    *others.get(chance.below(others.len()))?
                }
            };
        }
        Mistake::OffTheList => {
            let first = chance.below(4);
            let mut astray = (0..4).map(|turn| {
                let (du, dv) = [(1, 1), (-1, 1), (-1, -1), (1, -1)][(first + turn) % 4];
                PixelPoint::new(right.u + du * ASTRAY_PX, right.v + dv * ASTRAY_PX)
            });
            *pick = astray.find(|point| !decision.picks.contains(point))?;
        }
        Mistake::Opposite => match end {
            End::Place(at) => std::mem::swap(at, pick),
            End::Pull(direction, _) => {
                let along = |it: &&Choice| (it.value - direction.value).to_radians().cos();
                let directions = decision.directions.iter();
                let opposite = directions.min_by(|a, b| along(a).total_cmp(&along(b)));
                *direction = opposite?.clone();
            }
        },
        Mistake::Neighbour => match end {
            End::Place(at) if chance.below(2) == 1 => {
                *at = nearest(&decision.places, *at, *at)?;
            }
            _ => *pick = nearest(&decision.picks, right, right)?,
        },
    }
    Some(())
}

/// Returns the point nearest to another one, but not `right`.
fn nearest(points: &[PixelPoint], right: PixelPoint, to: PixelPoint) -> Option<PixelPoint> {
    let others = points.iter().filter(|point| **point != right);
    let others = others.copied();
    others.min_by(|a, b| a.distance_px(to).total_cmp(&b.distance_px(to)))
}

/// Reads the last place point: the first point in a line that mentions the last or previous action, or in the next.
fn last_place(question: &str) -> Option<PixelPoint> {
    let lines: Vec<&str> = question.lines().collect();
    lines.windows(2).find_map(|pair| {
        let line = pair[0].to_lowercase();
        let is_about = line.contains("last") || line.contains("previous");
        let points = is_about.then(|| geometric::points(&pair.join("\n")))?;
        points.first().copied()
    })
}

#[cfg(test)]
mod tests;

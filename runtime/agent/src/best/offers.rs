//! The actions that a state offers and the task's checks accept, the most promising first.
//!
//! In: the scene of a state. Out: [`Offers`]. Each action is written as an answer in the asked format and read again, and
//! judged as a rollout judges it. Actions that move the cloth alike are offered once.

use super::aim::Aim;
use super::{BestError, Choice, key_of};
use crate::action::Action;
use crate::scene::Scene;
use fab_base::chance::Chance;
use fab_base::interrupt::Interrupt;
use fab_picture::observation::Observation;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::{Notation, Pointing};
use fab_program::scene::SceneView;
use fab_program::verify::{self, Strictness, Verdict};
use fab_program::{ActionField, Choices, Exhausted, Program, Proposal, Value, reply, space};
use fab_world::{WorldError, WorldPoint};
use std::collections::{BTreeMap, BTreeSet};

/// The most combinations of a step's choices that are listed; of more, as many are drawn.
const MOST: u64 = 20_000;

/// How many pixels of a mask are drawn.
const PIXELS: usize = 64;

/// A state before an action.
pub(super) struct Situation<'a> {
    pub program: &'a Program,
    pub scene: &'a Scene,
    pub observation: &'a Observation,
    pub step: u32,
    pub last: Option<&'a ExecutedAction>,
    /// Where the experts would pick and place, each with how far the state is from theirs, metres.
    pub wanted: Vec<(f64, [WorldPoint; 2])>,
    /// Makes what is drawn in this state independent of other states.
    pub draw: String,
    /// A request to stop early.
    pub interrupt: &'a Interrupt,
}

/// What can be done in a state.
#[derive(Debug, Default)]
pub(super) struct Offers {
    /// The most promising first.
    pub choices: Vec<Choice>,
    /// What was only drawn from.
    pub sampled: Vec<String>,
    pub refused: u64,
    pub unreadable: u64,
}

/// Lists what can be done in a state. An interrupt is a failure.
pub(super) fn offers(at: &Situation<'_>) -> Result<Offers, BestError> {
    let mut chance = Chance::of(&at.draw);
    let mut offers = Offers::default();
    let proposals = proposals(at, &mut chance, &mut offers);
    let mut seen = BTreeSet::new();
    let mut ranked = Vec::new();
    for proposal in proposals {
        if at.interrupt.is_raised() {
            return Err(WorldError::Interrupted.into());
        }
        let Some(without) = accepted(at, &proposal, &mut offers)? else {
            continue;
        };
        let Some(action) = Action::lower(at.program, &proposal, at.scene, at.observation) else {
            offers.refused += 1;
            continue;
        };
        if !seen.insert(key_of(&action.grip)) {
            continue;
        }
        let off = Aim::off(&at.wanted, &action.grip);
        ranked.push((
            off,
            Choice::Act {
                proposal,
                action,
                without,
            },
        ));
    }
    if at.wanted.is_empty() {
        // Nothing ranks them: any order, but a seeded one, so that the first few are a fair sample.
        for index in (1..ranked.len()).rev() {
            ranked.swap(index, chance.below(index + 1));
        }
    } else {
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    offers.choices = ranked.into_iter().map(|(_, choice)| choice).collect();
    if at.program.verify.exhausted == Exhausted::Skips {
        offers.choices.push(Choice::Skip);
    }
    Ok(offers)
}

/// Returns the checks that must be dropped to accept an action; `None` if it cannot be stated or is refused for good.
pub(super) fn accepted(
    at: &Situation<'_>,
    proposal: &Proposal,
    offers: &mut Offers,
) -> Result<Option<Vec<String>>, BestError> {
    let Some(refusing) = refusing(at, proposal, verify::verdict)? else {
        offers.refused += 1;
        return Ok(None);
    };
    let texts = BTreeMap::new();
    if !is_readable(at.program, &at.facts(&texts).notation(at.program), proposal) {
        offers.unreadable += 1;
        return Ok(None);
    }
    Ok(Some(refusing))
}

/// Judges an action at some strictness.
type Judge = fn(
    &Program,
    Facts<'_>,
    &Proposal,
    Strictness,
) -> Result<Verdict, fab_program::render::RenderError>;

/// Returns the checks that must be dropped to accept an action; `None` if it is refused for good.
pub(super) fn refusing(
    at: &Situation<'_>,
    proposal: &Proposal,
    judge: Judge,
) -> Result<Option<Vec<String>>, BestError> {
    let (program, texts) = (at.program, BTreeMap::new());
    let relaxed = &program.verify.relaxed;
    for (strictness, without) in [
        (Strictness::Full, Vec::new()),
        (Strictness::Relaxed, relaxed.clone()),
    ] {
        let verdict = judge(program, at.facts(&texts), proposal, strictness)?;
        if verdict == Verdict::Accept {
            return Ok(Some(without));
        }
        if relaxed.is_empty() {
            break;
        }
    }
    Ok(None)
}

impl<'a> Situation<'a> {
    fn facts(&self, texts: &'a BTreeMap<String, String>) -> Facts<'a> {
        Facts {
            scene: self.scene,
            texts,
            step: self.step,
            last: self.last,
            proposal: None,
            pointing: Pointing::of_camera(&self.program.camera),
        }
    }
}

/// Returns whether an answer that states an action in the asked format is read as that action.
fn is_readable(program: &Program, notation: &Notation, proposal: &Proposal) -> bool {
    let lines = proposal.fields.iter().filter_map(|(name, value)| {
        let field = program.field(name)?;
        Some(space::statement(
            field,
            &notation.stated_value(field, value),
        ))
    });
    let answer = lines.collect::<Vec<_>>().join("\n");
    reply::read_action_in(program, notation, &answer).is_ok_and(|read| read.value == *proposal)
}

/// Combines the choices of all fields.
fn proposals(at: &Situation<'_>, chance: &mut Chance, offers: &mut Offers) -> Vec<Proposal> {
    let fields = &at.program.actions;
    let values: Vec<Vec<Value>> = fields
        .iter()
        .map(|field| values(field, at.scene, chance, offers))
        .collect();
    let counts = values.iter().map(|values| values.len() as u64);
    let all = counts.fold(1u64, u64::saturating_mul);
    let numbers: Vec<u64> = match all > MOST {
        false => (0..all).collect(),
        true => {
            let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
            offers.sampled.push(names.join(" x "));
            // Twice the same is no loss: equal motions are offered once.
            let draw = |_| (chance.fraction() * all as f64) as u64;
            (0..MOST).map(draw).collect()
        }
    };
    let proposal = |mut number: u64| {
        let chosen = fields.iter().zip(&values).map(|(field, values)| {
            let count = values.len() as u64;
            let value = values[(number % count) as usize].clone();
            number /= count;
            (field.name.clone(), value)
        });
        Proposal {
            fields: chosen.collect(),
        }
    };
    numbers.into_iter().map(proposal).collect()
}

/// Returns the choices of a field; of a mask, some pixels.
fn values(
    field: &ActionField,
    scene: &Scene,
    chance: &mut Chance,
    offers: &mut Offers,
) -> Vec<Value> {
    let Choices::Region { mask } = &field.choices else {
        return space::choices(field, scene);
    };
    // An area is a whole number far below 2^53.
    let n_pixels = scene.area_px(mask).unwrap_or_default() as usize;
    if n_pixels > PIXELS {
        offers.sampled.push(space::any_of(mask));
    }
    let mut pixels: Vec<Value> = Vec::new();
    for number in 0..n_pixels.min(PIXELS) {
        let number = match n_pixels > PIXELS {
            true => chance.below(n_pixels),
            false => number,
        };
        let pixel = scene.region_pixel(mask, number as u64).map(Value::Point);
        pixels.extend(pixel.filter(|pixel| !pixels.contains(pixel)));
    }
    pixels
}

//! Estimates the calls and cost of a run before anything is sent.
//!
//! In: the first messages of each stage, how often they may be asked, and the models' known facts. Out: what the run
//! likely takes, a hard bound, and a list of unknowns. The bound counts every question, with all previous corrections,
//! the longest answers, and [`SAFETY`] times the estimated input; it excludes calls that are repeated after a network
//! failure. Likely is that every step is taken and answered at once, in [`ANSWER_TOKENS`]. Hidden reasoning is in the
//! bound alone, since no vendor says how long a model thinks.

use crate::catalogue::{Date, ImageTokens, Profile, SAFETY, tokens};
use fab_model::calls::{Usage, Usd};
use fab_model::{Message, Part};
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;

/// Assumed upper limit on the tokens of a correction; those of the shipped tasks have up to 60.
const CORRECTION_TOKENS: u64 = 200;

/// Likely tokens of an answer: the mean of 1,533 hand-written test answers that imitate models, counted as the likely
/// tokens of a text. 163 answers in words have 43.
pub const ANSWER_TOKENS: u64 = 56;

/// Likely questions for ten steps of a task that tries a step again if its result misses the subgoal: 28 calls of
/// `geometric` for 20 steps and stages of `double_straight` and `double_triangle`, cloths of 28 and 30 particles a side.
const CALLS_PER_TEN_RETRIED_STEPS: u64 = 14;

/// A stage and its first messages, as sent in the first step.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// Name of the stage.
    pub stage: &'a str,
    /// The profile of the model.
    pub profile: &'a Profile,
    /// The first messages.
    pub messages: &'a [Message],
    /// The JSON Schema of the answer, if one is sent.
    pub schema: Option<&'a serde_json::Value>,
    /// The longest answer that can be seen, tokens, if the task states a limit.
    pub max_tokens: Option<u32>,
    /// The hidden tokens allowed on top; no later question repeats them.
    pub hidden_tokens: u32,
    /// The rollouts that are likely to ask it anew; the others share an answer of another method of their suite.
    pub fresh: u64,
    /// Further candidates that a rehearsal asks for, each with all its attempts.
    pub candidates: u32,
    /// Revisions of the best candidate, each with a picture.
    pub revisions: u32,
}

/// The contents of a correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// Words alone.
    Words,
    /// Also the refused action, drawn on a picture as large as the stage's largest.
    Picture,
}

/// Questions and how often they may be asked.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// The stages of a step, in order; later ones may quote earlier answers.
    pub questions: &'a [Question<'a>],
    /// Steps of a rollout.
    pub horizon: u32,
    /// The most actions for a step: one, and its retries.
    pub actions_per_step: u32,
    /// The most questions per stage and action.
    pub attempts: u32,
    /// The contents of a correction.
    pub correction: Correction,
    /// Number of rollouts.
    pub rollouts: u64,
    /// The date that determines the prices.
    pub today: Date,
}

/// The estimated calls and cost of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// What it likely takes.
    pub likely: Amount,
    /// What it takes at most.
    pub at_most: Amount,
    /// The unknowns, in words.
    pub unknown: BTreeSet<String>,
}

/// Calls with their tokens and cost, `None` if a part is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Amount {
    /// Number of calls.
    pub calls: u64,
    /// Tokens of all questions.
    pub input_tokens: Option<u64>,
    /// Tokens of all answers.
    pub output_tokens: Option<u64>,
    /// Billionths of a US dollar.
    pub cost: Option<Usd>,
}

impl Amount {
    const NONE: Amount = Amount {
        calls: 0,
        input_tokens: Some(0),
        output_tokens: Some(0),
        cost: Some(Usd::ZERO),
    };

    fn plus(self, other: Amount) -> Amount {
        Amount {
            calls: self.calls.saturating_add(other.calls),
            input_tokens: sum(self.input_tokens, other.input_tokens),
            output_tokens: sum(self.output_tokens, other.output_tokens),
            cost: self.cost.zip(other.cost).map(|(one, other)| one + other),
        }
    }

    /// Sets the cost of the calls at a model's price.
    fn priced(mut self, profile: &Profile, today: Date) -> Amount {
        let cost = || {
            let usage = Usage {
                input_tokens: self.input_tokens?,
                output_tokens: self.output_tokens?,
                ..Usage::default()
            };
            Some(profile.price_on(today)?.cost(usage))
        };
        self.cost = if profile.is_free() {
            Some(Usd::ZERO)
        } else {
            cost()
        };
        self
    }
}

impl Estimate {
    /// Sums the estimates of several parts of a run.
    pub fn total(parts: impl IntoIterator<Item = Estimate>) -> Estimate {
        let nothing = Estimate {
            likely: Amount::NONE,
            at_most: Amount::NONE,
            unknown: BTreeSet::new(),
        };
        parts.into_iter().fold(nothing, |mut sum, part| {
            sum.unknown.extend(part.unknown);
            Estimate {
                likely: sum.likely.plus(part.likely),
                at_most: sum.at_most.plus(part.at_most),
                unknown: sum.unknown,
            }
        })
    }
}

impl Plan<'_> {
    /// Estimates the run.
    pub fn estimate(&self) -> Estimate {
        let (mut likely_told, mut most_told) = (0, Some(0));
        let stages = self.questions.iter().map(|question| {
            let stage = Estimate {
                likely: self.likely(question, likely_told),
                at_most: self.at_most(question, most_told),
                unknown: self.unknown(question),
            };
            likely_told += likely_answer(question);
            most_told = sum(most_told, question.max_tokens.map(u64::from));
            stage
        });
        Estimate::total(stages)
    }

    fn unknown(&self, question: &Question<'_>) -> BTreeSet<String> {
        let profile = question.profile;
        let model = profile.title();
        let mut unknown = BTreeSet::new();
        if tokens::of_messages(question.messages, formula(question)).is_none() {
            unknown.insert(format!("how many tokens a picture has for {model}"));
        }
        if question.max_tokens.is_none() {
            unknown.insert(format!(
                "the longest answer of the stage `{}`: state `tokens`",
                question.stage
            ));
        }
        if profile.price_on(self.today).is_none() {
            unknown.insert(format!("the price of {model}"));
        }
        unknown
    }

    fn steps(&self, rollouts: u64) -> u64 {
        rollouts.saturating_mul(self.horizon.into())
    }

    /// Returns what a stage likely takes.
    ///
    /// - `told`: tokens of earlier answers, which its question may quote.
    fn likely(&self, question: &Question<'_>, told: u64) -> Amount {
        let first = self.steps(question.fresh);
        let asked = if self.actions_per_step > 1 {
            // Rounded to the nearest.
            first
                .saturating_mul(CALLS_PER_TEN_RETRIED_STEPS)
                .saturating_add(5)
                / 10
        } else {
            first
        };
        // No other method shares the answers of a rehearsal.
        let more = u64::from(question.candidates) + u64::from(question.revisions);
        let calls = asked.saturating_add(self.steps(self.rollouts).saturating_mul(more));
        let input = tokens::likely_of_messages(question.messages, formula(question));
        let amount = Amount {
            calls,
            input_tokens: input.map(|input| input.saturating_add(told).saturating_mul(calls)),
            output_tokens: Some(likely_answer(question).saturating_mul(calls)),
            cost: None,
        };
        amount.priced(question.profile, self.today)
    }

    /// Returns what a stage takes at most.
    ///
    /// - `told`: the most tokens of earlier answers, which its question may quote.
    fn at_most(&self, question: &Question<'_>, told: Option<u64>) -> Amount {
        let actions = self.steps(self.rollouts);
        let actions = actions.saturating_mul(self.actions_per_step.into());
        let calls_per_action = u64::from(self.attempts)
            .saturating_mul(u64::from(question.candidates) + 1)
            .saturating_add(question.revisions.into());
        let calls = actions.saturating_mul(calls_per_action);
        let input = self.most_input(question, told);
        let amount = Amount {
            calls,
            input_tokens: input.map(|input| input.saturating_mul(actions)),
            output_tokens: question.max_tokens.map(|visible| {
                let tokens = u64::from(visible) + u64::from(question.hidden_tokens);
                tokens.saturating_mul(calls)
            }),
            cost: None,
        };
        amount.priced(question.profile, self.today)
    }

    /// Returns the most input tokens of all attempts at one action: each question repeats the previous ones with their
    /// answers and corrections.
    fn most_input(&self, question: &Question<'_>, told: Option<u64>) -> Option<u64> {
        let formula = formula(question);
        // Revisions go on where a candidate's attempts ended.
        let attempts = u64::from(self.attempts) + u64::from(question.revisions);
        let schema = question.schema.map(|schema| schema.to_string());
        // A step that is tried again begins with a remark.
        let remark = if self.actions_per_step > 1 {
            CORRECTION_TOKENS
        } else {
            0
        };
        let each = tokens::of_messages(question.messages, formula)?
            .at_most
            .saturating_add(told?)
            .saturating_add(schema.map_or(0, |schema| tokens::of_text(&schema)))
            .saturating_add(remark);
        let mut all = each.saturating_mul(attempts);
        if attempts > 1 {
            let picture = match (self.correction, question.revisions) {
                (Correction::Words, 0) => 0,
                _ => largest_picture(question.messages, formula)?,
            };
            let more = u64::from(question.max_tokens?)
                .saturating_add(CORRECTION_TOKENS)
                .saturating_add(picture);
            // 0 corrections before the first question, 1 before the second, and so on.
            let repeated = attempts.saturating_mul(attempts - 1) / 2;
            all = all.saturating_add(more.saturating_mul(repeated));
        }
        let all = all.saturating_mul(u64::from(question.candidates) + 1);
        Some(all.saturating_mul(SAFETY))
    }
}

fn formula<'a>(question: &Question<'a>) -> Option<&'a ImageTokens> {
    question.profile.facts.image_tokens.as_ref()
}

fn likely_answer(question: &Question<'_>) -> u64 {
    let most = question.max_tokens.map_or(u64::MAX, u64::from);
    ANSWER_TOKENS.min(most)
}

fn largest_picture(messages: &[Message], formula: Option<&ImageTokens>) -> Option<u64> {
    let mut parts = messages.iter().flat_map(|message| &message.parts);
    parts.try_fold(0, |largest, part| match part {
        Part::Text(_) => Some(largest),
        Part::Image(png) => Some(tokens::of_picture(png, formula)?.at_most.max(largest)),
    })
}

fn sum(one: Option<u64>, other: Option<u64>) -> Option<u64> {
    Some(one?.saturating_add(other?))
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn or_unknown<T: ToString>(value: Option<T>) -> String {
            value.map_or("?".to_owned(), |value| value.to_string())
        }
        write!(
            f,
            "calls {}, input tokens {}, output tokens {}, cost {}",
            self.calls,
            or_unknown(self.input_tokens),
            or_unknown(self.output_tokens),
            or_unknown(self.cost)
        )
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "likely: {}\nat most: {}", self.likely, self.at_most)?;
        let mut unknown = self.unknown.iter();
        unknown.try_for_each(|what| write!(f, "\nnot known: {what}"))
    }
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;

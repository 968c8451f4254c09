//! Estimates the calls and cost of a run before anything is sent.
//!
//! In: the first messages of each stage, how often they may be asked, and the models' known facts. Out: what the run
//! likely takes, a hard bound, and a list of unknowns. The bound counts every question, with all previous corrections,
//! the longest answers, and [`SAFETY`] times the estimated input; it excludes calls that are repeated after a network
//! failure. Likely is that every step is taken and answered at once, in [`ANSWER_TOKENS`]. Hidden reasoning is in the
//! bound alone, since no vendor says how long a model thinks.

use crate::catalogue::{Date, ImageTokens, Profile, SAFETY, Tokens, tokens};
use crate::remote::Lengths;
use fab_model::calls::{Usage, Usd};
use fab_model::{Part, Request};
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

/// A stage and its first question, as sent in the first step.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// Name of the stage.
    pub stage: &'a str,
    /// The profile of the model.
    pub profile: &'a Profile,
    /// The first request.
    pub request: &'a Request,
    /// The longest answer; no later question repeats its hidden tokens.
    pub lengths: Lengths,
    /// The rollouts that are likely to ask it anew; the others share an answer of another method of their suite.
    pub fresh: u64,
    /// Further candidates that a rehearsal asks for, each with all its attempts.
    pub candidates: u32,
    /// Revisions of the best candidate, each with a picture.
    pub revisions: u32,
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
    /// Whether a correction shows the refused action, on a picture as large as the stage's largest.
    pub shows_correction: bool,
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
    #[serde(rename = "cost_nano_usd")]
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
            likely_told += question.likely_answer();
            most_told = sum(most_told, question.visible());
            stage
        });
        Estimate::total(stages)
    }

    fn unknown(&self, question: &Question<'_>) -> BTreeSet<String> {
        let model = question.profile.title();
        let stage = question.stage;
        let tokens = question.tokens(tokens::of_text);
        let price = question.profile.price_on(self.today);
        let unknown = [
            (tokens.is_none()).then(|| format!("how many tokens a picture has for {model}")),
            (question.visible().is_none())
                .then(|| format!("the longest answer of the stage `{stage}`: state `tokens`")),
            (price.is_none()).then(|| format!("the price of {model}")),
        ];
        unknown.into_iter().flatten().collect()
    }

    fn steps(&self, rollouts: u64) -> u64 {
        rollouts.saturating_mul(self.horizon.into())
    }

    fn amount(&self, profile: &Profile, calls: u64, tokens: [Option<u64>; 2]) -> Amount {
        let [input_tokens, output_tokens] = tokens;
        let cost = || {
            let usage = Usage {
                input_tokens: input_tokens?,
                output_tokens: output_tokens?,
                ..Usage::default()
            };
            Some(profile.price_on(self.today)?.cost(usage))
        };
        Amount {
            calls,
            input_tokens,
            output_tokens,
            cost: if profile.is_free() {
                Some(Usd::ZERO)
            } else {
                cost()
            },
        }
    }

    /// Returns what a stage likely takes.
    ///
    /// - `told`: tokens of earlier answers, which its question may quote.
    fn likely(&self, question: &Question<'_>, told: u64) -> Amount {
        let first = self.steps(question.fresh);
        let asked = if self.actions_per_step > 1 {
            let tenths = first.saturating_mul(CALLS_PER_TEN_RETRIED_STEPS);
            // Rounded to the nearest.
            tenths.saturating_add(5) / 10
        } else {
            first
        };
        // No other method shares the answers of a rehearsal.
        let more = u64::from(question.candidates) + u64::from(question.revisions);
        let calls = asked.saturating_add(self.steps(self.rollouts).saturating_mul(more));
        let input = question.tokens(tokens::likely_of_text).map(|input| {
            let each = input.at_least.midpoint(input.at_most).saturating_add(told);
            each.saturating_mul(calls)
        });
        let output = question.likely_answer().saturating_mul(calls);
        self.amount(question.profile, calls, [input, Some(output)])
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
        let input = input.map(|input| input.saturating_mul(actions));
        let output = question.visible().map(|visible| {
            let tokens = visible + u64::from(question.lengths.hidden);
            tokens.saturating_mul(calls)
        });
        self.amount(question.profile, calls, [input, output])
    }

    /// Returns the most input tokens of all attempts at one action: each question repeats the previous ones with their
    /// answers and corrections.
    fn most_input(&self, question: &Question<'_>, told: Option<u64>) -> Option<u64> {
        // Revisions go on where a candidate's attempts ended.
        let attempts = u64::from(self.attempts) + u64::from(question.revisions);
        let schema = question.request.schema.as_ref();
        let schema = schema.map_or(0, |schema| tokens::of_text(&schema.to_string()));
        // A step that is tried again begins with a remark.
        let remark = if self.actions_per_step > 1 {
            CORRECTION_TOKENS
        } else {
            0
        };
        let each = question.tokens(tokens::of_text)?.at_most;
        let each = { each.saturating_add(told?).saturating_add(schema) }.saturating_add(remark);
        let mut all = each.saturating_mul(attempts);
        if attempts > 1 {
            let picture = if self.shows_correction || question.revisions > 0 {
                question.largest_picture()?
            } else {
                0
            };
            let more = question.visible()?.saturating_add(CORRECTION_TOKENS);
            let more = more.saturating_add(picture);
            // 0 corrections before the first question, 1 before the second, and so on.
            let repeated = attempts.saturating_mul(attempts - 1) / 2;
            all = all.saturating_add(more.saturating_mul(repeated));
        }
        let all = all.saturating_mul(u64::from(question.candidates) + 1);
        Some(all.saturating_mul(SAFETY))
    }
}

impl Question<'_> {
    fn formula(&self) -> Option<&ImageTokens> {
        self.profile.facts.image_tokens.as_ref()
    }

    fn tokens(&self, of_text: fn(&str) -> u64) -> Option<Tokens> {
        tokens::of_messages(&self.request.messages, self.formula(), of_text)
    }

    fn largest_picture(&self) -> Option<u64> {
        let messages = self.request.messages.iter();
        let mut parts = messages.flat_map(|message| &message.parts);
        parts.try_fold(0, |largest, part| match part {
            Part::Text(_) => Some(largest),
            Part::Image(png) => {
                let tokens = tokens::of_picture(png, self.formula())?;
                Some(tokens.at_most.max(largest))
            }
        })
    }

    fn visible(&self) -> Option<u64> {
        self.lengths.visible.map(u64::from)
    }

    fn likely_answer(&self) -> u64 {
        self.visible().unwrap_or(u64::MAX).min(ANSWER_TOKENS)
    }
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

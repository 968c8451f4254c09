//! Estimates the calls and cost of a run before anything is sent.
//!
//! In: the first messages of each stage, how often they may be asked, and the models' known facts. Out: bounds on
//! calls, tokens and money, and a list of unknowns. The lower bound assumes that every step is taken and answered at
//! once, and that methods share what they can; a rollout that reaches its goal early or fails asks less. The upper bound counts every question, with all
//! previous corrections, the longest answers, and [`SAFETY`] times the estimated input; it excludes calls that are
//! repeated after a network failure. The likely value comes from recorded calls, or else from typical lengths.

use crate::catalogue::{Date, Profile, SAFETY, Tokens, tokens};
use fab_model::calls::Usage;
use fab_model::calls::Usd;
use fab_model::{Message, Part};
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt;

/// Assumed upper limit on the tokens of a correction; those of the shipped tasks have up to 60.
const CORRECTION_TOKENS: u64 = 200;

/// What calls of a stage usually take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Typical {
    /// Questions per step.
    pub calls_per_step: f64,
    /// The part of its horizon that a rollout takes.
    pub steps_share: f64,
    /// Input tokens of a call; `None`: those of the first question, and of the answers that it quotes.
    pub input_tokens: Option<f64>,
    /// Output tokens of a call, hidden ones included.
    pub output_tokens: f64,
    /// The recorded calls that say so; 0: typical lengths.
    pub recorded_calls: u64,
}

impl Typical {
    /// Mean tokens of an answer that states an action, counted as [`tokens::likely_of_text`] does over 1533 answers
    /// that were written for tests after models' habits; none hides thoughts.
    pub const ACTION_TOKENS: f64 = 56.0;
    /// The same for 163 such answers that state a text.
    pub const TEXT_TOKENS: f64 = 43.0;

    /// Questions per step of a task that tries a step again if its result misses the subgoal: 28 calls of `geometric`
    /// for 20 steps and stages of `double_straight` and `double_triangle`, cloths of 28 and 30 particles a side.
    pub const CALLS_PER_RETRIED_STEP: f64 = 1.4;

    /// Returns typical lengths, for a stage without recorded calls.
    ///
    /// - `actions_per_step`: the most actions for a step: one, and its retries.
    pub fn shipped(answer_tokens: f64, actions_per_step: u32) -> Typical {
        Typical {
            calls_per_step: match actions_per_step {
                0 | 1 => 1.0,
                _ => Self::CALLS_PER_RETRIED_STEP,
            },
            steps_share: 1.0,
            input_tokens: None,
            output_tokens: answer_tokens,
            recorded_calls: 0,
        }
    }
}

/// The rollouts that put a question anew; the others share an answer of another method of their suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fresh {
    /// At least.
    pub at_least: u64,
    /// Likely.
    pub likely: u64,
}

impl Fresh {
    /// Every one of so many rollouts.
    pub fn all(rollouts: u64) -> Fresh {
        Fresh {
            at_least: rollouts,
            likely: rollouts,
        }
    }
}

/// The questions of a stage that a rehearsal adds to each action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rehearsed {
    /// Further candidates, each with all its attempts.
    pub candidates: u32,
    /// Revisions of the best one, each with a picture.
    pub revisions: u32,
}

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
    /// What its calls usually take.
    pub typical: Typical,
    /// The rollouts that ask it anew.
    pub fresh: Fresh,
    /// The hidden tokens allowed on top; no later question repeats them.
    pub hidden_tokens: u32,
    /// What a rehearsal adds.
    pub rehearsed: Rehearsed,
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
    /// Number of calls.
    pub calls: Bounds<u64>,
    /// Tokens of all questions; the upper bound is `None` if a part of it is unknown.
    pub input_tokens: Bounds<u64>,
    /// Tokens of all answers.
    pub output_tokens: Bounds<u64>,
    /// Cost of all calls, billionths of a US dollar.
    pub cost: Bounds<Usd>,
    /// The unknowns, in words.
    pub unknown: Vec<String>,
    /// The same per stage.
    pub stages: Vec<StageEstimate>,
}

/// Two bounds and a likely value between them, `None` if a part of one is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Bounds<T> {
    /// The lower one.
    pub at_least: Option<T>,
    /// The likely value.
    pub likely: Option<T>,
    /// The upper one.
    pub at_most: Option<T>,
}

impl Estimate {
    /// Sums the estimates of several parts of a run.
    pub fn total(parts: impl IntoIterator<Item = Estimate>) -> Estimate {
        let (mut stages, mut unknown) = (Vec::new(), BTreeSet::new());
        for part in parts {
            stages.extend(part.stages);
            unknown.extend(part.unknown);
        }
        Estimate::of(stages, unknown)
    }

    fn of(stages: Vec<StageEstimate>, unknown: BTreeSet<String>) -> Estimate {
        let sum = |part: fn(&StageEstimate) -> Bounds<u64>| {
            let sum = |bound: fn(Bounds<u64>) -> Option<u64>| {
                stages
                    .iter()
                    .map(|stage| bound(part(stage)))
                    .try_fold(0, plus)
            };
            Bounds {
                at_least: sum(|it| it.at_least),
                likely: sum(|it| it.likely),
                at_most: sum(|it| it.at_most),
            }
        };
        let costs = |part: fn(&Bounds<Usd>) -> Option<Usd>| {
            stages
                .iter()
                .map(|stage| part(&stage.cost))
                .sum::<Option<Usd>>()
        };
        Estimate {
            calls: sum(|stage| stage.calls),
            input_tokens: sum(|stage| stage.input_tokens),
            output_tokens: sum(|stage| stage.output_tokens),
            cost: Bounds {
                at_least: costs(|cost| cost.at_least),
                likely: costs(|cost| cost.likely),
                at_most: costs(|cost| cost.at_most),
            },
            unknown: unknown.into_iter().collect(),
            stages,
        }
    }
}

/// The estimated calls and cost of a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageEstimate {
    /// Its name.
    pub stage: String,
    /// `PROVIDER:NAME` of the model.
    pub model: String,
    /// Estimated tokens of its first question in a step.
    pub first_question: Option<Tokens>,
    /// Number of calls.
    pub calls: Bounds<u64>,
    /// Tokens of all its questions.
    pub input_tokens: Bounds<u64>,
    /// Tokens of all its answers.
    pub output_tokens: Bounds<u64>,
    /// Cost of its calls, billionths of a US dollar.
    pub cost: Bounds<Usd>,
    /// What the likely values rest on.
    pub typical: Typical,
}

impl Plan<'_> {
    /// Estimates the run.
    pub fn estimate(&self) -> Estimate {
        let mut unknown = BTreeSet::new();
        let mut told = Some(0);
        let mut likely_told = 0.0;
        let mut stages = Vec::with_capacity(self.questions.len());
        for question in self.questions {
            stages.push(self.stage(question, told, likely_told, &mut unknown));
            likely_told += question.typical.output_tokens;
            told = add(told, question.max_tokens.map(u64::from));
        }
        Estimate::of(stages, unknown)
    }

    /// Estimates one stage; `told` is the most tokens of earlier answers that its question may quote, `likely_told`
    /// their typical number.
    fn stage(
        &self,
        question: &Question<'_>,
        told: Option<u64>,
        likely_told: f64,
        unknown: &mut BTreeSet<String>,
    ) -> StageEstimate {
        let profile = question.profile;
        let model = profile.title();
        let formula = profile.facts.image_tokens.as_ref();
        let first = tokens::of_messages(question.messages, formula);
        if first.is_none() {
            unknown.insert(format!("how many tokens a picture has for {model}"));
        }
        if question.max_tokens.is_none() {
            unknown.insert(format!(
                "the longest answer of the stage `{}`: state `tokens`",
                question.stage
            ));
        }
        let price = profile.price_on(self.today);
        if price.is_none() {
            unknown.insert(format!("the price of {model}"));
        }
        let actions = |rollouts: u64| rollouts.saturating_mul(self.horizon.into());
        let least_actions = actions(question.fresh.at_least);
        let most_actions = actions(self.rollouts).saturating_mul(self.actions_per_step.into());
        let Rehearsed {
            candidates,
            revisions,
        } = question.rehearsed;
        let calls_of_action = u64::from(self.attempts)
            .saturating_mul(u64::from(candidates) + 1)
            .saturating_add(revisions.into());
        let most_calls = most_actions.saturating_mul(calls_of_action);
        let typical = question.typical;
        let likely_actions = actions(question.fresh.likely) as f64;
        // Recorded calls include those of rehearsals. No other method shares these answers.
        let likely_more = match typical.recorded_calls {
            0 => actions(self.rollouts) as f64 * (f64::from(candidates) + f64::from(revisions)),
            _ => 0.0,
        };
        let likely_calls =
            (likely_actions * typical.calls_per_step + likely_more) * typical.steps_share;
        let likely_input = typical.input_tokens.or_else(|| {
            let first = tokens::likely_of_messages(question.messages, formula)?;
            Some(first + likely_told)
        });
        // Rounded, and saturated where a number is too large.
        let whole = |number: f64| number.round() as u64;
        let calls = Bounds {
            at_least: Some(least_actions),
            likely: Some(whole(likely_calls)),
            at_most: Some(most_calls),
        };
        let input_tokens = Bounds {
            at_least: first.map(|first| first.at_least.saturating_mul(least_actions)),
            likely: likely_input.map(|input| whole(input * likely_calls)),
            at_most: self
                .most_input(question, first, told, formula)
                .map(|input| input.saturating_mul(most_actions)),
        };
        let output_tokens = Bounds {
            // An answer has at least one token.
            at_least: calls.at_least,
            likely: Some(whole(typical.output_tokens * likely_calls)),
            at_most: question.max_tokens.map(|visible| {
                let tokens = u64::from(visible) + u64::from(question.hidden_tokens);
                tokens.saturating_mul(most_calls)
            }),
        };
        let cost = |input: Option<u64>, output: Option<u64>| {
            if profile.is_free() {
                return Some(Usd::ZERO);
            }
            let usage = Usage {
                input_tokens: input?,
                output_tokens: output?,
                ..Usage::default()
            };
            Some(price?.cost(usage))
        };
        StageEstimate {
            stage: question.stage.to_owned(),
            model,
            first_question: first,
            calls,
            input_tokens,
            output_tokens,
            cost: Bounds {
                at_least: cost(input_tokens.at_least, output_tokens.at_least),
                likely: cost(input_tokens.likely, output_tokens.likely),
                at_most: cost(input_tokens.at_most, output_tokens.at_most),
            },
            typical,
        }
    }

    /// Returns the most input tokens of all attempts at one action: each question repeats the previous ones with their
    /// answers and corrections.
    fn most_input(
        &self,
        question: &Question<'_>,
        first: Option<Tokens>,
        told: Option<u64>,
        formula: Option<&crate::catalogue::ImageTokens>,
    ) -> Option<u64> {
        let Rehearsed {
            candidates,
            revisions,
        } = question.rehearsed;
        // Revisions go on where a candidate's attempts ended.
        let attempts = u64::from(self.attempts) + u64::from(revisions);
        let schema = question
            .schema
            .map_or(0, |schema| tokens::of_text(&schema.to_string()));
        let remark = if self.actions_per_step > 1 {
            CORRECTION_TOKENS
        } else {
            0
        };
        let each = first?
            .at_most
            .saturating_add(told?)
            .saturating_add(schema)
            .saturating_add(remark);
        let mut all = each.saturating_mul(attempts);
        if attempts > 1 {
            let picture = match (self.correction, revisions) {
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
        let all = all.saturating_mul(u64::from(candidates) + 1);
        Some(all.saturating_mul(SAFETY))
    }
}

fn largest_picture(
    messages: &[Message],
    formula: Option<&crate::catalogue::ImageTokens>,
) -> Option<u64> {
    let mut parts = messages.iter().flat_map(|message| &message.parts);
    parts.try_fold(0, |largest, part| match part {
        Part::Text(_) => Some(largest),
        Part::Image(png) => Some(tokens::of_picture(png, formula)?.at_most.max(largest)),
    })
}

fn add(one: Option<u64>, other: Option<u64>) -> Option<u64> {
    plus(one?, other)
}

fn plus(sum: u64, more: Option<u64>) -> Option<u64> {
    Some(sum.saturating_add(more?))
}

impl<T: fmt::Display> fmt::Display for Bounds<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = |bound: &Option<T>| {
            let known = bound.as_ref();
            known.map_or("?".to_owned(), |bound| bound.to_string())
        };
        write!(f, "{} to {}", words(&self.at_least), words(&self.at_most))?;
        let likely = self.likely.as_ref();
        likely.map_or(Ok(()), |likely| write!(f, ", likely {likely}"))
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for stage in &self.stages {
            let first = stage.first_question;
            let first = first.map_or("?".to_owned(), |first| first.to_string());
            writeln!(
                f,
                "{} ({}): calls {}; about {first} tokens for a first question",
                stage.stage, stage.model, stage.calls
            )?;
        }
        writeln!(f, "calls: {}", self.calls)?;
        writeln!(f, "input tokens: {}", self.input_tokens)?;
        writeln!(f, "output tokens: {}", self.output_tokens)?;
        write!(f, "cost: {}", self.cost)?;
        let mut unknown = self.unknown.iter();
        unknown.try_for_each(|what| write!(f, "\nnot known: {what}"))
    }
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;

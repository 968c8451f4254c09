//! What tokens cost.
//!
//! In: a price per million tokens, and how many there were or may be. Out: an amount, exact but for the last
//! billionth of a dollar, which is rounded up. Counting tokens is [`super::tokens`].

use super::Profile;
use super::date::Date;
use super::tokens;
use fab_model::Request;
use fab_model::calls::{Usage, Usd};
use serde::{Deserialize, Serialize};

/// The input of a request may have so many times the tokens that are estimated.
///
/// A text of numbers and brackets, as lists of points are, has about one token per 1.7 letters instead of the four
/// that the estimate takes; no vendor documents a bound.
pub const SAFETY: u64 = 3;

/// What a million tokens cost, from a day on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Price {
    /// The first day that it counts; None: since always.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Date>,
    /// US dollars per million tokens of the question.
    pub input: f64,
    /// The same of those that the provider had in its cache; unknown: they are counted like others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cached_input: Option<f64>,
    /// The same of the answer.
    pub output: f64,
}

impl Price {
    /// The most that a million tokens may cost for the price to be believed, US dollars.
    pub const MOST: f64 = 1e6;

    /// What costs nothing.
    pub const FREE: Price = Price {
        from: None,
        input: 0.0,
        cached_input: None,
        output: 0.0,
    };

    /// Returns what a call cost.
    ///
    /// Cached tokens without a price of theirs are counted at the full one, so that a sum is never too low.
    pub fn cost(&self, usage: Usage) -> Usd {
        let cached = usage.cached_input_tokens.min(usage.input_tokens);
        let parts = [
            (usage.input_tokens - cached, self.input),
            (cached, self.cached_input.unwrap_or(self.input)),
            (usage.output_tokens, self.output),
        ];
        let millionths: u128 = parts
            .iter()
            .map(|(tokens, price)| u128::from(*tokens) * nano_per_million(*price))
            .sum();
        Usd::from_nano(u64::try_from(millionths.div_ceil(1_000_000)).unwrap_or(u64::MAX))
    }
}

/// Returns a price as whole billionths of a dollar, the nearest to the decimal number that was written.
fn nano_per_million(dollars: f64) -> u128 {
    (dollars * 1e9).round() as u128
}

/// A model's price on a day: what requests may cost, and what calls did.
#[derive(Clone, Debug)]
pub struct Priced {
    profile: Profile,
    price: Option<Price>,
}

impl Profile {
    /// Returns what a million tokens cost on a day; None where that is not known.
    pub fn price_on(&self, today: Date) -> Option<Price> {
        if self.is_free() {
            return Some(Price::FREE);
        }
        let prices = self.facts.price.as_ref()?;
        let counts = |price: &&Price| price.from.is_none_or(|from| from.days_until(today) >= 0);
        prices.iter().rfind(counts).copied()
    }

    /// Fixes the day, for a run whose calls are to be priced alike.
    pub fn priced_on(&self, today: Date) -> Priced {
        Priced {
            profile: self.clone(),
            price: self.price_on(today),
        }
    }
}

impl Priced {
    /// Returns what a call cost; None where the price is not known.
    pub fn cost(&self, usage: Usage) -> Option<Usd> {
        Some(self.price?.cost(usage))
    }

    /// Returns the most that a request may cost: [`SAFETY`] times its estimated input, and the longest answer.
    ///
    /// None where the price, the longest answer, or what one of its pictures counts is not known.
    pub fn at_most(&self, request: &Request) -> Option<Usd> {
        if self.profile.is_free() {
            return Some(Usd::ZERO);
        }
        let input =
            tokens::of_messages(&request.messages, self.profile.facts.image_tokens.as_ref());
        let schema = request
            .schema
            .as_ref()
            .map(|schema| tokens::of_text(&schema.to_string()));
        let input_tokens = input?.at_most.saturating_add(schema.unwrap_or(0));
        self.cost(Usage {
            input_tokens: input_tokens.saturating_mul(SAFETY),
            cached_input_tokens: 0,
            output_tokens: request.max_tokens?.into(),
        })
    }
}

//! Token prices.
//!
//! In: a price per million tokens, and a count of tokens or its bound. Out: an amount, exact except that the last
//! billionth of a dollar is rounded up. [`super::tokens`] counts tokens.

use super::Profile;
use super::date::Date;
use super::tokens;
use fab_model::Request;
use fab_model::calls::{Usage, Usd};
use serde::{Deserialize, Serialize};

/// Safety factor between the estimated and the most possible input tokens of a request.
///
/// A text of numbers and brackets, such as a list of points, has about one token per 1.7 letters, while the estimate
/// assumes four; no vendor documents a bound.
pub const SAFETY: u64 = 3;

/// The price of a million tokens, from a date on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Price {
    /// The first day that it applies; `None`: always.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Date>,
    /// US dollars per million input tokens.
    pub input: f64,
    /// US dollars per million cached input tokens; if unknown, they cost as much as others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cached_input: Option<f64>,
    /// US dollars per million output tokens.
    pub output: f64,
}

impl Price {
    /// The highest plausible price of a million tokens, US dollars.
    pub(super) const MOST: f64 = 1e6;

    /// The price of zero.
    pub const FREE: Price = Price {
        from: None,
        input: 0.0,
        cached_input: None,
        output: 0.0,
    };

    /// Returns what is wrong with the price.
    pub(super) fn check(&self) -> Result<(), String> {
        let dollars = [Some(self.input), self.cached_input, Some(self.output)];
        let mut dollars = dollars.into_iter().flatten();
        // NaN must fail this check.
        match dollars.find(|dollars| !(0.0..=Price::MOST).contains(dollars)) {
            Some(wrong) => Err(format!(
                "the price {wrong} is not from 0 to {} USD per million tokens",
                Price::MOST
            )),
            None => Ok(()),
        }
    }

    /// Returns the cost of a call.
    ///
    /// Cached tokens without their own price cost the full one, so a sum is never too low.
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

/// Converts a price to whole billionths of a dollar, the nearest to the decimal number as written.
fn nano_per_million(dollars: f64) -> u128 {
    (dollars * 1e9).round() as u128
}

impl Profile {
    /// Returns the price of a million tokens on a date; `None` if unknown.
    pub fn price_on(&self, today: Date) -> Option<Price> {
        if self.is_free() {
            return Some(Price::FREE);
        }
        let prices = self.facts.price.iter().flatten();
        let begun = prices.filter(|price| price.from.is_none_or(|from| from <= today));
        begun.max_by_key(|price| price.from).copied()
    }

    /// Returns the most that a request may cost: [`SAFETY`] times its estimated input, and the longest answer, tokens.
    ///
    /// `None` if the price, the longest answer, or the tokens of one of its pictures are unknown.
    pub fn at_most(
        &self,
        price: Option<Price>,
        request: &Request,
        longest: Option<u32>,
    ) -> Option<Usd> {
        if self.is_free() {
            return Some(Usd::ZERO);
        }
        let input = tokens::of_messages(
            &request.messages,
            self.facts.image_tokens.as_ref(),
            tokens::of_text,
        );
        let schema = request.schema.as_ref();
        let schema = schema.map_or(0, |schema| tokens::of_text(&schema.to_string()));
        let input_tokens = input?.at_most.saturating_add(schema);
        Some(price?.cost(Usage {
            input_tokens: input_tokens.saturating_mul(SAFETY),
            output_tokens: longest?.into(),
            ..Usage::default()
        }))
    }
}

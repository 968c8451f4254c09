//! Token usage of a call, and amounts of money.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::iter::Sum;
use std::ops::Add;

/// Usage as reported by the provider, tokens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Usage {
    /// Tokens of the question, pictures and cached ones included.
    pub input_tokens: u64,
    /// Input tokens that came from the provider's cache.
    #[serde(default)]
    pub cached_input_tokens: u64,
    /// Tokens of the answer, its hidden reasoning included.
    pub output_tokens: u64,
    /// The hidden reasoning in it; `None`: not reported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reasoning_tokens: Option<u64>,
}

impl Usage {
    /// Returns the tokens of the answer that can be seen, as far as hidden ones are reported.
    pub fn visible_tokens(&self) -> u64 {
        let hidden = self.reasoning_tokens.unwrap_or(0);
        self.output_tokens.saturating_sub(hidden)
    }
}

impl Add for Usage {
    type Output = Usage;

    fn add(self, other: Usage) -> Usage {
        Usage {
            input_tokens: self.input_tokens.saturating_add(other.input_tokens),
            cached_input_tokens: self
                .cached_input_tokens
                .saturating_add(other.cached_input_tokens),
            output_tokens: self.output_tokens.saturating_add(other.output_tokens),
            reasoning_tokens: match (self.reasoning_tokens, other.reasoning_tokens) {
                (None, None) => None,
                (one, two) => Some(one.unwrap_or(0).saturating_add(two.unwrap_or(0))),
            },
        }
    }
}

/// An amount of money in billionths of a US dollar; integers keep sums exact and caps hard.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Usd {
    nano: u64,
}

impl Usd {
    /// Nothing.
    pub const ZERO: Usd = Usd { nano: 0 };

    /// Makes an amount from billionths.
    pub const fn from_nano(nano: u64) -> Usd {
        Usd { nano }
    }

    /// Makes an amount from dollars, rounded up to a billionth; `None` if negative, too large or not a number.
    pub fn from_dollars(dollars: f64) -> Option<Usd> {
        let nano = (dollars * 1e9).ceil();
        // Below 2^63, so the conversion is exact.
        let is_amount = (0.0..9.2e18).contains(&nano);
        is_amount.then_some(Usd { nano: nano as u64 })
    }

    /// Returns the billionths.
    pub fn nano(self) -> u64 {
        self.nano
    }

    /// Returns the dollars, for reports.
    pub fn dollars(self) -> f64 {
        self.nano as f64 / 1e9
    }
}

impl Add for Usd {
    type Output = Usd;

    fn add(self, other: Usd) -> Usd {
        Usd {
            nano: self.nano.saturating_add(other.nano),
        }
    }
}

impl Sum for Usd {
    fn sum<I: Iterator<Item = Usd>>(amounts: I) -> Usd {
        amounts.fold(Usd::ZERO, Add::add)
    }
}

impl fmt::Display for Usd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4} USD", self.dollars())
    }
}

#[cfg(test)]
#[path = "tests/usage.rs"]
mod tests;

//! The facts that can be known about a model, as an entry of a file gives them.
//!
//! In: TOML. Out: [`Facts`], in which `None` means "unknown". Other modules interpret them for requests, pictures and
//! prices.

use super::price::Price;
use super::tokens::ImageTokens;
use fab_model::Lowering;
use fab_program::pointing::{CoordinateUnit, Order};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::num::NonZeroU32;

/// The known facts about a model; `None` is unknown, never a default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// Whether it takes pictures.
    pub vision: Option<bool>,
    /// Whether it supports a JSON Schema for its answer.
    pub structured_output: Option<bool>,
    /// The sampling temperatures that it accepts.
    pub temperature: Option<Accepted>,
    /// The values of nucleus sampling that it accepts.
    pub top_p: Option<Accepted>,
    /// How it takes `reasoning`; what is absent holds as its provider says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reasoning: Option<ReasoningFacts>,
    /// The Chat Completions field for the maximum answer length.
    pub max_tokens_field: Option<MaxTokensField>,
    /// What a picture costs.
    pub image_tokens: Option<ImageTokens>,
    /// How it states positions in a picture.
    pub coordinates: Option<PositionFormat>,
    /// Token prices, each from its day on.
    pub price: Option<Vec<Price>>,
}

/// How a model states positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionFormat {
    /// The unit of its numbers.
    pub unit: CoordinateUnit,
    /// Which coordinate comes first.
    pub order: Order,
    /// The sides of the picture in whose pixels it answers are multiples of this, those closest to the sent picture's;
    /// `None`: it answers in pixels of the picture as sent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multiples_of_px: Option<NonZeroU32>,
}

/// The accepted values of a sampling parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Accepted {
    /// These and no others.
    Only(Vec<f64>),
    /// None: the model refuses the parameter itself.
    Refused,
}

impl Accepted {
    /// Returns whether a value is accepted.
    pub fn takes(&self, value: f64) -> bool {
        match self {
            Accepted::Only(values) => values.contains(&value),
            Accepted::Refused => false,
        }
    }
}

impl fmt::Display for Accepted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Accepted::Only(values) => {
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                write!(f, "{} alone", values.join(", "))
            }
            Accepted::Refused => f.write_str("no value of it"),
        }
    }
}

/// How a model takes `reasoning`; `None` is unknown, and what is stated is then sent in the usual form of the interface.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReasoningFacts {
    /// The forms that it refuses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refuses: Option<Vec<ReasoningKind>>,
    /// The smallest number of tokens that it accepts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_tokens: Option<u32>,
    /// Whether it takes numbers of tokens alone, so that a level is sent as one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels_as_tokens: Option<bool>,
    /// The Chat Completions field for a number of tokens.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tokens_field: Option<String>,
}

fab_base::named! {
    /// A form in which `reasoning` is stated.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum ReasoningKind {
        /// `none`.
        None = "none",
        /// `low`.
        Low = "low",
        /// `medium`.
        Medium = "medium",
        /// `high`.
        High = "high",
        /// `N tokens`.
        Tokens = "tokens",
    }
}

impl ReasoningFacts {
    /// Returns these facts, with unknown ones filled in from `other`.
    pub fn or(self, other: &ReasoningFacts) -> ReasoningFacts {
        ReasoningFacts {
            refuses: self.refuses.or_else(|| other.refuses.clone()),
            least_tokens: self.least_tokens.or(other.least_tokens),
            levels_as_tokens: self.levels_as_tokens.or(other.levels_as_tokens),
            tokens_field: self.tokens_field.or_else(|| other.tokens_field.clone()),
        }
    }
}

/// The Chat Completions field for the maximum answer length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MaxTokensField {
    /// `max_tokens`.
    MaxTokens,
    /// `max_completion_tokens`.
    MaxCompletionTokens,
}

impl Facts {
    /// Returns how the model gets points, and a picture size that it has no reason to change; without known
    /// coordinates, pixels of the picture as sent.
    pub fn lowering(&self) -> Lowering {
        let Some(coordinates) = self.coordinates else {
            return Lowering::PIXELS;
        };
        Lowering {
            unit: coordinates.unit,
            order: coordinates.order,
            multiples_of_px: coordinates.multiples_of_px,
            ..Lowering::PIXELS
        }
    }
}

//! The facts that can be known about a model.
//!
//! In: an entry of a file. Out: [`Facts`], in which `None` means "unknown". Other modules interpret them for requests,
//! pictures and prices.

use super::date::Date;
use super::price::Price;
use super::tokens::ImageTokens;
use fab_model::lowering::{Lowering, Resize};
use fab_program::pointing::{CoordinateUnit, Order};
use fab_program::{Reasoning, ReasoningLevel};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::num::NonZeroU32;

/// The known facts about a model; `None` is unknown, never a default.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Facts {
    /// Whether it takes pictures.
    pub vision: Option<bool>,
    /// Whether a message may hold several pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub several_pictures: Option<bool>,
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
    /// The longest side of a picture that is not downscaled, pixels.
    pub largest_side_px: Option<u32>,
    /// The largest picture that is not downscaled, total pixels.
    pub largest_area_px: Option<u64>,
    /// What a picture costs.
    pub image_tokens: Option<ImageTokens>,
    /// How it states positions in a picture.
    pub coordinates: Option<PositionFormat>,
    /// Token prices, earliest first.
    pub price: Option<Vec<Price>>,
    /// When it stops answering, or stopped.
    pub shutdown: Option<Date>,
    /// The model that its vendor recommends in its place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub replaced_by: Option<String>,
    /// Whether the vendor may put another model behind its id; `None`: inferred from the id.
    pub moving: Option<bool>,
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
    pub multiples_of_px: Option<u32>,
}

/// The accepted values of a sampling parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Accepted {
    /// These and no others.
    Only(Vec<f64>),
    /// All from the first to the second.
    Range([f64; 2]),
    /// None: the model refuses the parameter itself.
    Refused,
}

impl Accepted {
    /// Returns whether a value is accepted.
    pub fn takes(&self, value: f64) -> bool {
        match self {
            Accepted::Only(values) => values.contains(&value),
            Accepted::Range([least, most]) => (*least..=*most).contains(&value),
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
            Accepted::Range([least, most]) => write!(f, "{least} to {most}"),
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

impl ReasoningKind {
    /// Returns the form of a statement.
    pub fn of(stated: Reasoning) -> ReasoningKind {
        match stated {
            Reasoning::Level(ReasoningLevel::None) => ReasoningKind::None,
            Reasoning::Level(ReasoningLevel::Low) => ReasoningKind::Low,
            Reasoning::Level(ReasoningLevel::Medium) => ReasoningKind::Medium,
            Reasoning::Level(ReasoningLevel::High) => ReasoningKind::High,
            Reasoning::Tokens(_) => ReasoningKind::Tokens,
        }
    }
}

impl fmt::Display for ReasoningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The word that a file of facts uses.
        f.pad(self.name())
    }
}

impl ReasoningFacts {
    /// Returns whether nothing is known.
    pub fn is_empty(&self) -> bool {
        *self == ReasoningFacts::default()
    }

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
    /// Returns how the model gets points, and a picture size that it has no reason to change; without a known habit,
    /// pixels of the picture as sent.
    pub fn lowering(&self) -> Lowering {
        let within = self.largest_side_px.and_then(NonZeroU32::new);
        let resize = within.map_or(Resize::Never, |side_px| Resize::Within { side_px });
        let Some(habit) = self.coordinates else {
            return Lowering {
                resize,
                ..Lowering::PIXELS
            };
        };
        let multiples = habit.multiples_of_px.and_then(NonZeroU32::new);
        Lowering {
            unit: habit.unit,
            order: habit.order,
            resize: multiples.map_or(resize, |of_px| Resize::Multiples { of_px }),
            ..Lowering::PIXELS
        }
    }

    /// Returns what also holds where another server stands before the vendor: not its prices, nor what its interface
    /// takes.
    pub fn behind_a_server(&self) -> Facts {
        Facts {
            structured_output: None,
            max_tokens_field: None,
            price: None,
            ..self.clone()
        }
    }

    /// Returns these facts, with unknown ones filled in from `other`.
    pub fn or(self, other: &Facts) -> Facts {
        Facts {
            vision: self.vision.or(other.vision),
            several_pictures: self.several_pictures.or(other.several_pictures),
            structured_output: self.structured_output.or(other.structured_output),
            temperature: self.temperature.or_else(|| other.temperature.clone()),
            top_p: self.top_p.or_else(|| other.top_p.clone()),
            reasoning: match (self.reasoning, &other.reasoning) {
                (Some(known), Some(other)) => Some(known.or(other)),
                (known, other) => known.or_else(|| other.clone()),
            },
            max_tokens_field: self.max_tokens_field.or(other.max_tokens_field),
            largest_side_px: self.largest_side_px.or(other.largest_side_px),
            largest_area_px: self.largest_area_px.or(other.largest_area_px),
            image_tokens: self.image_tokens.or(other.image_tokens),
            coordinates: self.coordinates.or(other.coordinates),
            price: self.price.or_else(|| other.price.clone()),
            shutdown: self.shutdown.or(other.shutdown),
            // The replacement belongs to the day.
            replaced_by: match self.shutdown {
                Some(_) => self.replaced_by,
                None => self.replaced_by.or_else(|| other.replaced_by.clone()),
            },
            moving: self.moving.or(other.moving),
        }
    }
}

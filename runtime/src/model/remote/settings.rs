//! What is known of a model and how it is called: data that the command gathers.
//!
//! In: a profile of the model, the user's own settings. Out: [`Settings`]. What is unknown is sent as the task states
//! it, so that the provider decides; only what is known not to be accepted is refused before it is sent.

use super::{BaseUrl, Key, Retry, Wire};
use crate::calls::{Usage, Usd};
use crate::model::{Lowering, Request};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// Everything that decides how a model is called.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The provider, as in `PROVIDER:NAME`.
    pub provider: String,
    /// The model, as the provider calls it.
    pub model: String,
    /// The form of requests and replies.
    pub wire: Wire,
    /// Where they go.
    pub base_url: BaseUrl,
    /// The key, where one is needed.
    pub key: Option<Key>,
    /// Whether it takes pictures.
    pub pictures: Support,
    /// Whether it takes a JSON Schema of its answer; only where it does, the schema is sent.
    pub structured_output: Support,
    /// How points are written for it, and what becomes of pictures.
    pub lowering: Lowering,
    /// The sampling temperatures that it takes.
    pub temperature: Accepts,
    /// The `top_p` that it takes.
    pub top_p: Accepts,
    /// What Chat Completions call the longest answer.
    pub max_tokens_field: MaxTokensField,
    /// The longest answer where the stage states none and the provider wants one, tokens.
    pub unstated_max_tokens: u32,
    /// What is left out although a stage states it.
    pub omit: Vec<Parameter>,
    /// How long one call may take in all.
    pub timeout: Duration,
    /// Which failures are tried again, and how often.
    pub retry: Retry,
    /// What calls cost.
    pub pricing: Arc<dyn Pricing>,
}

impl Settings {
    /// Makes settings of a model of which nothing is known.
    pub fn new(provider: &str, model: &str, wire: Wire, base_url: BaseUrl) -> Settings {
        Settings {
            provider: provider.to_owned(),
            model: model.to_owned(),
            wire,
            base_url,
            key: None,
            pictures: Support::Unknown,
            structured_output: Support::Unknown,
            lowering: Lowering::PIXELS,
            temperature: Accepts::Unknown,
            top_p: Accepts::Unknown,
            max_tokens_field: MaxTokensField::MaxTokens,
            unstated_max_tokens: 4096,
            omit: Vec::new(),
            timeout: Duration::from_secs(300),
            retry: Retry::default(),
            pricing: Arc::new(Unpriced),
        }
    }
}

/// Whether a model can do something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Nobody has said.
    Unknown,
    /// It can.
    Yes,
    /// It cannot.
    No,
}

/// The values of a parameter that a model takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Accepts {
    /// Nobody has said; what is stated is sent.
    Unknown,
    /// The parameter must not be sent at all.
    Nothing,
    /// These alone.
    Values(Vec<f64>),
    /// Those from the first to the second, both included.
    Range(f64, f64),
}

impl Accepts {
    /// Returns whether a value may be sent.
    pub fn takes(&self, value: f64) -> bool {
        match self {
            _ if !value.is_finite() => false,
            Accepts::Unknown => true,
            Accepts::Nothing => false,
            Accepts::Values(values) => values.contains(&value),
            Accepts::Range(from, to) => (*from..=*to).contains(&value),
        }
    }
}

impl fmt::Display for Accepts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Accepts::Unknown => f.write_str("a finite number"),
            Accepts::Nothing => f.write_str("none"),
            Accepts::Values(values) => {
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                write!(f, "{} alone", values.join(", "))
            }
            Accepts::Range(from, to) => write!(f, "{from} to {to}"),
        }
    }
}

/// A parameter that a stage may state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// `temperature`.
    Temperature,
    /// `top_p`.
    TopP,
    /// `tokens`, the longest answer.
    MaxTokens,
}

impl Parameter {
    /// Every parameter.
    pub const ALL: [Parameter; 3] = [
        Parameter::Temperature,
        Parameter::TopP,
        Parameter::MaxTokens,
    ];

    /// Returns the name that a `.fab` file uses.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Temperature => "temperature",
            Parameter::TopP => "top_p",
            Parameter::MaxTokens => "tokens",
        }
    }
}

/// What Chat Completions call the longest answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaxTokensField {
    /// `max_tokens`, which most compatible servers know.
    MaxTokens,
    /// `max_completion_tokens`, which OpenAI's newer models want.
    MaxCompletionTokens,
}

/// Knows what calls cost.
pub trait Pricing: Send + Sync + fmt::Debug {
    /// Returns the most that one call for the request may cost; None where that is not known.
    fn at_most(&self, request: &Request) -> Option<Usd>;

    /// Returns what a call cost that used so much; None where the price is not known.
    fn cost(&self, usage: Usage) -> Option<Usd>;
}

/// Knows no price.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unpriced;

impl Pricing for Unpriced {
    fn at_most(&self, _: &Request) -> Option<Usd> {
        None
    }

    fn cost(&self, _: Usage) -> Option<Usd> {
        None
    }
}

//! The settings for calling a model, as gathered by the command.
//!
//! In: a [`Profile`] of the model, its provider's address, the date that determines prices, the user's own settings.
//! Out: [`Settings`]. Unknown facts do not restrict a request, and the provider decides; only requests known to be
//! unacceptable are refused before they are sent.

use super::{BaseUrl, Key, Retry, Wire};
use crate::catalogue::{Accepted, Date, MaxTokensField, Priced, Profile, ReasoningFacts};
use fab_model::calls::{Usage, Usd};
use fab_model::{Lowering, Reasoning, Request};
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// The lengths that a question is sent with, tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lengths {
    /// The longest visible answer; `None`: not limited.
    pub visible: Option<u32>,
    /// Allowed for hidden reasoning.
    pub hidden: u32,
}

impl Lengths {
    /// Returns the lengths for a question's first call.
    pub(super) fn of(request: &Request, settings: &Settings) -> Lengths {
        let is_sent = |parameter| !settings.omit.contains(&parameter);
        let stated = request.max_tokens;
        let visible = stated.filter(|_| is_sent(Parameter::MaxTokens));
        let reasoning = request.reasoning;
        let reasoning = reasoning.filter(|_| is_sent(Parameter::Reasoning));
        Lengths {
            visible: match settings.wire {
                Wire::Anthropic => Some(visible.unwrap_or(settings.unstated_max_tokens)),
                Wire::OpenaiResponses | Wire::OpenaiChat | Wire::Gemini => visible,
            },
            hidden: reasoning.map_or(0, Reasoning::allowed_tokens),
        }
    }

    /// Returns the longest answer as it is sent: all interfaces count hidden and visible tokens together.
    pub fn sent(self) -> Option<u32> {
        Some(self.visible?.saturating_add(self.hidden))
    }
}

/// Everything that determines how a model is called.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The provider, as in `PROVIDER:NAME`.
    pub provider: String,
    /// The provider's id for the model.
    pub model: String,
    /// The form of requests and replies.
    pub wire: Wire,
    /// The base address.
    pub base_url: BaseUrl,
    /// The API key, if needed.
    pub key: Option<Key>,
    /// The names that a key is looked for under; for messages.
    pub key_names: Vec<String>,
    /// The command that starts the provider's server; for messages.
    pub start: Option<String>,
    /// Whether it accepts pictures; `None`: unknown.
    pub pictures: Option<bool>,
    /// Whether it accepts several pictures in one message; `None`: unknown.
    pub several_pictures: Option<bool>,
    /// Whether it accepts a JSON Schema of its answer; `None`: unknown, and it is sent until it is refused.
    pub structured_output: Option<bool>,
    /// How points are written for it, and how pictures are resized.
    pub lowering: Lowering,
    /// The sampling temperatures that it accepts; `None`: unknown, and stated values are sent.
    pub temperature: Option<Accepted>,
    /// The values of `top_p` that it accepts.
    pub top_p: Option<Accepted>,
    /// How it takes `reasoning`.
    pub reasoning: ReasoningFacts,
    /// The Chat Completions field for the maximum answer length; `None`: `max_tokens`.
    pub max_tokens_field: Option<MaxTokensField>,
    /// The maximum answer length if the stage states none but the provider requires one, tokens.
    pub unstated_max_tokens: u32,
    /// Parameters omitted even if a stage states them.
    pub omit: Vec<Parameter>,
    /// Time limit of one call.
    pub timeout: Duration,
    /// Which failures are retried, and how often.
    pub retry: Retry,
    /// Prices of calls.
    pub pricing: Arc<dyn Pricing>,
}

impl Settings {
    /// Makes settings for a model without known facts.
    pub fn new(provider: &str, model: &str, wire: Wire, base_url: BaseUrl) -> Settings {
        Settings {
            provider: provider.to_owned(),
            model: model.to_owned(),
            wire,
            base_url,
            key: None,
            key_names: Vec::new(),
            start: None,
            pictures: None,
            several_pictures: None,
            structured_output: None,
            lowering: Lowering::PIXELS,
            temperature: None,
            top_p: None,
            reasoning: ReasoningFacts::default(),
            max_tokens_field: None,
            unstated_max_tokens: 4096,
            omit: Vec::new(),
            timeout: Duration::from_secs(300),
            retry: Retry::default(),
            pricing: Arc::new(Unpriced),
        }
    }

    /// Makes the settings for a model with a profile.
    pub fn of(profile: &Profile, base_url: BaseUrl, today: Date) -> Settings {
        let (provider, facts) = (&profile.provider, &profile.facts);
        Settings {
            key_names: provider.key_env.clone(),
            start: provider.start.clone(),
            pictures: facts.vision,
            several_pictures: facts.several_pictures,
            structured_output: facts.structured_output,
            lowering: profile.lowering(),
            temperature: facts.temperature.clone(),
            top_p: facts.top_p.clone(),
            reasoning: profile.reasoning(),
            max_tokens_field: facts.max_tokens_field,
            pricing: Arc::new(profile.priced_on(today)),
            ..Settings::new(&provider.name, &profile.id, provider.wire, base_url)
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
    /// `tokens`, the maximum answer length.
    MaxTokens,
    /// `reasoning`, how much the model thinks.
    Reasoning,
    /// The JSON Schema of the answer.
    Schema,
}

impl Parameter {
    /// Every parameter.
    pub const ALL: [Parameter; 5] = [
        Parameter::Temperature,
        Parameter::TopP,
        Parameter::MaxTokens,
        Parameter::Reasoning,
        Parameter::Schema,
    ];

    /// Returns the name that a `.fab` file and `--omit` use.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Temperature => "temperature",
            Parameter::TopP => "top_p",
            Parameter::MaxTokens => "tokens",
            Parameter::Reasoning => "reasoning",
            Parameter::Schema => "schema",
        }
    }
}

/// Prices calls.
pub trait Pricing: Send + Sync + fmt::Debug {
    /// Returns the most that one call for the request may cost; `None` if unknown.
    fn at_most(&self, request: &Request) -> Option<Usd>;

    /// Returns the cost of a call with this usage; `None` if the price is unknown.
    fn cost(&self, usage: Usage) -> Option<Usd>;
}

impl Pricing for Priced {
    fn at_most(&self, request: &Request) -> Option<Usd> {
        Priced::at_most(self, request)
    }

    fn cost(&self, usage: Usage) -> Option<Usd> {
        Priced::cost(self, usage)
    }
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

//! What is known of a model and how it is called: data that the command gathers.
//!
//! In: a [`Profile`] of the model, where its provider is reached, the day whose prices count, the user's own settings.
//! Out: [`Settings`]. What is unknown is sent as the task states it, so that the provider decides; only what is known
//! not to be accepted is refused before it is sent.

use super::{BaseUrl, Key, Retry, Wire};
use crate::catalogue::{Accepted, Date, MaxTokensField, Priced, Profile};
use fab_model::calls::{Usage, Usd};
use fab_model::{Lowering, Request};
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
    /// Whether it takes pictures; None: nobody has said.
    pub pictures: Option<bool>,
    /// Whether it takes a JSON Schema of its answer; only where it is known to, the schema is sent.
    pub structured_output: Option<bool>,
    /// How points are written for it, and what becomes of pictures.
    pub lowering: Lowering,
    /// The sampling temperatures that it takes; None: nobody has said, and what is stated is sent.
    pub temperature: Option<Accepted>,
    /// The same of `top_p`.
    pub top_p: Option<Accepted>,
    /// What Chat Completions call the longest answer; None: `max_tokens`.
    pub max_tokens_field: Option<MaxTokensField>,
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
            pictures: None,
            structured_output: None,
            lowering: Lowering::PIXELS,
            temperature: None,
            top_p: None,
            max_tokens_field: None,
            unstated_max_tokens: 4096,
            omit: Vec::new(),
            timeout: Duration::from_secs(300),
            retry: Retry::default(),
            pricing: Arc::new(Unpriced),
        }
    }

    /// Makes the settings of a model of which a profile is known.
    pub fn of(profile: &Profile, base_url: BaseUrl, today: Date) -> Settings {
        let (provider, facts) = (&profile.provider, &profile.facts);
        Settings {
            pictures: facts.vision,
            structured_output: facts.structured_output,
            lowering: profile.lowering(),
            temperature: facts.temperature.clone(),
            top_p: facts.top_p.clone(),
            max_tokens_field: facts.max_tokens_field,
            pricing: Arc::new(profile.priced_on(today)),
            ..Settings::new(&provider.name, &profile.id, provider.wire, base_url)
        }
    }
}

impl Settings {
    /// Returns the longest answer that is asked for in the end, tokens; None where none is sent.
    pub(super) fn sent_max_tokens(&self, request: &Request) -> Option<u32> {
        let stated = request.max_tokens;
        let sent = stated.filter(|_| !self.omit.contains(&Parameter::MaxTokens));
        match self.wire {
            Wire::Anthropic => Some(sent.unwrap_or(self.unstated_max_tokens)),
            Wire::OpenaiResponses | Wire::OpenaiChat | Wire::Gemini => sent,
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

/// Knows what calls cost.
pub trait Pricing: Send + Sync + fmt::Debug {
    /// Returns the most that one call for the request may cost; None where that is not known.
    fn at_most(&self, request: &Request) -> Option<Usd>;

    /// Returns what a call cost that used so much; None where the price is not known.
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

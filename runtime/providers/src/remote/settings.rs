//! The settings for calling a model, as gathered by the command.
//!
//! In: a [`Profile`] of the model, its provider's address, the date that determines prices, the user's own settings.
//! Out: [`Settings`]. Unknown facts do not restrict a request, and the provider decides; only requests known to be
//! unacceptable are refused before they are sent.

use super::{BaseUrl, Key, Retry, Wire};
use crate::catalogue::{Date, Price, Profile, Provider};
use fab_model::{Lowering, Reasoning, Request};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// The maximum answer length if the stage states none but the provider requires one, tokens.
const UNSTATED_MAX_TOKENS: u32 = 4096;

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
    pub fn of(request: &Request, settings: &Settings) -> Lengths {
        let visible = request.max_tokens;
        let visible = visible.filter(|_| settings.sends(Parameter::MaxTokens));
        let reasoning = request.reasoning;
        let reasoning = reasoning.filter(|_| settings.sends(Parameter::Reasoning));
        Lengths {
            visible: match settings.profile.provider.wire {
                Wire::Anthropic => Some(visible.unwrap_or(UNSTATED_MAX_TOKENS)),
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
    /// The model, its provider, and what is known of both.
    pub profile: Profile,
    /// The base address.
    pub base_url: BaseUrl,
    /// The API key, if needed.
    pub key: Option<Key>,
    /// How points are written for it, and how pictures are resized.
    pub lowering: Lowering,
    /// Parameters omitted even if a stage states them.
    pub omit: Vec<Parameter>,
    /// Time limit of one call.
    pub timeout: Duration,
    /// Which failures are retried, and how often.
    pub retry: Retry,
    /// The price of a million tokens; `None`: unknown.
    pub price: Option<Price>,
}

impl Settings {
    /// Makes the settings for a model of which nothing is known.
    pub fn new(provider: &str, model: &str, wire: Wire, base_url: BaseUrl) -> Settings {
        let profile = Profile {
            provider: Provider {
                name: provider.to_owned(),
                wire,
                ..Provider::default()
            },
            id: model.to_owned(),
            ..Profile::default()
        };
        Settings::of(&profile, base_url, Date::default())
    }

    /// Makes the settings for a model, at the prices of a day.
    pub fn of(profile: &Profile, base_url: BaseUrl, today: Date) -> Settings {
        Settings {
            price: profile.price_on(today),
            lowering: profile.facts.lowering(),
            profile: profile.clone(),
            base_url,
            key: None,
            omit: Vec::new(),
            timeout: Duration::from_secs(300),
            retry: Retry::default(),
        }
    }

    pub(super) fn sends(&self, parameter: Parameter) -> bool {
        !self.omit.contains(&parameter)
    }
}

fab_base::named! {
    /// A parameter that a stage may state.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Parameter {
        /// `temperature`.
        Temperature = "temperature",
        /// `top_p`.
        TopP = "top_p",
        /// The maximum answer length.
        MaxTokens = "tokens",
        /// How much the model thinks.
        Reasoning = "reasoning",
        /// The JSON Schema of the answer.
        Schema = "schema",
    }
}

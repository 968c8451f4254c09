//! Providers of models, as data.
//!
//! In: an entry of a file. Out: a [`Provider`]. Nothing here sends anything.

use super::date::Date;
use super::facts::ReasoningFacts;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A provider of models.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provider {
    /// The part of `--model PROVIDER:NAME` before the colon.
    pub name: String,
    /// The form of its messages.
    pub wire: Wire,
    /// The base of its interface's paths; `None`: the user has to state it.
    pub base_url: Option<String>,
    /// Variable names that may hold its key; the first one found counts.
    pub key_env: Vec<String>,
    /// Whether it needs a key.
    pub key: KeyNeed,
    /// Whose machine answers; None: unknown.
    pub runs_on: Option<RunsOn>,
    /// Another provider with the same models.
    pub models_of: Option<String>,
    /// The command that starts its server at the known address.
    pub start: Option<String>,
    /// How it takes `reasoning`, unless a model's own facts say otherwise.
    #[serde(skip_serializing_if = "ReasoningFacts::is_empty")]
    pub reasoning: ReasoningFacts,
    /// Sources of these facts, newest layer first.
    pub sources: Vec<Source>,
}

fab_base::named! {
    /// The form of a provider's messages.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
    pub enum Wire {
        /// OpenAI's Responses.
        OpenaiResponses = "openai_responses",
        /// OpenAI's Chat Completions, which many others speak too.
        OpenaiChat = "openai_chat",
        /// Anthropic's Messages.
        Anthropic = "anthropic",
        /// Google's generateContent.
        Gemini = "gemini",
    }
}

impl fmt::Display for Wire {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The name that data files use.
        f.pad(self.name())
    }
}

/// Whether a provider needs a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KeyNeed {
    /// It does not answer without a key.
    Required,
    /// It may be configured to require a key.
    Optional,
}

/// Whose machine answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunsOn {
    /// The vendor's, which bills each call.
    Vendor,
    /// The user's; no call is billed.
    Own,
}

/// A source of facts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Source {
    /// When they were gathered.
    pub as_of: Date,
    /// Their origin.
    pub source: String,
}

/// Returns whether a name can hold a key: 1 to 60 capital letters, digits and `_`, as for variables.
pub(crate) fn is_key_name(name: &str) -> bool {
    let is_of_it = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    (1..=60).contains(&name.len()) && name.chars().all(is_of_it)
}

impl Provider {
    /// Returns the name of the provider whose models it offers: its own, or another's.
    pub fn owner(&self) -> &str {
        self.models_of.as_ref().unwrap_or(&self.name)
    }
}

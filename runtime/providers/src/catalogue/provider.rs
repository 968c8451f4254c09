//! Providers of models, as data.
//!
//! In: an entry of a file. Out: a [`Provider`]. Nothing here sends anything.

use super::date::Date;
use super::facts::ReasoningFacts;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// A provider of models. All fields but the name have defaults: those of a server of one's own that speaks OpenAI's Chat
/// Completions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provider {
    /// The part of `--model PROVIDER:NAME` before the colon.
    pub name: String,
    /// The form of its messages.
    #[serde(default)]
    pub wire: Wire,
    /// The base of its interface's paths; `None`: the user has to state it.
    #[serde(default, deserialize_with = "base_url")]
    pub base_url: Option<String>,
    /// Variable names that may hold its key; the first one found counts.
    #[serde(default, deserialize_with = "key_names")]
    pub key_env: Vec<String>,
    /// Whose machine answers; `None`: unknown, and prices have to be known.
    pub runs_on: Option<RunsOn>,
    /// Another provider with the same models.
    pub models_of: Option<String>,
    /// The command that starts its server at the known address.
    pub start: Option<String>,
    /// How it takes `reasoning`, unless a model's own facts say otherwise.
    #[serde(default)]
    pub reasoning: ReasoningFacts,
    /// When these facts were gathered.
    pub as_of: Option<Date>,
    /// Their origin.
    pub source: Option<String>,
}

fab_base::named! {
    /// The form of a provider's messages.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
    pub enum Wire {
        /// OpenAI's Responses.
        OpenaiResponses = "openai_responses",
        /// OpenAI's Chat Completions, which many others speak too.
        #[default]
        OpenaiChat = "openai_chat",
        /// Anthropic's Messages.
        Anthropic = "anthropic",
        /// Google's generateContent.
        Gemini = "gemini",
    }
}

/// Whose machine answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunsOn {
    /// The vendor's, which bills each call, and answers none without a key.
    Vendor,
    /// The user's; no call is billed.
    Own,
}

/// Returns whether a name can hold a key: 1 to 60 capital letters, digits and `_`, as for variables.
pub(crate) fn is_key_name(name: &str) -> bool {
    let is_of_it = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    (1..=60).contains(&name.len()) && name.chars().all(is_of_it)
}

/// Reads `key_env`. What is no name is not repeated: it may be a key, put there by mistake.
fn key_names<'de, D: Deserializer<'de>>(names: D) -> Result<Vec<String>, D::Error> {
    let names: Vec<String> = Vec::deserialize(names)?;
    if names.iter().all(|name| is_key_name(name)) {
        return Ok(names);
    }
    let why = "`key_env` lists names of variables, such as `OPENAI_API_KEY`, and never keys";
    Err(D::Error::custom(why))
}

/// Reads `base_url`. One with a part that may hold a secret is not repeated.
fn base_url<'de, D: Deserializer<'de>>(url: D) -> Result<Option<String>, D::Error> {
    let url: Option<String> = Option::deserialize(url)?;
    let holds_more = |url: &str| url.contains(['@', '?', '#']);
    if url.as_deref().is_some_and(holds_more) {
        let why = "`base_url` holds `@`, `?` or `#`; it is an address alone, and a key has no place in it";
        return Err(D::Error::custom(why));
    }
    Ok(url)
}

impl Provider {
    /// Returns the name of the provider whose models it offers: its own, or another's.
    pub fn owner(&self) -> &str {
        self.models_of.as_ref().unwrap_or(&self.name)
    }
}

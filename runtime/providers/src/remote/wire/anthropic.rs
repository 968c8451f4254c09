//! Anthropic's Messages API.
//!
//! In: messages and the request's settings; a `message`. Out: a typed body; an answer or a failure.

use super::content::{Turn, base64, framed, pieces, turn};
use super::error::refuse_error;
use super::{Answer, Ending, Failure, SentSettings, Unfit, if_readable, read};
use fab_model::calls::Usage;
use fab_model::{Message, Part, Reasoning};
use fab_program::ReasoningLevel;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

#[derive(Serialize)]
pub(super) struct Body<'a> {
    model: &'a str,
    max_tokens: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    system: Option<String>,
    messages: Vec<Turn<Block<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    top_p: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thinking: Option<Thinking>,
    #[serde(skip_serializing_if = "Option::is_none")]
    output_config: Option<OutputConfig>,
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Thinking {
    Disabled,
    Adaptive,
    Enabled { budget_tokens: u32 },
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Block<'a> {
    Text { text: &'a str },
    Image { source: Value },
}

#[derive(Serialize)]
struct OutputConfig {
    #[serde(skip_serializing_if = "Option::is_none")]
    effort: Option<ReasoningLevel>,
    #[serde(skip_serializing_if = "Option::is_none")]
    format: Option<Value>,
}

/// The version that accepts sampling parameters; it also lists models.
pub(super) const OLDER_VERSION: &str = "2023-06-01";

/// Returns the API version that supports the request's settings.
///
/// The current version has no sampling parameters and answers 400 to them; the previous one accepts them for models
/// that still have them.
pub(super) fn version(stated: &SentSettings) -> &'static str {
    if stated.temperature.is_some() || stated.top_p.is_some() {
        OLDER_VERSION
    } else {
        "2026-10-21"
    }
}

pub(super) fn body<'a>(
    model: &'a str,
    messages: &'a [Message],
    stated: SentSettings,
    max_tokens: u32,
) -> Result<Body<'a>, Unfit> {
    let (system, turns) = framed(messages)?;
    let (thinking, effort) = match stated.reasoning {
        None => (None, None),
        Some(Reasoning::Level(ReasoningLevel::None) | Reasoning::Tokens(0)) => {
            (Some(Thinking::Disabled), None)
        }
        Some(Reasoning::Level(level)) => (Some(Thinking::Adaptive), Some(level)),
        Some(Reasoning::Tokens(budget_tokens)) => (Some(Thinking::Enabled { budget_tokens }), None),
    };
    let format = stated.schema;
    let format = format.map(|schema| json!({ "type": "json_schema", "schema": schema }));
    let has_config = effort.is_some() || format.is_some();
    Ok(Body {
        model,
        max_tokens,
        system,
        messages: turns
            .iter()
            .map(|message| turn(message, |it| pieces(it, block)))
            .collect::<Result<_, _>>()?,
        temperature: stated.temperature,
        top_p: stated.top_p,
        thinking,
        output_config: has_config.then_some(OutputConfig { effort, format }),
    })
}

fn block(part: &Part) -> Block<'_> {
    match part {
        Part::Text(text) => Block::Text { text },
        Part::Image(png) => Block::Image {
            source: json!({ "type": "base64", "media_type": "image/png", "data": base64(png) }),
        },
    }
}

#[derive(Deserialize)]
struct Reply {
    content: Option<Vec<ContentBlock>>,
    stop_reason: Option<String>,
    stop_details: Option<Details>,
    #[serde(default, deserialize_with = "if_readable")]
    usage: Option<AnthropicTokens>,
    error: Option<Value>,
}

#[derive(Deserialize)]
struct Details {
    explanation: Option<String>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum ContentBlock {
    Text {
        text: String,
    },
    ToolUse {},
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
struct AnthropicTokens {
    input_tokens: u64,
    output_tokens: u64,
    cache_creation_input_tokens: Option<u64>,
    cache_read_input_tokens: Option<u64>,
    output_tokens_details: Option<OutputDetails>,
}

#[derive(Deserialize)]
struct OutputDetails {
    thinking_tokens: Option<u64>,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply: Reply = read(bytes)?;
    let usage = reply.usage.map(|tokens| {
        let cached = tokens.cache_read_input_tokens.unwrap_or(0);
        let written = tokens.cache_creation_input_tokens.unwrap_or(0);
        // Cache reads and writes are not counted in the input.
        let input = tokens.input_tokens.saturating_add(cached);
        Usage {
            input_tokens: input.saturating_add(written),
            cached_input_tokens: cached,
            output_tokens: tokens.output_tokens,
            reasoning_tokens: tokens
                .output_tokens_details
                .and_then(|details| details.thinking_tokens),
        }
    });
    refuse_error(reply.error.as_ref(), usage)?;
    let mut ending = Ending {
        reason: reply.stop_reason.as_deref(),
        explanation: reply.stop_details.and_then(|details| details.explanation),
        ..Ending::default()
    };
    for said in reply.content.unwrap_or_default() {
        match said {
            ContentBlock::Text { text } => ending.text.push_str(&text),
            ContentBlock::ToolUse {} => ending.is_tool_call = true,
            ContentBlock::Other => {}
        }
    }
    ending.answer(usage)
}

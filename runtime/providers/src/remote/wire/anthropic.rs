//! Anthropic's Messages API.
//!
//! In: messages and the request's settings; a `message`. Out: a body; an answer or a failure.

use super::content::{base64, framed, stated, turn};
use super::error::refuse_error;
use super::{Answer, Ending, Failure, Sent, Unfit, count, read};
use fab_model::calls::Usage;
use fab_model::{Message, Part, Reasoning};
use fab_program::ReasoningLevel;
use serde::Deserialize;
use serde_json::{Value, json};

/// The version that accepts sampling parameters; it also lists models.
pub(super) const OLDER_VERSION: &str = "2023-06-01";

/// Returns the API version that supports the request's settings.
///
/// The current version has no sampling parameters and answers 400 to them; the previous one accepts them for models
/// that still have them.
pub(super) fn version(sent: &Sent) -> &'static str {
    if sent.temperature.is_some() || sent.top_p.is_some() {
        OLDER_VERSION
    } else {
        "2026-10-21"
    }
}

pub(super) fn body(model: &str, messages: &[Message], sent: Sent) -> Result<Value, Unfit> {
    let (system, turns) = framed(messages)?;
    let (thinking, effort) = match sent.reasoning {
        None => (None, None),
        Some(Reasoning::Level(ReasoningLevel::None) | Reasoning::Tokens(0)) => {
            (Some(json!({ "type": "disabled" })), None)
        }
        Some(Reasoning::Level(level)) => (Some(json!({ "type": "adaptive" })), Some(level)),
        Some(Reasoning::Tokens(tokens)) => (
            Some(json!({ "type": "enabled", "budget_tokens": tokens })),
            None,
        ),
    };
    let format = { sent.schema }.map(|it| json!({ "type": "json_schema", "schema": it }));
    let config = stated(json!({ "effort": effort, "format": format }));
    let turns = turns.iter().map(|message| turn(message, blocks));
    Ok(stated(json!({
        "model": model,
        "max_tokens": sent.max_tokens,
        "system": system,
        "messages": turns.collect::<Result<Vec<_>, _>>()?,
        "temperature": sent.temperature,
        "top_p": sent.top_p,
        "thinking": thinking,
        "output_config": Some(config).filter(|it| *it != json!({})),
    })))
}

fn blocks(message: &Message) -> Value {
    let blocks = message.parts.iter().map(|part| match part {
        Part::Text(text) => json!({ "type": "text", "text": text }),
        Part::Image(png) => {
            let source =
                json!({ "type": "base64", "media_type": "image/png", "data": base64(png) });
            json!({ "type": "image", "source": source })
        }
    });
    blocks.collect()
}

#[derive(Deserialize)]
struct Reply {
    content: Option<Vec<ContentBlock>>,
    stop_reason: Option<String>,
    stop_details: Option<Details>,
    usage: Option<Value>,
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

fn usage(bill: &Value) -> Option<Usage> {
    let cached = count(bill, "/cache_read_input_tokens").unwrap_or(0);
    let written = count(bill, "/cache_creation_input_tokens").unwrap_or(0);
    // Cache reads and writes are not counted in the input.
    let input = count(bill, "/input_tokens")?.saturating_add(cached);
    Some(Usage {
        input_tokens: input.saturating_add(written),
        cached_input_tokens: cached,
        output_tokens: count(bill, "/output_tokens")?,
        reasoning_tokens: count(bill, "/output_tokens_details/thinking_tokens"),
    })
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply: Reply = read(bytes)?;
    let usage = reply.usage.as_ref().and_then(usage);
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

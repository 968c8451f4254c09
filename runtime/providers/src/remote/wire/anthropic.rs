//! Anthropic's Messages API.
//!
//! In: messages and the request's settings; a `message`. Out: a body; an answer or a failure.

use super::content::{base64, framed, stated, turn};
use super::error::refuse_error;
use super::{Answer, Ending, Failure, Sent, count, elements, read};
use fab_model::calls::Usage;
use fab_model::{Message, Part, Reasoning};
use fab_program::ReasoningLevel;
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

pub(super) fn body(model: &str, messages: &[Message], sent: Sent) -> Result<Value, String> {
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

fn usage(bill: &Value) -> Option<Usage> {
    let cached = count(bill, "/cache_read_input_tokens")?.unwrap_or(0);
    let written = count(bill, "/cache_creation_input_tokens")?.unwrap_or(0);
    // Cache reads and writes are not counted in the input.
    let input = count(bill, "/input_tokens")??.saturating_add(cached);
    Some(Usage {
        input_tokens: input.saturating_add(written),
        cached_input_tokens: cached,
        output_tokens: count(bill, "/output_tokens")??,
        reasoning_tokens: count(bill, "/output_tokens_details/thinking_tokens")?,
    })
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply = read(bytes)?;
    let usage = usage(&reply["usage"]);
    refuse_error(&reply["error"], usage)?;
    let mut ending = Ending {
        reason: reply["stop_reason"].as_str(),
        explanation: reply["stop_details"]["explanation"].as_str(),
        ..Ending::default()
    };
    for block in elements(&reply["content"]) {
        if block["type"] == "text" {
            let text = block["text"].as_str();
            ending.text.push_str(text.unwrap_or_default());
        }
    }
    ending.answer(usage)
}

//! OpenAI's Chat Completions API; also Ollama, vLLM, llama.cpp, LM Studio, LiteLLM and others.
//!
//! In: messages and the request's settings; a `chat.completion`. Out: a body; an answer or a failure. Compatible servers
//! omit fields, so a reply needs only a choice with text.

use super::content::{data_url, stated, turn};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, elements, openai_usage, read};
use crate::catalogue::{Facts, MaxTokensField};
use fab_model::calls::Fault;
use fab_model::{Message, Part, Reasoning};
use serde_json::{Value, json};

/// - `tokens_field`: the server's own name for a number of hidden tokens.
pub(super) fn body(
    model: &str,
    messages: &[Message],
    sent: Sent,
    facts: &Facts,
    tokens_field: Option<&str>,
) -> Result<Value, String> {
    // Most compatible servers know the older name.
    let field = facts.max_tokens_field.unwrap_or(MaxTokensField::MaxTokens);
    let limit = |wanted| sent.max_tokens.filter(|_| field == wanted);
    let (effort, hidden) = match sent.reasoning {
        Some(Reasoning::Level(level)) => (Some(level), None),
        Some(Reasoning::Tokens(tokens)) => (None, Some(tokens)),
        None => (None, None),
    };
    let format = sent.schema.map(|schema| {
        let named = json!({ "name": "action", "schema": schema, "strict": true });
        json!({ "type": "json_schema", "json_schema": named })
    });
    let messages = messages.iter().map(|message| turn(message, asked));
    Ok(stated(json!({
        "model": model,
        "messages": messages.collect::<Result<Vec<_>, _>>()?,
        "temperature": sent.temperature,
        "top_p": sent.top_p,
        "max_tokens": limit(MaxTokensField::MaxTokens),
        "max_completion_tokens": limit(MaxTokensField::MaxCompletionTokens),
        "reasoning_effort": effort,
        (tokens_field.unwrap_or_default()): hidden,
        "response_format": format,
    })))
}

fn asked(message: &Message) -> Value {
    // Some servers accept text-only content only as a string.
    if let [Part::Text(text)] = &message.parts[..] {
        return json!(text);
    }
    let pieces = message.parts.iter().map(|part| match part {
        Part::Text(text) => json!({ "type": "text", "text": text }),
        Part::Image(png) => json!({ "type": "image_url", "image_url": { "url": data_url(png) } }),
    });
    pieces.collect()
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply = read(bytes)?;
    let usage = openai_usage(&reply["usage"], ["prompt", "completion"]);
    refuse_error(&reply["error"], usage)?;
    let choice = &reply["choices"][0];
    // Some gateways put a provider's error here, in a reply with status 200.
    refuse_error(&choice["error"], usage)?;
    let said = &choice["message"];
    if !said.is_object() {
        let why = "the reply holds no choice with a message";
        return Err(Failure::new(Fault::InvalidReply, why, usage));
    }
    if let Some(refusal) = said["refusal"].as_str().filter(|it| !it.is_empty()) {
        return Err(Failure::new(Fault::Refused, repeated(refusal), usage));
    }
    // A string or, from some servers, pieces.
    let text = match &said["content"] {
        Value::String(text) => text.clone(),
        pieces => elements(pieces)
            .filter_map(|it| it["text"].as_str())
            .collect(),
    };
    let named = |name| Some((name, said[name].as_str()?));
    // llama.cpp's and older vLLM's name for thoughts; that of newer vLLM, Ollama and OpenRouter.
    let reasoning = named("reasoning_content").or_else(|| named("reasoning"));
    let ending = Ending {
        text,
        reason: choice["finish_reason"].as_str(),
        explanation: None,
        reasoning,
    };
    ending.answer(usage)
}

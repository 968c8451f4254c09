//! OpenAI's Chat Completions API; also Ollama, vLLM, llama.cpp, LM Studio, LiteLLM and others.
//!
//! In: messages and the request's settings; a `chat.completion`. Out: a body; an answer or a failure. Compatible servers
//! omit fields, so a reply needs only a choice with text.

use super::content::{data_url, stated, turn};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, Unfit, openai_usage, read};
use crate::catalogue::{Facts, MaxTokensField};
use fab_model::calls::Fault;
use fab_model::{Message, Part, Reasoning};
use serde::Deserialize;
use serde_json::{Value, json};

/// - `tokens_field`: the server's own name for a number of hidden tokens.
pub(super) fn body(
    model: &str,
    messages: &[Message],
    sent: Sent,
    facts: &Facts,
    tokens_field: Option<&str>,
) -> Result<Value, Unfit> {
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

#[derive(Deserialize)]
struct Completion {
    choices: Option<Vec<Choice>>,
    usage: Option<Value>,
    error: Option<Value>,
}

#[derive(Deserialize)]
struct Choice {
    message: Option<AnswerMessage>,
    finish_reason: Option<String>,
    /// Some gateways put a provider's error here, in a reply with status 200.
    error: Option<Value>,
}

#[derive(Deserialize)]
struct AnswerMessage {
    content: Option<Text>,
    refusal: Option<String>,
    tool_calls: Option<Vec<Value>>,
    function_call: Option<Value>,
    /// llama.cpp's and older vLLM's name for thoughts.
    reasoning_content: Option<Value>,
    /// Newer vLLM's, Ollama's and OpenRouter's name.
    reasoning: Option<Value>,
}

/// Text as a string or, from some servers, in pieces.
#[derive(Deserialize)]
#[serde(untagged)]
enum Text {
    Whole(String),
    Pieces(Vec<TextPiece>),
}

#[derive(Deserialize)]
struct TextPiece {
    text: Option<String>,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let completion: Completion = read(bytes)?;
    let usage = openai_usage(completion.usage.as_ref(), ["prompt", "completion"]);
    refuse_error(completion.error.as_ref(), usage)?;
    let choice = completion.choices.unwrap_or_default().into_iter().next();
    let error = choice.as_ref().and_then(|choice| choice.error.as_ref());
    refuse_error(error, usage)?;
    let Some(Choice {
        message: Some(said),
        finish_reason,
        ..
    }) = choice
    else {
        let why = "the reply holds no choice with a message";
        return Err(Failure::new(Fault::InvalidReply, why, usage));
    };
    if let Some(refusal) = said.refusal.filter(|refusal| !refusal.is_empty()) {
        return Err(Failure::new(Fault::Refused, repeated(&refusal), usage));
    }
    let text = match said.content {
        None => String::new(),
        Some(Text::Whole(text)) => text,
        Some(Text::Pieces(pieces)) => pieces.into_iter().filter_map(|piece| piece.text).collect(),
    };
    let named = |name, text: Option<Value>| Some((name, text?.as_str()?.to_owned()));
    let reasoning = named("reasoning_content", said.reasoning_content);
    let ending = Ending {
        text,
        reason: finish_reason.as_deref(),
        explanation: None,
        reasoning: reasoning.or_else(|| named("reasoning", said.reasoning)),
        is_tool_call: said.tool_calls.is_some_and(|calls| !calls.is_empty())
            || said.function_call.is_some(),
    };
    ending.answer(usage)
}

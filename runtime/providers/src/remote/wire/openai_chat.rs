//! OpenAI's Chat Completions API; also Ollama, vLLM, llama.cpp, LM Studio, LiteLLM and others.
//!
//! In: messages and the request's settings; a `chat.completion`. Out: a typed body; an answer or a failure. Compatible
//! servers omit fields, so a reply needs only a choice with text.

use super::content::{Content, Turn, data_url, pieces, refuse_no_question, turn};
use super::error::{refuse_error, repeated};
use super::{
    Answer, Ending, Failure, InputDetails, OutputDetails, SentSettings, Unfit, if_readable, read,
    with_hidden,
};
use crate::catalogue::MaxTokensField;
use fab_model::calls::{Fault, Usage};
use fab_model::{Message, Part, Reasoning};
use fab_program::ReasoningLevel;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;

#[derive(Serialize)]
pub(super) struct Body<'a> {
    model: &'a str,
    messages: Vec<Turn<Piece<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    top_p: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_tokens: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_completion_tokens: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reasoning_effort: Option<ReasoningLevel>,
    /// A number of hidden tokens, under the server's own name.
    #[serde(flatten)]
    budget: BTreeMap<&'a str, u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    response_format: Option<Value>,
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Piece<'a> {
    Text { text: &'a str },
    ImageUrl { image_url: Value },
}

pub(super) fn body<'a>(
    model: &'a str,
    messages: &'a [Message],
    stated: SentSettings,
    (field, budget): (MaxTokensField, Option<&'a str>),
) -> Result<Body<'a>, Unfit> {
    refuse_no_question(messages)?;
    let limit = |wanted| stated.max_tokens.filter(|_| field == wanted);
    Ok(Body {
        model,
        messages: messages
            .iter()
            .map(|message| turn(message, asked))
            .collect::<Result<_, _>>()?,
        temperature: stated.temperature,
        top_p: stated.top_p,
        max_tokens: limit(MaxTokensField::MaxTokens),
        max_completion_tokens: limit(MaxTokensField::MaxCompletionTokens),
        reasoning_effort: match stated.reasoning {
            Some(Reasoning::Level(level)) => Some(level),
            Some(Reasoning::Tokens(_)) | None => None,
        },
        budget: match stated.reasoning {
            Some(Reasoning::Tokens(tokens)) => budget.into_iter().map(|it| (it, tokens)).collect(),
            Some(Reasoning::Level(_)) | None => BTreeMap::new(),
        },
        response_format: stated.schema.map(|schema| {
            let named = json!({ "name": "action", "schema": schema, "strict": true });
            json!({ "type": "json_schema", "json_schema": named })
        }),
    })
}

fn asked(message: &Message) -> Content<Piece<'_>> {
    // Some servers accept text-only content only as a string.
    if let [Part::Text(text)] = &message.parts[..] {
        return Content::Text(text.clone());
    }
    pieces(message, |part| match part {
        Part::Text(text) => Piece::Text { text },
        Part::Image(png) => Piece::ImageUrl {
            image_url: json!({ "url": data_url(png) }),
        },
    })
}

#[derive(Deserialize)]
struct Completion {
    choices: Option<Vec<Choice>>,
    #[serde(default, deserialize_with = "if_readable")]
    usage: Option<ChatTokens>,
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
    #[serde(default, deserialize_with = "if_readable")]
    reasoning_content: Option<String>,
    /// Newer vLLM's, Ollama's and OpenRouter's name.
    #[serde(default, deserialize_with = "if_readable")]
    reasoning: Option<String>,
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

#[derive(Deserialize)]
struct ChatTokens {
    prompt_tokens: u64,
    #[serde(default)]
    completion_tokens: u64,
    total_tokens: Option<u64>,
    prompt_tokens_details: Option<InputDetails>,
    completion_tokens_details: Option<OutputDetails>,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let completion: Completion = read(bytes)?;
    let usage = completion.usage.map(|tokens| {
        let usage = Usage {
            input_tokens: tokens.prompt_tokens,
            cached_input_tokens: tokens
                .prompt_tokens_details
                .and_then(|details| details.cached_tokens)
                .unwrap_or(0),
            output_tokens: tokens.completion_tokens,
            reasoning_tokens: tokens
                .completion_tokens_details
                .and_then(|details| details.reasoning_tokens),
        };
        with_hidden(usage, tokens.total_tokens)
    });
    refuse_error(completion.error.as_ref(), usage)?;
    let choice = completion.choices.unwrap_or_default().into_iter().next();
    refuse_error(
        choice.as_ref().and_then(|choice| choice.error.as_ref()),
        usage,
    )?;
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
    let named = |name, text: Option<String>| Some((name, text?));
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

//! Google's `generateContent` API.
//!
//! In: messages and the request's settings; a `GenerateContentResponse`. Out: a typed body; an answer or a failure.

use super::content::{base64, framed, words};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, SentSettings, Unfit, if_readable, read};
use fab_model::calls::{Fault, Usage};
use fab_model::{Message, Part, Reasoning, Speaker};
use fab_program::ReasoningLevel;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Body<'a> {
    contents: Vec<GeminiContent<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    system_instruction: Option<Value>,
    generation_config: Config,
}

#[derive(Serialize)]
struct GeminiContent<'a> {
    role: &'static str,
    parts: Vec<Piece<'a>>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
enum Piece<'a> {
    Text(&'a str),
    InlineData(Value),
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Config {
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    top_p: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_output_tokens: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    response_mime_type: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    response_json_schema: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    thinking_config: Option<Thinking>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
enum Thinking {
    ThinkingLevel(&'static str),
    /// 0 turns thinking off.
    ThinkingBudget(u32),
}

pub(super) fn body<'a>(messages: &'a [Message], stated: SentSettings) -> Result<Body<'a>, Unfit> {
    let (frame, turns) = framed(messages)?;
    Ok(Body {
        contents: turns.iter().map(content).collect::<Result<_, _>>()?,
        system_instruction: frame.map(|text| json!({ "parts": [{ "text": text }] })),
        generation_config: Config {
            temperature: stated.temperature,
            top_p: stated.top_p,
            max_output_tokens: stated.max_tokens,
            response_mime_type: stated.schema.is_some().then_some("application/json"),
            response_json_schema: stated.schema,
            thinking_config: stated.reasoning.map(|reasoning| match reasoning {
                Reasoning::Level(ReasoningLevel::None) => Thinking::ThinkingBudget(0),
                Reasoning::Level(ReasoningLevel::Low) => Thinking::ThinkingLevel("LOW"),
                Reasoning::Level(ReasoningLevel::Medium) => Thinking::ThinkingLevel("MEDIUM"),
                Reasoning::Level(ReasoningLevel::High) => Thinking::ThinkingLevel("HIGH"),
                Reasoning::Tokens(tokens) => Thinking::ThinkingBudget(tokens),
            }),
        },
    })
}

fn content(message: &Message) -> Result<GeminiContent<'_>, Unfit> {
    let role = if message.speaker == Speaker::Assistant {
        words(message)?;
        "model"
    } else {
        "user"
    };
    let parts = message.parts.iter().map(|part| match part {
        Part::Text(text) => Piece::Text(text),
        Part::Image(png) => {
            Piece::InlineData(json!({ "mimeType": "image/png", "data": base64(png) }))
        }
    });
    Ok(GeminiContent {
        role,
        parts: parts.collect(),
    })
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Reply {
    candidates: Option<Vec<Candidate>>,
    prompt_feedback: Option<Feedback>,
    #[serde(default, deserialize_with = "if_readable")]
    usage_metadata: Option<GeminiTokens>,
    error: Option<Value>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Candidate {
    content: Option<AnswerContent>,
    finish_reason: Option<String>,
    finish_message: Option<String>,
}

#[derive(Deserialize)]
struct AnswerContent {
    parts: Option<Vec<AnswerPart>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct AnswerPart {
    text: Option<String>,
    thought: Option<bool>,
    function_call: Option<Value>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Feedback {
    block_reason: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct GeminiTokens {
    prompt_token_count: Option<u64>,
    cached_content_token_count: Option<u64>,
    candidates_token_count: Option<u64>,
    thoughts_token_count: Option<u64>,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply: Reply = read(bytes)?;
    let usage = reply.usage_metadata.map(|tokens| Usage {
        input_tokens: tokens.prompt_token_count.unwrap_or(0),
        cached_input_tokens: tokens.cached_content_token_count.unwrap_or(0),
        // Hidden reasoning is counted separately from the answer.
        output_tokens: tokens
            .candidates_token_count
            .unwrap_or(0)
            .saturating_add(tokens.thoughts_token_count.unwrap_or(0)),
        reasoning_tokens: tokens.thoughts_token_count,
    });
    refuse_error(reply.error.as_ref(), usage)?;
    if let Some(reason) = reply.prompt_feedback.and_then(|said| said.block_reason) {
        let reason = repeated(&reason);
        let why = format!("the provider's filter refused the question: `{reason}`");
        return Err(Failure::new(Fault::ContentFiltered, why, usage));
    }
    let Some(candidate) = reply.candidates.unwrap_or_default().into_iter().next() else {
        let why = "the reply holds no candidate";
        return Err(Failure::new(Fault::InvalidReply, why, usage));
    };
    let mut ending = Ending {
        reason: candidate.finish_reason.as_deref(),
        explanation: candidate.finish_message,
        ..Ending::default()
    };
    let parts = candidate.content.and_then(|content| content.parts);
    for part in parts.unwrap_or_default() {
        ending.is_tool_call |= part.function_call.is_some();
        if part.thought != Some(true) {
            ending
                .text
                .push_str(part.text.as_deref().unwrap_or_default());
        }
    }
    ending.answer(usage)
}

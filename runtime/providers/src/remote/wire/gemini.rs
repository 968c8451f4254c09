//! Google's `generateContent` API.
//!
//! In: messages and the request's settings; a `GenerateContentResponse`. Out: a body; an answer or a failure.

use super::content::{base64, framed, stated, words};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, Unfit, count, read};
use fab_model::calls::{Fault, Usage};
use fab_model::{Message, Part, Reasoning, Speaker};
use fab_program::ReasoningLevel;
use serde::Deserialize;
use serde_json::{Value, json};

pub(super) fn body(messages: &[Message], sent: Sent) -> Result<Value, Unfit> {
    let (frame, turns) = framed(messages)?;
    let thinking = sent.reasoning.map(|reasoning| match reasoning {
        Reasoning::Level(ReasoningLevel::None) => json!({ "thinkingBudget": 0 }),
        Reasoning::Level(level) => json!({ "thinkingLevel": level.word().to_uppercase() }),
        Reasoning::Tokens(tokens) => json!({ "thinkingBudget": tokens }),
    });
    Ok(stated(json!({
        "contents": turns.iter().map(content).collect::<Result<Vec<_>, _>>()?,
        "systemInstruction": frame.map(|text| json!({ "parts": [{ "text": text }] })),
        "generationConfig": stated(json!({
            "temperature": sent.temperature,
            "topP": sent.top_p,
            "maxOutputTokens": sent.max_tokens,
            "responseMimeType": sent.schema.as_ref().map(|_| "application/json"),
            "responseJsonSchema": sent.schema,
            "thinkingConfig": thinking,
        })),
    })))
}

fn content(message: &Message) -> Result<Value, Unfit> {
    let role = if message.speaker == Speaker::Assistant {
        words(message)?;
        "model"
    } else {
        "user"
    };
    let parts = message.parts.iter().map(|part| match part {
        Part::Text(text) => json!({ "text": text }),
        Part::Image(png) => {
            json!({ "inlineData": { "mimeType": "image/png", "data": base64(png) } })
        }
    });
    Ok(json!({ "role": role, "parts": parts.collect::<Value>() }))
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Reply {
    candidates: Option<Vec<Candidate>>,
    prompt_feedback: Option<Feedback>,
    usage_metadata: Option<Value>,
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

fn usage(bill: &Value) -> Option<Usage> {
    let hidden = count(bill, "/thoughtsTokenCount");
    // Hidden reasoning is counted separately from the answer.
    let visible = count(bill, "/candidatesTokenCount").unwrap_or(0);
    Some(Usage {
        input_tokens: count(bill, "/promptTokenCount")?,
        cached_input_tokens: count(bill, "/cachedContentTokenCount").unwrap_or(0),
        output_tokens: visible.saturating_add(hidden.unwrap_or(0)),
        reasoning_tokens: hidden,
    })
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply: Reply = read(bytes)?;
    let usage = reply.usage_metadata.as_ref().and_then(usage);
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

//! Google's `generateContent` API.
//!
//! In: messages and the request's settings; a `GenerateContentResponse`. Out: a body; an answer or a failure.

use super::content::{base64, framed, stated, words};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, count, elements, read};
use fab_model::calls::{Fault, Usage};
use fab_model::{Message, Part, Reasoning, Speaker};
use fab_program::ReasoningLevel;
use serde_json::{Value, json};

pub(super) fn body(messages: &[Message], sent: Sent) -> Result<Value, String> {
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

fn content(message: &Message) -> Result<Value, String> {
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

fn usage(bill: &Value) -> Option<Usage> {
    bill.as_object()?;
    let hidden = count(bill, "/thoughtsTokenCount")?;
    // Hidden reasoning is counted separately from the answer.
    let visible = count(bill, "/candidatesTokenCount")?.unwrap_or(0);
    Some(Usage {
        input_tokens: count(bill, "/promptTokenCount")?.unwrap_or(0),
        cached_input_tokens: count(bill, "/cachedContentTokenCount")?.unwrap_or(0),
        output_tokens: visible.saturating_add(hidden.unwrap_or(0)),
        reasoning_tokens: hidden,
    })
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply = read(bytes)?;
    let usage = usage(&reply["usageMetadata"]);
    refuse_error(&reply["error"], usage)?;
    if let Some(reason) = reply["promptFeedback"]["blockReason"].as_str() {
        let reason = repeated(reason);
        let why = format!("the provider's filter refused the question: `{reason}`");
        return Err(Failure::new(Fault::ContentFiltered, why, usage));
    }
    let candidate = &reply["candidates"][0];
    if !candidate.is_object() {
        let why = "the reply holds no candidate";
        return Err(Failure::new(Fault::InvalidReply, why, usage));
    }
    let mut ending = Ending {
        reason: candidate["finishReason"].as_str(),
        explanation: candidate["finishMessage"].as_str(),
        ..Ending::default()
    };
    for part in elements(&candidate["content"]["parts"]) {
        if part["thought"] != true {
            let text = part["text"].as_str();
            ending.text.push_str(text.unwrap_or_default());
        }
    }
    ending.answer(usage)
}

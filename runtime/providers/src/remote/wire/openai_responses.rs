//! OpenAI's Responses API, with storage turned off.
//!
//! In: messages and the request's settings; a `response`. Out: a body; an answer or a failure.

use super::content::{BETWEEN, data_url, stated, turn};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, elements, fault_of_end, openai_usage, read};
use fab_model::calls::Fault;
use fab_model::{Message, Part, Reasoning};
use serde_json::{Value, json};

pub(super) fn body(model: &str, messages: &[Message], sent: Sent) -> Result<Value, String> {
    let reasoning = match sent.reasoning {
        Some(Reasoning::Level(effort)) => Some(json!({ "effort": effort })),
        // There is no field for a number of tokens, and `reasoning::sent` refuses it.
        Some(Reasoning::Tokens(_)) | None => None,
    };
    let format = sent.schema.map(|schema| {
        json!({ "format": { "type": "json_schema", "name": "action", "schema": schema, "strict": true } })
    });
    let messages = messages.iter().map(|message| turn(message, pieces));
    Ok(stated(json!({
        "model": model,
        "input": messages.collect::<Result<Vec<_>, _>>()?,
        "store": false,
        "temperature": sent.temperature,
        "top_p": sent.top_p,
        "max_output_tokens": sent.max_tokens,
        "reasoning": reasoning,
        "text": format,
    })))
}

fn pieces(message: &Message) -> Value {
    let pieces = message.parts.iter().map(|part| match part {
        Part::Text(text) => json!({ "type": "input_text", "text": text }),
        Part::Image(png) => {
            json!({ "type": "input_image", "image_url": data_url(png), "detail": "auto" })
        }
    });
    pieces.collect()
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let reply = read(bytes)?;
    let usage = openai_usage(&reply["usage"], ["input", "output"]);
    refuse_error(&reply["error"], usage)?;
    let named = reply["incomplete_details"]["reason"].as_str();
    let mut end = match reply["status"].as_str() {
        Some("incomplete") => named
            .filter(|it| fault_of_end(it).is_some())
            .or(Some("incomplete")),
        status => status,
    };
    let mut texts = Vec::new();
    for item in elements(&reply["output"]) {
        // Remarks on the way to the answer are no part of it.
        if item["type"] != "message" || item["phase"] == "commentary" {
            continue;
        }
        // Some gateways leave out the status of the whole.
        if item["status"] == "incomplete" {
            end = end.or(Some("incomplete"));
        }
        let mut text = String::new();
        for part in elements(&item["content"]) {
            if part["type"] == "refusal" {
                let refusal = part["refusal"].as_str().unwrap_or_default();
                return Err(Failure::new(Fault::Refused, repeated(refusal), usage));
            }
            if part["type"] == "output_text" {
                text.push_str(part["text"].as_str().unwrap_or_default());
            }
        }
        texts.push(text);
    }
    let ending = Ending {
        text: texts.join(BETWEEN),
        reason: end,
        ..Ending::default()
    };
    ending.answer(usage)
}

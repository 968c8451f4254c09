//! OpenAI's Responses API, with storage turned off.
//!
//! In: messages and the request's settings; a `response`. Out: a body; an answer or a failure.

use super::content::{BETWEEN, data_url, stated, turn};
use super::error::{refuse_error, repeated};
use super::{Answer, Ending, Failure, Sent, Unfit, fault_of_end, openai_usage, read};
use fab_model::calls::Fault;
use fab_model::{Message, Part, Reasoning};
use serde::Deserialize;
use serde_json::{Value, json};

pub(super) fn body(model: &str, messages: &[Message], sent: Sent) -> Result<Value, Unfit> {
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

#[derive(Deserialize)]
struct Response {
    status: Option<String>,
    error: Option<Value>,
    incomplete_details: Option<Incomplete>,
    output: Option<Vec<Item>>,
    usage: Option<Value>,
}

#[derive(Deserialize)]
struct Incomplete {
    reason: Option<String>,
}

#[derive(Deserialize)]
struct Item {
    r#type: String,
    status: Option<String>,
    phase: Option<String>,
    content: Option<Vec<ContentPart>>,
}

#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum ContentPart {
    OutputText {
        text: String,
    },
    Refusal {
        refusal: String,
    },
    #[serde(other)]
    Other,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let response: Response = read(bytes)?;
    let usage = openai_usage(response.usage.as_ref(), ["input", "output"]);
    refuse_error(response.error.as_ref(), usage)?;
    let details = response.incomplete_details;
    let named = details.as_ref().and_then(|it| it.reason.as_deref());
    let mut end = match response.status.as_deref() {
        Some("incomplete") => named
            .filter(|it| fault_of_end(it).is_some())
            .or(Some("incomplete")),
        status => status,
    };
    let output = response.output.unwrap_or_default();
    let is_tool_call = output.iter().any(|item| item.r#type.ends_with("_call"));
    // Remarks on the way to the answer are no part of it.
    let is_answer =
        |item: &Item| item.r#type == "message" && item.phase.as_deref() != Some("commentary");
    let mut texts = Vec::new();
    for message in output.into_iter().filter(is_answer) {
        // Some gateways leave out the status of the whole.
        if message.status.as_deref() == Some("incomplete") {
            end = end.or(Some("incomplete"));
        }
        let mut text = String::new();
        for said in message.content.unwrap_or_default() {
            match said {
                ContentPart::OutputText { text: more } => text.push_str(&more),
                ContentPart::Refusal { refusal } => {
                    return Err(Failure::new(Fault::Refused, repeated(&refusal), usage));
                }
                ContentPart::Other => {}
            }
        }
        texts.push(text);
    }
    let ending = Ending {
        text: texts.join(BETWEEN),
        reason: end,
        is_tool_call,
        ..Ending::default()
    };
    ending.answer(usage)
}

//! OpenAI's Responses API, with storage turned off.
//!
//! In: messages and the request's settings; a `response`. Out: a typed body; an answer or a failure.

use super::content::{BETWEEN, Turn, data_url, pieces, refuse_no_question, turn};
use super::error::{refuse_error, repeated};
use super::{
    Answer, Ending, Failure, InputDetails, OutputDetails, SentSettings, Unfit, fault_of_end,
    if_readable, read, with_hidden,
};
use fab_model::calls::{Fault, Usage};
use fab_model::{Message, Part, Reasoning};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

#[derive(Serialize)]
pub(super) struct Body<'a> {
    model: &'a str,
    input: Vec<Turn<Piece<'a>>>,
    store: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    temperature: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    top_p: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_output_tokens: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reasoning: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<Value>,
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Piece<'a> {
    InputText {
        text: &'a str,
    },
    InputImage {
        image_url: String,
        detail: &'static str,
    },
}

pub(super) fn body<'a>(
    model: &'a str,
    messages: &'a [Message],
    stated: SentSettings,
) -> Result<Body<'a>, Unfit> {
    refuse_no_question(messages)?;
    Ok(Body {
        model,
        input: messages
            .iter()
            .map(|message| turn(message, |it| pieces(it, piece)))
            .collect::<Result<_, _>>()?,
        store: false,
        temperature: stated.temperature,
        top_p: stated.top_p,
        max_output_tokens: stated.max_tokens,
        reasoning: match stated.reasoning {
            Some(Reasoning::Level(effort)) => Some(json!({ "effort": effort })),
            // There is no field for a number of tokens, and `reasoning::sent` refuses it.
            Some(Reasoning::Tokens(_)) | None => None,
        },
        text: stated.schema.map(|schema| {
            json!({
                "format": { "type": "json_schema", "name": "action", "schema": schema, "strict": true },
            })
        }),
    })
}

fn piece(part: &Part) -> Piece<'_> {
    match part {
        Part::Text(text) => Piece::InputText { text },
        Part::Image(png) => Piece::InputImage {
            image_url: data_url(png),
            detail: "auto",
        },
    }
}

#[derive(Deserialize)]
struct Response {
    status: Option<String>,
    error: Option<Value>,
    incomplete_details: Option<Incomplete>,
    output: Option<Vec<Item>>,
    #[serde(default, deserialize_with = "if_readable")]
    usage: Option<ResponsesTokens>,
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

#[derive(Deserialize)]
struct ResponsesTokens {
    input_tokens: u64,
    output_tokens: u64,
    total_tokens: Option<u64>,
    input_tokens_details: Option<InputDetails>,
    output_tokens_details: Option<OutputDetails>,
}

pub(super) fn decode(bytes: &[u8]) -> Result<Answer, Failure> {
    let response: Response = read(bytes)?;
    let usage = response.usage.map(|tokens| {
        let usage = Usage {
            input_tokens: tokens.input_tokens,
            cached_input_tokens: tokens
                .input_tokens_details
                .and_then(|details| details.cached_tokens)
                .unwrap_or(0),
            output_tokens: tokens.output_tokens,
            reasoning_tokens: tokens
                .output_tokens_details
                .and_then(|details| details.reasoning_tokens),
        };
        with_hidden(usage, tokens.total_tokens)
    });
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

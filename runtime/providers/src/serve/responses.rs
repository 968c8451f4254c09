//! Responses: reads requests, writes answers, whole or as events.

use super::answer::{Answer, Content, pieces};
use super::content::{self, Address, Names};
use super::fields::Fields;
use super::format::Format;
use super::refusal::Refusal;
use super::{Asked, Form, HARMLESS, Sent};
use fab_model::{Message, Request, Speaker};
use serde_json::{Value, json};

const NAMES: Names = Names {
    text: &["input_text", "output_text", "text"],
    image: "input_image",
    address: Address::Plain,
};

/// Additional output that an answer here has none of, so that it can be asked for without effect.
const INCLUDED: [&str; 5] = [
    "reasoning.encrypted_content",
    "message.input_image.image_url",
    "file_search_call.results",
    "web_search_call.action.sources",
    "code_interpreter_call.outputs",
];

/// The fields of a request that its answer echoes.
pub(super) struct Responses {
    instructions: Option<String>,
    format: Value,
    temperature: Option<f64>,
    top_p: Option<f64>,
    max_tokens: Option<u32>,
}

impl Form for Responses {
    fn read(mut fields: Fields) -> Result<(Asked, Responses), Refusal> {
        let instructions = match fields.take("instructions") {
            None => None,
            Some(Value::String(text)) => Some(text),
            Some(_) => return Err(fields.wrong("instructions", "is not a string")),
        };
        let mut messages = match fields.required("input")? {
            Value::String(text) => vec![Message::text(Speaker::User, text)],
            Value::Array(turns) => content::turns(turns, "input", &NAMES)?,
            _ => return Err(fields.wrong("input", "is neither a string nor a list")),
        };
        if let Some(text) = &instructions {
            messages.insert(0, Message::text(Speaker::System, text));
        }
        let mut request = Request::new(content::role(&messages), messages);
        request.temperature = fields.number("temperature", 0.0, 2.0)?;
        request.top_p = fields.number("top_p", 0.0, 1.0)?;
        request.max_tokens = fields.whole("max_output_tokens", 1)?;
        request.repetition = fields.whole("seed", 0)?.unwrap_or(0);
        if let Some(reasoning) = fields.take("reasoning") {
            let mut reasoning = Fields::of("reasoning", reasoning)?;
            request.reasoning = reasoning.level("effort")?;
            // No thoughts are returned, so there is nothing to summarise.
            reasoning.finish(&["summary", "generate_summary"])?;
        }
        let mut echoed = json!({ "type": "text" });
        let mut format = Format::default();
        if let Some(text) = fields.take("text") {
            let mut text = Fields::of("text", text)?;
            if let Some(stated) = text.take("format") {
                format = Format::read(Fields::of("text.format", stated.clone())?, None)?;
                echoed = stated;
            }
            text.only("verbosity", json!("medium"))?;
            text.finish(&[])?;
        }
        request.schema = format.stated.clone();
        let is_streamed = fields.switch("stream")?;
        if let Some(options) = fields.stream_options(is_streamed)? {
            options.finish(&[])?;
        }
        for (name, allowed) in [
            ("background", json!(false)),
            ("truncation", json!("disabled")),
            ("tools", json!([])),
            ("tool_choice", json!("none")),
            ("top_logprobs", json!(0)),
        ] {
            fields.only(name, allowed)?;
        }
        fields.only_of("include", &INCLUDED)?;
        fields.finish(&HARMLESS)?;
        let form = Responses {
            instructions,
            format: echoed,
            temperature: request.temperature,
            top_p: request.top_p,
            max_tokens: request.max_tokens,
        };
        let asked = Asked {
            request,
            format,
            is_streamed,
        };
        Ok((asked, form))
    }

    fn whole(&self, answer: &Answer) -> Value {
        let mut response = self.begun(answer);
        let usage = &answer.usage;
        response["status"] = json!(status(answer));
        response["output"] = json!([item(answer)]);
        response["usage"] = json!({
            "input_tokens": usage.input_tokens,
            "input_tokens_details": { "cached_tokens": usage.cached_input_tokens },
            "output_tokens": usage.output_tokens,
            "output_tokens_details": { "reasoning_tokens": usage.reasoning_tokens.unwrap_or(0) },
            "total_tokens": usage.input_tokens.saturating_add(usage.output_tokens),
        });
        if answer.is_cut {
            response["incomplete_details"] = json!({ "reason": "max_output_tokens" });
        }
        response
    }

    fn events(self, answer: Answer) -> impl Iterator<Item = Sent> + Send + 'static {
        let begun = self.begun(&answer);
        let whole = self.whole(&answer);
        let item_id = answer.id("msg_");
        let item = item(&answer);
        let mut empty = item.clone();
        empty["status"] = json!("in_progress");
        empty["content"] = json!([]);
        let part = item["content"][0].clone();
        let (kind, field) = match &answer.content {
            Content::Text(_) => ("output_text", "text"),
            Content::Refusal(_) => ("refusal", "refusal"),
        };
        let mut empty_part = part.clone();
        empty_part[field] = json!("");
        let place = json!({ "item_id": item_id, "output_index": 0, "content_index": 0 });
        // The fields of an event about the part, with those that only texts have.
        let about = move |event: &str, field: &str, value: Value| {
            let mut about = place.clone();
            about["type"] = json!(format!("response.{event}"));
            about[field] = value;
            if event.starts_with("output_text") {
                about["logprobs"] = json!([]);
            }
            about
        };
        let head = [
            json!({ "type": "response.created", "response": begun.clone() }),
            json!({ "type": "response.in_progress", "response": begun }),
            json!({ "type": "response.output_item.added", "output_index": 0, "item": empty }),
            about("content_part.added", "part", empty_part),
        ];
        let tail = [
            about(&format!("{kind}.done"), field, part[field].clone()),
            about("content_part.done", "part", part),
            json!({ "type": "response.output_item.done", "output_index": 0, "item": item }),
            json!({ "type": format!("response.{}", status(&answer)), "response": whole }),
        ];
        let (Content::Text(words) | Content::Refusal(words)) = answer.content;
        let deltas =
            pieces(words).map(move |piece| about(&format!("{kind}.delta"), "delta", json!(piece)));
        let events = head.into_iter().chain(deltas).chain(tail);
        events.enumerate().map(|(number, mut event)| {
            event["sequence_number"] = json!(number);
            Sent::event(&event)
        })
    }
}

impl Responses {
    /// Writes a response without output.
    fn begun(&self, answer: &Answer) -> Value {
        json!({
            "id": answer.id("resp_"),
            "object": "response",
            "created_at": 0,
            "status": "in_progress",
            "error": null,
            "incomplete_details": null,
            "instructions": self.instructions,
            "metadata": {},
            "model": answer.model,
            "output": [],
            "parallel_tool_calls": false,
            "temperature": self.temperature,
            "tool_choice": "none",
            "tools": [],
            "top_p": self.top_p,
            "max_output_tokens": self.max_tokens,
            "text": { "format": self.format },
            "usage": null,
        })
    }
}

fn status(answer: &Answer) -> &'static str {
    if answer.is_cut {
        "incomplete"
    } else {
        "completed"
    }
}

/// Writes the only item of the output.
fn item(answer: &Answer) -> Value {
    let part = match &answer.content {
        Content::Text(text) => {
            json!({ "type": "output_text", "text": text, "annotations": [], "logprobs": [] })
        }
        Content::Refusal(why) => json!({ "type": "refusal", "refusal": why }),
    };
    json!({
        "type": "message",
        "id": answer.id("msg_"),
        "status": status(answer),
        "role": "assistant",
        "content": [part],
    })
}

//! Responses: reads requests, writes answers.

use super::content::{self, Address, Names};
use super::fields::{Fields, schema};
use super::refusal::Refusal;
use super::{Form, HARMLESS, answer};
use fab_model::{Message, Reply, Request, Speaker};
use serde_json::{Value, json};

const NAMES: Names = Names {
    text: &["input_text", "output_text", "text"],
    image: "input_image",
    address: Address::Plain,
};

/// The fields of a request that its answer echoes.
pub(super) struct Responses {
    instructions: Option<String>,
    format: Value,
}

impl Form for Responses {
    fn read(mut fields: Fields) -> Result<(Request, Responses), Refusal> {
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
            reasoning.finish(&[])?;
        }
        let mut format = json!({ "type": "text" });
        if let Some(text) = fields.take("text") {
            let mut text = Fields::of("text", text)?;
            if let Some(stated) = text.take("format") {
                request.schema = schema(Fields::of("text.format", stated.clone())?, None)?;
                format = stated;
            }
            text.only("verbosity", json!("medium"))?;
            text.finish(&[])?;
        }
        for (name, allowed) in [
            ("stream", json!(false)),
            ("background", json!(false)),
            ("truncation", json!("disabled")),
            ("tools", json!([])),
        ] {
            fields.only(name, allowed)?;
        }
        // It requests additional output, and a stand-in has none.
        fields.take("include");
        fields.finish(&HARMLESS)?;
        Ok((
            request,
            Responses {
                instructions,
                format,
            },
        ))
    }

    fn write(&self, request: &Request, reply: &Reply, model: &str) -> Value {
        let usage = answer::usage(request, reply);
        json!({
            "id": answer::id("resp_", request),
            "object": "response",
            "created_at": 0,
            "status": "completed",
            "error": null,
            "incomplete_details": null,
            "instructions": self.instructions,
            "metadata": {},
            "model": model,
            "output": [{
                "type": "message",
                "id": answer::id("msg_", request),
                "status": "completed",
                "role": "assistant",
                "content": [{ "type": "output_text", "text": reply.text, "annotations": [] }],
            }],
            "parallel_tool_calls": false,
            "temperature": request.temperature,
            "tool_choice": "none",
            "tools": [],
            "top_p": request.top_p,
            "max_output_tokens": request.max_tokens,
            "text": { "format": self.format },
            "usage": {
                "input_tokens": usage.input_tokens,
                "input_tokens_details": { "cached_tokens": usage.cached_input_tokens },
                "output_tokens": usage.output_tokens,
                "output_tokens_details": { "reasoning_tokens": usage.reasoning_tokens.unwrap_or(0) },
                "total_tokens": usage.input_tokens.saturating_add(usage.output_tokens),
            },
        })
    }
}

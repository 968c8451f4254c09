//! Chat Completions: reads requests, writes answers.

use super::content::{self, Address, Names};
use super::fields::{Fields, schema};
use super::refusal::Refusal;
use super::{Form, HARMLESS, answer};
use fab_model::{Reply, Request};
use serde_json::{Value, json};

const NAMES: Names = Names {
    text: &["text"],
    image: "image_url",
    address: Address::InObject,
};

/// A request for a chat completion.
pub(super) struct Chat;

impl Form for Chat {
    fn read(mut fields: Fields) -> Result<(Request, Chat), Refusal> {
        let Value::Array(turns) = fields.required("messages")? else {
            return Err(fields.wrong("messages", "is no list"));
        };
        let messages = content::turns(turns, "messages", &NAMES)?;
        let mut request = Request::new(content::role(&messages), messages);
        request.temperature = fields.number("temperature", 0.0, 2.0)?;
        request.top_p = fields.number("top_p", 0.0, 1.0)?;
        request.repetition = fields.whole("seed", 0)?.unwrap_or(0);
        let (old, new) = (
            fields.whole("max_tokens", 1)?,
            fields.whole("max_completion_tokens", 1)?,
        );
        if old.is_some() && new.is_some() && old != new {
            return Err(fields.wrong(
                "max_tokens",
                "and `max_completion_tokens` differ; say one of them",
            ));
        }
        request.max_tokens = new.or(old);
        request.reasoning = fields.level("reasoning_effort")?;
        if let Some(format) = fields.take("response_format") {
            request.schema = schema(Fields::of("response_format", format)?, Some("json_schema"))?;
        }
        for (name, allowed) in [
            ("stream", json!(false)),
            ("n", json!(1)),
            ("frequency_penalty", json!(0)),
            ("presence_penalty", json!(0)),
            ("logprobs", json!(false)),
            ("tools", json!([])),
            ("stop", json!([])),
            ("logit_bias", json!({})),
        ] {
            fields.only(name, allowed)?;
        }
        fields.finish(&HARMLESS)?;
        Ok((request, Chat))
    }

    fn write(&self, request: &Request, reply: &Reply, model: &str) -> Value {
        let usage = answer::usage(request, reply);
        json!({
            "id": answer::id("chatcmpl-", request),
            "object": "chat.completion",
            "created": 0,
            "model": model,
            "choices": [{
                "index": 0,
                "message": { "role": "assistant", "content": reply.text, "refusal": null, "annotations": [] },
                "logprobs": null,
                "finish_reason": "stop",
            }],
            "usage": {
                "prompt_tokens": usage.input_tokens,
                "completion_tokens": usage.output_tokens,
                "total_tokens": usage.input_tokens.saturating_add(usage.output_tokens),
                "prompt_tokens_details": { "cached_tokens": usage.cached_input_tokens },
                "completion_tokens_details": { "reasoning_tokens": usage.reasoning_tokens.unwrap_or(0) },
            },
        })
    }
}

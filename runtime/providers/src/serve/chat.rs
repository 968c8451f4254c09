//! Chat Completions: reads requests, writes answers, whole or in chunks.

use super::answer::{Answer, Content, pieces};
use super::content::{self, Address, Names};
use super::fields::Fields;
use super::format::Format;
use super::refusal::Refusal;
use super::{Asked, Form, HARMLESS, Sent};
use fab_model::Request;
use serde_json::{Value, json};
use std::iter::once;

const NAMES: Names = Names {
    text: &["text"],
    image: "image_url",
    address: Address::InObject,
};

/// A request for a chat completion.
pub(super) struct Chat {
    /// Whether a stream ends with its token counts.
    with_usage: bool,
}

impl Form for Chat {
    fn read(mut fields: Fields) -> Result<(Asked, Chat), Refusal> {
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
        let mut format = Format::default();
        if let Some(stated) = fields.take("response_format") {
            format = Format::read(Fields::of("response_format", stated)?, Some("json_schema"))?;
        }
        request.schema = format.stated.clone();
        let is_streamed = fields.switch("stream")?;
        let mut with_usage = false;
        if let Some(mut options) = fields.stream_options(is_streamed)? {
            with_usage = options.switch("include_usage")?;
            options.finish(&[])?;
        }
        for (name, allowed) in [
            ("n", json!(1)),
            ("frequency_penalty", json!(0)),
            ("presence_penalty", json!(0)),
            ("logprobs", json!(false)),
            ("top_logprobs", json!(0)),
            ("tools", json!([])),
            ("tool_choice", json!("none")),
            ("functions", json!([])),
            ("stop", json!([])),
            ("logit_bias", json!({})),
            ("modalities", json!(["text"])),
            ("verbosity", json!("medium")),
        ] {
            fields.only(name, allowed)?;
        }
        fields.finish(&HARMLESS)?;
        let asked = Asked {
            request,
            format,
            is_streamed,
        };
        Ok((asked, Chat { with_usage }))
    }

    fn whole(&self, answer: &Answer) -> Value {
        let (content, refusal) = match &answer.content {
            Content::Text(text) => (Some(text), None),
            Content::Refusal(why) => (None, Some(why)),
        };
        let message = json!({
            "role": "assistant",
            "content": content,
            "refusal": refusal,
            "annotations": [],
        });
        let mut whole = head(answer, "chat.completion");
        whole["choices"] = json!([{
            "index": 0,
            "message": message,
            "logprobs": null,
            "finish_reason": finish_reason(answer),
        }]);
        whole["usage"] = usage(answer);
        whole
    }

    fn events(self, answer: Answer) -> impl Iterator<Item = Sent> + Send + 'static {
        let chunk = head(&answer, "chat.completion.chunk");
        let end = finish_reason(&answer);
        let usage = usage(&answer);
        let (field, words) = match answer.content {
            Content::Text(text) => ("content", text),
            Content::Refusal(why) => ("refusal", why),
        };
        let first = json!({ "role": "assistant", field: "" });
        let deltas = once(first)
            .chain(pieces(words).map(move |piece| json!({ field: piece })))
            .map(|delta| (delta, Value::Null))
            .chain(once((json!({}), json!(end))));
        let choices = deltas.map(|(delta, end)| {
            json!([{ "index": 0, "delta": delta, "logprobs": null, "finish_reason": end }])
        });
        let choices = choices.map(|choices| (choices, Value::Null));
        // The counts come in a chunk of their own, which has no choice.
        let counts = self.with_usage.then(|| (json!([]), usage));
        let chunks = choices.chain(counts).map(move |(choices, usage)| {
            let mut chunk = chunk.clone();
            chunk["choices"] = choices;
            if self.with_usage {
                chunk["usage"] = usage;
            }
            Sent::data(&chunk)
        });
        chunks.chain(once(Sent::end()))
    }
}

fn head(answer: &Answer, object: &str) -> Value {
    json!({
        "id": answer.id("chatcmpl-"),
        "object": object,
        "created": 0,
        "model": answer.model,
    })
}

fn finish_reason(answer: &Answer) -> &'static str {
    if answer.is_cut { "length" } else { "stop" }
}

fn usage(answer: &Answer) -> Value {
    let usage = &answer.usage;
    json!({
        "prompt_tokens": usage.input_tokens,
        "completion_tokens": usage.output_tokens,
        "total_tokens": usage.input_tokens.saturating_add(usage.output_tokens),
        "prompt_tokens_details": { "cached_tokens": usage.cached_input_tokens },
        "completion_tokens_details": { "reasoning_tokens": usage.reasoning_tokens.unwrap_or(0) },
    })
}

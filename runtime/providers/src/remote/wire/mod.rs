//! The four wire formats of providers, one file each.
//!
//! In: a [`Request`] and [`Settings`]; the bytes of a reply with status 200. Out: the bytes to send; an [`Answer`], or
//! a [`Failure`] by name. `remote` handles sending, status codes and retries.

mod anthropic;
mod content;
pub(super) mod error;
mod gemini;
mod openai_chat;
mod openai_responses;
mod reasoning;

use super::settings::{Lengths, Parameter, Settings};
use crate::catalogue::{Accepted, Wire};
use fab_model::calls::{Fault, Usage};
use fab_model::{Part, Reasoning, Request, Speaker};
use serde::{Deserialize, Serialize};
use serde_json::error::Category;
use serde_json::{Map, Value};

/// An encoded question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Encoded {
    /// The body, JSON.
    pub body: Vec<u8>,
    /// Headers other than the key's and the content type.
    pub headers: Vec<(&'static str, &'static str)>,
}

/// The contents of an answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// The model's text, never empty.
    pub text: String,
    /// Usage as reported by the provider.
    pub usage: Option<Usage>,
}

/// Why a reply is not an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What went wrong.
    pub fault: Fault,
    /// The failure in words.
    pub why: String,
    /// Usage as reported by the provider, even without an answer.
    pub usage: Option<Usage>,
    /// The visible part of an answer that was cut off at its longest length.
    pub cut_text: Option<String>,
}

impl Wire {
    /// Encodes a request with an answer of these lengths; equal requests give equal bytes.
    ///
    /// Fails if the model is known not to support something in the request.
    pub fn encode(
        self,
        request: &Request,
        settings: &Settings,
        lengths: Lengths,
    ) -> Result<Encoded, String> {
        let sent = Sent::of(request, settings, lengths)?;
        let (model, messages) = (settings.profile.id.as_str(), &request.messages);
        let facts = &settings.profile.facts;
        let mut headers = Vec::new();
        let body = match self {
            Wire::OpenaiResponses => openai_responses::body(model, messages, sent)?,
            Wire::OpenaiChat => {
                let field = settings.profile.reasoning().tokens_field;
                openai_chat::body(model, messages, sent, facts, field.as_deref())?
            }
            Wire::Anthropic => {
                headers.push(("anthropic-version", anthropic::version(&sent)));
                anthropic::body(model, messages, sent)?
            }
            Wire::Gemini => gemini::body(messages, sent)?,
        };
        let body = body.to_string().into_bytes();
        Ok(Encoded { body, headers })
    }

    /// Decodes a reply with status 200.
    pub fn decode(self, bytes: &[u8]) -> Result<Answer, Failure> {
        match self {
            Wire::OpenaiResponses => openai_responses::decode(bytes),
            Wire::OpenaiChat => openai_chat::decode(bytes),
            Wire::Anthropic => anthropic::decode(bytes),
            Wire::Gemini => gemini::decode(bytes),
        }
    }

    /// Returns the header that carries a key, and the prefix of its value.
    pub(super) fn key_header(self) -> (&'static str, &'static str) {
        match self {
            Wire::OpenaiResponses | Wire::OpenaiChat => ("authorization", "Bearer "),
            Wire::Anthropic => ("x-api-key", ""),
            Wire::Gemini => ("x-goog-api-key", ""),
        }
    }

    /// Returns the header that a call without a question needs.
    pub(super) fn version_header(self) -> Option<(&'static str, &'static str)> {
        match self {
            Wire::Anthropic => Some(("anthropic-version", anthropic::OLDER_VERSION)),
            _ => None,
        }
    }

    /// Returns the version segment for addresses whose base URL names none.
    pub(super) fn version_segment(self) -> &'static str {
        match self {
            Wire::Gemini => "v1beta",
            _ => "v1",
        }
    }

    /// Returns the path below the base URL.
    pub(super) fn path(self, model: &str) -> Vec<String> {
        match self {
            Wire::OpenaiResponses => vec!["responses".to_owned()],
            Wire::OpenaiChat => vec!["chat".to_owned(), "completions".to_owned()],
            Wire::Anthropic => vec!["messages".to_owned()],
            Wire::Gemini => vec!["models".to_owned(), format!("{model}:generateContent")],
        }
    }
}

/// The request's settings that are sent.
struct Sent {
    temperature: Option<f64>,
    top_p: Option<f64>,
    max_tokens: Option<u32>,
    reasoning: Option<Reasoning>,
    schema: Option<Value>,
}

impl Sent {
    fn of(request: &Request, settings: &Settings, lengths: Lengths) -> Result<Sent, String> {
        let facts = &settings.profile.facts;
        let sampling = |value: Option<f64>, parameter: Parameter, accepted: &Option<Accepted>| {
            let Some(value) = value.filter(|_| settings.sends(parameter)) else {
                return Ok(None);
            };
            let takes = |accepted: &Accepted| accepted.takes(value);
            if value.is_finite() && accepted.as_ref().is_none_or(takes) {
                return Ok(Some(value));
            }
            let name = parameter.name();
            let accepts = accepted
                .as_ref()
                .map_or("a finite number".to_owned(), Accepted::to_string);
            Err(format!(
                "the stage states `{name}` {value}, and it accepts {accepts}; state that, or leave it out with `--omit {name}`"
            ))
        };
        if { request.messages.iter() }.all(|message| message.speaker == Speaker::System) {
            return Err("the request asks nothing".to_owned());
        }
        let mut parts = request.messages.iter().flat_map(|message| &message.parts);
        if facts.vision == Some(false) && parts.any(|part| matches!(part, Part::Image(_))) {
            return Err("the request holds a picture, and it takes text alone".to_owned());
        }
        let is_structured =
            facts.structured_output != Some(false) && settings.sends(Parameter::Schema);
        let schema = request.schema.as_ref().filter(|_| is_structured);
        let wire = settings.profile.provider.wire;
        Ok(Sent {
            temperature: sampling(
                request.temperature,
                Parameter::Temperature,
                &facts.temperature,
            )?,
            top_p: sampling(request.top_p, Parameter::TopP, &facts.top_p)?,
            max_tokens: lengths.sent(),
            reasoning: reasoning::sent(request, settings)?,
            schema: schema.map(|schema| accepted_schema(wire, schema)),
        })
    }
}

/// Returns a schema with the keywords that an interface accepts.
///
/// Anthropic answers 400 to bounds of lengths. Gemini's `responseJsonSchema` knows neither these nor patterns, and has an
/// order of its own for what it writes.
fn accepted_schema(wire: Wire, schema: &Value) -> Value {
    let mut schema = schema.clone();
    let unknown: &[&str] = match wire {
        Wire::OpenaiResponses | Wire::OpenaiChat => return schema,
        Wire::Anthropic => &["maxLength"],
        Wire::Gemini => &["maxLength", "pattern"],
    };
    let properties = schema["properties"].as_object_mut().into_iter().flatten();
    for property in properties.filter_map(|(_, property)| property.as_object_mut()) {
        property.retain(|keyword, _| !unknown.contains(&keyword.as_str()));
    }
    if wire == Wire::Gemini {
        schema["propertyOrdering"] = schema["required"].clone();
    }
    schema
}

impl Failure {
    fn new(fault: Fault, why: impl Into<String>, usage: Option<Usage>) -> Failure {
        Failure {
            fault,
            why: why.into(),
            usage,
            cut_text: None,
        }
    }
}

/// Reads the usage of OpenAI's two formats, whose names begin otherwise.
///
/// Hidden tokens are added where a server counts them beside those of the answer, and not in them. That is certain if there
/// are more of them, or if only then the sum is the reported total.
fn openai_usage(bill: &Value, [input, output]: [&str; 2]) -> Option<Usage> {
    let count = |name: String| count(bill, &name);
    let input_tokens = count(format!("/{input}_tokens"))??;
    let visible = count(format!("/{output}_tokens"))??;
    let reasoning_tokens = count(format!("/{output}_tokens_details/reasoning_tokens"))?;
    let total = count("/total_tokens".to_owned())?;
    let hidden = reasoning_tokens.unwrap_or(0);
    let both = visible.saturating_add(hidden);
    let is_total = total.is_some() && total == input_tokens.checked_add(both);
    let are_beside = hidden > visible || hidden > 0 && is_total;
    let cached = count(format!("/{input}_tokens_details/cached_tokens"))?;
    Some(Usage {
        input_tokens,
        cached_input_tokens: cached.unwrap_or(0),
        output_tokens: if are_beside { both } else { visible },
        reasoning_tokens,
    })
}

/// Returns a number of a bill, which may be absent. The outer `None` is a malformed one, after which nothing in the bill
/// is believed: a count that is taken for zero would let a cap on the cost be passed.
fn count(bill: &Value, pointer: &str) -> Option<Option<u64>> {
    match bill.pointer(pointer) {
        None | Some(Value::Null) => Some(None),
        Some(number) => number.as_u64().map(Some),
    }
}

/// The end of a reply: what the model wrote, and why it stopped.
#[derive(Default)]
struct Ending<'r> {
    text: String,
    /// The interface's word for the end.
    reason: Option<&'r str>,
    /// The provider's own words about it.
    explanation: Option<&'r str>,
    /// A field beside the answer with the text of its reasoning.
    reasoning: Option<(&'static str, &'r str)>,
}

impl Ending<'_> {
    /// Makes the answer. Only words for a cut or a refusal stop a text from being read, since it is paid for.
    fn answer(self, usage: Option<Usage>) -> Result<Answer, Failure> {
        let is_blank = self.text.trim().is_empty();
        let hidden = usage.and_then(|usage| usage.reasoning_tokens);
        let reasoning = self.reasoning.filter(|(_, text)| !text.trim().is_empty());
        // An answer of hidden reasoning alone was cut off.
        let is_hidden = is_blank && reasoning.is_none() && hidden > Some(0);
        let fault = self.reason.and_then(fault_of_end);
        let fault = fault.or(is_hidden.then_some(Fault::Truncated));
        let why = match (fault, self.reason) {
            (None, _) if !is_blank => {
                return Ok(Answer {
                    text: self.text,
                    usage,
                });
            }
            (None, None) => "the answer is empty".to_owned(),
            (None, Some(reason)) => {
                let reason = error::repeated(reason);
                format!("the answer is empty, and ended with `{reason}`")
            }
            (_, Some("model_context_window_exceeded")) => {
                "the model's context window was full before the answer was whole".to_owned()
            }
            (Some(Fault::Truncated), _) => {
                "the answer was cut off at its longest length".to_owned()
            }
            (Some(Fault::Refused), _) => match self.explanation {
                Some(words) => error::repeated(words),
                None => "the model declined to answer".to_owned(),
            },
            (_, reason) => {
                let words = error::repeated(self.explanation.unwrap_or_default());
                let reason = error::repeated(reason.unwrap_or_default());
                format!("the answer stopped for `{reason}` {words}")
                    .trim_end()
                    .to_owned()
            }
        };
        let fault = fault.unwrap_or(Fault::InvalidReply);
        let is_cut = fault == Fault::Truncated && !why.contains("context window");
        let mut failure = Failure::new(fault, why, usage);
        if let Some((field, text)) = reasoning.filter(|_| is_blank) {
            let text = error::repeated(text);
            failure
                .why
                .push_str(&format!("; `{field}` holds: `{text}`"));
        }
        failure.cut_text = is_cut.then_some(self.text);
        Err(failure)
    }
}

/// The words for an end that leaves no whole answer.
const ENDS: [(Fault, &str); 5] = [
    (
        Fault::Truncated,
        "length max_tokens max_output_tokens model_length continuation incomplete model_context_window_exceeded",
    ),
    (Fault::Refused, "refusal"),
    (
        Fault::ContentFiltered,
        "content_filter safety recitation language blocklist prohibited_content spii image_safety \
         image_prohibited_content image_recitation escalation model_armor guardrail_intervened",
    ),
    (Fault::ServerFailed, "error abort failed cancelled"),
    (Fault::NotAuthorised, "pup_limited_disabled"),
];

/// Returns the fault of an end that leaves no whole answer; `None` for every other word, known or not.
fn fault_of_end(reason: &str) -> Option<Fault> {
    let is_it = |word: &str| word.eq_ignore_ascii_case(reason);
    let found = ENDS.iter().find(|(_, words)| words.split(' ').any(is_it));
    found.map(|(fault, _)| *fault)
}

/// Reads a reply with status 200.
fn read(bytes: &[u8]) -> Result<Value, Failure> {
    let read = serde_json::from_slice::<Map<String, Value>>(bytes);
    read.map(Value::from).map_err(|error| {
        // The parser's own message may quote its input at any length.
        let why = match error.classify() {
            Category::Data => "the reply has another form than the interface promises",
            Category::Eof if error.column() == 0 => "the reply is empty",
            Category::Eof => "the reply is not complete JSON",
            Category::Syntax | Category::Io => "the reply is not JSON",
        };
        Failure::new(Fault::InvalidReply, why, None)
    })
}

/// Returns the elements of a list; none if it is something else.
fn elements(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

#[cfg(test)]
#[path = "../tests/wire/mod.rs"]
mod tests;

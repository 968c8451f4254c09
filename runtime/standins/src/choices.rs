//! The choices that a request offers: the values of each field, from its schema.
//!
//! In: a [`Request`]. Out: the fields in the schema's order. For stand-ins that look at nothing but the offered
//! choices.

use fab_model::{Part, Request, Speaker};
use fab_program::PixelPoint;
use serde_json::{Map, Value};

/// A field of an answer and its permitted values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    /// In the notation of answers; empty if the schema gives a pattern.
    pub values: Vec<String>,
}

/// Returns the fields of an action; empty if the request does not ask for one.
pub(super) fn fields(request: &Request) -> Vec<Field> {
    let chosen = properties(request).filter(|(_, property)| !is_free_text(property));
    let fields = chosen.map(|(name, property)| {
        let values = property["enum"].as_array().into_iter().flatten();
        Field {
            name: name.clone(),
            values: values
                .filter_map(|value| value.as_str().map(str::to_owned))
                .collect(),
        }
    });
    fields.collect()
}

/// Writes an answer as the JSON object that the schema describes, with words without content where it wants text.
pub(super) fn answer(request: &Request, values: Vec<(String, String)>) -> String {
    let texts = properties(request).filter(|(_, property)| is_free_text(property));
    let texts = texts.map(|(name, _)| (name.clone(), "I look at nothing.".to_owned()));
    let object: Map<String, Value> = values
        .into_iter()
        .chain(texts)
        .map(|(name, value)| (name, Value::String(value)))
        .collect();
    Value::Object(object).to_string()
}

fn properties(request: &Request) -> impl Iterator<Item = (&String, &Value)> {
    let schema = request.schema.as_ref();
    let properties = schema.and_then(|schema| schema["properties"].as_object());
    properties.into_iter().flatten()
}

/// Returns whether a property takes any text, such as a reason.
fn is_free_text(property: &Value) -> bool {
    property["enum"].is_null() && property["pattern"].is_null()
}

/// Reads `(x, y)`, integer pixels.
pub(super) fn point(text: &str) -> Option<PixelPoint> {
    let inside = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    let (u, v) = inside.split_once(',')?;
    Some(PixelPoint {
        u: u.trim().parse().ok()?,
        v: v.trim().parse().ok()?,
    })
}

/// Returns the text of the user's last turn; empty if there is none.
pub(super) fn last_asked(request: &Request) -> String {
    let mut users = request.messages.iter().rev();
    let Some(last) = users.find(|message| message.speaker == Speaker::User) else {
        return String::new();
    };
    let texts = last.parts.iter().filter_map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    texts.collect::<Vec<_>>().join("\n")
}

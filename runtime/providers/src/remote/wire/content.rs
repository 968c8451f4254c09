//! Common parts of the four wire formats: where pictures and system prompts may appear.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::{Message, Part, Png, Speaker};
use serde_json::{Value, json};

/// Separates texts that are joined into one string.
pub(super) const BETWEEN: &str = "\n\n";

/// Makes a turn in the formats that name a role beside the content; `asked` writes the content of a user's.
pub(super) fn turn(
    message: &Message,
    asked: impl FnOnce(&Message) -> Value,
) -> Result<Value, String> {
    Ok(match message.speaker {
        Speaker::System => json!({ "role": "system", "content": words(message)? }),
        Speaker::Assistant => json!({ "role": "assistant", "content": words(message)? }),
        Speaker::User => json!({ "role": "user", "content": asked(message) }),
    })
}

/// Returns an object without those of its fields that are `null`.
pub(super) fn stated(mut object: Value) -> Value {
    if let Some(fields) = object.as_object_mut() {
        fields.retain(|_, value| !value.is_null());
    }
    object
}

/// Returns the bytes of a picture in base64.
pub(super) fn base64(png: &Png) -> String {
    STANDARD.encode(png.bytes())
}

/// Returns a picture as a `data:` URL.
pub(super) fn data_url(png: &Png) -> String {
    format!("data:image/png;base64,{}", base64(png))
}

/// Returns the joined texts of a turn that may not have pictures.
pub(super) fn words(message: &Message) -> Result<String, String> {
    let texts = message.parts.iter().map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    let texts = texts.collect::<Option<Vec<_>>>().ok_or_else(|| {
        let speaker = match message.speaker {
            Speaker::System => "the system",
            Speaker::User => "the user",
            Speaker::Assistant => "the model",
        };
        format!("there is a picture in a turn of {speaker}, and only the user's can hold one")
    })?;
    Ok(texts.join(BETWEEN))
}

/// Splits a conversation into system prompt and turns, for formats with a separate place for it.
///
/// Fails if a system prompt appears among the turns.
pub(super) fn framed(messages: &[Message]) -> Result<(Option<String>, &[Message]), String> {
    let is_frame = |message: &Message| message.speaker == Speaker::System;
    let first_turn = messages.iter().position(|message| !is_frame(message));
    let (frame, turns) = messages.split_at(first_turn.unwrap_or(messages.len()));
    if turns.iter().any(is_frame) {
        return Err("there is a system message after the first question, and its interface has no place for it".to_owned());
    }
    let texts = frame.iter().map(words).collect::<Result<Vec<_>, _>>()?;
    let frame = (!texts.is_empty()).then(|| texts.join(BETWEEN));
    Ok((frame, turns))
}

//! Reads conversation turns: speaker, text, pictures.

use super::fields::Fields;
use super::picture::Pictures;
use super::refusal::Refusal;
use fab_model::{Message, ModelRole, Part, Speaker};
use serde_json::Value;

/// The most turns of a conversation.
const MAX_TURNS: usize = 1000;

/// The names of content types in one of the two formats.
pub(super) struct Names {
    /// Types of a text.
    pub text: &'static [&'static str],
    /// The type of a picture.
    pub image: &'static str,
    /// Whether a picture's address is in an object of its own.
    pub address: Address,
}

/// Where a picture's address is.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Address {
    /// `"image_url": {"url": "data:…"}`.
    InObject,
    /// `"image_url": "data:…"`.
    Plain,
}

/// Reads all turns; `path` names the list in refusals.
pub(super) fn turns(turns: Vec<Value>, path: &str, names: &Names) -> Result<Vec<Message>, Refusal> {
    if turns.is_empty() || turns.len() > MAX_TURNS {
        let message = format!(
            "`{path}` has {} turns; 1 to {MAX_TURNS} are taken",
            turns.len()
        );
        return Err(Refusal::of(path, message));
    }
    let pictures = Pictures::default();
    let turns = turns.into_iter().enumerate().map(|(number, turn)| {
        let turn = Fields::of(format!("{path}[{number}]"), turn)?;
        self::turn(turn, names, &pictures)
    });
    turns.collect()
}

fn turn(mut turn: Fields, names: &Names, pictures: &Pictures) -> Result<Message, Refusal> {
    turn.only("type", "message".into())?;
    let role = turn.text("role")?;
    let speaker = match role.as_str() {
        "system" | "developer" => Speaker::System,
        "user" => Speaker::User,
        "assistant" => Speaker::Assistant,
        _ => return Err(turn.wrong("role", "must be system, developer, user or assistant")),
    };
    let path = turn.path("content");
    let refusal = turn.take("refusal");
    let content = match (turn.take("content"), refusal) {
        // Clients echo answers, and one that was refused has no other content.
        (None, Some(refusal)) => refusal,
        (Some(content), _) => content,
        (None, None) => turn.required("content")?,
    };
    let parts = match content {
        Value::String(text) => vec![Part::Text(text)],
        Value::Array(parts) => {
            let parts = parts.into_iter().enumerate();
            let read = parts.map(|(number, part)| {
                let part = Fields::of(format!("{path}[{number}]"), part)?;
                self::part(part, names, pictures)
            });
            read.collect::<Result<_, _>>()?
        }
        _ => return Err(turn.wrong("content", "is neither a string nor a list")),
    };
    // Clients echo this field from answers; it carries no information.
    turn.only("tool_calls", Value::Array(Vec::new()))?;
    turn.finish(&["name", "id", "status", "annotations"])?;
    Ok(Message { speaker, parts })
}

fn part(mut part: Fields, names: &Names, pictures: &Pictures) -> Result<Part, Refusal> {
    let kind = part.text("type")?;
    let is_text = names.text.contains(&kind.as_str());
    if is_text || kind == "refusal" {
        let text = part.text(if is_text { "text" } else { "refusal" })?;
        part.finish(&["annotations", "logprobs"])?;
        return Ok(Part::Text(text));
    }
    if kind != names.image {
        return Err(part.wrong(
            "type",
            &format!("is neither {} nor {}", names.text.join(", "), names.image),
        ));
    }
    let path = part.path("image_url");
    let address = match (names.address, part.required("image_url")?) {
        (Address::Plain, Value::String(address)) => address,
        (Address::InObject, value @ Value::Object(_)) => {
            let mut inner = Fields::of(path.as_str(), value)?;
            let address = inner.text("url")?;
            inner.finish(&["detail"])?;
            address
        }
        _ => return Err(part.wrong("image_url", "has another form here")),
    };
    part.finish(&["detail"])?;
    pictures.decode(&address, &path).map(Part::Image)
}

/// Returns the role that a conversation asks for: vision if it has a picture.
pub(super) fn role(messages: &[Message]) -> ModelRole {
    let mut parts = messages.iter().flat_map(|message| &message.parts);
    if parts.any(|part| matches!(part, Part::Image(_))) {
        ModelRole::Vision
    } else {
        ModelRole::Text
    }
}

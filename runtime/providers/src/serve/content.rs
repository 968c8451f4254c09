//! Reads conversation turns: speaker, text, pictures.

use super::fields::Fields;
use super::refusal::Refusal;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use fab_model::{Message, ModelRole, Part, Png, Speaker};
use fab_picture::png;
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
    let turns = turns.into_iter().enumerate();
    turns
        .map(|(number, turn)| self::turn(Fields::of(format!("{path}[{number}]"), turn)?, names))
        .collect()
}

fn turn(mut turn: Fields, names: &Names) -> Result<Message, Refusal> {
    turn.only("type", "message".into())?;
    let role = turn.text("role")?;
    let speaker = match role.as_str() {
        "system" | "developer" => Speaker::System,
        "user" => Speaker::User,
        "assistant" => Speaker::Assistant,
        _ => return Err(turn.wrong("role", "must be system, developer, user or assistant")),
    };
    let path = turn.path("content");
    let parts = match turn.required("content")? {
        Value::String(text) => vec![Part::Text(text)],
        Value::Array(parts) => {
            let parts = parts.into_iter().enumerate();
            let read = parts.map(|(number, part)| {
                self::part(Fields::of(format!("{path}[{number}]"), part)?, names)
            });
            read.collect::<Result<_, _>>()?
        }
        _ => return Err(turn.wrong("content", "is neither a string nor a list")),
    };
    // Clients echo this field from answers; it carries no information.
    turn.only("tool_calls", Value::Array(Vec::new()))?;
    turn.finish(&["name", "id", "status", "refusal", "annotations"])?;
    Ok(Message { speaker, parts })
}

fn part(mut part: Fields, names: &Names) -> Result<Part, Refusal> {
    let kind = part.text("type")?;
    if names.text.contains(&kind.as_str()) {
        let text = part.text("text")?;
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
    png(&address, &path).map(Part::Image)
}

/// Decodes a picture from a `data:` address.
fn png(address: &str, path: &str) -> Result<Png, Refusal> {
    const START: &str = "data:image/png;base64,";
    let wrong = |why: &str| Refusal::of(path, format!("`{path}` {why}"));
    let is_data = address
        .get(..5)
        .is_some_and(|start| start.eq_ignore_ascii_case("data:"));
    if !is_data {
        return Err(wrong(
            "leads elsewhere, and nothing is fetched: send the PNG as a data: URL in base64",
        ));
    }
    let encoded = match address.split_at_checked(START.len()) {
        Some((start, encoded)) if start.eq_ignore_ascii_case(START) => encoded,
        _ => {
            return Err(wrong(
                "is not a PNG in base64; it must begin with `data:image/png;base64,`",
            ));
        }
    };
    let bytes = STANDARD
        .decode(encoded)
        .map_err(|_| wrong("is not base64"))?;
    match png::size(&bytes) {
        Some([width, height]) if width.max(height) <= png::MAX_SIDE_PX => Ok(Png::new(bytes)),
        Some([width, height]) => {
            let most = png::MAX_SIDE_PX;
            Err(wrong(&format!(
                "is {width} by {height} pixels; at most {most} by {most} are taken"
            )))
        }
        None => Err(wrong("is not a PNG picture")),
    }
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

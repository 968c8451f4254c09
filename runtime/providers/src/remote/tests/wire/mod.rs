//! Tests of the four wire formats: what is sent, what is read, and that no input makes the reader panic.

mod replies;
mod requests;

use super::*;
use crate::catalogue::Facts;
use crate::remote::BaseUrl;
use fab_model::{Message, ModelRole, Part, Png, Speaker};

fn settings(wire: Wire) -> Settings {
    let base = BaseUrl::parse("http://localhost:1").expect("a base URL");
    Settings::new("provider", "a-model", wire, base)
}

fn knowing(wire: Wire, facts: Facts) -> Settings {
    let mut settings = settings(wire);
    settings.profile.facts = facts;
    settings
}

/// A conversation with a system prompt, a picture, an answer and a correction.
fn request() -> Request {
    let question = Message {
        speaker: Speaker::User,
        parts: vec![
            Part::Text("fold".to_owned()),
            Part::Image(Png::new(vec![1, 2, 3])),
            Part::Text("it".to_owned()),
        ],
    };
    let messages = vec![
        Message::text(Speaker::System, "You fold."),
        question,
        Message::text(Speaker::Assistant, "how?"),
        Message::text(Speaker::User, "so"),
    ];
    Request::new(ModelRole::Vision, messages)
}

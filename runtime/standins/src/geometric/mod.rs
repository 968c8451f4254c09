//! `geometric`: an offline stand-in for a vision-language model.
//!
//! In: the same [`Request`] that a remote model would get, and nothing else. Out: a [`Reply`] in the form that the
//! prompt asks for. With pictures, it describes their step in words; without, it reads such words and a list of points
//! and picks two of them. It is a program about outlines and rectangles, not a model: it is called a stand-in wherever
//! its results appear, and its scores say nothing about models.
//!
//! It knows no task. If it cannot understand a prompt, it answers with words that hold no instruction and no point,
//! which the caller reports like any other unusable answer. An answer states a pick point with a place point, or with a
//! direction and a distance, and nothing else that a prompt may ask for.

mod decision;
mod frame;
mod instruction;
mod plan;
mod prompt;
mod see;
mod smooth;

#[cfg(test)]
mod tests;

pub(crate) use decision::{Action, Decision, End};
use fab_model::calls::Calls;
use fab_model::{Message, Model, ModelError, ModelKind, Part, Reply, Request};
pub(crate) use prompt::{Choice, points};

/// The stand-in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geometric;

impl Model for Geometric {
    fn name(&self) -> &str {
        "geometric"
    }

    fn nature(&self) -> ModelKind {
        ModelKind::StandIn
    }

    fn varies(&self) -> bool {
        false
    }

    fn ask(&self, request: &Request, _: &mut dyn Calls) -> Result<Reply, ModelError> {
        let asked = all_words(&request.messages);
        let answer = answer(request).map(|decision| decision.worded(&asked));
        Ok(Reply::text(answer.unwrap_or_else(|words| words)))
    }
}

/// Answers a question: with an action before it is put into words, or with words alone.
pub(crate) fn answer(request: &Request) -> Result<Decision, String> {
    let messages = &request.messages;
    let asked = all_words(messages);
    let (decided, what) = if smooth::is_asked(&asked) {
        (smooth::choose(messages), "a pull")
    } else if let Some(description) = see::describe(messages) {
        return Err(description);
    } else {
        (plan::choose(messages), "points")
    };
    decided.map_err(|why| format!("I cannot choose {what}: {why}."))
}

/// The text of a message, one part per line.
pub(crate) fn spoken(message: &Message) -> String {
    let texts = message.parts.iter().filter_map(|part| match part {
        Part::Text(text) => Some(text.as_str()),
        Part::Image(_) => None,
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// The text of all messages.
pub(crate) fn all_words(messages: &[Message]) -> String {
    let texts: Vec<String> = messages.iter().map(spoken).collect();
    texts.join("\n")
}

/// The encoded pictures of a message.
pub(crate) fn pictures(message: &Message) -> Vec<&[u8]> {
    let pictures = message.parts.iter().filter_map(|part| match part {
        Part::Image(png) => Some(png.bytes()),
        Part::Text(_) => None,
    });
    pictures.collect()
}

//! The messages of a stage: their text, its origin, and the form sent to a model.
//!
//! In: a program, known values, available pictures. Out: a [`Conversation`]. Its `spoken` side has the source file and
//! line of every piece of text; its `messages` side is what is sent: the same texts, and the pictures in the model's
//! size. `fabc render`, `fabc snap` and rollouts all call this, so they show and send the same messages.

use crate::demos::DemosError;
use crate::examples::{AnsweredExample, Examples};
use crate::pictures::Pictures;
use fab_model::{Lowering, Message, Part, Png, Speaker};
use fab_program::render::{
    self, NUMBERED_POINTS, PromptPicture, PromptSpeaker, PromptText, RenderError, Values,
};
use fab_program::{Picture, Program, Stage};

/// Why the messages of a stage cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PromptError {
    /// A template and its values do not match, or the stage does not support the model's point convention.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The demonstrations cannot be shown.
    #[error(transparent)]
    Demos(#[from] DemosError),
}

/// One message, before its pictures are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UndrawnMessage {
    /// Who speaks.
    pub speaker: Speaker,
    /// Its pieces, in order.
    pub parts: Vec<MessagePart>,
}

/// A piece of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MessagePart {
    /// Text with its source positions.
    Text(PromptText),
    /// A picture that the task shows.
    Picture(PromptPicture),
    /// The refused action, drawn on the stage's picture.
    RefusedAction,
    /// What would come of an answer, as a twin shows it.
    Prediction,
}

/// The messages of a stage, in both forms, message by message.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    /// The messages with their origin.
    pub spoken: Vec<UndrawnMessage>,
    /// The messages as sent.
    pub messages: Vec<Message>,
}

impl Conversation {
    /// Adds a text-only message.
    pub(super) fn say(&mut self, speaker: Speaker, said: PromptText) {
        self.messages
            .push(Message::text(speaker, said.text.clone()));
        self.spoken.push(UndrawnMessage {
            speaker,
            parts: vec![MessagePart::Text(said)],
        });
    }

    /// Adds a text to the last message.
    pub(super) fn add(&mut self, said: PromptText) {
        if let (Some(spoken), Some(message)) = (self.spoken.last_mut(), self.messages.last_mut()) {
            message.parts.push(Part::Text(said.text.clone()));
            spoken.parts.push(MessagePart::Text(said));
        }
    }

    /// Adds the picture of the refused action to the last message.
    pub(super) fn add_refused_action(&mut self, png: Png) {
        self.add_picture(MessagePart::RefusedAction, png);
    }

    /// Adds the picture of what would come of an answer to the last message.
    pub(super) fn add_prediction(&mut self, png: Png) {
        self.add_picture(MessagePart::Prediction, png);
    }

    fn add_picture(&mut self, part: MessagePart, png: Png) {
        if let (Some(spoken), Some(message)) = (self.spoken.last_mut(), self.messages.last_mut()) {
            message.parts.push(Part::Image(png));
            spoken.parts.push(part);
        }
    }
}

/// Renders the opening messages of a stage, with placeholders for its pictures.
///
/// - `values`: known values, with the model's point notation.
/// - `step`: from 1; selects the demonstrations, which come just before the question.
pub fn opening(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    examples: &Examples,
    step: u32,
) -> Result<Vec<UndrawnMessage>, PromptError> {
    let notation = values.notation(program);
    let mut spoken = Vec::new();
    for prompt in render::messages(program, stage, values)? {
        let speaker = match prompt.speaker {
            PromptSpeaker::System => Speaker::System,
            PromptSpeaker::User => Speaker::User,
            PromptSpeaker::Assistant => Speaker::Assistant,
        };
        let is_scene = |picture: &PromptPicture| {
            matches!(picture, PromptPicture::Drawn(Picture::Scene { .. }))
        };
        let is_numbered = !notation.marks().is_empty() && prompt.pictures.iter().any(is_scene);
        let mut parts = vec![MessagePart::Text(prompt.content)];
        parts.extend(prompt.pictures.into_iter().map(MessagePart::Picture));
        if is_numbered {
            parts.push(MessagePart::Text(PromptText::by_fabc(NUMBERED_POINTS)));
        }
        spoken.push(UndrawnMessage { speaker, parts });
    }
    let question = spoken.len().saturating_sub(1);
    let answered =
        examples.answered_examples(program, &stage.name, step, values.pointing(program))?;
    let answered = answered
        .into_iter()
        .flat_map(|AnsweredExample { question, answer }| {
            let turn = |speaker, said| UndrawnMessage {
                speaker,
                parts: vec![MessagePart::Text(said)],
            };
            [
                turn(Speaker::User, question),
                turn(Speaker::Assistant, answer),
            ]
        });
    spoken.splice(question..question, answered);
    Ok(spoken)
}

/// Renders the opening messages of a stage as sent to a model with this lowering.
///
/// - `values`: known values; points are written as the lowering says, whatever `values` says about them.
pub fn conversation(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    pictures: &Pictures,
    step: u32,
    lowering: &Lowering,
) -> Result<Conversation, PromptError> {
    let values = values.with_pointing(lowering.pointing(pictures.size()));
    let notation = values.notation(program);
    let spoken = opening(program, stage, values, &pictures.examples, step)?;
    let drawn = |picture: &PromptPicture| {
        let found = pictures.png(picture, lowering, &notation);
        found.ok_or_else(|| RenderError::MissingFact {
            name: format!("{picture:?}"),
        })
    };
    let mut messages = Vec::with_capacity(spoken.len());
    for UndrawnMessage { speaker, parts } in &spoken {
        let mut sent = Vec::with_capacity(parts.len());
        for part in parts {
            match part {
                MessagePart::Text(said) => sent.push(Part::Text(said.text.clone())),
                MessagePart::Picture(picture) => sent.push(Part::Image(drawn(picture)?)),
                MessagePart::RefusedAction | MessagePart::Prediction => {}
            }
        }
        messages.push(Message {
            speaker: *speaker,
            parts: sent,
        });
    }
    Ok(Conversation { spoken, messages })
}

//! The messages of a stage: what is said, where it comes from, and what a model is sent.
//!
//! In: a program, what is known, what can be shown. Out: a [`Conversation`], whose `spoken` side says of every stretch
//! which file and line it comes from, and whose `messages` side is what is sent: the same texts, and the pictures in
//! the model's size. `fabc render` and `fabc snap` show what a rollout sends because all of them call this.

use crate::demos::DemosError;
use crate::examples::{Examples, Told};
use crate::pictures::Pictures;
use fab_model::{Lowering, Message, Part, Png, Speaker};
use fab_program::render::{
    self, NUMBERED_POINTS, PromptPicture, PromptSpeaker, PromptText, RenderError, Values,
};
use fab_program::{Picture, Program, Stage};

/// Why the messages of a stage cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PromptError {
    /// A template and its values do not fit, or the stage cannot be asked of a model that writes points so.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The demonstrations cannot be told.
    #[error(transparent)]
    Demos(#[from] DemosError),
}

/// One message, before its pictures are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spoken {
    /// Who speaks.
    pub speaker: Speaker,
    /// Its pieces, in order.
    pub parts: Vec<SpokenPart>,
}

/// A piece of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SpokenPart {
    /// Text that knows where it comes from.
    Text(PromptText),
    /// A picture that the task shows.
    Picture(PromptPicture),
    /// The refused action, drawn on what the stage shows.
    RefusedAction,
}

/// What is said and sent in a stage, message by message on both sides.
#[derive(Clone, Debug, Default)]
pub struct Conversation {
    /// What is said.
    pub spoken: Vec<Spoken>,
    /// What is sent.
    pub messages: Vec<Message>,
}

impl Conversation {
    /// Adds a message of texts alone.
    pub(super) fn say(&mut self, speaker: Speaker, said: PromptText) {
        self.messages
            .push(Message::text(speaker, said.text.clone()));
        self.spoken.push(Spoken {
            speaker,
            parts: vec![SpokenPart::Text(said)],
        });
    }

    /// Adds a text to the last message.
    pub(super) fn add(&mut self, said: PromptText) {
        if let (Some(spoken), Some(message)) = (self.spoken.last_mut(), self.messages.last_mut()) {
            message.parts.push(Part::Text(said.text.clone()));
            spoken.parts.push(SpokenPart::Text(said));
        }
    }

    /// Adds the picture of the refused action to the last message.
    pub(super) fn add_refused_action(&mut self, png: Png) {
        if let (Some(spoken), Some(message)) = (self.spoken.last_mut(), self.messages.last_mut()) {
            message.parts.push(Part::Image(png));
            spoken.parts.push(SpokenPart::RefusedAction);
        }
    }
}

/// Renders the opening messages of a stage, with the places of its pictures.
///
/// - `values`: what is known, with the way in which the model writes points.
/// - `step`: from 1; chooses the demonstrations, which stand just before the question.
pub fn opening(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    examples: &Examples,
    step: u32,
) -> Result<Vec<Spoken>, PromptError> {
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
        let mut parts = vec![SpokenPart::Text(prompt.content)];
        parts.extend(prompt.pictures.into_iter().map(SpokenPart::Picture));
        if is_numbered {
            parts.push(SpokenPart::Text(PromptText::by_fabc(NUMBERED_POINTS)));
        }
        spoken.push(Spoken { speaker, parts });
    }
    let question = spoken.len().saturating_sub(1);
    let told = examples.told(program, &stage.name, step, values.pointing(program))?;
    let told = told.into_iter().flat_map(|Told { question, answer }| {
        let turn = |speaker, said| Spoken {
            speaker,
            parts: vec![SpokenPart::Text(said)],
        };
        [
            turn(Speaker::User, question),
            turn(Speaker::Assistant, answer),
        ]
    });
    spoken.splice(question..question, told);
    Ok(spoken)
}

/// Renders the opening messages of a stage as a model with this lowering is sent them.
///
/// - `values`: what is known; points are written as the lowering says, whatever `values` says of them.
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
    for Spoken { speaker, parts } in &spoken {
        let mut sent = Vec::with_capacity(parts.len());
        for part in parts {
            match part {
                SpokenPart::Text(said) => sent.push(Part::Text(said.text.clone())),
                SpokenPart::Picture(picture) => sent.push(Part::Image(drawn(picture)?)),
                SpokenPart::RefusedAction => {}
            }
        }
        messages.push(Message {
            speaker: *speaker,
            parts: sent,
        });
    }
    Ok(Conversation { spoken, messages })
}

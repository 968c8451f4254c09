//! The messages of a stage: their text, its origin, and the form sent to a model.
//!
//! In: a program, known values, available pictures. Out: [`StageMessage`]s. Each piece of text has its source file and
//! line, each picture its bytes in the model's size. `fabc render`, `fabc snap` and rollouts all call this, so they show
//! and send the same messages.

use crate::error::RunError;
use crate::examples::Examples;
use crate::pictures::Pictures;
use fab_model::{Lowering, Message, Part, Png, Speaker};
use fab_program::render::{self, NUMBERED_POINTS, PromptPicture, PromptText, RenderError, Values};
use fab_program::{Picture, Program, Stage};

/// A message of a stage.
#[derive(Clone, Debug, PartialEq)]
pub struct StageMessage {
    /// Who speaks.
    pub speaker: Speaker,
    /// Its pieces, in order.
    pub parts: Vec<MessagePart>,
}

/// A piece of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum MessagePart {
    /// Text with its source positions.
    Text(PromptText),
    /// A picture that the task shows; `None` before it is drawn.
    Picture(PromptPicture, Option<Png>),
    /// A picture that the rollout adds, and what it shows, in words.
    Added(&'static str, Png),
}

impl StageMessage {
    /// Makes a text-only message.
    pub(super) fn text(speaker: Speaker, text: PromptText) -> StageMessage {
        StageMessage {
            speaker,
            parts: vec![MessagePart::Text(text)],
        }
    }

    /// Returns the message as sent to a model, without pictures that are not drawn.
    pub fn sent(&self) -> Message {
        let parts = self.parts.iter().filter_map(|part| match part {
            MessagePart::Text(said) => Some(Part::Text(said.text.clone())),
            MessagePart::Picture(_, png) => png.clone().map(Part::Image),
            MessagePart::Added(_, png) => Some(Part::Image(png.clone())),
        });
        Message {
            speaker: self.speaker,
            parts: parts.collect(),
        }
    }
}

/// Renders the opening messages of a stage, whose pictures are not drawn yet.
///
/// - `values`: known values, with the model's point notation.
/// - `step`: from 1; selects the demonstrations, which come just before the question.
pub fn opening(
    program: &Program,
    stage: &Stage,
    values: Values<'_>,
    examples: &Examples,
    step: u32,
) -> Result<Vec<StageMessage>, RunError> {
    let notation = values.notation(program);
    let mut spoken = Vec::new();
    for prompt in render::messages(program, stage, values)? {
        let is_scene = |picture: &PromptPicture| {
            matches!(picture, PromptPicture::Drawn(Picture::Scene { .. }))
        };
        let is_numbered = !notation.marks().is_empty() && prompt.pictures.iter().any(is_scene);
        let mut parts = vec![MessagePart::Text(prompt.content)];
        let pictures = prompt.pictures.into_iter();
        parts.extend(pictures.map(|picture| MessagePart::Picture(picture, None)));
        if is_numbered {
            parts.push(MessagePart::Text(PromptText::by_fabc(NUMBERED_POINTS)));
        }
        spoken.push(StageMessage {
            speaker: prompt.speaker,
            parts,
        });
    }
    let question = spoken.len().saturating_sub(1);
    let pointing = values.pointing(program);
    let answered = match &examples.demonstrations {
        Some(shown) => shown.answered_examples(program, &stage.name, step, pointing)?,
        None => Vec::new(),
    };
    let answered = answered.into_iter().flat_map(|[question, answer]| {
        [
            StageMessage::text(Speaker::User, question),
            StageMessage::text(Speaker::Assistant, answer),
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
) -> Result<Vec<StageMessage>, RunError> {
    let values = values.with_pointing(lowering.pointing(pictures.size()));
    let notation = values.notation(program);
    let mut messages = opening(program, stage, values, &pictures.examples, step)?;
    for part in messages.iter_mut().flat_map(|message| &mut message.parts) {
        if let MessagePart::Picture(picture, png) = part {
            let drawn = pictures.png(picture, lowering, &notation);
            *png = Some(drawn.ok_or_else(|| RenderError::MissingFact {
                name: format!("{picture:?}"),
            })?);
        }
    }
    Ok(messages)
}

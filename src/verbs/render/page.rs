//! The text of a stage, as lines with their origins.
//!
//! In: a stage's messages, whose texts record their origins. Out: the lines that `fabc render` prints and `fabc snap`
//! pins, the same for both.

use crate::exit::Failure;
use fab_program::facts::{ExecutedAction, Facts};
use fab_program::pointing::Pointing;
use fab_program::render::{self, Origin, PromptText, RenderError, Values};
use fab_program::scene::SceneView;
use fab_program::{Program, Read, Stage};
use serde::{Serialize, Serializer};
use std::path::Path;

#[derive(Serialize)]
pub struct DisplayMessage {
    pub role: String,
    pub parts: Vec<DisplayPart>,
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum DisplayPart {
    Text {
        #[serde(rename = "text", serialize_with = "words")]
        said: PromptText,
    },
    Image {
        #[serde(rename = "shows")]
        title: String,
        /// The PNG bytes, if requested and if this build can draw it.
        #[serde(rename = "bytes", serialize_with = "length")]
        png: Option<Vec<u8>>,
    },
}

/// What a model would be told after a check's rejection.
#[derive(Serialize)]
pub struct Correction {
    check: String,
    #[serde(rename = "text", serialize_with = "words")]
    said: PromptText,
}

#[derive(Serialize)]
pub struct ShownStage {
    #[serde(rename = "stage")]
    pub name: String,
    pub messages: Vec<DisplayMessage>,
    /// How many of the messages make up the first question.
    #[serde(skip)]
    pub n_asked_first: usize,
    /// Empty if the stage reads no action.
    pub corrections: Vec<Correction>,
    /// The findings about the given answers, in words.
    pub findings: Vec<String>,
    /// The same as data, as a run records them.
    pub results: Vec<serde_json::Value>,
}

pub struct Line {
    pub text: String,
    /// Where its text comes from; `None` for headings, blank lines between texts, and pictures.
    pub origin: Option<Origin>,
}

fn words<S: Serializer>(said: &PromptText, serializer: S) -> Result<S::Ok, S::Error> {
    said.text.serialize(serializer)
}

fn length<S: Serializer>(png: &Option<Vec<u8>>, serializer: S) -> Result<S::Ok, S::Error> {
    png.as_ref().map(Vec::len).serialize(serializer)
}

/// Returns the first question of a stage, without pictures, by the function that a rollout uses.
#[cfg(feature = "runtime")]
fn messages(
    program: &Program,
    folder: &Path,
    stage: &Stage,
    values: Values<'_>,
    step: u32,
) -> Result<Vec<DisplayMessage>, Failure> {
    let examples = fab_agent::examples::Examples::load(program, folder)?;
    let spoken = fab_agent::policy::opening(program, stage, values, &examples, step)?;
    let displayed = spoken.iter().map(|it| super::camera::displayed(it, step));
    Ok(displayed.collect())
}

/// Returns the first question of a stage, without pictures and demonstrations, which the authoring tool cannot read.
#[cfg(not(feature = "runtime"))]
fn messages(
    program: &Program,
    _folder: &Path,
    stage: &Stage,
    values: Values<'_>,
    step: u32,
) -> Result<Vec<DisplayMessage>, Failure> {
    let messages = render::messages(program, stage, values)?.into_iter();
    let displayed = messages.map(|message| {
        let said = message.content;
        let mut parts = vec![DisplayPart::Text { said }];
        parts.extend(message.pictures.iter().map(|picture| DisplayPart::Image {
            title: super::title(picture, step),
            png: None,
        }));
        let role = format!("{:?}", message.speaker).to_lowercase();
        DisplayMessage { role, parts }
    });
    Ok(displayed.collect())
}

impl ShownStage {
    /// Makes a stage of its first question, with the points of a scene or else with typed placeholders, without pictures.
    pub fn without_camera(
        program: &Program,
        folder: &Path,
        stage: &Stage,
        scene: Option<&dyn SceneView>,
        last: Option<&ExecutedAction>,
        step: u32,
    ) -> Result<ShownStage, Failure> {
        let values = scene.map_or(Values::Typed, |scene| {
            Values::Partly(Facts {
                last,
                ..Facts::of(scene, step, Pointing::of_camera(&program.camera))
            })
        });
        let messages = messages(program, folder, stage, values, step)?;
        Ok(ShownStage::of(program, stage, values, messages)?)
    }

    pub fn of(
        program: &Program,
        stage: &Stage,
        values: Values<'_>,
        messages: Vec<DisplayMessage>,
    ) -> Result<ShownStage, RenderError> {
        let corrections = match stage.read {
            Read::Action => render::corrections(program, values)?,
            Read::Text { .. } => Vec::new(),
        };
        let corrections = corrections.into_iter();
        let corrections = corrections.map(|(check, said)| Correction { check, said });
        Ok(ShownStage {
            name: stage.name.clone(),
            n_asked_first: messages.len(),
            messages,
            corrections: corrections.collect(),
            findings: Vec::new(),
            results: Vec::new(),
        })
    }

    pub fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        for message in &self.messages {
            lines.push(heading(format!("--- {}", message.role)));
            for part in &message.parts {
                match part {
                    DisplayPart::Text { said } => lines.extend(of_text(said)),
                    DisplayPart::Image { title, .. } => {
                        lines.push(heading(format!("[picture: {title}]")));
                    }
                }
            }
        }
        for Correction { check, said } in &self.corrections {
            lines.push(heading(format!("--- told where `{check}` refuses")));
            lines.extend(of_text(said));
        }
        lines
    }

    pub fn first_question(&self) -> impl Iterator<Item = &DisplayPart> {
        let asked = self.messages.iter().take(self.n_asked_first);
        asked.flat_map(|message| &message.parts)
    }

    /// Returns the texts of the first question, without headings.
    pub fn texts(&self) -> impl Iterator<Item = &PromptText> {
        self.first_question().filter_map(|part| match part {
            DisplayPart::Text { said } => Some(said),
            DisplayPart::Image { .. } => None,
        })
    }

    pub fn text(&self) -> String {
        let lines = self.lines().into_iter();
        lines.map(|line| line.text + "\n").collect()
    }
}

fn heading(text: String) -> Line {
    Line { text, origin: None }
}

/// Splits a text into lines; the origin of each is that of its first stretch.
fn of_text(said: &PromptText) -> impl Iterator<Item = Line> {
    let mut start = 0;
    said.text.split('\n').map(move |text| {
        let end = start + text.len();
        // A line's own newline counts.
        let mut stretches = said.stretches.iter();
        let first = stretches.find(|it| it.bytes.start <= end && start < it.bytes.end);
        start = end + 1;
        Line {
            text: text.to_owned(),
            origin: first.map(|stretch| stretch.origin.clone()),
        }
    })
}

#[cfg(test)]
mod tests;

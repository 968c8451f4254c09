//! Renders prompts in a build without simulator and vision: points are typed placeholders, or come from `--scene`.

use super::page::{DisplayMessage, DisplayPart, ShownStage};
use super::scene_file::SceneFile;
use super::title;
use super::why::Rates;
use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::render::RenderArguments;
use clap::Args;
use fab_program::facts::Facts;
use fab_program::pointing::Pointing;
use fab_program::render::{self, PromptMessage, PromptSpeaker, RenderError, Values};
use fab_program::{Program, Stage};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Nothing: without a camera there is no start and nobody who answers.
#[derive(Args)]
pub struct CameraArguments {}

impl CameraArguments {
    /// Returns no files.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        std::iter::empty()
    }
}

/// Returns the task unchanged: this build lays no cloth.
pub fn fitted(
    declared: &Program,
    _arguments: &RenderArguments,
    _io: &Io,
) -> Result<Program, Failure> {
    Ok(declared.clone())
}

/// Takes the place of a scene.
pub struct DisplayedScene {
    step: u32,
}

impl DisplayedScene {
    /// Fails if points are needed, since this build has no camera.
    pub fn at(
        _program: &Program,
        _declared: &Program,
        arguments: &RenderArguments,
        io: &Io,
    ) -> Result<DisplayedScene, Failure> {
        if arguments.scene.is_none() {
            io.talk(
                "note: this build of fabc has no camera; points stand as placeholders (`--scene FILE.json` gives them)",
            );
        }
        Ok(DisplayedScene {
            step: arguments.step,
        })
    }

    /// Returns `None`: this build knows no models.
    pub fn rates(&self) -> Option<&dyn Rates> {
        None
    }

    /// Renders stages.
    pub fn stages(
        &self,
        program: &Program,
        stages: &[&Stage],
        listed: Option<&SceneFile>,
        _arguments: &RenderArguments,
    ) -> Result<Vec<ShownStage>, Failure> {
        let texts = BTreeMap::new();
        let values = match listed {
            None => Values::Typed,
            Some(scene) => Values::Partly(Facts {
                scene,
                texts: &texts,
                step: self.step,
                last: None,
                proposal: None,
                pointing: Pointing::of_camera(&program.camera),
            }),
        };
        let shown = stages.iter().map(|stage| {
            let messages = render::messages(program, stage, values)?;
            Ok(ShownStage {
                name: stage.name.clone(),
                n_asked_first: messages.len(),
                messages: messages
                    .into_iter()
                    .map(|it| shown(it, self.step))
                    .collect(),
                corrections: super::corrections_of(program, stage, values)?,
                findings: Vec::new(),
                results: Vec::new(),
            })
        });
        let shown: Result<Vec<ShownStage>, RenderError> = shown.collect();
        shown.map_err(Failure::environment)
    }
}

/// Returns messages for display in a build that cannot draw.
pub fn shown_without_drawing(messages: Vec<PromptMessage>, step: u32) -> Vec<DisplayMessage> {
    let messages = messages.into_iter();
    messages.map(|message| shown(message, step)).collect()
}

fn shown(message: PromptMessage, step: u32) -> DisplayMessage {
    let role = match message.speaker {
        PromptSpeaker::System => "system",
        PromptSpeaker::User => "user",
        PromptSpeaker::Assistant => "assistant",
    };
    let mut parts = vec![DisplayPart::Text(message.content)];
    parts.extend(message.pictures.iter().map(|picture| DisplayPart::Picture {
        title: title(picture, step),
        png: None,
    }));
    DisplayMessage { role, parts }
}

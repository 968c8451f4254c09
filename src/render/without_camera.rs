//! Prompts in a build without simulator and vision: points are typed placeholders, or from `--scene`.

use super::{Listed, Shown, ShownPart, title};
use crate::cli::RenderArguments;
use crate::exit::Failure;
use crate::output;
use compiler::facts::Facts;
use compiler::pointing::Pointing;
use compiler::program::{Program, Stage};
use compiler::render::{self, PromptSpeaker, RenderError, Values};
use std::collections::BTreeMap;

/// Returns the task as it is: no start is laid.
pub fn fitted(declared: &Program, _arguments: &RenderArguments) -> Result<Program, Failure> {
    Ok(declared.clone())
}

/// Stands where a scene would be.
pub struct View {
    step: u32,
}

impl View {
    /// Says that this build has no camera, where points are needed.
    pub fn at(
        _program: &Program,
        _declared: &Program,
        arguments: &RenderArguments,
    ) -> Result<View, Failure> {
        if arguments.scene.is_none() {
            output::talk(
                "note: this build of fabc has no camera; points stand as placeholders (`--scene FILE.json` gives them)",
            );
        }
        Ok(View {
            step: arguments.step,
        })
    }

    /// Renders one stage.
    pub fn messages(
        &self,
        program: &Program,
        stage: &Stage,
        listed: Option<&Listed>,
    ) -> Result<Vec<Shown>, RenderError> {
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
        let shown = |message: render::PromptMessage| {
            let role = match message.speaker {
                PromptSpeaker::System => "system",
                PromptSpeaker::User => "user",
                PromptSpeaker::Assistant => "assistant",
            };
            let mut parts = vec![ShownPart::Text(message.text)];
            parts.extend(message.pictures.iter().map(|picture| ShownPart::Picture {
                title: title(picture, self.step),
                png: None,
            }));
            Shown { role, parts }
        };
        Ok(render::messages(program, stage, values)?
            .into_iter()
            .map(shown)
            .collect())
    }
}

//! Prompts in a build without simulator and vision: points are typed placeholders, or from `--scene`.

use super::{Shown, ShownPart};
use crate::cli::RenderArguments;
use crate::exit::Failure;
use crate::output;
use compiler::program::{Arrow, Program, Stage, Which};
use compiler::render::{self, Bindings, PromptSpeaker, RenderError};

/// Stands where a scene would be.
pub struct View {
    step: u32,
}

impl View {
    /// Says that this build has no camera, where points are needed.
    pub fn at(_program: &Program, arguments: &RenderArguments) -> Result<View, Failure> {
        if arguments.scene.is_none() {
            output::talk(
                "note: this build of fabc has no camera; points stand as placeholders (`--scene FILE.json` gives them)",
            );
        }
        Ok(View {
            step: arguments.step,
        })
    }

    /// Leaves the placeholders as they are.
    pub fn bind(&self, _bindings: &mut Bindings) {}

    /// Renders one stage.
    pub fn messages(
        &self,
        program: &Program,
        stage: &Stage,
        bindings: &Bindings,
    ) -> Result<Vec<Shown>, RenderError> {
        let shown = |message: render::PromptMessage| {
            let role = match message.speaker {
                PromptSpeaker::System => "system",
                PromptSpeaker::User => "user",
            };
            let mut parts = vec![ShownPart::Text(message.text)];
            parts.extend(message.pictures.into_iter().map(|picture| {
                let number = match picture.subgoal {
                    Which::Now => self.step - 1,
                    Which::Next => self.step,
                };
                let arrow = if picture.arrow == Arrow::Drawn {
                    " with arrow"
                } else {
                    ""
                };
                ShownPart::Picture {
                    title: format!("subgoal {number}{arrow}"),
                    png: None,
                }
            }));
            Shown { role, parts }
        };
        Ok(render::messages(program, stage, bindings)?
            .into_iter()
            .map(shown)
            .collect())
    }
}

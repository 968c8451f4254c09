//! `demos plan from "double_straight.demos.json"`.

use super::{Context, files};
use crate::ast;
use crate::diag::{Code, Diagnostic};
use crate::merge::Merged;
use fab_program::{Demos, Read, Stage};

/// Reads which stage is told which demonstrations; `stages` are the task's, checked.
pub(crate) fn check(
    part: &ast::Demos,
    merged: &Merged<'_>,
    stages: &[Stage],
    context: &mut Context<'_>,
) -> Option<Demos> {
    let file = files::named(&part.file, "demonstrations", context);
    let declared = || merged.stages.iter().map(|stage| stage.name.text.as_str());
    if !declared().any(|name| name == part.stage.text) {
        // A base may leave the stages to the tasks that extend it.
        if declared().next().is_some() {
            let known: Vec<&str> = declared().collect();
            context.unknown("stage", &part.stage, known);
        }
        return None;
    }
    let stage = stages.iter().find(|stage| stage.name == part.stage.text)?;
    if stage.read != Read::Action || !stage.show.is_empty() {
        let message = if stage.show.is_empty() {
            format!("the stage `{}` reads no action", stage.name)
        } else {
            format!("the stage `{}` shows pictures", stage.name)
        };
        context.push(
            Diagnostic::new(Code::WrongForm, part.stage.span, message)
                .help("demonstrations are told to a stage of words alone that reads the action"),
        );
        return None;
    }
    Some(Demos {
        stage: stage.name.clone(),
        file: file?,
    })
}

//! `demos plan from "double_straight.demos.json"`.

use super::context::{Context, Declared};
use super::files;
use super::stage::number_of;
use crate::diag::{Code, Diagnostic, Reported};
use crate::loader::Wanted;
use crate::merge::Merged;
use fab_grammar::ast;
use fab_program::{Demos, Read, Stage};

/// Reads which demonstrations a stage uses; `None` in a base without stages.
///
/// - `stages`: the task's stages, in the order in which they are declared.
pub(crate) fn check<'a>(
    part: ast::Demos<'a>,
    merged: &Merged<'a>,
    stages: &[Result<Stage, Reported>],
    context: &mut Context<'a, '_>,
) -> Declared<Demos> {
    let file = files::named(
        part.file(),
        "demonstrations",
        Wanted::Demonstrations,
        context,
    );
    if merged.stages.is_empty() {
        return file.map(|_| None);
    }
    let number = number_of(part.stage(), merged, context)?;
    let stage = stages[number].as_ref().map_err(|reported| *reported)?;
    if stage.read != Read::Action || !stage.show.is_empty() {
        let lacks = if stage.show.is_empty() {
            "does not read the action"
        } else {
            "shows pictures"
        };
        let message = format!("the stage `{}` {lacks}", stage.name);
        let diagnostic = Diagnostic::new(Code::WrongForm, part.stage().span(), message);
        return Err(context.error(
            diagnostic
                .help("demonstrations need a stage that reads the action and shows no pictures"),
        ));
    }
    Ok(Some(Demos {
        stage: stage.name.clone(),
        file: file?,
    }))
}

//! `demos plan from "double_straight.demos.json"`.

use super::context::{Context, Declared};
use super::files;
use crate::diag::Code;
use crate::loader::Wanted;
use fab_grammar::ast;
use fab_program::{Demos, Read};

/// Reads which demonstrations a stage uses; `None` in a base without stages.
pub(crate) fn check(part: ast::Demos<'_>, context: &mut Context<'_>) -> Declared<Demos> {
    let (file, wanted) = (part.file(), Wanted::Demonstrations);
    let file = files::named(file, "demonstrations", wanted, context);
    if context.stages.0.is_empty() {
        return file.map(|_| None);
    }
    let (_, stage) = context.stage(part.stage())?;
    if stage.read != Read::Action || !stage.show.is_empty() {
        let lacks = if stage.show.is_empty() {
            "does not read the action"
        } else {
            "shows pictures"
        };
        let message = format!("the stage `{}` {lacks}", stage.name);
        let help = "demonstrations need a stage that reads the action and shows no pictures";
        return Err(context.refuse(Code::WrongForm, part.stage().span(), message, help));
    }
    Ok(Some(Demos {
        stage: stage.name,
        file: file?,
    }))
}

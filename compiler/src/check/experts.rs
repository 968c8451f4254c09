//! `experts NAME { sequence { … } }`: the fold sequences that count as right.

use super::context::{Context, Result};
use super::folds;
use crate::diag::{Code, every};
use crate::merge::Merged;
use fab_grammar::ast::{Experts, File};
use fab_program::{Sequence, Subgoals};

/// Builds the sequences of a list of experts.
pub(crate) fn check(list: Experts<'_>, context: &mut Context<'_>) -> Result<Vec<Sequence>> {
    if list.sequences().next().is_none() {
        let name = list.name();
        let message = format!("`{}` has no sequence", name.text());
        let help = "write one such as `sequence { fold corner(back_left) -> center }`";
        return Err(context.refuse(Code::NoFolds, name.span(), message, help));
    }
    every(list.sequences().map(|block| {
        let folds = folds::check(block, context)?;
        Ok(Sequence { folds })
    }))
}

/// Returns the sequences that count as right for a task: the named experts', or else the demonstration.
pub(crate) fn sequences(merged: &Merged<'_>, context: &mut Context<'_>) -> Result<Vec<Sequence>> {
    let Some(named) = merged.experts() else {
        return Ok(match &context.subgoals {
            Ok(Some(Subgoals::Demonstrate { folds })) => vec![Sequence {
                folds: folds.clone(),
            }],
            Ok(_) => Vec::new(),
            Err(reported) => return Err(*reported),
        });
    };
    let file = named.name().span().file;
    match context.loaded.experts(file, named.name().text()) {
        Some(found) => context.outside.experts[&found.span()].clone(),
        None => {
            let seen = context.loaded.visible_from(file);
            let names = seen.flat_map(File::experts).map(|list| list.name().text());
            Err(context.unknown("list of experts", named.name(), names))
        }
    }
}

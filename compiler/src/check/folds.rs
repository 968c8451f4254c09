//! Folds between points of the cloth: `corner(back_left) -> center at 0.9`.

use super::context::{Context, Result};
use super::expressions::cloth_point;
use super::quantity::read;
use crate::diag::{Code, Diagnostic, every};
use crate::lang::calls::FOLD_FRACTION;
use fab_grammar::ast::{FoldBlock, Move};
use fab_program::Fold;

/// The most folds in a sequence.
const MAX_FOLDS: usize = 100;

/// Builds the folds of one block.
pub(super) fn check(block: FoldBlock<'_>, context: &mut Context<'_>) -> Result<Vec<Fold>> {
    let moves: Vec<Move<'_>> = block.moves().collect();
    if moves.is_empty() {
        let help = "write one such as `fold corner(back_left) -> corner(front_left)`";
        let message = "there is no fold here";
        return Err(context.refuse(Code::NoFolds, block.head_span(), message, help));
    }
    let places = moves.iter().map(|part| part.span());
    context.at_most(MAX_FOLDS, places, "a sequence", "folds")?;
    every(moves.into_iter().map(|part| fold(part, context)))
}

fn fold(part: Move<'_>, context: &mut Context<'_>) -> Result<Fold> {
    let pick = cloth_point(part.pick(), context);
    let place = cloth_point(part.place(), context);
    let fraction = part
        .fraction()
        .map_or(Ok(1.0), |it| read(it, &FOLD_FRACTION, context));
    let fold = Fold {
        pick: pick?,
        place: place?,
        fraction: fraction?,
    };
    if fold.pick == fold.place {
        let message = "this fold ends where it begins";
        let diagnostic = Diagnostic::new(Code::FoldGoesNowhere, part.span(), message);
        return Err(context.error(diagnostic.label("picks and places the same point")));
    }
    Ok(fold)
}

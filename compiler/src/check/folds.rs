//! Folds between points of the cloth: `corner(back_left) -> center at 0.9`.

use super::context::Context;
use super::expressions::cloth_point;
use super::quantity::read;
use crate::diag::{Code, Diagnostic, Reported, every};
use crate::lang::calls::FOLD_FRACTION;
use fab_grammar::ast::{FoldBlock, Move};
use fab_program::Fold;

/// The most folds in a sequence.
const MAX_FOLDS: usize = 100;

/// Builds the folds of one block.
pub(super) fn check<'a>(
    block: FoldBlock<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<Fold>, Reported> {
    let moves: Vec<Move<'_>> = block.moves().collect();
    if moves.is_empty() {
        let span = block.head_span();
        let diagnostic = Diagnostic::new(Code::NoFolds, span, "there is no fold here")
            .help("write one such as `fold corner(back_left) -> corner(front_left)`");
        return Err(context.error(diagnostic));
    }
    context.bounded(moves.get(MAX_FOLDS).map(|beyond| beyond.span()), || {
        format!(
            "a sequence has at most {MAX_FOLDS} folds, this one has {}",
            moves.len()
        )
    })?;
    every(moves.into_iter().map(|part| fold(part, context)))
}

fn fold<'a>(part: Move<'a>, context: &mut Context<'a, '_>) -> Result<Fold, Reported> {
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

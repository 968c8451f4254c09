//! Folds between points of the cloth, `corner(back_left) -> center at 0.9`, and the pictures that show them.

use super::context::{Context, Declared};
use super::expressions::{cloth_point, pixel};
use super::files;
use super::quantity::read;
use crate::diag::{Code, Diagnostic, Reported};
use crate::lang::calls::FOLD_FRACTION;
use crate::merge::{Merged, once};
use fab_grammar::ast::{Experts, FoldBlock, Image, Move};
use fab_program::{Fold, Sequence, SubgoalImage, Subgoals};

/// The most folds in a sequence.
const MAX_FOLDS: usize = 100;

/// The most subgoal pictures of a task.
const MAX_IMAGES: usize = 101;

/// Builds the folds of one block.
fn folds<'a>(block: FoldBlock<'a>, context: &mut Context<'a, '_>) -> Result<Vec<Fold>, Reported> {
    let moves: Vec<Move<'_>> = block.moves().collect();
    if moves.is_empty() {
        let span = block.head_span();
        let diagnostic = Diagnostic::new(Code::NoFolds, span, "there is no fold here")
            .help("write one such as `fold corner(back_left) -> corner(front_left)`");
        return Err(context.missing(block.is_damaged(), span.file, diagnostic));
    }
    context.bounded(moves.get(MAX_FOLDS).map(|beyond| beyond.span()), || {
        format!(
            "a sequence has at most {MAX_FOLDS} folds, this one has {}",
            moves.len()
        )
    })?;
    let folds: Vec<_> = moves.into_iter().map(|part| fold(part, context)).collect();
    folds.into_iter().collect()
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

/// Builds the sequences of a list of experts.
pub(crate) fn experts<'a>(
    list: Experts<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<Sequence>, Reported> {
    let sequences: Vec<_> = list
        .sequences()
        .map(|block| {
            Ok(Sequence {
                folds: folds(block, context)?,
            })
        })
        .collect();
    if sequences.is_empty() {
        let name = list.name();
        let message = format!("`{}` has no sequence", name.text());
        let diagnostic = Diagnostic::new(Code::NoFolds, name.span(), message)
            .help("write one such as `sequence { fold corner(back_left) -> center }`");
        return Err(context.missing(list.is_damaged(), name.span().file, diagnostic));
    }
    sequences.into_iter().collect()
}

/// Returns the sequences that count as right for a task: the named experts', or else the demonstration.
pub(crate) fn expert_sequences<'a>(
    merged: &Merged<'a>,
    subgoals: &Declared<Subgoals>,
    context: &mut Context<'a, '_>,
) -> Result<Vec<Sequence>, Reported> {
    let Some(named) = merged.experts else {
        return Ok(match subgoals {
            Ok(Some(Subgoals::Demonstrate { folds })) => vec![Sequence {
                folds: folds.clone(),
            }],
            Ok(_) => Vec::new(),
            Err(reported) => return Err(*reported),
        });
    };
    let file = named.name().span().file;
    match context.loaded.experts(file, named.name().text()) {
        // Every list is checked by itself too; the report shows the same message once.
        Some(found) => experts(found, context),
        None => {
            let seen = context
                .loaded
                .visible_from(file)
                .flat_map(|file| &file.experts);
            let names: Vec<&str> = seen.map(|list| list.name().text()).collect();
            Err(context.unknown("list of experts", named.name(), names))
        }
    }
}

/// Builds the subgoals: folds that the simulator draws, or the author's pictures.
pub(crate) fn subgoals<'a>(
    part: fab_grammar::ast::Subgoals<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Subgoals, Reported> {
    let head = |block: FoldBlock<'_>| block.head_span();
    let demonstrated = once(part.demonstrations(), "demonstrate", head, context.report);
    match (demonstrated, part.images().next()) {
        (Some(block), Some(image)) => {
            let message = "the subgoals are both demonstrated and listed as images";
            let diagnostic = Diagnostic::new(Code::MixedSubgoals, image.span(), message);
            Err(context.error(
                diagnostic
                    .also(block.head_span(), "demonstrated here")
                    .help("keep one of the two"),
            ))
        }
        (Some(block), None) => Ok(Subgoals::Demonstrate {
            folds: folds(block, context)?,
        }),
        (None, Some(_)) => images(part, context),
        (None, None) => {
            let span = part.head_span();
            let diagnostic = Diagnostic::new(Code::NoFolds, span, "there are no subgoals here")
                .help("write `demonstrate { fold … }`, or list images");
            Err(context.missing(part.is_damaged(), span.file, diagnostic))
        }
    }
}

fn images<'a>(
    part: fab_grammar::ast::Subgoals<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Subgoals, Reported> {
    let images: Vec<Image<'_>> = part.images().collect();
    if let [only] = images.as_slice() {
        let diagnostic =
            Diagnostic::new(Code::TooFewImages, only.span(), "one image shows no step")
                .help("add the picture after the step");
        return Err(context.missing(part.is_damaged(), only.span().file, diagnostic));
    }
    context.bounded(images.get(MAX_IMAGES).map(|beyond| beyond.span()), || {
        format!(
            "there are {} images, at most {MAX_IMAGES} are accepted",
            images.len()
        )
    })?;
    let images: Vec<_> = images
        .into_iter()
        .map(|part| image(part, context))
        .collect();
    let images = images.into_iter().collect::<Result<_, _>>()?;
    Ok(Subgoals::Images { images })
}

fn image<'a>(part: Image<'a>, context: &mut Context<'a, '_>) -> Result<SubgoalImage, Reported> {
    let file = files::named(part.path(), "an image", context);
    let ends = part.arrow().map(|ends| ends.map(|end| pixel(end, context)));
    let arrow = match ends {
        Some([tail, tip]) => Some([tail?, tip?]),
        None => None,
    };
    Ok(SubgoalImage { file: file?, arrow })
}

//! `subgoals { demonstrate { … } }` or `subgoals { image "…" … }`: the pictures that show what to do.

use super::context::{Context, Result, declared};
use super::expressions::pixel_of;
use super::{files, folds};
use crate::diag::{Code, Diagnostic, every};
use crate::loader::Wanted;
use crate::merge::{Merged, once};
use fab_grammar::ast::{FoldBlock, Image};
use fab_program::{ClothStart, SubgoalImage, Subgoals};

/// The most subgoal pictures of a task.
const MAX_IMAGES: usize = 101;

/// Builds the subgoals: folds for the simulator to draw, or the author's pictures.
pub(crate) fn check(
    part: fab_grammar::ast::Subgoals<'_>,
    context: &mut Context<'_>,
) -> Result<Subgoals> {
    let head = |block: FoldBlock<'_>| block.head_span();
    let demonstrated = once(part.demonstrations(), "demonstrate", head, context.report);
    match (demonstrated, part.images().next()) {
        (Some(block), Some(image)) => {
            let message = "the subgoals are both demonstrated and listed as images";
            let diagnostic = Diagnostic::new(Code::MixedSubgoals, image.span(), message)
                .also(block.head_span(), "demonstrated here")
                .help("keep one of the two");
            Err(context.error(diagnostic))
        }
        (Some(block), None) => Ok(Subgoals::Demonstrate {
            folds: folds::check(block, context)?,
        }),
        (None, Some(_)) => images(part, context),
        (None, None) => {
            let help = "write `demonstrate { fold … }`, or list images";
            let message = "there are no subgoals here";
            Err(context.refuse(Code::NoFolds, part.head_span(), message, help))
        }
    }
}

/// Warns of a crumpled cloth: subgoals are drawn of a flat one, and a step's result is compared with them.
pub(crate) fn begin_flat(merged: &Merged<'_>, context: &mut Context<'_>) {
    if let (Ok(Some(cloth)), Some(laid), Some(part)) =
        (&context.cloth, merged.statement("cloth"), merged.subgoals())
        && cloth.start == ClothStart::Crumpled
    {
        let message = "the cloth starts crumpled, and the subgoals show the folds of a flat one";
        let help = "leave `start: crumpled` out; a task without subgoals, such as `smoothing`, spreads a crumpled cloth";
        let diagnostic = Diagnostic::new(Code::FoldOfCrumpledCloth, laid.span(), message)
            .also(part.head_span(), "the subgoals")
            .help(help);
        context.remark(diagnostic);
    }
}

fn images(part: fab_grammar::ast::Subgoals<'_>, context: &mut Context<'_>) -> Result<Subgoals> {
    let images: Vec<Image<'_>> = part.images().collect();
    if let [only] = images.as_slice() {
        let message = "one image does not show a step";
        let help = "add the picture after the step";
        return Err(context.refuse(Code::TooFewImages, only.span(), message, help));
    }
    let places = images.iter().map(|image| image.span());
    context.at_most(MAX_IMAGES, places, "a task", "images")?;
    let images = every(images.into_iter().map(|part| image(part, context)))?;
    Ok(Subgoals::Images { images })
}

fn image(part: Image<'_>, context: &mut Context<'_>) -> Result<SubgoalImage> {
    let file = files::named(part.path(), "an image", Wanted::CameraPicture, context);
    let arrow = declared(part.arrow(), |ends| {
        let [tail, tip] = ends.map(|end| pixel_of(end, context));
        Ok([tail?, tip?])
    });
    Ok(SubgoalImage {
        file: file?,
        arrow: arrow?,
    })
}

//! `subgoals { demonstrate { … } }` or `subgoals { image "…" … }`: the pictures that show what to do.

use super::context::Context;
use super::expressions::pixel;
use super::{files, folds};
use crate::diag::{Code, Diagnostic, Reported, every};
use crate::loader::Wanted;
use crate::merge::once;
use fab_grammar::ast::{FoldBlock, Image};
use fab_program::{SubgoalImage, Subgoals};

/// The most subgoal pictures of a task.
const MAX_IMAGES: usize = 101;

/// Builds the subgoals: folds for the simulator to draw, or the author's pictures.
pub(crate) fn check<'a>(
    part: fab_grammar::ast::Subgoals<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Subgoals, Reported> {
    let head = |block: FoldBlock<'_>| block.head_span();
    let demonstrated = once(part.demonstrations(), "demonstrate", head, context.report);
    let subgoals = match (demonstrated.first, part.images().next()) {
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
            folds: folds::check(block, context)?,
        }),
        (None, Some(_)) => images(part, context),
        (None, None) => {
            let span = part.head_span();
            let diagnostic = Diagnostic::new(Code::NoFolds, span, "there are no subgoals here")
                .help("write `demonstrate { fold … }`, or list images");
            Err(context.error(diagnostic))
        }
    };
    demonstrated.alone.and(subgoals)
}

fn images<'a>(
    part: fab_grammar::ast::Subgoals<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Subgoals, Reported> {
    let images: Vec<Image<'_>> = part.images().collect();
    if let [only] = images.as_slice() {
        let diagnostic = Diagnostic::new(
            Code::TooFewImages,
            only.span(),
            "one image does not show a step",
        )
        .help("add the picture after the step");
        return Err(context.error(diagnostic));
    }
    context.bounded(images.get(MAX_IMAGES).map(|beyond| beyond.span()), || {
        format!(
            "there are {} images, at most {MAX_IMAGES} are accepted",
            images.len()
        )
    })?;
    let images = every(images.into_iter().map(|part| image(part, context)))?;
    Ok(Subgoals::Images { images })
}

fn image<'a>(part: Image<'a>, context: &mut Context<'a, '_>) -> Result<SubgoalImage, Reported> {
    let file = files::named(part.path(), "an image", Wanted::CameraPicture, context);
    let ends = part.arrow().map(|ends| ends.map(|end| pixel(end, context)));
    let arrow = match ends {
        Some([tail, tip]) => Some([tail?, tip?]),
        None => None,
    };
    Ok(SubgoalImage { file: file?, arrow })
}

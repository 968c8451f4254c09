//! `subgoals { demonstrate { … } }` or `subgoals { image "…" … }`.

use super::Context;
use super::quantity::{Measure, Wanted, read_whole};
use super::{files, folds};
use crate::ast::{self, Image};
use crate::diag::{Code, Diagnostic};
use crate::merge::once;
use fab_program::{PixelPoint, SubgoalImage, Subgoals};

/// The most pictures an author brings.
const MAX_IMAGES: usize = 101;

pub(super) const PIXEL: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 0.0..=8191.0,
    range_words: "a pixel from `0px` to `8191px`",
};

/// Builds the subgoals.
pub(crate) fn check(part: &ast::Subgoals, context: &mut Context<'_>) -> Option<Subgoals> {
    let demonstrate = once(
        &part.demonstrate,
        "`demonstrate`",
        |folds| folds.span,
        context.report,
    );
    match (demonstrate, part.images.first()) {
        (Some(folds), Some(image)) => {
            context.push(
                Diagnostic::new(
                    Code::MixedSubgoals,
                    image.span,
                    "the subgoals are demonstrated and brought as images",
                )
                .also(folds.span, "demonstrated here")
                .help("keep one of the two"),
            );
            None
        }
        (Some(folds), None) => {
            let checked = folds::check(folds, context);
            // A fold that is wrong is reported; the steps still count as written.
            (!checked.is_empty()).then_some(Subgoals::Demonstrate { folds: checked })
        }
        (None, Some(_)) => images(part, context),
        (None, None) => {
            if !part.has_faults {
                context.push(
                    Diagnostic::new(Code::NoFolds, part.span, "there are no subgoals here")
                        .help("write `demonstrate { fold … }`, or list images"),
                );
            }
            None
        }
    }
}

fn images(part: &ast::Subgoals, context: &mut Context<'_>) -> Option<Subgoals> {
    if part.images.len() < 2 && !part.has_faults {
        let message = "one image shows no step";
        context.push(
            Diagnostic::new(Code::TooFewImages, part.images[0].span, message)
                .help("add the picture after the step"),
        );
        return None;
    }
    if part.images.len() > MAX_IMAGES {
        let message = format!(
            "there are {} images, at most {MAX_IMAGES} are accepted",
            part.images.len()
        );
        context.push(Diagnostic::new(
            Code::OutOfRange,
            part.images[MAX_IMAGES].span,
            message,
        ));
        return None;
    }
    let checked: Vec<SubgoalImage> = part
        .images
        .iter()
        .filter_map(|part| image(part, context))
        .collect();
    (checked.len() == part.images.len()).then_some(Subgoals::Images { images: checked })
}

fn image(part: &Image, context: &mut Context<'_>) -> Option<SubgoalImage> {
    let file = files::named(&part.path, "an image", context)?;
    let arrow = match &part.arrow {
        Some([tail, tip]) => Some([pixel(tail, context)?, pixel(tip, context)?]),
        None => None,
    };
    Some(SubgoalImage { file, arrow })
}

pub(super) fn pixel([u, v]: &[ast::Expr; 2], context: &mut Context<'_>) -> Option<PixelPoint> {
    let u = read_whole(u, &PIXEL, context);
    let v = read_whole(v, &PIXEL, context);
    Some(PixelPoint::new(u? as i32, v? as i32))
}

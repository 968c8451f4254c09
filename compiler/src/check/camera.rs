//! `camera top_down(height: 650mm, fov: 45deg, image: 224px)`: where the camera is, and what it sees.

use super::context::{Context, Result};
use super::expressions::made;
use crate::diag::{Code, Diagnostic};
use crate::lang::calls::CAMERAS;
use crate::merge::Merged;
use fab_grammar::ast::Statement;
use fab_program::exact::written;
use fab_program::{Camera, Extractor, KeypointShape, RECORDED_HEIGHT_M};

/// Reads where the camera is, and what it sees.
pub(crate) fn check(statement: Statement<'_>, context: &mut Context<'_>) -> Result<Camera> {
    let (camera, ..) = made("camera", statement.value(), CAMERAS, context)?;
    Ok(camera)
}

/// Warns if the flat cloth, turned in any direction, does not fit into the picture.
pub(crate) fn fits_cloth(laid: Statement<'_>, seen: Statement<'_>, context: &mut Context<'_>) {
    let (Ok(Some(cloth)), Ok(Some(camera))) = (&context.cloth, &context.camera) else {
        return;
    };
    let view_m = 2.0 * camera.height_m * (camera.fov_rad / 2.0).tan();
    let side_m = |n_particles: u32| f64::from(n_particles - 1) * cloth.spacing_m;
    let diagonal_m = side_m(cloth.dimx).hypot(side_m(cloth.dimy));
    if diagonal_m > view_m {
        let [view_mm, diagonal_mm] = [view_m, diagonal_m].map(|length_m| length_m * 1000.0);
        let message = format!(
            "the camera sees {view_mm:.0}mm of the table, and the cloth is {diagonal_mm:.0}mm from corner to corner"
        );
        let diagnostic = Diagnostic::new(Code::CameraSeesTooLittle, laid.value().span(), message)
            .also(seen.value().span(), "the camera")
            .help("raise the camera, or widen its field of view");
        context.remark(diagnostic);
    }
}

/// How far above the table the depth limit of a mask should be, as a fraction of the flat cloth's height: the paper's
/// 646 mm for a camera at 650 mm and a cloth 5 mm above the table.
const CLEAR_OF_TABLE: f64 = 0.8;

/// Warns of a depth limit so near to the camera that a flat cloth is not in the mask, as after raising the camera.
pub(crate) fn masks_see_cloth(seen: Statement<'_>, merged: &Merged<'_>, context: &mut Context<'_>) {
    let (Ok(Some(camera)), Ok(keypoints)) = (&context.camera, &context.keypoints) else {
        return;
    };
    // A base without a cloth is judged by the recorded one.
    let cloth_m = match &context.cloth {
        Ok(Some(cloth)) => cloth.rest_height_m(),
        _ => RECORDED_HEIGHT_M,
    };
    let (height_m, flat_m) = (camera.height_m, camera.height_m - cloth_m);
    let masks = keypoints.iter().filter_map(|it| match it.extractor {
        Extractor::DepthMask { below_m } => Some((it.name.clone(), below_m)),
        _ => None,
    });
    let masks: Vec<(String, f64)> = masks.collect();
    // A second mask may be meant for what is above the cloth. A limit at the cloth's own depth excludes it.
    if masks.iter().any(|(_, below_m)| *below_m > flat_m) {
        return;
    }
    for (name, below_m) in masks {
        let Some(declared) = merged.keypoints.get(&name) else {
            continue;
        };
        let right_m = height_m - CLEAR_OF_TABLE * cloth_m;
        let [below, flat, right] = [below_m, flat_m, right_m].map(|it| written(it * 1000.0, 3));
        let message = format!(
            "`{name}` takes only depths below {below}mm, and a flat cloth lies {flat}mm from the camera"
        );
        let help = format!("write `{name} = mask(depth < {right}mm)` in `keypoints`");
        let (camera, mask) = (seen.value().span(), declared.value().span());
        // The cause is what this file says about an inherited mask or an inherited camera.
        let here = merged.task.name().span().file;
        let (at, other, label) = if camera.file != here && mask.file == here {
            (mask, camera, "the camera")
        } else {
            (camera, mask, "the mask")
        };
        let diagnostic = Diagnostic::new(Code::MaskSeesNoCloth, at, message);
        context.remark(diagnostic.also(other, label).help(help));
    }
}

/// Warns if another mask than the one of that name is the task's cloth.
pub(crate) fn cloth_is_first(merged: &Merged<'_>, context: &mut Context<'_>) {
    const NAME: &str = "cloth";
    let masks = { context.keypoints.iter().flatten() }
        .filter(|it| it.extractor.shape() == KeypointShape::Mask);
    let (mut first, mut cloth): (Option<&str>, Option<&str>) = (None, None);
    let mut named = false;
    for mask in masks {
        // As a rollout does: the first mask, and a cleaned version of it.
        if cloth.is_none() || mask.extractor.refines() == cloth {
            cloth = Some(&mask.name);
            first = first.or(cloth);
        }
        named |= mask.name == NAME && cloth != Some(NAME);
    }
    let declared = |name: &str| merged.keypoints.get(name).map(|it| it.value().span());
    let ends = cloth
        .filter(|_| named)
        .and_then(|cloth| Some((cloth, declared(cloth)?, declared(NAME)?)));
    let Some((cloth, at, own)) = ends else {
        return;
    };
    let what = match first {
        Some(first) if first != cloth => format!("made of the first mask, `{first}`"),
        _ => "the first mask".to_owned(),
    };
    let message = format!("`{cloth}`, {what}, is the cloth, and `{NAME}` is not");
    let diagnostic = Diagnostic::new(Code::OtherMaskIsCloth, at, message)
        .also(own, "this is another mask")
        .help("declare the cloth's mask above all others: picks land on it, and coverage is measured on it; only `largest` and `closed` of it take its place");
    context.remark(diagnostic);
}

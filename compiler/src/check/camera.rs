//! `camera top_down(height: 650mm, fov: 45deg, image: 224px)`: where the camera is, and what it sees.

use super::context::Context;
use super::expressions::{Scope, call, wrong_form};
use crate::diag::{Code, Diagnostic, Reported};
use crate::lang::calls::CAMERAS;
use fab_grammar::ast::{Expr, Statement};
use fab_program::Camera;

/// Reads where the camera is, and what it sees.
pub(crate) fn check<'a>(
    statement: Statement<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Camera, Reported> {
    let signatures = CAMERAS.iter().map(|row| &row.signature);
    let Expr::Call(written) = statement.value() else {
        return Err(wrong_form(
            statement.value(),
            "a camera",
            signatures,
            context,
        ));
    };
    let (row, args, _) = call("camera", written, signatures, Scope::Everywhere, context)?;
    Ok((CAMERAS[row].make)(&args))
}

/// Warns if the flat cloth, turned in any direction, does not fit into the picture.
pub(crate) fn fits_cloth(laid: Statement<'_>, seen: Statement<'_>, context: &mut Context<'_, '_>) {
    let (Ok(Some(cloth)), Ok(Some(camera))) = (&context.cloth, &context.camera) else {
        return;
    };
    let view_m = 2.0 * camera.height_m * (camera.fov_rad / 2.0).tan();
    let side_m = |n_particles: u32| f64::from(n_particles - 1) * cloth.spacing_m;
    let diagonal_m = side_m(cloth.dimx).hypot(side_m(cloth.dimy));
    if diagonal_m > view_m {
        let message = format!(
            "the camera sees {:.0}mm of the table, and the cloth is {:.0}mm from corner to corner",
            view_m * 1000.0,
            diagonal_m * 1000.0
        );
        let diagnostic = Diagnostic::new(Code::CameraSeesTooLittle, laid.value().span(), message);
        context.remark(
            diagnostic
                .also(seen.value().span(), "the camera")
                .help("raise the camera, or widen its field of view"),
        );
    }
}

//! `camera top_down(height: 650mm, fov: 45deg, image: 224px)`.

use super::Context;
use super::arguments::{bind, named, optional};
use super::quantity::{Measure, Wanted, read, read_whole};
use crate::ast::{Expr, ExprKind, Statement};
use crate::diag::{Code, Diagnostic};
use fab_program::{Camera, ImageUp};
use std::f64::consts::PI;

const HEIGHT: Wanted = Wanted {
    measure: Measure::Length,
    range: 0.1..=5.0,
    range_words: "a height from `100mm` to `5m`",
};
const FOV: Wanted = Wanted {
    measure: Measure::Angle,
    range: 5.0 * PI / 180.0..=150.0 * PI / 180.0,
    range_words: "a field of view from `5deg` to `150deg`",
};
pub(super) const IMAGE: Wanted = Wanted {
    measure: Measure::Pixels,
    range: 16.0..=2048.0,
    range_words: "a picture's side from `16px` to `2048px`",
};

/// Builds the camera.
pub(crate) fn check(statement: &Statement, context: &mut Context<'_>) -> Option<Camera> {
    let ExprKind::Call { name, arguments } = &statement.value.kind else {
        context.push(
            Diagnostic::new(Code::WrongForm, statement.value.span, "expected a camera")
                .help("write `top_down(height: 650mm, fov: 45deg, image: 224px)`"),
        );
        return None;
    };
    if name.text != "top_down" {
        context.unknown("camera", name, ["top_down"]);
        return None;
    }
    let bound = bind(
        name,
        arguments,
        &[
            named("height"),
            named("fov"),
            named("image"),
            optional("up"),
        ],
        context,
    )?;
    let height_m = read(bound.get("height")?, &HEIGHT, context);
    let fov_rad = read(bound.get("fov")?, &FOV, context);
    let image_px = read_whole(bound.get("image")?, &IMAGE, context);
    let up = bound
        .get("up")
        .map_or(Some(ImageUp::Y), |up| image_up(up, context));
    Some(Camera {
        height_m: height_m?,
        fov_rad: fov_rad?,
        image_px: image_px?,
        up: up?,
    })
}

fn image_up(expr: &Expr, context: &mut Context<'_>) -> Option<ImageUp> {
    match &expr.kind {
        ExprKind::Name(name) if name == "x" => Some(ImageUp::X),
        ExprKind::Name(name) if name == "y" => Some(ImageUp::Y),
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected `x` or `y`, found `{found}`");
            context.push(
                Diagnostic::new(Code::WrongForm, expr.span, message)
                    .help("the axis of the table that is up in the picture"),
            );
            None
        }
    }
}

/// Warns where the flat cloth, however it is turned, does not fit into the picture.
pub(crate) fn compare(laid: &Statement, seen: &Statement, context: &mut Context<'_>) {
    let (Some(cloth), Some(camera)) = (&context.cloth, &context.camera) else {
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
        context.push(
            Diagnostic::new(Code::CameraSeesTooLittle, laid.value.span, message)
                .also(seen.value.span, "the camera")
                .help("raise the camera, or widen its field of view"),
        );
    }
}

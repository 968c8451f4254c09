//! `cloth grid(55, 44)`, `camera top_down(…)` and `picker drop`: the cloth, the camera and the gripper.

use super::context::{Context, Declared};
use super::expressions::{Scope, call, name_of};
use crate::diag::{Code, Diagnostic, Reported, among};
use crate::lang::calls::{CAMERAS, CLOTHS, SPACING_M, particle_limits};
use fab_grammar::ast::{Expr, Statement};
use fab_program::vocabulary::{ArgValue, Call, Signature};
use fab_program::{Camera, Cloth, Picker};

/// Reads a statement, if there is one.
pub(super) fn statement<'a, T>(
    statement: Option<Statement<'a>>,
    read: impl FnOnce(Statement<'a>) -> Result<T, Reported>,
) -> Declared<T> {
    statement.map(read).transpose()
}

/// Reads the cloth's size and how it lies at the start.
pub(crate) fn cloth<'a>(
    statement: Statement<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Cloth, Reported> {
    let signatures = CLOTHS.iter().map(signature);
    let Expr::Call(written) = statement.value() else {
        return Err(wrong_form(
            statement.value(),
            "a cloth",
            signatures,
            context,
        ));
    };
    let (row, args, bound) = call("cloth", written, signatures, Scope::Everywhere, context)?;
    for ((_, value), (_, expr)) in args.0.iter().zip(&bound) {
        // `edge` is the only unit without a size before the cloth is known.
        if matches!(value, ArgValue::Number(number) if number.is_nan()) {
            let message = "a side of the cloth cannot be given in `edge`, the cloth's own side";
            let diagnostic = Diagnostic::new(Code::WrongQuantity, expr.span(), message);
            return Err(context.error(diagnostic.help("write a length such as `250mm`")));
        }
    }
    let cloth = (CLOTHS[row].make)(&args);
    if let Some(grid) = context.grid {
        return replaced(cloth, grid, statement, context);
    }
    rounded(&cloth, &args.0, statement, context);
    Ok(cloth)
}

fn signature<T>(row: &'static Call<T>) -> &'static Signature {
    &row.signature
}

fn wrong_form(
    value: Expr<'_>,
    expected: &str,
    rows: impl Iterator<Item = &'static Signature>,
    context: &mut Context<'_, '_>,
) -> Reported {
    let forms: Vec<String> = rows.map(Signature::form).collect();
    let message = format!("expected {expected}");
    let diagnostic = Diagnostic::new(Code::WrongForm, value.span(), message);
    context.error(diagnostic.help(format!("write {}", among(forms.iter().map(String::as_str)))))
}

/// Replaces the declared grid by the caller's, if there is one.
fn replaced(
    declared: Cloth,
    [dimx, dimy]: [u32; 2],
    statement: Statement<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Cloth, Reported> {
    let [least, most] = particle_limits();
    if [dimx, dimy].iter().all(|dim| (least..=most).contains(dim)) {
        return Ok(Cloth {
            dimx,
            dimy,
            ..declared
        });
    }
    let message = format!("the start's cloth has {dimx} by {dimy} particles");
    let diagnostic = Diagnostic::new(Code::OutOfRange, statement.value().span(), message);
    let help = format!("accepted are {least} to {most} particles on each side");
    Err(context.error(diagnostic.help(help)))
}

/// Notes that a cloth of whole particles is not exactly as large as stated.
fn rounded(
    cloth: &Cloth,
    args: &[(&str, ArgValue)],
    statement: Statement<'_>,
    context: &mut Context<'_, '_>,
) {
    let Cloth { dimx, dimy, .. } = *cloth;
    let side_mm = |n_particles: u32| f64::from(n_particles - 1) * SPACING_M * 1000.0;
    let is_exact = |(name, value): &(&str, ArgValue)| match (*name, value) {
        ("width", ArgValue::Number(m)) => (m * 1000.0 - side_mm(dimx)).abs() < 1e-6,
        ("depth" | "side", ArgValue::Number(m)) => (m * 1000.0 - side_mm(dimy)).abs() < 1e-6,
        _ => true,
    };
    let is_grid = matches!(statement.value(), Expr::Call(call) if call.name().text() == "grid");
    if is_grid || args.iter().all(is_exact) {
        return;
    }
    let message = format!(
        "the cloth has {dimx} by {dimy} particles, so its sides are {}mm and {}mm",
        side_mm(dimx),
        side_mm(dimy)
    );
    let diagnostic = Diagnostic::new(Code::Rounded, statement.value().span(), message);
    context.remark(diagnostic.help(format!("`grid({dimx}, {dimy})` says the same exactly")));
}

/// Reads where the camera is, and what it sees.
pub(crate) fn camera<'a>(
    statement: Statement<'a>,
    context: &mut Context<'a, '_>,
) -> Result<Camera, Reported> {
    let signatures = CAMERAS.iter().map(signature);
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
pub(crate) fn fits_picture(
    laid: Statement<'_>,
    seen: Statement<'_>,
    context: &mut Context<'_, '_>,
) {
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

/// Reads how the gripper carries and releases the cloth.
pub(crate) fn picker(
    statement: Statement<'_>,
    context: &mut Context<'_, '_>,
) -> Result<Picker, Reported> {
    let name = name_of(statement.value(), "picker", Picker::WORDS, context)?;
    Ok(Picker::from_word(name).unwrap_or_default())
}

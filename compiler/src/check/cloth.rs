//! `cloth grid(55, 44, material: towel)`: how large the cloth is, how it lies, and what it is made of.

use super::context::{Context, Result};
use super::expressions::{made, without_edge};
use super::material;
use crate::diag::Code;
use crate::lang::calls::{CLOTHS, SPACING};
use fab_grammar::Span;
use fab_grammar::ast::Statement;
use fab_program::exact::written;
use fab_program::{Cloth, PARTICLES_A_SIDE, RECORDED_SPACING_M};

/// Reads the cloth's size and how it lies at the start.
pub(crate) fn check(statement: Statement<'_>, context: &mut Context<'_>) -> Result<Cloth> {
    let (mut cloth, args, bound) = made("cloth", statement.value(), CLOTHS, context)?;
    let message = "a length of the cloth cannot be given in `edge`, the cloth's own side";
    without_edge(&args, &bound, message, context)?;
    if let Some((_, material)) = material::of_call(&bound, context)? {
        cloth.material = material;
    }
    let spacing = bound.iter().find(|(arg, _)| arg.name == SPACING.name);
    if let Some((_, expr)) = spacing {
        check_spacing(&cloth, expr.span(), context)?;
    }
    if let Some(material) = &cloth.material
        && let Some(why) = context
            .loaded
            .loader
            .refuses_cloth(material, cloth.spacing_m)
    {
        let message = format!("the cloth cannot be laid in the simulator: {why}");
        let at = statement.value().span();
        let help = "state a larger `spacing`; a run on a real arm is not affected";
        context.warn(Code::ClothTooStiff, at, message, help);
    }
    if let Some(grid) = context.grid {
        return replaced(cloth, grid, statement, context);
    }
    Ok(cloth)
}

/// Reports a spacing that the cloth cannot have: the recorded one has its own, and a side can have too many particles.
fn check_spacing(cloth: &Cloth, at: Span, context: &mut Context<'_>) -> Result<()> {
    if cloth.material.is_none() && cloth.spacing_m != RECORDED_SPACING_M {
        let message = "the recorded cloth has a spacing of `6.25mm`";
        let help =
            "its springs were fitted at that spacing; leave `spacing` out, or state a `material`";
        return Err(context.refuse(Code::OutOfRange, at, message, help));
    }
    let [_, most] = PARTICLES_A_SIDE;
    let longer = cloth.dimx.max(cloth.dimy);
    if longer > most {
        let spacing = written(mm(cloth.spacing_m), 3);
        let message = format!("a side would have `{longer}` particles `{spacing}mm` apart");
        let least_mm = (cloth.edge_m() * 1e4 / f64::from(most - 1)).ceil() / 10.0;
        let help = format!(
            "a side has at most {most} particles; write `spacing: {}mm`, or a side of at most `{}mm`",
            written(least_mm, 1),
            written(mm(cloth.spacing_m * f64::from(most - 1)), 3),
        );
        return Err(context.refuse(Code::OutOfRange, at, message, help));
    }
    Ok(())
}

/// Replaces the declared grid with the caller's, if there is one.
fn replaced(
    declared: Cloth,
    [dimx, dimy]: [u32; 2],
    statement: Statement<'_>,
    context: &mut Context<'_>,
) -> Result<Cloth> {
    let [least, most] = PARTICLES_A_SIDE;
    if [dimx, dimy].iter().all(|dim| (least..=most).contains(dim)) {
        return Ok(Cloth {
            dimx,
            dimy,
            ..declared
        });
    }
    let message = format!("the start's cloth has {dimx} by {dimy} particles");
    let help = format!("a side has {least} to {most} particles");
    Err(context.refuse(Code::OutOfRange, statement.value().span(), message, help))
}

fn mm(metres: f64) -> f64 {
    metres * 1000.0
}

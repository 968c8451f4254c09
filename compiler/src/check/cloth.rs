//! `cloth grid(55, 44)`, `cloth square(250mm)`, `cloth rectangle(338mm, 269mm)`.

use super::Context;
use super::arguments::{Bound, bare, bind, optional};
use super::quantity::{Measure, Wanted, quantity, read, read_whole};
use crate::ast::{Expr, ExprKind, Ident, Statement};
use crate::diag::{Code, Diagnostic};
use fab_program::{Cloth, ClothStart};

/// Distance between particles, metres: the grid that the paper's cloths have (protocol, section 1).
const SPACING_M: f64 = 0.00625;

/// The most particles on a side; their number grows with the square.
const MAX_SIDE: u32 = 200;

const COUNT: Wanted = Wanted {
    measure: Measure::Number,
    range: 2.0..=MAX_SIDE as f64,
    range_words: "a count of particles from `2` to `200`",
};

/// Half a spacing more and the side would round to another particle.
const SIDE: Wanted = Wanted {
    measure: Measure::Length,
    range: SPACING_M..=SPACING_M * (MAX_SIDE - 1) as f64,
    range_words: "a side from `6.25mm` to `1243.75mm`",
};

/// Builds the cloth.
pub(crate) fn check(statement: &Statement, context: &mut Context<'_>) -> Option<Cloth> {
    let (name, arguments) = match &statement.value.kind {
        ExprKind::Call { name, arguments } => (name, arguments.as_slice()),
        _ => {
            context.push(wrong_form(&statement.value));
            return None;
        }
    };
    let parameters: &[_] = match name.text.as_str() {
        "grid" | "rectangle" => &[bare("width"), bare("depth"), optional("start")],
        "square" => &[bare("side"), optional("start")],
        _ => {
            context.unknown("cloth", name, ["grid", "rectangle", "square"]);
            return None;
        }
    };
    let bound = bind(name, arguments, parameters, context)?;
    let start = bound
        .get("start")
        .map_or(Some(ClothStart::Flat), |start| self::start(start, context));
    let cloth = match context.grid {
        Some(grid) => replaced(grid, statement, context),
        None => sized(name, statement, &bound, context),
    };
    Some(Cloth {
        start: start?,
        ..cloth?
    })
}

/// Takes the grid that a caller gives in place of the declared one.
fn replaced(
    [dimx, dimy]: [u32; 2],
    statement: &Statement,
    context: &mut Context<'_>,
) -> Option<Cloth> {
    if [dimx, dimy].iter().any(|dim| !(2..=MAX_SIDE).contains(dim)) {
        let message = format!("the start has {dimx} by {dimy} particles in this cloth's place");
        context.push(
            Diagnostic::new(Code::OutOfRange, statement.value.span, message).help(format!(
                "right would be from 2 to {MAX_SIDE} particles on each side"
            )),
        );
        return None;
    }
    Some(Cloth {
        dimx,
        dimy,
        spacing_m: SPACING_M,
        start: ClothStart::Flat,
    })
}

fn sized(
    name: &Ident,
    statement: &Statement,
    bound: &Bound<'_>,
    context: &mut Context<'_>,
) -> Option<Cloth> {
    match name.text.as_str() {
        "grid" => {
            let dimx = read_whole(bound.get("width")?, &COUNT, context);
            let dimy = read_whole(bound.get("depth")?, &COUNT, context);
            Some(Cloth {
                dimx: dimx?,
                dimy: dimy?,
                spacing_m: SPACING_M,
                start: ClothStart::Flat,
            })
        }
        "square" => measured(statement, bound, ["side", "side"], context),
        _ => measured(statement, bound, ["width", "depth"], context),
    }
}

/// Reads how the cloth lies at first.
fn start(expr: &Expr, context: &mut Context<'_>) -> Option<ClothStart> {
    match &expr.kind {
        ExprKind::Name(name) if name == "flat" => Some(ClothStart::Flat),
        ExprKind::Name(name) if name == "crumpled" => Some(ClothStart::Crumpled),
        ExprKind::Text(text) => {
            let file = super::files::named(text, "a start file", context)?;
            if !file.path.ends_with(".npy") {
                let written = context.written(expr.span);
                let message = format!("{written} names no start file");
                context.push(Diagnostic::new(Code::WrongForm, expr.span, message).help(
                    "a start file ends in `.npy`; `flat` and `crumpled` stand without quotes",
                ));
                return None;
            }
            Some(ClothStart::File { file })
        }
        _ => {
            let found = context.written(expr.span);
            let message = format!("expected a way to lie, found `{found}`");
            context.push(Diagnostic::new(Code::WrongForm, expr.span, message).help(
                "write `start: flat`, `start: crumpled`, or the path of a start file in quotes",
            ));
            None
        }
    }
}

fn wrong_form(value: &Expr) -> Diagnostic {
    Diagnostic::new(Code::WrongForm, value.span, "expected a cloth")
        .help("write `grid(55, 44)` for particles, `square(250mm)` or `rectangle(338mm, 269mm)` for sides")
}

fn measured(
    statement: &Statement,
    bound: &Bound<'_>,
    sides: [&str; 2],
    context: &mut Context<'_>,
) -> Option<Cloth> {
    for side in sides {
        if let Some(side) = bound.get(side)
            && quantity(side, context).is_some_and(|side| side.unit == "edge")
        {
            let message = "a side of the cloth is counted in the cloth's own side";
            context.push(
                Diagnostic::new(Code::WrongQuantity, side.span, message)
                    .help("write a length such as `250mm`"),
            );
            return None;
        }
    }
    let [width_m, depth_m] =
        sides.map(|side| bound.get(side).and_then(|side| read(side, &SIDE, context)));
    let (width_m, depth_m) = (width_m?, depth_m?);
    let particles = |side_m: f64| (side_m / SPACING_M).round() as u32 + 1;
    let cloth = Cloth {
        dimx: particles(width_m),
        dimy: particles(depth_m),
        spacing_m: SPACING_M,
        start: ClothStart::Flat,
    };
    let side_mm = |n_particles: u32| f64::from(n_particles - 1) * SPACING_M * 1000.0;
    let is_exact =
        |side_m: f64, n_particles: u32| (side_m * 1000.0 - side_mm(n_particles)).abs() < 1e-6;
    if !is_exact(width_m, cloth.dimx) || !is_exact(depth_m, cloth.dimy) {
        let Cloth { dimx, dimy, .. } = cloth;
        let message = format!(
            "the cloth has {dimx} by {dimy} particles and so sides of {}mm and {}mm",
            side_mm(dimx),
            side_mm(dimy)
        );
        context.push(
            Diagnostic::new(Code::Rounded, statement.value.span, message)
                .help(format!("`grid({dimx}, {dimy})` says the same exactly")),
        );
    }
    Some(cloth)
}

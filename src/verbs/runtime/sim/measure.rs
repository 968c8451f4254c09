//! `fabc sim measure`: what a textile laboratory would read of a simulated cloth, beside what its material declares.

use super::SPACING_M;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::materials;
use clap::{Args, ValueHint};
use fab_base::table::{Align, aligned};
use fab_program::SmallestFold;
use fab_sim::measure::{Reading, textile_table};
use fab_sim::{Grid, Material, Params};
use fab_world::corner_fold::{CARRIED_MM, CornerFold};
use fab_world::simulated;
use serde::Serialize;
use std::borrow::Cow;

/// The reading of a corner that is carried by [`CARRIED_MM`].
const CARRIED: &str = "corner carried 40 mm";
const _: () = assert!(CARRIED_MM == 40);

#[derive(Args)]
pub struct MeasureArguments {
    /// The material: a shipped one (`cotton`, `towel`, `denim`, `silk`), or `FILE.fab:NAME` for one of a file.
    #[arg(value_name = "MATERIAL", value_hint = ValueHint::FilePath)]
    pub material: String,
    /// Distance between particles, millimetres.
    #[arg(long, value_name = "MM", default_value_t = 1000.0 * SPACING_M)]
    pub spacing: f64,
    /// Search the smallest fold of a corner that stays, too, which takes ten times as long or more.
    #[arg(long)]
    pub smallest_fold: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct Measured {
    params: String,
    material: Material,
    spacing_mm: f64,
    readings: Vec<Reading>,
    warnings: Vec<String>,
}

pub fn run(arguments: &MeasureArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    let material = simulated::material(&materials::find(&arguments.material, io)?);
    let spacing_m = 0.001 * arguments.spacing;
    let spacing = arguments.spacing;
    Grid::new(2, 2, spacing_m as f32)
        .map_err(|error| Failure::usage(format!("`--spacing {spacing}`: {error}")))?;
    let warnings = material.check(spacing_m as f32)?;
    let mut readings = textile_table(&material, spacing_m as f32)?;
    let params = Params {
        material: Some(material.clone()),
        ..Params::default()
    };
    let hash = params.hash();
    for Reading { what, .. } in readings.iter().filter(|it| !it.measured.is_finite()) {
        io.talk(&format!(
            "{what} has no reading at this spacing; choose a smaller `--spacing`"
        ));
    }
    io.progress("folding corners");
    let mut fold = CornerFold::new(params, spacing_m)?;
    let stays_mm = fold.stays_mm(&interrupt)?;
    readings.push(of_corner(CARRIED, "how far away it stays".into(), stays_mm));
    if arguments.smallest_fold {
        let (method, mm) = match fold.smallest(&interrupt)? {
            SmallestFold::From { mm } => ("carried so far, it stays".into(), Some(mm.into())),
            SmallestFold::NoneUpTo { mm } => (format!("none up to {mm} mm stays").into(), None),
        };
        readings.push(of_corner("smallest corner fold", method, mm));
    }
    io.progress("");
    let measured = Measured {
        params: hash,
        material,
        spacing_mm: spacing,
        readings,
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    io.either(arguments.json, &measured, || text(&measured.readings));
    for warning in &measured.warnings {
        io.talk(warning);
    }
    Ok(Exit::Done)
}

/// Returns what becomes of a corner of a square of 340 mm that is carried along the diagonal.
fn of_corner(what: &'static str, method: Cow<'static, str>, mm: Option<f64>) -> Reading {
    Reading {
        what,
        method,
        unit: "mm",
        declared: None,
        expected: None,
        measured: mm.unwrap_or(f64::NAN),
        within: None,
    }
}

fn text(readings: &[Reading]) -> String {
    use Align::{Left, Right};
    let titles = [
        "", "declared", "expected", "measured", "", "within", "method",
    ];
    let mut table = vec![titles.map(str::to_owned)];
    table.extend(readings.iter().map(cells));
    aligned(&[Left, Right, Right, Right], &table).join("\n") + "\n"
}

fn cells(reading: &Reading) -> [String; 7] {
    let digits = match (reading.unit, reading.declared) {
        ("", _) => 3,
        ("mm", Some(declared)) if declared < 1.0 => 2,
        _ => 1,
    };
    let value = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.digits$}"));
    let is_off = reading.is_within() == Some(false);
    let mark = if is_off { "off: " } else { "" };
    let within = reading.within.map(|[least, most]| {
        // The bounds of small shares differ in one digit more.
        let digits = if digits == 3 { 4 } else { 1 };
        format!("{mark}{least:.digits$} to {most:.digits$}")
    });
    [
        reading.what.to_owned(),
        value(reading.declared),
        value(reading.expected),
        value(Some(reading.measured).filter(|it| it.is_finite())),
        reading.unit.to_owned(),
        within.unwrap_or("-".to_owned()),
        reading.method.to_string(),
    ]
}

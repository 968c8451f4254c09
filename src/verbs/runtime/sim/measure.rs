//! `fabc sim measure`: what a textile laboratory would read of a simulated cloth, beside what its material declares.

use super::SPACING_M;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources;
use crate::verbs::runtime::setting::materials;
use clap::Args;
use clap::ValueHint;
use fab_program::SmallestFold;
use fab_sim::measure::{Reading, textile_table};
use fab_sim::{Grid, Material, Params};
use fab_world::corner_fold::{CARRIED_MM, CornerFold};
use fab_world::{WorldError, simulated};
use serde_json::{Value, json};
use std::path::Path;

/// What `--help` says at its end.
const EXAMPLES: &str = "Examples:
  fabc sim measure cotton
  fabc sim measure tasks/dishcloth.fab:dishcloth --smallest-fold
  fabc sim measure denim --set bending_length_m.warp=0.02

docs/materials.md says how a cloth is measured on a desk, and what each line means.";

/// Arguments of `sim measure`.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct MeasureArguments {
    /// The material: a shipped one (`cotton`, `towel`, `denim`, `silk`), `FILE.fab:NAME` for one of a file, or a `.json` file with one object.
    #[arg(value_name = "MATERIAL", value_hint = ValueHint::FilePath)]
    pub material: String,
    /// Replace a value of the material, such as `bending_length_m.warp=0.02`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
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

/// Measures the material and reports.
pub fn run(arguments: &MeasureArguments, io: &Io) -> Result<Exit, Failure> {
    let mut values = named(&arguments.material, io)?;
    for change in &arguments.set {
        replace(&mut values, change)?;
    }
    let material: Material = serde_json::from_value(values)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", arguments.material)))?;
    let spacing_m = (0.001 * arguments.spacing) as f32;
    Grid::new(2, 2, spacing_m)
        .map_err(|error| Failure::usage(format!("`--spacing {}`: {error}", arguments.spacing)))?;
    let warnings = material
        .check(spacing_m)
        .map_err(|error| Failure::environment(format!("`{}`: {error}", arguments.material)))?;
    io.progress("measuring");
    let readings = textile_table(&material, spacing_m).map_err(Failure::environment)?;
    let params = Params {
        material: Some(material.clone()),
        ..Params::default()
    };
    let corner = corner(arguments, &params, io)?;
    io.progress("");
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    if arguments.json {
        io.json(&json!({
            "params": params.hash(),
            "material": material,
            "spacing_mm": arguments.spacing,
            "readings": readings,
            "corner": corner,
            "warnings": warnings,
        }));
    } else {
        io.data(&(table(&readings, &corner) + "\n"));
    }
    let missing = readings
        .iter()
        .filter(|reading| !reading.measured.is_finite());
    for reading in missing {
        io.talk(&format!(
            "{} has no reading at this spacing; choose a smaller `--spacing`",
            reading.what
        ));
    }
    if !arguments.json {
        for warning in warnings {
            io.talk(&warning);
        }
    }
    Ok(Exit::Done)
}

/// Returns the values of the material that the command line names.
fn named(name: &str, io: &Io) -> Result<Value, Failure> {
    if name == "pyflex" {
        return Err(Failure::usage(
            "`pyflex` is the recorded scene's cloth of springs: it declares no value of a textile, and has no bending length, since each overhang shows another",
        ));
    }
    if !name.ends_with(".json") {
        let declared = materials::find(name, io)?;
        return serde_json::to_value(simulated::material(&declared)).map_err(Failure::environment);
    }
    let wrong = |why: String| Failure::environment(format!("`{name}`: {why}"));
    let text = sources::read_text(Path::new(name)).map_err(wrong)?;
    serde_json::from_str(&text).map_err(|error| {
        Failure::environment(format!("`{name}` is no JSON of a material: {error}"))
    })
}

/// Replaces one value; a part of a direction is named after a dot.
fn replace(values: &mut Value, change: &str) -> Result<(), Failure> {
    let wrong = |why: String| Failure::usage(format!("`--set {change}`: {why}"));
    let (name, text) = change
        .split_once('=')
        .ok_or_else(|| wrong("write NAME=VALUE, such as `weight_kg_m2=0.15`".to_owned()))?;
    let value: f64 = text
        .parse()
        .map_err(|_| wrong(format!("`{text}` is no number")))?;
    let mut place = values;
    for part in name.split('.') {
        let object = place
            .as_object_mut()
            .ok_or_else(|| wrong(format!("`{name}` is no part of the material")))?;
        let there: Vec<String> = object.keys().cloned().collect();
        place = object.get_mut(part).ok_or_else(|| {
            wrong(format!(
                "there is no `{part}`; there are {}",
                there.join(", ")
            ))
        })?;
    }
    if !place.is_number() {
        return Err(wrong(format!(
            "`{name}` has parts; name one, such as `{name}.warp`"
        )));
    }
    *place = json!(value);
    Ok(())
}

/// What becomes of a corner of a square of 340 mm that is carried along the diagonal.
#[derive(serde::Serialize)]
struct Corner {
    carried_mm: u32,
    /// How far from its place it comes to rest; null if nothing was held.
    stays_mm: Option<f64>,
    /// Null if it was not asked for.
    smallest_fold: Option<SmallestFold>,
}

fn corner(arguments: &MeasureArguments, params: &Params, io: &Io) -> Result<Corner, Failure> {
    let failed = |error: WorldError| match error {
        WorldError::Interrupted => Failure::interrupted(),
        error => Failure::environment(error),
    };
    let interrupt = io.interrupt()?;
    let mut fold = CornerFold::new(params.clone(), 0.001 * arguments.spacing).map_err(failed)?;
    let stays_mm = fold.stays_mm(&interrupt).map_err(failed)?;
    let smallest_fold = match arguments.smallest_fold {
        true => {
            io.progress("searching the smallest fold");
            Some(fold.smallest(&interrupt).map_err(failed)?)
        }
        false => None,
    };
    Ok(Corner {
        carried_mm: CARRIED_MM,
        stays_mm,
        smallest_fold,
    })
}

fn table(readings: &[Reading], corner: &Corner) -> String {
    let titles = [
        "", "declared", "expected", "measured", "", "within", "method",
    ];
    let mut lines = vec![line(titles)];
    lines.extend(readings.iter().map(|reading| {
        let digits = match (reading.unit, reading.declared) {
            ("", _) => 3,
            ("mm", Some(declared)) if declared < 1.0 => 2,
            _ => 1,
        };
        let value = |value: Option<f64>| match value {
            Some(value) => format!("{value:.digits$}"),
            None => "-".to_owned(),
        };
        let [declared, expected] = [reading.declared, reading.expected].map(value);
        let measured = value(Some(reading.measured).filter(|it| it.is_finite()));
        let mark = if reading.is_within() == Some(false) {
            "off: "
        } else {
            ""
        };
        let within = match reading.within {
            Some([least, most]) => {
                // The bounds of small shares differ in one digit more.
                let digits = if digits == 3 { 4 } else { 1 };
                format!("{mark}{least:.digits$} to {most:.digits$}")
            }
            None => "-".to_owned(),
        };
        let Reading {
            what, unit, method, ..
        } = reading;
        line([what, &declared, &expected, &measured, unit, &within, method])
    }));
    let (smallest, how) = match corner.smallest_fold {
        Some(SmallestFold::From { mm }) => (format!("{mm}"), "carried so far, it stays".to_owned()),
        Some(SmallestFold::NoneUpTo { mm }) => {
            ("-".to_owned(), format!("none up to {mm} mm stays"))
        }
        None => ("-".to_owned(), "`--smallest-fold` searches it".to_owned()),
    };
    let carried = format!("corner carried {} mm", corner.carried_mm);
    let stays = corner
        .stays_mm
        .map_or("-".to_owned(), |mm| format!("{mm:.1}"));
    let stays_how = "how far away it stays";
    lines.push(line([&carried, "-", "-", &stays, "mm", "-", stays_how]));
    lines.push(line([
        "smallest corner fold",
        "-",
        "-",
        &smallest,
        "mm",
        "-",
        &how,
    ]));
    lines.join("\n")
}

fn line([what, declared, expected, measured, unit, within, method]: [&str; 7]) -> String {
    format!("{what:<24} {declared:>9} {expected:>9} {measured:>9}  {unit:<4} {within:<21} {method}")
}

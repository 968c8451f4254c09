//! `fabc sim measure`: what a textile laboratory would read of a simulated cloth, beside what its material declares.

use super::SPACING_M;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources;
use crate::verbs::runtime::setting::materials;
use clap::Args;
use clap::ValueHint;
use fab_sim::measure::{Reading, textile_table};
use fab_sim::{Grid, Material, Params};
use fab_world::simulated;
use serde_json::{Value, json};
use std::path::Path;

/// Arguments of `sim measure`.
#[derive(Args)]
pub struct MeasureArguments {
    /// The material: the name of a shipped one, `FILE.fab:NAME` for one of a file, or a `.json` file with one object.
    #[arg(value_name = "MATERIAL", value_hint = ValueHint::FilePath)]
    pub material: String,
    /// Replace a value of the material, such as `bending_length_m.warp=0.02`.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Distance between particles, millimetres.
    #[arg(long, value_name = "MM", default_value_t = 1000.0 * SPACING_M)]
    pub spacing: f64,
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
    let readings = textile_table(&material, spacing_m);
    io.progress("");
    let readings = readings.map_err(Failure::environment)?;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    if arguments.json {
        let params = Params {
            material: Some(material.clone()),
            ..Params::default()
        };
        io.json(&json!({
            "params": params.hash(),
            "material": material,
            "spacing_mm": arguments.spacing,
            "readings": readings,
            "warnings": warnings,
        }));
    } else {
        io.data(&(table(&readings) + "\n"));
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
    let bytes = sources::read_bounded(Path::new(name)).map_err(wrong)?;
    serde_json::from_slice(&bytes).map_err(|error| {
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

fn table(readings: &[Reading]) -> String {
    let mut lines = vec![format!(
        "{:<24} {:>9} {:>9} {:>9}  {:<4} method",
        "", "declared", "expected", "measured", ""
    )];
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
        format!(
            "{:<24} {declared:>9} {expected:>9} {measured:>9}  {:<4} {}",
            reading.what, reading.unit, reading.method
        )
    }));
    lines.join("\n")
}

//! The command line of `fabc new`.

use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

/// Arguments of `new`.
#[derive(Args)]
pub struct NewArguments {
    /// What to begin.
    #[command(subcommand)]
    pub what: NewVerb,
}

/// What to begin.
#[derive(Subcommand)]
pub enum NewVerb {
    /// Writes a folding task that runs at once, with comments that say how to change it.
    Fold(NewFoldArguments),
    /// Writes a smoothing task that runs at once, with comments that say how to change it.
    Smoothing(NewTaskArguments),
}

impl NewVerb {
    /// Returns whether stdout must be one JSON document, whatever happens.
    pub fn wants_json(&self) -> bool {
        match self {
            NewVerb::Fold(arguments) => arguments.task.json,
            NewVerb::Smoothing(arguments) => arguments.json,
        }
    }
}

/// Arguments of `new fold`.
#[derive(Args)]
pub struct NewFoldArguments {
    #[command(flatten)]
    pub task: NewTaskArguments,
    /// Pictures of your own, the flat cloth first and then one after each step: the steps are found in them. Arrows that
    /// they carry are found where they are black, with a ring at the tail and a head at the tip; others are proposed.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "PNG", num_args = 1.., value_hint = ValueHint::FilePath)]
    pub from_images: Vec<PathBuf>,
    /// The flat cloth's longer side, such as `340mm`; without `--height` the camera's height follows from it.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "LENGTH", requires = "from_images", value_parser = cloth)]
    pub cloth: Option<f64>,
    /// The camera's height above the table, such as `65cm`; without `--cloth` the cloth's size follows from it. With both
    /// the camera's field of view follows.
    #[cfg(feature = "runtime")]
    #[arg(long, value_name = "LENGTH", requires = "from_images", value_parser = height)]
    pub height: Option<f64>,
}

/// Where a new task goes.
#[derive(Args)]
pub struct NewTaskArguments {
    /// The task's name: letters, digits and `_`; the file is NAME.fab.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// The folder that gets the file; default: the current one.
    #[arg(long = "in", value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub folder: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Reads a cloth's side, metres.
#[cfg(feature = "runtime")]
fn cloth(text: &str) -> Result<f64, String> {
    length(text, [20.0, 1200.0])
}

/// Reads a camera's height, metres.
#[cfg(feature = "runtime")]
fn height(text: &str) -> Result<f64, String> {
    length(text, [100.0, 5000.0])
}

/// Reads a length with its unit, metres; both ends of what it may be are in millimetres.
#[cfg(feature = "runtime")]
fn length(text: &str, [least_mm, most_mm]: [f64; 2]) -> Result<f64, String> {
    let units = [("mm", 1.0), ("cm", 10.0), ("m", 1000.0)];
    let read = |(unit, mm): (&str, f64)| {
        let number: f64 = text.strip_suffix(unit)?.trim_end().parse().ok()?;
        Some(number * mm)
    };
    let Some(found_mm) = units.into_iter().find_map(read) else {
        return Err("write a number with its unit, such as `340mm`, `34cm` or `0.34m`".to_owned());
    };
    match (least_mm..=most_mm).contains(&found_mm) {
        // Whole tenths of a millimetre, as the file states them.
        true => Ok((found_mm * 10.0).round() / 10_000.0),
        false => Err(format!("right is from {least_mm}mm to {most_mm}mm")),
    }
}

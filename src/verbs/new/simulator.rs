//! The part of `fabc new` that needs the simulator: drafts a fold from pictures, and draws subgoal pictures.

mod from_images;
mod page;

pub use from_images::draft;

use crate::exit::Failure;
use crate::io::Io;
use crate::verbs::runtime::setting;
use clap::{Args, ValueHint};
use fab_agent::subgoals::SubgoalSet;
use fab_program::units::{self, Dimension};
use fab_program::{Program, Subgoals};
use std::path::{Path, PathBuf};

/// Pictures to draft a fold from.
#[derive(Args)]
pub struct PictureArguments {
    /// Pictures of your own, the flat cloth first and then one after each step: the steps are found in them.
    #[arg(long, value_name = "PICTURE", num_args = 1.., value_hint = ValueHint::FilePath)]
    pub from_images: Vec<PathBuf>,
    /// The flat cloth's longer side, such as `340mm`, from which the camera's height follows.
    #[arg(long, value_name = "LENGTH", requires = "from_images", value_parser = length)]
    pub cloth: Option<f64>,
}

/// Parses the length of a cloth with its unit, metres.
fn length(text: &str) -> Result<f64, &'static str> {
    let letter = |letter: char| letter.is_ascii_alphabetic();
    let (number, unit) = text.split_at(text.find(letter).unwrap_or(text.len()));
    let unit = units::find(unit).filter(|unit| unit.dimension == Dimension::Length);
    let number: Option<f64> = number.trim_end().parse().ok();
    let (Some(number), Some(unit)) = (number, unit) else {
        return Err("write a number with its unit, such as `340mm`, `34cm` or `0.34m`");
    };
    // Whole tenths of a millimetre, as the file states lengths.
    let length_m = (number * unit.size * 10_000.0).round() / 10_000.0;
    let fits = (0.02..=1.2).contains(&length_m);
    fits.then_some(length_m)
        .ok_or("right is from 20mm to 1200mm")
}

/// Executes a task's demonstration; `None` if it has none. Also returns the parameters of the world in which it did.
pub fn demonstrated(program: &Program, io: &Io) -> Result<Option<(SubgoalSet, String)>, Failure> {
    if !matches!(program.subgoals, Some(Subgoals::Demonstrate { .. })) {
        return Ok(None);
    }
    let interrupt = io.interrupt()?;
    let mut world = setting::world(program)?;
    let beside = Path::new("");
    let drawn = SubgoalSet::draw(program, beside, world.as_mut(), &interrupt)?;
    Ok(Some((drawn, world.parameters())))
}

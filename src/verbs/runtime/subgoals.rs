//! `fabc subgoals`: draws a task's demonstration and pins the pictures beside its file.

pub mod offered;
mod tried;

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::shipped;
use crate::sources;
use crate::sources::TaskArguments;
use crate::verbs::runtime::setting;
use clap::Args;
use clap::ValueHint;
use fab_agent::subgoals::{Demonstrated, Drawn, Origin, SubgoalError, SubgoalSet};
use fab_base::files::ends_in;
use fab_compiler::diag;
use fab_picture::png;
use fab_program::{Arrow, SubgoalStep};
use fab_vision::VisionError;
use fab_world::WorldError;
use image::{RgbImage, imageops};
use offered::Offered;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Arguments of `subgoals`.
#[derive(Args)]
pub struct SubgoalsArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// Also draw all pictures with their arrows on one sheet.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Draws, pins, and lists the files.
pub fn run(arguments: &SubgoalsArguments, io: &Io) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task, io)?;
    if arguments.sheet.is_none() {
        shipped::check_own(&arguments.task.file, io)?;
    }
    let folder = sources::folder_of(&arguments.task.file);
    let interrupt = io.interrupt()?;
    let mut world = setting::world(&program).map_err(Failure::environment)?;
    let mut offered = Offered::of(&program);
    let watch = &mut |step: Demonstrated<'_>| offered.look(step);
    let drawn = SubgoalSet::draw(&program, &folder, world.as_mut(), &interrupt, watch);
    let drawn = drawn.map_err(failure)?;
    let mut files = match shipped::is_shipped(&arguments.task.file, io) {
        true => Vec::new(),
        false => drawn
            .pin(&program, &folder, &world.parameters())
            .map_err(Failure::environment)?,
    };
    for note in offered.notes {
        io.talk(&format!("note: {note}"));
    }
    let Drawn { set, trial } = drawn;
    let mut diagnostics = json!([]);
    if let Some(trial) = &trial {
        let tried = tried::compile(&arguments.task.file, &program, trial)?;
        if !tried.diagnostics.is_empty() {
            io.painted_talk(&sources::findings(&tried, io.talk_color()));
        }
        diagnostics = diag::to_json(&tried.diagnostics, &tried.sources);
    }
    let name = &program.task;
    match (set.origin, &arguments.sheet) {
        (Origin::Author, None) => io.talk(&format!(
            "`{name}` brings its own pictures; there are none to draw"
        )),
        (Origin::Author, Some(_)) => io.talk(&format!(
            "`{name}` brings its own pictures, which are left as they are; the sheet shows them"
        )),
        (Origin::Absent, _) => io.talk(&format!("`{name}` has no subgoals")),
        _ => {}
    }
    if let Some(path) = arguments
        .sheet
        .as_ref()
        .filter(|_| !set.pictures.is_empty())
    {
        if !ends_in(path, "png") {
            let shown = path.display();
            return Err(Failure::usage(format!(
                "`--sheet {shown}` is no PNG file; name one that ends in `.png`"
            )));
        }
        let sheet = sheet(&set).map_err(Failure::environment)?;
        write_file(path, &png::encode(&sheet))?;
        files.push(path.clone());
    }
    report(&files, &diagnostics, arguments, io);
    Ok(Exit::Done)
}

fn failure(error: SubgoalError) -> Failure {
    match error {
        SubgoalError::World(WorldError::Interrupted) => Failure::interrupted(),
        error => Failure::environment(error),
    }
}

/// Lays all pictures side by side, each with the arrow of its next fold.
fn sheet(set: &SubgoalSet) -> Result<RgbImage, VisionError> {
    const GAP_PX: u32 = 8;
    let width = set
        .pictures
        .iter()
        .map(|picture| picture.width() + GAP_PX)
        .sum::<u32>()
        - GAP_PX;
    let height = set.pictures.iter().map(RgbImage::height).max().unwrap_or(1);
    let mut sheet = RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
    let mut left = 0;
    for (number, bare) in set.pictures.iter().enumerate() {
        let last = number + 1 == set.pictures.len();
        let step = if last { None } else { set.step(number)? };
        let shown = match &step {
            Some(step) => step.picture(SubgoalStep::Now, Arrow::Drawn).clone(),
            None => bare.clone(),
        };
        imageops::replace(&mut sheet, &shown, i64::from(left), 0);
        left += shown.width() + GAP_PX;
    }
    Ok(sheet)
}

fn report(files: &[PathBuf], diagnostics: &Value, arguments: &SubgoalsArguments, io: &Io) {
    let names: Vec<String> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    if arguments.json {
        io.json(&json!({ "files": names, "diagnostics": diagnostics }));
    } else if !names.is_empty() {
        io.data(&names.join("\n"));
    }
}

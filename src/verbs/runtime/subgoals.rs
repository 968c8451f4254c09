//! `fabc subgoals`: draws a task's demonstration and pins the pictures beside its file.

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::shipped;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::setting;
use clap::{Args, ValueHint};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_compiler::diag;
use fab_picture::png;
use fab_program::{Arrow, SubgoalStep};
use fab_vision::VisionError;
use image::{RgbImage, imageops};
use serde_json::json;
use std::path::PathBuf;

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

pub fn run(arguments: &SubgoalsArguments, io: &Io) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task, io)?;
    if arguments.sheet.is_none() {
        shipped::check_own(&arguments.task.file, io)?;
    }
    let folder = sources::folder_of(&arguments.task.file);
    let interrupt = io.interrupt()?;
    let mut world = setting::world(&program)?;
    let set = SubgoalSet::draw(&program, &folder, world.as_mut(), &interrupt)?;
    let mut files = if shipped::is_shipped(&arguments.task.file, io) {
        Vec::new()
    } else {
        set.pin(&program, &folder, &world.parameters())?
    };
    let mut diagnostics = json!([]);
    if set.trial.is_some() {
        // What the steps do to the cloth is pinned beside the pictures.
        let mut found = sources::compile_looking(&arguments.task.file)?;
        let of_steps = [diag::Code::StepFoldsNothing, diag::Code::StepNotOffered];
        found.diagnostics.retain(|it| of_steps.contains(&it.code));
        found.left_out = 0;
        if !found.diagnostics.is_empty() {
            io.painted_talk(&sources::findings(&found, io.talk_color()));
        }
        diagnostics = diag::to_json(&found.diagnostics, &found.sources);
    }
    let name = &program.task;
    match set.origin {
        Origin::Author => io.talk(&format!(
            "`{name}` brings its own pictures, which are left as they are"
        )),
        Origin::Absent => io.talk(&format!("`{name}` has no subgoals")),
        _ => {}
    }
    let on_sheet = arguments.sheet.as_ref();
    if let Some(path) = on_sheet.filter(|_| !set.pictures.is_empty()) {
        setting::check_ending("--sheet", path, "png")?;
        let sheet = sheet(&set)?;
        write_file(path, &png::encode(&sheet))?;
        files.push(path.clone());
    }
    let files = files.iter().map(|file| file.display().to_string());
    let files: Vec<String> = files.collect();
    let document = json!({ "files": files, "diagnostics": diagnostics });
    io.either(arguments.json, &document, || files.join("\n"));
    Ok(Exit::Done)
}

/// Lays all pictures side by side, each with the arrow of its next fold.
fn sheet(set: &SubgoalSet) -> Result<RgbImage, VisionError> {
    const GAP_PX: u32 = 8;
    let widths = set.pictures.iter().map(|picture| picture.width() + GAP_PX);
    let height = set.pictures.iter().map(RgbImage::height).max().unwrap_or(1);
    let width = widths.sum::<u32>() - GAP_PX;
    let mut sheet = RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
    let mut left = 0;
    for (number, bare) in set.pictures.iter().enumerate() {
        let is_last = number + 1 == set.pictures.len();
        let step = if is_last { None } else { set.step(number)? };
        let shown = step
            .as_ref()
            .map_or(bare, |step| step.picture(SubgoalStep::Now, Arrow::Drawn));
        imageops::replace(&mut sheet, shown, i64::from(left), 0);
        left += shown.width() + GAP_PX;
    }
    Ok(sheet)
}

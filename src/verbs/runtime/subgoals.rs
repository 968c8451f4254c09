//! `fabc subgoals`: draws a task's demonstration and pins the pictures beside its file.

use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::shipped;
use crate::sources::{self, TaskArguments};
use crate::verbs::runtime::setting::{self, materials};
use clap::{Args, ValueHint};
use fab_agent::subgoals::{Origin, SubgoalSet};
use fab_base::interrupt::Interrupt;
use fab_compiler::diag;
use fab_picture::png;
use fab_program::{Arrow, Program, SubgoalStep};
use fab_vision::VisionError;
use image::{RgbImage, imageops};
use serde::Serialize;
use serde_json::json;
use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

#[derive(Args)]
pub struct SubgoalsArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// Also draw all pictures with their arrows on one sheet.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub sheet: Option<PathBuf>,
    /// Also try the demonstration with each shipped material, and say which keep every step folded.
    #[arg(long)]
    pub materials: bool,
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
    let mut document = json!({ "files": files, "diagnostics": diagnostics });
    let mut lines = files;
    if arguments.materials {
        if set.trial.is_none() {
            let why = format!(
                "`{name}` demonstrates no folds, so there is nothing to try with materials"
            );
            return Err(Failure::usage(why));
        }
        let tried = tried_materials(&program, &interrupt)?;
        lines.extend(tried.iter().map(|tried| tried.to_string()));
        document["materials"] = json!(tried);
    }
    io.either(arguments.json, &document, || lines.join("\n"));
    Ok(Exit::Done)
}

/// What a demonstration does to a cloth of a material.
#[derive(Serialize)]
struct TriedMaterial {
    material: String,
    /// The steps that fold nothing, from 1.
    folds_nothing: Vec<usize>,
    /// Why it cannot be tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

impl Display for TriedMaterial {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            material,
            folds_nothing,
            error,
        } = self;
        let steps: Vec<String> = folds_nothing.iter().map(usize::to_string).collect();
        match error {
            Some(why) => write!(f, "{material}: {why}"),
            None if steps.is_empty() => write!(f, "{material}: every step stays folded"),
            None => write!(f, "{material}: folds nothing in step {}", steps.join(", ")),
        }
    }
}

/// Executes the demonstration with each shipped material in place of the task's own.
fn tried_materials(
    program: &Program,
    interrupt: &Interrupt,
) -> Result<Vec<TriedMaterial>, Failure> {
    let mut tried = Vec::new();
    for material in materials::shipped()? {
        let name = material.name.clone();
        let mut other = program.clone();
        other.cloth.material = Some(material);
        let (steps, error) = match setting::world(&other) {
            Ok(mut world) => {
                let steps = SubgoalSet::steps_that_stay(&other, world.as_mut(), interrupt)?;
                (steps, None)
            }
            Err(why) => (Vec::new(), Some(why.to_string())),
        };
        let failed = (1..).zip(steps).filter(|(_, stays)| !stays);
        tried.push(TriedMaterial {
            material: name,
            folds_nothing: failed.map(|(number, _)| number).collect(),
            error,
        });
    }
    Ok(tried)
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

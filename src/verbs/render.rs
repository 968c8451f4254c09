//! `fabc render`: prints the exact messages of each stage, without asking a model.
//!
//! Points come from the camera at the chosen step; a build without the runtime writes typed placeholders. An earlier stage's answer, which only a model can
//! give, comes from `--reply`; without it, a typed placeholder takes its place.

#[cfg(feature = "runtime")]
pub mod camera;
pub mod page;
mod why;

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use crate::verbs::price::Price;
use crate::watch;
use clap::{Args, ValueHint};
use fab_base::wording::quoted;
use fab_program::render::PromptPicture;
use fab_program::{Arrow, Layers, Picture, Program, Stage, SubgoalStep};
use page::{DisplayPart, ShownStage};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct RenderArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// Only this stage.
    #[arg(long, value_name = "NAME")]
    pub stage: Option<String>,
    /// The step whose prompts are shown; earlier steps are done as demonstrated, or as the stand-in decides.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub step: u32,
    #[cfg(feature = "runtime")]
    #[command(flatten)]
    pub camera: camera::CameraArguments,
    /// Show which component, file and line each line comes from, and what each component weighs in tokens.
    #[arg(long)]
    pub why: bool,
    /// Write the messages and the pictures into this folder.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Run again whenever a file that was read changes, until Ctrl-C.
    #[arg(long, conflicts_with = "json")]
    pub watch: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

pub fn run(arguments: &RenderArguments, io: &Io) -> Result<Exit, Failure> {
    let entry = std::slice::from_ref(&arguments.task.file);
    #[cfg(feature = "runtime")]
    let others: Vec<PathBuf> = arguments.camera.files().collect();
    #[cfg(not(feature = "runtime"))]
    let others = Vec::new();
    let render = || render(arguments, io);
    watch::run(arguments.watch, entry, &others, render, io)
}

pub struct Rendered {
    stages: Vec<ShownStage>,
    /// What the model that is shown the messages costs, if one is named.
    price: Option<Price>,
}

fn render(arguments: &RenderArguments, io: &Io) -> Result<Exit, Failure> {
    let declared = sources::compile_task(&arguments.task, io)?;
    if arguments.step > declared.horizon {
        let (title, horizon, step) = (declared.title(), declared.horizon, arguments.step);
        return Err(Failure::usage(format!(
            "`{title}` has {horizon} steps; there is no step {step}"
        )));
    }
    #[cfg(feature = "runtime")]
    let rendered = camera::rendered(&declared, arguments, io)?;
    #[cfg(not(feature = "runtime"))]
    let rendered = without_camera(&declared, arguments)?;
    let Rendered { stages, price } = &rendered;
    if let Some(folder) = &arguments.out {
        write(folder, stages).map_err(|error| {
            Failure::environment(format!("cannot write into `{}`: {error}", folder.display()))
        })?;
    }
    let folder = sources::folder_of(&arguments.task.file);
    let why = |stage| why::of(stage, &folder, price.as_ref());
    let document = stages.iter().map(|stage| {
        let mut document = json!(stage);
        if arguments.why {
            document["why"] = why(stage);
        }
        document
    });
    let document = json!({ "stages": document.collect::<Vec<_>>() });
    io.either(arguments.json, &document, || {
        let texts = stages.iter().map(|stage| {
            if arguments.why {
                why::text(stage, &folder, price.as_ref())
            } else if arguments.out.is_none() {
                format!("=== stage {}\n{}", stage.name, stage.text())
            } else {
                String::new()
            }
        });
        let texts: Vec<String> = texts.collect();
        texts.join("\n").trim_end().to_owned()
    });
    for stage in stages {
        for (finding, number) in stage.findings.iter().zip(1..) {
            io.talk(&format!("`{}`, answer {number}: {finding}", stage.name));
        }
    }
    Ok(Exit::Done)
}

/// Renders stages with typed placeholders in place of points.
#[cfg(not(feature = "runtime"))]
fn without_camera(program: &Program, arguments: &RenderArguments) -> Result<Rendered, Failure> {
    let folder = sources::folder_of(&arguments.task.file);
    let stages = chosen_stages(program, arguments.stage.as_deref())?;
    let stages = stages.into_iter().map(|stage| {
        ShownStage::without_camera(program, &folder, stage, None, None, arguments.step)
    });
    Ok(Rendered {
        stages: stages.collect::<Result<_, Failure>>()?,
        price: None,
    })
}

fn chosen_stages<'p>(
    program: &'p Program,
    wanted: Option<&str>,
) -> Result<Vec<&'p Stage>, Failure> {
    let Some(wanted) = wanted else {
        return Ok(program.stages.iter().collect());
    };
    let mut stages = program.stages.iter();
    let stage = stages.find(|stage| stage.name == wanted);
    stage.map(|stage| vec![stage]).ok_or_else(|| {
        let (task, names) = (&program.task, program.stages.iter());
        let names = quoted(names.map(|stage| &stage.name));
        Failure::usage(format!("`{task}` has no stage `{wanted}`; it has {names}"))
    })
}

/// Says what a picture shows.
pub fn title(picture: &PromptPicture, step: u32) -> String {
    match picture {
        PromptPicture::File(file) => file.path.clone(),
        PromptPicture::Drawn(Picture::Scene { layers }) => match layers {
            Layers::Drawn => "scene with annotations".to_owned(),
            Layers::Absent => "scene".to_owned(),
        },
        PromptPicture::Drawn(Picture::Subgoal { which, arrow }) => {
            let number = step - u32::from(*which == SubgoalStep::Now);
            match arrow {
                Arrow::Drawn => format!("subgoal {number} with arrow"),
                Arrow::Absent => format!("subgoal {number}"),
            }
        }
    }
}

/// Writes `STAGE.txt` and `STAGE_N.png` for every stage.
fn write(folder: &Path, shown: &[ShownStage]) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    for stage in shown {
        let name = &stage.name;
        fs::write(folder.join(format!("{name}.txt")), stage.text())?;
        let parts = stage.messages.iter().flat_map(|message| &message.parts);
        let pictures = parts.filter_map(|part| match part {
            DisplayPart::Image { png, .. } => png.as_ref(),
            DisplayPart::Text { .. } => None,
        });
        for (png, number) in pictures.zip(1..) {
            fs::write(folder.join(format!("{name}_{number}.png")), png)?;
        }
    }
    Ok(())
}

//! `fabc render`: the exact messages of each stage, without asking a model.
//!
//! Points come from the camera at the chosen step, or from `--scene`. What only a model can say
//! (an earlier stage's answer) stands as a typed placeholder, and a line on stderr says so.

#[cfg_attr(feature = "runtime", path = "render/with_camera.rs")]
#[cfg_attr(not(feature = "runtime"), path = "render/without_camera.rs")]
mod camera;

use crate::cli::RenderArguments;
use crate::exit::{Exit, Failure};
use crate::{output, sources};
use compiler::facts::SceneView;
use compiler::program::{
    Arrow, KeypointShape, Layers, Picture, PixelPoint, Program, Read, Stage, Which,
};
use compiler::render::PromptPicture;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// One message as it is shown.
struct Shown {
    role: &'static str,
    parts: Vec<ShownPart>,
}

/// A piece of a shown message.
enum ShownPart {
    Text(String),
    Picture {
        /// What the picture shows.
        title: String,
        /// The file's bytes, where this build can draw it.
        png: Option<Vec<u8>>,
    },
}

/// Renders every stage, or the one that is asked for.
pub fn run(arguments: &RenderArguments) -> Result<Exit, Failure> {
    let declared = sources::compile_task(&arguments.task)?;
    let program = camera::fitted(&declared, arguments)?;
    let stages = chosen_stages(&program, arguments.stage.as_deref())?;
    if arguments.step > program.horizon {
        return Err(Failure::usage(format!(
            "`{}` has {} steps; there is no step {}",
            program.title(),
            program.horizon,
            arguments.step
        )));
    }
    let listed = match &arguments.scene {
        Some(path) => Some(Listed::read(&program, path)?),
        None => None,
    };
    let view = camera::View::at(&program, &declared, arguments)?;
    say_placeholders(&program, &stages);
    let mut shown = Vec::with_capacity(stages.len());
    for stage in stages {
        let messages = view
            .messages(&program, stage, listed.as_ref())
            .map_err(Failure::environment)?;
        shown.push((stage.name.as_str(), messages));
    }
    if let Some(folder) = &arguments.out {
        write(folder, &shown).map_err(|error| {
            Failure::environment(format!("cannot write into `{}`: {error}", folder.display()))
        })?;
    }
    if arguments.json {
        let stages: Vec<Value> = shown
            .iter()
            .map(|(stage, messages)| as_json(stage, messages))
            .collect();
        output::json(&json!({ "stages": stages }));
    } else if arguments.out.is_none() {
        let texts: Vec<String> = shown
            .iter()
            .map(|(stage, messages)| format!("=== stage {stage}\n{}", as_text(messages)))
            .collect();
        output::data(texts.join("\n").trim_end());
    }
    Ok(Exit::Done)
}

fn chosen_stages<'p>(
    program: &'p Program,
    wanted: Option<&str>,
) -> Result<Vec<&'p Stage>, Failure> {
    let Some(wanted) = wanted else {
        return Ok(program.stages.iter().collect());
    };
    match program.stages.iter().find(|stage| stage.name == wanted) {
        Some(stage) => Ok(vec![stage]),
        None => {
            let names: Vec<String> = program
                .stages
                .iter()
                .map(|stage| format!("`{}`", stage.name))
                .collect();
            Err(Failure::usage(format!(
                "`{}` has no stage `{wanted}`; it has {}",
                program.task,
                names.join(", ")
            )))
        }
    }
}

fn say_placeholders(program: &Program, stages: &[&Stage]) {
    for stage in &program.stages {
        if let Read::Text { name, .. } = &stage.read
            && stages.iter().any(|later| later.name != stage.name)
        {
            output::talk(&format!(
                "note: `{name}` is what a model answers in stage `{}`; it stands as a placeholder",
                stage.name
            ));
        }
    }
}

/// A scene whose points come from a file; its masks and boxes are not known.
struct Listed {
    points: BTreeMap<String, Vec<PixelPoint>>,
}

impl Listed {
    /// Reads the points of every keypoint.
    fn read(program: &Program, path: &Path) -> Result<Listed, Failure> {
        let wrong = |why: String| {
            Failure::environment(format!(
                "the scene `{}` cannot be used: {why}",
                path.display()
            ))
        };
        let bytes = sources::read_bounded(path).map_err(wrong)?;
        let points: BTreeMap<String, Vec<PixelPoint>> = serde_json::from_slice(&bytes)
            .map_err(|error| wrong(format!("{error}; right would be {{\"corners\": [[12, 34], [56, 78]], \"center\": [[40, 50]]}}")))?;
        for keypoint in &program.keypoints {
            let name = keypoint.name.as_str();
            let found = points.get(name).map_or(0, Vec::len);
            match keypoint.extractor.shape() {
                KeypointShape::Point if found != 1 => {
                    return Err(wrong(format!(
                        "`{name}` needs exactly one point, it has {found}"
                    )));
                }
                KeypointShape::Points if found == 0 => {
                    return Err(wrong(format!("`{name}` needs at least one point")));
                }
                _ => {}
            }
        }
        Ok(Listed { points })
    }
}

impl SceneView for Listed {
    fn points(&self, keypoint: &str) -> Option<Vec<PixelPoint>> {
        self.points.get(keypoint).cloned()
    }

    fn distance_px(&self, _: &str, _: PixelPoint) -> Option<f64> {
        None
    }

    fn area_px(&self, _: &str) -> Option<f64> {
        None
    }
}

/// Says what a picture of a prompt shows.
fn title(picture: &PromptPicture, step: u32) -> String {
    match picture {
        PromptPicture::File(file) => file.path.clone(),
        PromptPicture::Drawn(Picture::Scene { layers }) => match layers {
            Layers::Drawn => "scene with annotations".to_owned(),
            Layers::Absent => "scene".to_owned(),
        },
        PromptPicture::Drawn(Picture::Subgoal { which, arrow }) => {
            let number = match which {
                Which::Now => step - 1,
                Which::Next => step,
            };
            let drawn = match arrow {
                Arrow::Drawn => " with arrow",
                Arrow::Absent => "",
            };
            format!("subgoal {number}{drawn}")
        }
    }
}

fn as_json(stage: &str, messages: &[Shown]) -> Value {
    let part = |part: &ShownPart| match part {
        ShownPart::Text(text) => json!({ "type": "text", "text": text }),
        ShownPart::Picture { title, png } => {
            json!({ "type": "image", "shows": title, "bytes": png.as_ref().map(Vec::len) })
        }
    };
    let message = |message: &Shown| json!({ "role": message.role, "parts": message.parts.iter().map(part).collect::<Vec<_>>() });
    json!({ "stage": stage, "messages": messages.iter().map(message).collect::<Vec<_>>() })
}

fn as_text(messages: &[Shown]) -> String {
    let mut text = String::new();
    for message in messages {
        text.push_str(&format!("--- {}\n", message.role));
        for part in &message.parts {
            match part {
                ShownPart::Text(words) => text.push_str(words),
                ShownPart::Picture { title, .. } => text.push_str(&format!("[picture: {title}]")),
            }
            text.push('\n');
        }
    }
    text
}

/// Writes `STAGE.txt` and `STAGE_N.png` for every stage.
fn write(folder: &Path, shown: &[(&str, Vec<Shown>)]) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    for (stage, messages) in shown {
        fs::write(folder.join(format!("{stage}.txt")), as_text(messages))?;
        let pictures = messages
            .iter()
            .flat_map(|message| &message.parts)
            .filter_map(|part| match part {
                ShownPart::Picture { png, .. } => png.as_ref(),
                ShownPart::Text(_) => None,
            });
        for (number, png) in pictures.enumerate() {
            fs::write(folder.join(format!("{stage}_{}.png", number + 1)), png)?;
        }
    }
    Ok(())
}

//! `fabc see`: shows what a task finds and draws on the user's picture, without a model.

use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use clap::{Args, ValueHint};
use fab_agent::rollout::RunError;
use fab_agent::see::{SeeInput, SeeOutput, see};
use fab_base::files;
use fab_picture::png;
use fab_program::PixelPoint;
use image::RgbImage;
use serde::{Serialize, Serializer};
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct SeeArguments {
    #[command(flatten)]
    pub task: TaskArguments,
    /// The picture, PNG or JPEG; of another size than the camera's, its middle square is scaled.
    #[arg(long, value_name = "PICTURE", value_hint = ValueHint::FilePath)]
    pub image: PathBuf,
    /// Its depth, aligned, in grey: 255 levels a metre in 8 bits, or millimetres in 16; 0 is no reading.
    #[arg(long, value_name = "PNG", value_hint = ValueHint::FilePath)]
    pub depth: Option<PathBuf>,
    /// Where the action before this one placed the cloth, for layers that show it.
    #[arg(long, value_name = "U,V", value_parser = pixel, allow_hyphen_values = true)]
    pub last_place: Option<PixelPoint>,
    /// Write a picture of each keypoint and layer into this folder, and `annotated.png`, what a model would see.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

#[derive(Serialize)]
struct SeenReport<'s> {
    #[serde(serialize_with = "as_map")]
    keypoints: Vec<(&'s str, Vec<PixelPoint>)>,
    #[serde(serialize_with = "as_map")]
    masks: Vec<(&'s str, MaskArea)>,
    files: Vec<String>,
}

#[derive(Serialize)]
struct MaskArea {
    area_px: usize,
}

/// Keeps the order of the pairs, which is the task's.
fn as_map<T: Serialize, S: Serializer>(pairs: &[(&str, T)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(pairs.iter().map(|(name, value)| (name, value)))
}

/// Analyses the picture, writes pictures if `--out` is given, and lists the keypoints.
pub fn run(arguments: &SeeArguments, io: &Io) -> Result<Exit, Failure> {
    let program = sources::compile_task(&arguments.task, io)?;
    let rgb = png::load(&arguments.image)?;
    let depth_m = arguments.depth.as_deref().map(png::load_depth);
    let brought = SeeInput {
        rgb,
        depth_m: depth_m.transpose()?,
        last_place: arguments.last_place,
    };
    let seen = see(&program, brought).map_err(|error| match error {
        RunError::Unfit(why) => Failure::usage(format!("{why}; `--depth PNG` brings it")),
        error => Failure::environment(error),
    })?;
    for note in &seen.notes {
        io.talk(&format!("note: {note}"));
    }
    for layer in &seen.left_out {
        io.talk(&format!(
            "note: `{layer}` shows the action before this one, of which `--last-place U,V` alone can be said; it is left out"
        ));
    }
    let files = match &arguments.out {
        Some(folder) => write(folder, &seen).map_err(|error| {
            Failure::environment(format!("cannot write into `{}`: {error}", folder.display()))
        })?,
        None => Vec::new(),
    };
    let masks = seen.scene.masks().into_iter().map(|(name, mask)| {
        let area_px = mask.area_px();
        (name, MaskArea { area_px })
    });
    let report = SeenReport {
        keypoints: seen.scene.keypoints().into_iter().collect(),
        masks: masks.collect(),
        files: files.iter().map(|it| it.display().to_string()).collect(),
    };
    io.either(arguments.json, &report, || report.text());
    Ok(Exit::Done)
}

/// Parses `U,V`, a pixel.
pub fn pixel(text: &str) -> Result<PixelPoint, String> {
    text.split_once(',')
        .and_then(|(u, v)| {
            Some(PixelPoint::new(
                u.trim().parse().ok()?,
                v.trim().parse().ok()?,
            ))
        })
        .ok_or_else(|| "write column and row of a pixel, such as `120,64`".to_owned())
}

/// Writes a picture of each stage, numbered, and `annotated.png`; returns their paths.
fn write(folder: &Path, seen: &SeeOutput) -> std::io::Result<Vec<PathBuf>> {
    fs::create_dir_all(folder)?;
    let numbered = (1..).zip(&seen.stages);
    let mut pictures: Vec<(String, &RgbImage)> = numbered
        .map(|(number, (name, picture))| (format!("{number:02}_{name}.png"), picture))
        .collect();
    pictures.push(("annotated.png".to_owned(), &seen.annotated));
    let mut files = Vec::with_capacity(pictures.len());
    for (name, drawn) in pictures {
        let path = folder.join(name);
        files::write_whole(&path, &png::encode(drawn))?;
        files.push(path);
    }
    Ok(files)
}

impl SeenReport<'_> {
    fn text(&self) -> String {
        let masks = self.masks.iter();
        let masks = masks.map(|(name, mask)| format!("{name}: {} pixels", mask.area_px));
        let keypoints = self.keypoints.iter().map(|(name, points)| {
            let points: Vec<String> = points.iter().map(PixelPoint::to_string).collect();
            format!("{name}: {}", points.join(", "))
        });
        let lines = masks.chain(keypoints).chain(self.files.iter().cloned());
        lines.collect::<Vec<_>>().join("\n")
    }
}

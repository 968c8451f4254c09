//! `fabc sim render`: a picture of particle positions, in colour or as depth.

use super::files::{self, StateArguments};
use crate::exit::{Exit, Failure};
use crate::io::{Io, write_file};
use crate::verbs::runtime::setting::{self, materials::MaterialArguments};
use clap::{Args, ValueEnum, ValueHint};
use fab_picture::png;
use fab_sim::{ImageUp, Params, TopDownCamera};
use fab_world::simulated;
use image::GrayImage;
use serde::Serialize;
use serde_json::json;
use std::path::PathBuf;

#[derive(Args)]
pub struct DrawArguments {
    #[command(flatten)]
    pub state: StateArguments,
    /// The picture.
    #[arg(short = 'o', long = "out", value_name = "FILE.png", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Whose camera looks.
    #[arg(long, value_enum, default_value = "folding")]
    pub camera: CameraArgument,
    /// The picture's side, pixels; default: the camera's own.
    #[arg(long, value_name = "PX")]
    pub size: Option<u32>,
    #[command(flatten)]
    pub cloth: MaterialArguments,
    /// Draw the distance from the camera instead of colour: grey is the whole part of 255 per metre.
    #[arg(long, conflicts_with = "material")]
    pub depth: bool,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// The paper's cameras; both look straight down with a field of view of 45 degrees.
#[derive(Clone, Copy, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum CameraArgument {
    /// 0.65 m above the table, 224 pixels, +Y of the table is up.
    Folding,
    /// 1 m above the table, 720 pixels, +X of the table is up.
    Smoothing,
}

/// Grey levels per metre in a depth picture, as in the recorded data.
const GREY_PER_M: f32 = 255.0;

pub fn run(arguments: &DrawArguments, io: &Io) -> Result<Exit, Failure> {
    let camera = camera(arguments.camera, arguments.size)?;
    setting::check_ending("-o", &arguments.out, "png")?;
    let (_, material) = arguments.cloth.params(io)?;
    let (state, mask) = files::read_state(&arguments.state.file, &arguments.state.frame)?;
    let look = simulated::look(material.as_ref());
    let frame = camera.render(mask, &state.positions, &look);
    // The table is at the camera's height, up to rounding.
    let nearer = |depth: &&f32| **depth < camera.height_m - 1e-4;
    let cloth_px = frame.depth_m.iter().filter(nearer).count();
    if cloth_px == 0 {
        io.talk("note: no part of the cloth is in the picture");
    }
    let (colours, depth_m) = simulated::pictures(frame);
    let picture = if arguments.depth {
        // Casts saturate: everything farther than 1 m is white.
        let grey = |metres: &f32| (GREY_PER_M * metres) as u8;
        let levels = depth_m.iter().map(grey).collect();
        let picture = GrayImage::from_raw(depth_m.width(), depth_m.height(), levels);
        png::encode(&picture.expect("as many levels as depths"))
    } else {
        png::encode(&colours)
    };
    write_file(&arguments.out, &picture)?;
    let file = arguments.out.display().to_string();
    let document = json!({
        "params": Params::default().hash(),
        "file": file,
        "size_px": camera.size_px,
        "camera": arguments.camera,
        "cloth_px": cloth_px,
    });
    io.either(arguments.json, &document, || file);
    Ok(Exit::Done)
}

/// Sets up one of the paper's cameras (protocol, section 3), with another side if one is asked for.
pub fn camera(camera: CameraArgument, side_px: Option<u32>) -> Result<TopDownCamera, Failure> {
    let (height_m, size_px, up) = match camera {
        CameraArgument::Folding => (0.65, 224, ImageUp::Y),
        CameraArgument::Smoothing => (1.0, 720, ImageUp::X),
    };
    let size_px = side_px.unwrap_or(size_px);
    TopDownCamera::new(height_m, std::f32::consts::FRAC_PI_4, size_px)
        .map(|camera| camera.with_up(up))
        .map_err(|error| Failure::usage(format!("`--size {size_px}`: {error}")))
}

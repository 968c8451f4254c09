//! `fabc sim record`: a film of picks and places, without any model.

use super::files;
use super::render::{self, CameraArgument};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::FrameArguments;
use crate::verbs::runtime::setting::materials::MaterialArguments;
use crate::verbs::runtime::video;
use clap::{Args, ValueHint};
use fab_sim::{Manner, SimError, Simulator};
use fab_world::film::{self, Film, FilmPlan, Recorder};
use fab_world::simulated;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Args)]
pub struct RecordArguments {
    /// Particle positions; default: a flat square cloth.
    #[arg(value_name = "STATE.npy", value_hint = ValueHint::FilePath)]
    pub from: Option<PathBuf>,
    #[command(flatten)]
    pub frame: FrameArguments,
    /// Particles along each side of the flat cloth, 6.25 mm apart.
    #[arg(long, value_name = "N", default_value_t = 40, conflicts_with = "from")]
    pub size: u32,
    #[command(flatten)]
    pub cloth: MaterialArguments,
    /// Pick at the first point and place at the second: metres from the table's centre. One for each motion, in order.
    #[arg(long = "move", value_name = "X,Y:X,Y", value_parser = parse_move, allow_hyphen_values = true, required = true)]
    pub moves: Vec<Move>,
    /// The film.
    #[arg(short = 'o', long = "out", value_name = "FILE.gif", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// A pick and a place, table coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Move {
    pick: [f32; 2],
    place: [f32; 2],
}

fn parse_move(text: &str) -> Result<Move, &'static str> {
    let number = |text: &str| text.trim().parse().ok().filter(|it: &f32| it.is_finite());
    let point = |text: &str| {
        let (x, y) = text.split_once(',')?;
        Some([number(x)?, number(y)?])
    };
    let points = text.split_once(':').and_then(|(pick, place)| {
        let (pick, place) = (point(pick)?, point(place)?);
        Some(Move { pick, place })
    });
    points.ok_or("write the pick and the place in metres from the table's centre, such as `-0.12,0.12:0.1,-0.1`")
}

#[derive(Serialize)]
struct Moved {
    #[serde(flatten)]
    asked: Move,
    /// Index of the held particle; null if nothing was held.
    grasped: Option<usize>,
    steps: u32,
}

#[derive(Serialize)]
struct Recorded {
    params: String,
    video: Film,
    moves: Vec<Moved>,
    digest: String,
}

pub fn run(arguments: &RecordArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    video::check_file("--out", &arguments.out)?;
    let (params, material) = arguments.cloth.params(io)?;
    let mut cloth = match &arguments.from {
        None => Simulator::flat(super::square(arguments.size)?, &params),
        Some(file) => {
            let (state, mask) = files::read_state(file, &arguments.frame)?;
            Simulator::from_positions(mask, &state.positions, &params)?
        }
    };
    let recorder = Recorder::new(FilmPlan {
        path: arguments.out.clone(),
        camera: render::camera(CameraArgument::Folding, None)?,
        motions: arguments.moves.len() as u32,
        max_bytes: film::MAX_BYTES,
    })?;
    recorder.begin(&cloth, &simulated::look(material.as_ref()));
    let mut moves = Vec::new();
    for (number, asked) in (1..).zip(arguments.moves.iter().copied()) {
        io.progress(&format!("motion {number}"));
        let (manner, Move { pick, place }) = (Manner::default(), asked);
        let recorder = Some(&recorder);
        let done = film::pick_and_place(&mut cloth, &manner, pick, place, recorder, &interrupt);
        io.progress("");
        let done = match done {
            Ok(done) => done,
            Err(SimError::Interrupted { .. }) => break,
            Err(error) => return Err(Failure::environment(format!("motion {number}: {error}"))),
        };
        if done.grasped.is_none() {
            io.talk(&format!("note: motion {number} grasped nothing"));
        }
        moves.push(Moved {
            asked,
            grasped: done.grasped,
            steps: done.steps,
        });
    }
    let film = recorder.finish()?;
    let recorded = Recorded {
        params: params.hash(),
        video: film.expect("a film with a begin has a picture"),
        moves,
        digest: cloth.digest(),
    };
    io.either(arguments.json, &recorded, || recorded.video.to_string());
    Ok(if recorded.moves.len() < arguments.moves.len() {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

//! `fabc sim record`: a film of picks and places, given or recorded, without any model.

use super::demonstrations;
use super::files::{self, StateArguments};
use super::render::{self, CameraArgument};
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::report::Report;
use crate::verbs::runtime::setting::FrameArguments;
use crate::verbs::runtime::setting::materials::MaterialArguments;
use crate::verbs::runtime::video;
use clap::{Args, ValueHint};
use fab_sim::{Manner, Mask, Params, SimError, Simulator};
use fab_world::film::{self, Film, FilmPlan, Recorder};
use fab_world::simulated;
use serde::Serialize;
use std::path::PathBuf;
use std::str::FromStr;

/// Arguments of `sim record`.
#[derive(Args)]
pub struct RecordArguments {
    /// Particle positions, or a folder of recorded demonstrations with manifest.json; default: a flat square cloth.
    #[arg(value_name = "STATE.npy|DIR", value_hint = ValueHint::AnyPath)]
    pub from: Option<PathBuf>,
    #[command(flatten)]
    pub frame: FrameArguments,
    /// Particles along each side of the flat cloth, 6.25 mm apart.
    #[arg(long, value_name = "N", default_value_t = 40, conflicts_with = "from")]
    pub size: u32,
    #[command(flatten)]
    pub cloth: MaterialArguments,
    /// Pick at the first point and place at the second: metres from the table's centre. One for each motion, in order.
    #[arg(long = "move", value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    pub moves: Vec<Move>,
    /// With DIR: the demonstration with this id.
    #[arg(long, value_name = "ID", conflicts_with = "moves")]
    pub id: Option<u64>,
    /// With DIR: a demonstration of this task, by the recorded data's own name.
    #[arg(long, value_name = "NAME", conflicts_with = "moves")]
    pub task: Option<String>,
    /// Whose camera over the table; the film shows as much.
    #[arg(long, value_enum, default_value = "folding")]
    pub camera: CameraArgument,
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

impl FromStr for Move {
    type Err = String;

    fn from_str(text: &str) -> Result<Move, String> {
        let point = |text: &str| {
            let (x, y) = text.split_once(',')?;
            let number = |text: &str| text.trim().parse().ok().filter(|it: &f32| it.is_finite());
            Some([number(x)?, number(y)?])
        };
        let points = text.split_once(':').and_then(|(pick, place)| {
            let (pick, place) = (point(pick)?, point(place)?);
            Some(Move { pick, place })
        });
        points.ok_or_else(|| {
            "write the pick and the place in metres from the table's centre, such as `-0.12,0.12:0.1,-0.1`".to_owned()
        })
    }
}

/// What was done.
#[derive(Serialize)]
struct Moved {
    #[serde(flatten)]
    asked: Move,
    /// Index of the held particle; null if nothing was held.
    grasped: Option<usize>,
    steps: u32,
}

/// The film, and what it shows.
#[derive(Serialize)]
struct Recorded {
    params: String,
    video: Film,
    moves: Vec<Moved>,
    digest: String,
}

/// Moves the cloth, films it, and reports.
pub fn run(arguments: &RecordArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    video::check_file("--out", &arguments.out)?;
    let (params, material) = arguments.cloth.params(io)?;
    let (mut cloth, asked) = cloth(arguments, &params)?;
    let recorder = Recorder::new(FilmPlan {
        path: arguments.out.clone(),
        camera: render::camera(arguments.camera, None)?,
        motions: u32::try_from(asked.len()).unwrap_or(u32::MAX),
        max_bytes: film::MAX_BYTES,
    });
    recorder.begin(&cloth, &simulated::look(material.as_ref()));
    let mut moves = Vec::new();
    for (number, asked) in (1..).zip(asked.iter().copied()) {
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
    io.result(arguments.json, &recorded);
    Ok(if recorded.moves.len() < asked.len() {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// Lays the cloth and lists what is to be done with it.
fn cloth(arguments: &RecordArguments, params: &Params) -> Result<(Simulator, Vec<Move>), Failure> {
    if let Some(folder) = arguments.from.as_ref().filter(|path| path.is_dir()) {
        if !arguments.moves.is_empty() || arguments.frame.dims.is_some() {
            return Err(Failure::usage(format!(
                "`{}` is a folder of demonstrations, which have picks and a grid of their own; leave `--move`, `--dims` and `--up` out",
                folder.display()
            )));
        }
        let ids = arguments.id.map(|id| vec![id]);
        let found = demonstrations::read(folder, arguments.task.as_deref(), ids.as_deref())?;
        let [one] = &found[..] else {
            return Err(Failure::usage(format!(
                "one demonstration is filmed at a time; choose it with `--task NAME --id ID`: {}",
                demonstrations::listed(found.iter().map(ToString::to_string))
            )));
        };
        let moves = one.picks.iter().map(|it| Move {
            pick: it.pick,
            place: it.place,
        });
        return Ok((one.lay(&one.positions()?.start, params)?, moves.collect()));
    }
    if arguments.id.is_some() || arguments.task.is_some() {
        return Err(Failure::usage(
            "`--task` and `--id` choose a recorded demonstration; name the folder with its manifest.json",
        ));
    }
    if arguments.moves.is_empty() {
        return Err(Failure::usage(
            "there is nothing to film; give `--move X,Y:X,Y`, or a folder of demonstrations",
        ));
    }
    let (mask, positions, named) = match &arguments.from {
        None => {
            let grid = super::square(arguments.size)?;
            let positions = grid.flat_positions(params);
            (Mask::full(grid), positions, "the flat cloth".to_owned())
        }
        Some(file) => {
            let state = files::read_state(&StateArguments {
                file: file.clone(),
                frame: arguments.frame.clone(),
                outline: None,
            })?;
            (state.mask, state.positions, format!("`{}`", file.display()))
        }
    };
    let laid = Simulator::from_positions(mask, &positions, params)
        .map_err(|error| Failure::environment(format!("{named} is no cloth's state: {error}")))?;
    Ok((laid, arguments.moves.clone()))
}

impl Report for Recorded {
    fn text(&self) -> String {
        self.video.to_string()
    }
}

//! `fabc sim record`: a film of picks and places, given or recorded, without any model.

use super::SPACING_M;
use super::demonstrations;
use super::files::{self, StateArguments};
use super::render::{self, CameraArgument};
use super::replay;
use crate::exit::{Exit, Failure};
use crate::io::Io;
use crate::verbs::runtime::setting::{FrameArguments, materials};
use crate::verbs::runtime::video::{self, ViewArgument};
use clap::Args;
use clap::ValueHint;
use fab_sim::{Grid, Manner, Mask, Params, SimError, Simulator};
use fab_world::film::{self, FilmPlan, Recorder};
use fab_world::simulated;
use serde::Serialize;
use serde_json::json;
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
    /// Particles along each side of the flat cloth, 6.25 mm apart; default: 40.
    #[arg(long, value_name = "N", conflicts_with = "from")]
    pub size: Option<u32>,
    /// What the cloth is made of, with its colours: the name of a shipped material, or `FILE.fab:NAME`; default: the
    /// recorded scene's cloth.
    #[arg(long, value_name = "NAME")]
    pub material: Option<String>,
    /// Pick at the first point and place at the second: metres from the table's centre. One for each motion, in order.
    #[arg(long = "move", value_name = "X,Y:X,Y", allow_hyphen_values = true)]
    pub moves: Vec<Move>,
    /// With DIR: the demonstration with this id.
    #[arg(long, value_name = "ID", conflicts_with = "moves")]
    pub id: Option<u64>,
    /// With DIR: a demonstration of this task, by the recorded data's own name.
    #[arg(long, value_name = "NAME", conflicts_with = "moves")]
    pub task: Option<String>,
    /// From where the film is taken; default: slanted.
    #[arg(long, value_enum)]
    pub view: Option<ViewArgument>,
    /// Whose camera over the table; the slanted view sees as much.
    #[arg(long, value_enum, default_value = "folding")]
    pub camera: CameraArgument,
    /// The film.
    #[arg(short = 'o', long = "out", value_name = "FILE.gif", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,
    /// Print one JSON document.
    #[arg(long)]
    pub json: bool,
}

/// Particles along each side of the flat cloth if the command line does not say.
const DEFAULT_SIZE: u32 = 40;

/// A pick and a place, table coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
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
        text.split_once(':')
            .and_then(|(pick, place)| {
                Some(Move {
                    pick: point(pick)?,
                    place: point(place)?,
                })
            })
            .ok_or_else(|| {
                "write the pick and the place in metres from the table's centre, such as `-0.12,0.12:0.1,-0.1`".to_owned()
            })
    }
}

/// What was done.
#[derive(Serialize)]
struct Moved {
    pick: [f32; 2],
    place: [f32; 2],
    /// Index of the held particle; null if nothing was held.
    grasped: Option<usize>,
    steps: u32,
}

/// Moves the cloth, films it, and reports.
pub fn run(arguments: &RecordArguments, io: &Io) -> Result<Exit, Failure> {
    let interrupt = io.interrupt()?;
    video::check_file("--out", &arguments.out)?;
    let material = arguments.material.as_deref();
    let material = material.map(|name| materials::find(name, io)).transpose()?;
    let params = Params {
        material: material.as_ref().map(simulated::material),
        ..Params::default()
    };
    let (mut cloth, moves) = cloth(arguments, &params)?;
    let recorder = Recorder::new(FilmPlan {
        path: arguments.out.clone(),
        view: ViewArgument::film(arguments.view),
        camera: render::camera(arguments.camera, None)?,
        motions: u32::try_from(moves.len()).unwrap_or(u32::MAX),
        max_bytes: film::MAX_BYTES,
    });
    recorder.begin(&cloth, &simulated::look(material.as_ref()));
    let mut moved = Vec::new();
    let mut is_interrupted = false;
    for (number, Move { pick, place }) in moves.iter().copied().enumerate() {
        io.progress(&format!("motion {} of {}", number + 1, moves.len()));
        match film::pick_and_place(
            &mut cloth,
            &Manner::default(),
            pick,
            place,
            Some(&recorder),
            &interrupt,
        ) {
            Ok(done) => moved.push(Moved {
                pick,
                place,
                grasped: done.grasped,
                steps: done.steps,
            }),
            Err(SimError::Interrupted { .. }) => {
                is_interrupted = true;
                break;
            }
            Err(error) => {
                io.progress("");
                return Err(Failure::environment(format!(
                    "motion {}: {error}",
                    number + 1
                )));
            }
        }
    }
    io.progress("");
    let film = recorder.finish().map_err(Failure::environment)?;
    let film = film.expect("a film with a begin has a picture");
    for (number, _) in moved
        .iter()
        .enumerate()
        .filter(|(_, it)| it.grasped.is_none())
    {
        io.talk(&format!("note: motion {} grasped nothing", number + 1));
    }
    io.report(
        arguments.json,
        || {
            json!({
                "params": params.hash(),
                "video": film,
                "moves": moved,
                "digest": cloth.digest(),
            })
        },
        || film.to_string(),
    );
    Ok(match is_interrupted {
        true => Exit::Interrupted,
        false => Exit::Done,
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
        let all = demonstrations::read(folder)?;
        let found = replay::choose(all, arguments.task.as_deref(), ids.as_deref())?;
        let [one] = &found[..] else {
            let named = found.iter().map(|it| format!("`{}` {}", it.task, it.id));
            return Err(Failure::usage(format!(
                "one demonstration is filmed at a time; choose it with `--task NAME --id ID`: {}",
                replay::listed(named)
            )));
        };
        let start = one.positions()?.start;
        let moves = one.picks.iter().map(|it| Move {
            pick: it.pick,
            place: it.place,
        });
        return Ok((replay::lay(one, &start, params)?, moves.collect()));
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
    let Some(file) = &arguments.from else {
        let size = arguments.size.unwrap_or(DEFAULT_SIZE);
        let grid = Grid::new(size as usize, size as usize, SPACING_M as f32)
            .map_err(|error| Failure::usage(format!("`--size {size}`: {error}")))?;
        let laid =
            Simulator::from_positions(Mask::full(grid), &grid.flat_positions(params), params);
        let laid =
            laid.map_err(|error| Failure::environment(format!("the flat cloth: {error}")))?;
        return Ok((laid, arguments.moves.clone()));
    };
    let state = files::read_state(&StateArguments {
        file: file.clone(),
        frame: arguments.frame.clone(),
        outline: None,
    })?;
    let laid = Simulator::from_positions(state.mask, &state.positions, params);
    let laid = laid.map_err(|error| {
        Failure::environment(format!("`{}` is no cloth's state: {error}", file.display()))
    })?;
    Ok((laid, arguments.moves.clone()))
}

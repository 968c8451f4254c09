//! What a verb needs besides a program: a world, a start, a cache, a way to be stopped.

pub mod arm;
pub mod catalogue;
pub mod materials;
pub mod model_arguments;
pub mod models;
pub mod policies;
pub mod remote;
pub mod worlds;

use crate::exit::Failure;
use crate::io::Io;
use crate::sources::{self, TaskArguments};
use clap::{Args, ValueHint};
use fab_agent::rollout::RunError;
use fab_agent::subgoals::SubgoalSet;
use fab_agent::task_files;
use fab_base::cache::Cache;
use fab_base::files;
use fab_base::interrupt::Interrupt;
use fab_program::exact::written;
use fab_program::{ClothStart, Program, STATED_SPACING_MM};
use fab_world::start::{Grid, Start, StartFrame, Up};
use fab_world::{SimulatedWorld, World, WorldError, crumple};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Where the cloth lies at first.
#[derive(Args, Clone, Debug, Default, Serialize, Deserialize)]
pub struct StartArguments {
    /// Particle positions (.npy), the folder of a run for its last state, or a seed that turns a flat cloth or crumples
    /// another one; default: as the task says.
    #[arg(long, value_name = "FILE.npy|RUN|SEED", value_hint = ValueHint::FilePath)]
    pub start: Option<String>,
    #[command(flatten)]
    pub frame: FrameArguments,
}

/// How the numbers of a file of particle positions are to be understood.
#[derive(Args, Clone, Debug, Default, Serialize, Deserialize)]
pub struct FrameArguments {
    /// Grid of the .npy file, if no description is beside it: particles along x and along the other side.
    #[arg(long, value_name = "55x44", requires = "up")]
    pub dims: Option<String>,
    /// Axis of the .npy file that points up, if no description is beside it.
    #[arg(long, value_name = "AXIS", requires = "dims", value_parser = ["y", "z"])]
    pub up: Option<String>,
}

/// The seed of a crumpled cloth if the command line gives none.
const DEFAULT_SEED: u64 = 0;

pub fn world(program: &Program) -> Result<Box<dyn World>, WorldError> {
    Ok(Box::new(SimulatedWorld::of(program)?))
}

/// Finds or draws the pictures of a task's subgoals; `folder` holds the task's file.
pub fn subgoals(
    program: &Program,
    folder: &Path,
    world: &mut dyn World,
    interrupt: &Interrupt,
) -> Result<SubgoalSet, Failure> {
    Ok(SubgoalSet::obtain(program, folder, world, interrupt)?)
}

/// Blames the command line if what it asks for cannot be done.
pub fn unfit_usage(error: RunError) -> Failure {
    match error {
        RunError::Unfit(why) => Failure::usage(why),
        error => error.into(),
    }
}

/// Lays the cloth as the command line says, or else as the task does; `folder` holds the task's file.
pub fn start(
    program: &Program,
    folder: &Path,
    arguments: &StartArguments,
    world: &dyn World,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Start, Failure> {
    let text = arguments.start.as_deref();
    let seed: Option<u64> = text.and_then(|text| text.parse().ok());
    if arguments.frame.dims.is_some() && (text.is_none() || seed.is_some()) {
        return Err(Failure::usage(
            "`--dims` and `--up` describe a start file; name it with `--start FILE.npy`",
        ));
    }
    let path = match (text, &program.cloth.start) {
        (Some(text), _) if seed.is_none() => PathBuf::from(text),
        (None, ClothStart::File { file }) => task_files::resolve(folder, file)?,
        (_, ClothStart::Crumpled) => {
            return crumpled(program, seed.unwrap_or(DEFAULT_SEED), world, interrupt, io);
        }
        _ => {
            return Ok(match seed {
                Some(seed) => Start::seeded(&program.cloth, seed),
                None => Start::flat(&program.cloth),
            });
        }
    };
    let stated = stated_frame(&arguments.frame, program.cloth.spacing_m)?;
    let start = Start::load(&path, stated)?;
    check_spacing(&format!("`{}`", start.name), start.grid.spacing_m, program)?;
    Ok(start)
}

/// Refuses a start whose particles are not as far apart as those of the task's cloth, from which the task counts lengths.
pub fn check_spacing(start: &str, spacing_m: f64, program: &Program) -> Result<(), Failure> {
    let declared_m = program.cloth.spacing_m;
    if (spacing_m / declared_m - 1.0).abs() < 1e-3 {
        return Ok(());
    }
    let [found, wanted] = [spacing_m, declared_m].map(|metres| written(metres * 1000.0, 3));
    let [least, most] = STATED_SPACING_MM;
    let state = match program.cloth.material {
        Some(_) if (least..=most).contains(&(spacing_m * 1000.0)) => {
            format!("; the task would state `spacing: {found}mm`")
        }
        _ => String::new(),
    };
    Err(Failure::environment(format!(
        "the particles of the start {start} are {found} mm apart, and those of the task's cloth {wanted} mm{state}"
    )))
}

/// Returns the task for the cloth of a start; compiles it again if that cloth has another grid.
pub fn fitted(
    task: &TaskArguments,
    declared: &Program,
    start: &Start,
    io: &Io,
) -> Result<Program, Failure> {
    let grid = [start.grid.dimx, start.grid.dimy];
    if grid == [declared.cloth.dimx, declared.cloth.dimy] {
        return Ok(declared.clone());
    }
    let programs = sources::compile_tasks(&task.file, task.task.as_deref(), Some(grid), io)?;
    sources::chosen(programs, task)
}

fn crumpled(
    program: &Program,
    seed: u64,
    world: &dyn World,
    interrupt: &Interrupt,
    io: &Io,
) -> Result<Start, Failure> {
    let mut announce = || io.talk(&format!("crumpling the cloth, seed {seed}"));
    let (flat, cache) = (Start::flat(&program.cloth), cache(io));
    let crumpled = crumple::start(&flat, seed, world, &cache, interrupt, &mut announce)?;
    let notes = [crumpled.not_kept, crumple::unlike_recorded(&crumpled.start)];
    for note in notes.into_iter().flatten() {
        io.talk(&format!("note: {note}"));
    }
    Ok(crumpled.start)
}

/// Returns what the command line states about a file of positions, if anything.
pub fn stated_frame(
    arguments: &FrameArguments,
    spacing_m: f64,
) -> Result<Option<StartFrame>, Failure> {
    let (Some(dims), Some(up)) = (&arguments.dims, &arguments.up) else {
        return Ok(None);
    };
    let [dimx, dimy] = dims_of(dims)?;
    Ok(Some(StartFrame {
        grid: Grid {
            dimx,
            dimy,
            spacing_m,
        },
        up: if up == "y" { Up::Y } else { Up::Z },
    }))
}

/// Parses `--dims`: particles along the cloth's x and along its other side.
pub fn dims_of(text: &str) -> Result<[u32; 2], Failure> {
    two_counts(text)
        .filter(|dims| dims.iter().all(|dim| *dim >= 2))
        .ok_or_else(|| {
            Failure::usage(format!(
                "`--dims {text}` is not a grid; write two counts of at least 2, such as `55x44`"
            ))
        })
}

/// Reads two counts, such as `55x44` or `55,44`.
fn two_counts(text: &str) -> Option<[u32; 2]> {
    let (x, y) = text.split_once(['x', ','])?;
    Some([x.parse().ok()?, y.parse().ok()?])
}

/// Creates the folder of many runs: the named one, or the next free `runs/NAME-NNNN`.
pub fn out_folder(named: Option<&Path>, name: &str) -> Result<PathBuf, Failure> {
    let runs = Path::new("runs");
    let made = match named {
        Some(path) => std::fs::create_dir_all(path).map(|()| path.to_owned()),
        None => files::next_folder(runs, name),
    };
    made.map_err(|error| {
        let path = named.unwrap_or(runs).display();
        Failure::environment(format!("cannot make the folder `{path}`: {error}"))
    })
}

/// Refuses a file whose name does not end as its kind does.
pub fn check_ending(option: &str, path: &Path, ending: &str) -> Result<(), Failure> {
    if files::ends_in(path, ending) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "`{option} {}` is no {} file; name one that ends in `.{ending}`",
        path.display(),
        ending.to_uppercase()
    )))
}

/// Opens the user's cache of simulated final states and starts.
pub fn cache(io: &Io) -> Cache {
    cache_of("experts", io)
}

/// Opens the same cache, or one beside the results: without a cache, every rollout would simulate its own experts.
pub fn cache_or_beside(out: &Path, io: &Io) -> Cache {
    match cache(io) {
        cache if cache.is_kept() => cache,
        _ => Cache::at(out.join("cache")),
    }
}

/// Opens the user's cache of one kind of results.
pub fn cache_of(kind: &str, io: &Io) -> Cache {
    match io.cache_folder() {
        Some(folder) => Cache::at(folder.join(kind)),
        None => Cache::none(),
    }
}

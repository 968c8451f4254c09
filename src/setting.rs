//! What a verb needs around a program: a world, a start, a cache, a way to be stopped.

pub mod arm;
pub mod catalogue;
pub mod models;
pub mod policies;
pub mod remote;
pub mod worlds;

use crate::cli::{FrameArguments, StartArguments, TaskArguments};
use crate::exit::Failure;
use crate::{output, sources};
use fab_agent::task_files;
use fab_base::cache::Cache;
use fab_base::interrupt::Interrupt;
use fab_program::{ClothStart, Program};
use fab_world::crumple;
use fab_world::start::{Grid, Start, StartFrame, Up};
use fab_world::{SimulatedWorld, World, WorldError};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The seed of a crumpled cloth where the command line names none.
const DEFAULT_SEED: u64 = 0;

/// Makes a simulated world for a program.
pub fn world(program: &Program) -> Result<Box<dyn World>, WorldError> {
    Ok(Box::new(SimulatedWorld::new(
        &program.camera,
        program.picker,
    )?))
}

/// Lays the cloth as the command line says, else as the task does; `folder` holds the task's file.
pub fn start(
    program: &Program,
    folder: &Path,
    arguments: &StartArguments,
    world: &dyn World,
    interrupt: &Interrupt,
) -> Result<Start, Failure> {
    let Some(text) = &arguments.start else {
        if arguments.frame.dims.is_some() {
            return Err(Failure::usage(
                "`--dims` and `--up` describe a start file; name it with `--start FILE.npy`",
            ));
        }
        return match &program.cloth.start {
            ClothStart::Flat => Ok(Start::flat(&program.cloth)),
            ClothStart::Crumpled => crumpled(program, DEFAULT_SEED, world, interrupt),
            ClothStart::File { file } => {
                let path = task_files::resolve(folder, file).map_err(Failure::environment)?;
                Start::load(&path, None).map_err(Failure::environment)
            }
        };
    };
    if text.bytes().all(|byte| byte.is_ascii_digit()) && !text.is_empty() {
        if arguments.frame.dims.is_some() {
            return Err(Failure::usage(format!(
                "`--dims` and `--up` describe a start file, and `--start {text}` is a seed"
            )));
        }
        let seed = text.parse().map_err(|_| {
            Failure::usage(format!("the seed `{text}` is larger than {}", u64::MAX))
        })?;
        return match program.cloth.start {
            ClothStart::Crumpled => crumpled(program, seed, world, interrupt),
            _ => Ok(Start::seeded(&program.cloth, seed)),
        };
    }
    let stated = stated_frame(&arguments.frame, program.cloth.spacing_m)?;
    Start::load(Path::new(text), stated).map_err(Failure::environment)
}

/// Returns the task as it is for the cloth that a start holds: compiled anew where that has another grid.
pub fn fitted(task: &TaskArguments, declared: &Program, start: &Start) -> Result<Program, Failure> {
    let grid = [start.grid.dimx, start.grid.dimy];
    if grid == [declared.cloth.dimx, declared.cloth.dimy] {
        return Ok(declared.clone());
    }
    sources::compile_task_for(task, grid)
}

fn crumpled(
    program: &Program,
    seed: u64,
    world: &dyn World,
    interrupt: &Interrupt,
) -> Result<Start, Failure> {
    let mut announce = || output::talk(&format!("crumpling the cloth, seed {seed}"));
    let cloth = &program.cloth;
    match crumple::start(
        &Start::flat(cloth),
        seed,
        world,
        &cache(),
        interrupt,
        &mut announce,
    ) {
        Ok(crumpled) => {
            if let Some(why) = crumpled.not_kept {
                output::talk(&format!("note: {why}"));
            }
            Ok(crumpled.start)
        }
        Err(WorldError::Interrupted) => Err(Failure::interrupted()),
        Err(error) => Err(Failure::environment(error)),
    }
}

/// Returns what the command line says of a file of positions, if it says anything.
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

/// Reads `--dims`: particles along the cloth's x and along its other side.
pub fn dims_of(text: &str) -> Result<[u32; 2], Failure> {
    text.split_once(['x', ','])
        .and_then(|(x, y)| Some([x.parse().ok()?, y.parse().ok()?]))
        .filter(|dims: &[u32; 2]| dims.iter().all(|dim| *dim >= 2))
        .ok_or_else(|| {
            Failure::usage(format!(
                "`--dims {text}` is no grid; write two counts of at least 2, such as `55x44`"
            ))
        })
}

/// Opens the user's cache of simulated ends and starts.
pub fn cache() -> Cache {
    cache_of("experts")
}

/// Opens the user's cache of one kind of results.
pub fn cache_of(kind: &str) -> Cache {
    match cache_folder() {
        Some(folder) => Cache::at(folder.join(kind)),
        None => Cache::none(),
    }
}

/// Returns the folder of the user's cache; `FABC_CACHE_DIR` names another place.
pub fn cache_folder() -> Option<PathBuf> {
    let named = std::env::var_os("FABC_CACHE_DIR")
        .filter(|value| !value.is_empty())
        .map(PathBuf::from);
    named.or_else(|| dirs::cache_dir().map(|folder| folder.join("fabc")))
}

/// What SIGINT raises: there is one handler in a process.
static INTERRUPT: OnceLock<Interrupt> = OnceLock::new();

/// Returns whether SIGINT came since [`interrupt`] was called.
pub fn is_interrupted() -> bool {
    INTERRUPT.get().is_some_and(Interrupt::is_raised)
}

/// Lets SIGINT stop work between two of its steps.
///
/// A second SIGINT ends the process at once.
pub fn interrupt() -> Result<Interrupt, Failure> {
    let interrupt = INTERRUPT.get_or_init(Interrupt::default).clone();
    let raised = interrupt.clone();
    ctrlc::set_handler(move || {
        if raised.is_raised() {
            // Nothing is dropped on this way out.
            crate::robot::restore_terminal();
            std::process::exit(i32::from(crate::exit::Exit::Interrupted.code()));
        }
        raised.raise();
    })
    .map_err(|error| Failure::environment(format!("cannot listen for interrupts: {error}")))?;
    Ok(interrupt)
}

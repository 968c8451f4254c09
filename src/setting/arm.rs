//! The world of `--world jaco`: an arm's settings, its calibration, its driver, and who watches it.

use crate::cli::robot::{ArmArguments, Confirm};
use crate::exit::Failure;
use crate::robot::terminal::{HoldToRun, Terminal};
use crate::robot::watchdog::Process;
use crate::robot::{connect, standing};
use fab_agent::arm_sight::SIGHT;
use fab_arm::directory::Which;
use fab_arm::last;
use fab_arm::settings::{DriverKind, Settings};
use fab_arm::supervisor::{NoWatchdog, Supervisor, Unattended};
use fab_arm::world;
use fab_arm::world::{ArmWorld, PlanningWorld};
use fab_arm::world::{FlatPicture, Parts, WithinReach};
use fab_program::{ClothStart, Program};
use fab_world::start::Start;
use fab_world::{World, WorldError};
use std::io::IsTerminal;
use std::path::PathBuf;

/// Whether an arm is to move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// It carries actions out.
    Carried,
    /// The first action is planned, and no arm is connected.
    Planned,
}

/// Makes sure before anything else that the settings can be used and that there is somebody to ask.
pub fn check(arguments: &ArmArguments, moving: Moving) -> Result<Settings, Failure> {
    let (settings, _, calibration) = world::load(&arguments.robot).map_err(Failure::environment)?;
    FlatPicture::load(&arguments.robot, &settings, &calibration).map_err(Failure::environment)?;
    if moving == Moving::Planned {
        return Ok(settings);
    }
    if settings.driver != DriverKind::Simulated {
        // First what was left: it is so whatever this build can reach.
        standing::claim(&arguments.robot).map_err(Failure::environment)?;
        standing::check(&arguments.robot).map_err(Failure::environment)?;
        if !cfg!(feature = "ros") {
            return Err(Failure::environment(connect::without_ros(&arguments.robot)));
        }
    }
    supervisor(arguments, &settings)?;
    Ok(settings)
}

/// Returns the start of a cloth that a person lays.
pub fn start(program: &Program, named: Option<&String>) -> Result<Start, Failure> {
    match named {
        Some(named) => Err(Failure::usage(format!(
            "`--start {named}` is for the simulator: on a real table a person lays the cloth"
        ))),
        None => Ok(Start {
            name: match program.cloth.start {
                ClothStart::Crumpled => "crumpled by hand",
                _ => "flat, laid by hand",
            }
            .to_owned(),
            ..Start::flat(&program.cloth)
        }),
    }
}

/// Makes the world of an arm; `folder` is the run folder, for the arm's journal.
pub fn world(
    program: &Program,
    arguments: &ArmArguments,
    moving: Moving,
    folder: Option<&PathBuf>,
) -> Result<Box<dyn World>, WorldError> {
    let (settings, settings_hash, calibration) = world::load(&arguments.robot).map_err(failed)?;
    let flat = FlatPicture::load(&arguments.robot, &settings, &calibration).map_err(failed)?;
    let supervisor = match moving {
        Moving::Carried => {
            supervisor(arguments, &settings).map_err(|error| failed(error.to_string()))?
        }
        Moving::Planned => Box::new(Unattended),
    };
    let is_simulated = settings.driver == DriverKind::Simulated;
    let watchdog_s = settings.tolerance.watchdog_s;
    let mut parts = Parts {
        settings,
        settings_hash,
        calibration,
        sight: SIGHT,
        image_px: program.camera.image_px,
        supervisor,
        // A simulated arm ends with this program; a real one gets a watchdog below.
        watchdog: Box::new(NoWatchdog),
        folder: folder.cloned(),
    };
    match (moving, is_simulated) {
        (Moving::Planned, true) => {
            return Ok(Box::new(PlanningWorld::simulated(parts)?.with_flat(flat)));
        }
        (Moving::Carried, true) => {
            return Ok(Box::new(ArmWorld::simulated(parts)?.with_flat(flat)));
        }
        (Moving::Planned, false) => {
            let camera = connect::camera(&parts.settings, &arguments.robot, Which::Last);
            let camera = camera.map_err(|why| WorldError::Camera { why })?;
            return Ok(Box::new(PlanningWorld::new(parts, camera)?.with_flat(flat)));
        }
        (Moving::Carried, false) => {}
    }
    standing::check(&arguments.robot).map_err(failed)?;
    let watchdog = Process::start(&arguments.robot, watchdog_s).map_err(failed)?;
    parts.watchdog = Box::new(watchdog);
    let world = real(parts, arguments)?.with_flat(flat);
    if let Some(folder) = folder {
        // Before the first motion: after a crash in it, the next run must find this one.
        last::note(&arguments.robot, folder).map_err(|error| failed(error.to_string()))?;
    }
    Ok(Box::new(world))
}

/// Makes a simulated world in which that alone can be done which the arm reaches: nobody is asked, and nothing moves.
pub fn look(program: &Program, arguments: &ArmArguments) -> Result<Box<dyn World>, WorldError> {
    let (settings, ..) = world::load(&arguments.robot).map_err(failed)?;
    let world = super::world(program)?;
    Ok(Box::new(WithinReach::new(world, settings)?))
}

/// Returns whether somebody beside the arm is asked in the end, where the command line does not say so.
pub fn has_operator(arguments: &ArmArguments, settings: &Settings) -> bool {
    settings.driver != DriverKind::Simulated
        && arguments.confirm != Some(Confirm::None)
        && std::io::stdin().is_terminal()
}

/// Connects to a real arm and its camera.
fn real(parts: Parts, arguments: &ArmArguments) -> Result<ArmWorld, WorldError> {
    let settings = &parts.settings;
    let timeout_s = settings.camera.timeout_s;
    let camera = connect::camera(settings, &arguments.robot, Which::Fresh { timeout_s });
    let camera = camera.map_err(|why| WorldError::Camera { why })?;
    let arm = connect::arm(settings).map_err(failed)?;
    ArmWorld::new(parts, arm, camera)
}

/// Returns who gives leave to move: for a real arm a person, unless told otherwise.
fn supervisor(
    arguments: &ArmArguments,
    settings: &Settings,
) -> Result<Box<dyn Supervisor>, Failure> {
    let is_simulated = settings.driver == DriverKind::Simulated;
    if is_simulated && arguments.confirm.is_none() && !arguments.hold_to_run {
        return Ok(Box::new(Unattended));
    }
    let confirm = arguments.confirm.unwrap_or(match is_simulated {
        true => Confirm::None,
        false => Confirm::Each,
    });
    let hold = match arguments.hold_to_run {
        true => HoldToRun::Space,
        false => HoldToRun::Off,
    };
    Ok(Box::new(Terminal::new(confirm, hold)?))
}

fn failed(why: String) -> WorldError {
    WorldError::Motion { why }
}

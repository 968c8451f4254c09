//! The world of `--world jaco`: an arm's settings, its calibration, its driver, and who watches it.

use crate::cli::robot::{ArmArguments, Confirm};
use crate::exit::Failure;
use crate::robot::terminal::{HoldToRun, Terminal};
use crate::robot::watchdog::Process;
use compiler::program::{ClothStart, Program};
use runtime::arm::directory::DirectoryCamera;
use runtime::arm::rgbd::RgbdSource;
use runtime::arm::settings::{CameraSource, DriverKind, Settings};
use runtime::arm::supervisor::{NoWatchdog, Supervisor, Unattended};
use runtime::start::Start;
use runtime::world::jaco::{self, FlatPicture, Parts, WithinReach};
use runtime::world::{ArmWorld, PlanningWorld, World, WorldError};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

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
    let (settings, _, calibration) = jaco::load(&arguments.robot).map_err(Failure::environment)?;
    FlatPicture::load(&arguments.robot, &settings, &calibration).map_err(Failure::environment)?;
    if moving == Moving::Planned {
        return Ok(settings);
    }
    if settings.driver != DriverKind::Simulated && !cfg!(feature = "ros") {
        return Err(Failure::environment(format!(
            "`{}` is of a real arm, and this fabc was built without ROS: build it with `--features ros`",
            arguments.robot.display()
        )));
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
    let (settings, settings_hash, calibration) = jaco::load(&arguments.robot).map_err(failed)?;
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
            let camera = camera(&parts.settings, arguments)?;
            return Ok(Box::new(PlanningWorld::new(parts, camera)?.with_flat(flat)));
        }
        (Moving::Carried, false) => {}
    }
    let watchdog = Process::start(&arguments.robot, watchdog_s).map_err(failed)?;
    parts.watchdog = Box::new(watchdog);
    real(parts, flat, arguments)
}

/// Makes a simulated world in which that alone can be done which the arm reaches: nobody is asked, and nothing moves.
pub fn look(program: &Program, arguments: &ArmArguments) -> Result<Box<dyn World>, WorldError> {
    let (settings, ..) = jaco::load(&arguments.robot).map_err(failed)?;
    let world = super::world(program)?;
    Ok(Box::new(WithinReach::new(world, settings)?))
}

/// Returns whether somebody beside the arm is asked in the end, where the command line does not say so.
pub fn has_operator(arguments: &ArmArguments, settings: &Settings) -> bool {
    settings.driver != DriverKind::Simulated
        && arguments.confirm != Some(Confirm::None)
        && std::io::stdin().is_terminal()
}

/// Connects to a real arm and its camera, and starts its watchdog.
#[cfg(feature = "ros")]
fn real(
    parts: Parts,
    flat: Option<FlatPicture>,
    arguments: &ArmArguments,
) -> Result<Box<dyn World>, WorldError> {
    use runtime::arm::driver::{Arm, PortArm};
    use runtime::arm::kinematics::chain::Chain;
    use runtime::arm::ros::connect;

    let settings = parts.settings.clone();
    let Some(ros) = &settings.ros else {
        return Err(failed("the settings have no `[ros]`".to_owned()));
    };
    let source = camera(&settings, arguments)?;
    let port = connect(ros, &settings.model, settings.camera.timeout_s);
    let port = port.map_err(|error| failed(error.to_string()))?;
    let arm: Box<dyn Arm> = match settings.driver {
        DriverKind::Trajectory => {
            let chain =
                Chain::of_model(&settings.model).map_err(|error| failed(error.to_string()))?;
            Box::new(PortArm::by_trajectories(
                port,
                chain,
                settings.fingers,
                settings.tolerance,
            ))
        }
        _ => Box::new(PortArm::by_poses(
            port,
            &settings.model,
            settings.fingers,
            settings.tolerance,
        )),
    };
    Ok(Box::new(ArmWorld::new(parts, arm, source)?.with_flat(flat)))
}

#[cfg(not(feature = "ros"))]
fn real(
    _: Parts,
    _: Option<FlatPicture>,
    arguments: &ArmArguments,
) -> Result<Box<dyn World>, WorldError> {
    Err(failed(format!(
        "`{}` is of a real arm, and this fabc was built without ROS: build it with `--features ros`",
        arguments.robot.display()
    )))
}

/// Opens the camera over a real table.
fn camera(
    settings: &Settings,
    arguments: &ArmArguments,
) -> Result<Box<dyn RgbdSource>, WorldError> {
    let camera = &settings.camera;
    let beside = arguments.robot.parent().unwrap_or(Path::new("."));
    match (camera.source, &camera.folder) {
        (CameraSource::Directory, Some(folder)) => Ok(Box::new(DirectoryCamera::of(
            &beside.join(folder),
            camera.intrinsics.clone(),
        ))),
        (CameraSource::Ros, _) => subscribed(settings),
        _ => Err(no_camera(
            "a real arm needs the camera `ros`, or `directory` with a folder".to_owned(),
        )),
    }
}

#[cfg(feature = "ros")]
fn subscribed(settings: &Settings) -> Result<Box<dyn RgbdSource>, WorldError> {
    let Some(ros) = &settings.ros else {
        return Err(no_camera("the settings have no `[ros]`".to_owned()));
    };
    let camera = runtime::arm::ros::RosCamera::subscribe(ros, settings.camera.timeout_s);
    Ok(Box::new(
        camera.map_err(|error| no_camera(error.to_string()))?,
    ))
}

#[cfg(not(feature = "ros"))]
fn subscribed(_: &Settings) -> Result<Box<dyn RgbdSource>, WorldError> {
    Err(no_camera(
        "`source = \"ros\"` needs a fabc that was built with `--features ros`".to_owned(),
    ))
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

fn no_camera(why: String) -> WorldError {
    WorldError::Camera { why }
}

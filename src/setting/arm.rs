//! The world of `--world jaco`: an arm's settings, its calibration, its driver, and who watches it.

use crate::cli::robot::ArmArguments;
use crate::exit::Failure;
use crate::robot::terminal::{HoldToRun, Terminal};
use crate::robot::watchdog::Process;
use compiler::program::Program;
use runtime::arm::settings::{DriverKind, Settings};
use runtime::arm::supervisor::{NoWatchdog, Supervisor, Unattended};
use runtime::start::Start;
use runtime::world::jaco::{self, Parts};
use runtime::world::{ArmWorld, World, WorldError};
use std::path::PathBuf;

/// Makes sure before anything else that the settings can be used and that there is somebody to ask.
pub fn check(arguments: &ArmArguments) -> Result<Settings, Failure> {
    let (settings, ..) = jaco::load(&arguments.robot).map_err(Failure::environment)?;
    supervisor(arguments, &settings)?;
    if settings.driver != DriverKind::Simulated && !cfg!(feature = "ros") {
        return Err(Failure::environment(format!(
            "`{}` is of a real arm, and this fabc was built without ROS: build it with `--features ros`",
            arguments.robot.display()
        )));
    }
    Ok(settings)
}

/// Returns the start of a cloth that a person lays.
pub fn start(program: &Program, named: Option<&String>) -> Result<Start, Failure> {
    match named {
        Some(named) => Err(Failure::usage(format!(
            "`--start {named}` is for the simulator: on a real table a person lays the cloth"
        ))),
        None => Ok(Start {
            name: "laid by hand".to_owned(),
            ..Start::flat(&program.cloth)
        }),
    }
}

/// Makes the world of an arm; `folder` is the run folder, for the arm's journal.
pub fn world(
    program: &Program,
    arguments: &ArmArguments,
    folder: Option<&PathBuf>,
) -> Result<Box<dyn World>, WorldError> {
    let (settings, settings_hash, calibration) = jaco::load(&arguments.robot).map_err(failed)?;
    let supervisor = supervisor(arguments, &settings).map_err(|error| failed(error.to_string()))?;
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
    if is_simulated {
        return Ok(Box::new(ArmWorld::simulated(parts)?));
    }
    let watchdog = Process::start(&arguments.robot, watchdog_s).map_err(failed)?;
    parts.watchdog = Box::new(watchdog);
    real(parts, arguments)
}

/// Connects to a real arm and its camera, and starts its watchdog.
#[cfg(feature = "ros")]
fn real(parts: Parts, arguments: &ArmArguments) -> Result<Box<dyn World>, WorldError> {
    use runtime::arm::directory::DirectoryCamera;
    use runtime::arm::driver::{Arm, PortArm};
    use runtime::arm::kinematics::chain::Chain;
    use runtime::arm::rgbd::RgbdSource;
    use runtime::arm::ros::{RosCamera, connect};
    use runtime::arm::settings::CameraSource;

    let settings = parts.settings.clone();
    let camera = &settings.camera;
    let Some(ros) = &settings.ros else {
        return Err(failed("the settings have no `[ros]`".to_owned()));
    };
    let beside = arguments
        .robot
        .parent()
        .unwrap_or(std::path::Path::new("."));
    let source: Box<dyn RgbdSource> = match (camera.source, &camera.folder) {
        (CameraSource::Ros, _) => {
            let subscribed = RosCamera::subscribe(ros, camera.timeout_s);
            Box::new(subscribed.map_err(|error| failed(error.to_string()))?)
        }
        (CameraSource::Directory, Some(folder)) => Box::new(DirectoryCamera::of(
            &beside.join(folder),
            camera.intrinsics.clone(),
        )),
        _ => {
            return Err(failed(
                "a real arm needs the camera `ros`, or `directory` with a folder".to_owned(),
            ));
        }
    };
    let port = connect(ros, &settings.model, camera.timeout_s);
    let port = port.map_err(|error| failed(error.to_string()))?;
    let arm: Box<dyn Arm> = match settings.driver {
        DriverKind::Trajectory => {
            let chain =
                Chain::of_model(&settings.model).map_err(|error| failed(error.to_string()))?;
            let (fingers, tolerance) = (settings.fingers, settings.tolerance);
            let arm = PortArm::by_trajectories(port, chain, fingers, tolerance);
            Box::new(arm.with_floor(settings.table.center_m[2]))
        }
        _ => Box::new(PortArm::by_poses(
            port,
            &settings.model,
            settings.fingers,
            settings.tolerance,
        )),
    };
    Ok(Box::new(ArmWorld::new(parts, arm, source)?))
}

#[cfg(not(feature = "ros"))]
fn real(_: Parts, arguments: &ArmArguments) -> Result<Box<dyn World>, WorldError> {
    Err(failed(format!(
        "`{}` is of a real arm, and this fabc was built without ROS: build it with `--features ros`",
        arguments.robot.display()
    )))
}

/// Returns who gives leave to move: for a real arm a person, unless told otherwise.
fn supervisor(
    arguments: &ArmArguments,
    settings: &Settings,
) -> Result<Box<dyn Supervisor>, Failure> {
    use crate::cli::robot::Confirm;

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

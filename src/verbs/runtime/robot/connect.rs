//! Connects to a real arm and its camera, as the settings say.
//!
//! In: settings with `[ros]`. Out: the arm's port, its driver, its camera; else why there is none. Connecting moves nothing.
//! A build without the feature `ros` connects to no arm.

use crate::exit::Failure;
use fab_arm::directory::{DirectoryCamera, PictureSelection};
use fab_arm::driver::Arm;
use fab_arm::guard::Guard;
use fab_arm::port::Port;
use fab_arm::rgbd::RgbdSource;
use fab_arm::settings::{CameraSource, DriverKind, Settings};
use std::path::Path;

/// Loads the settings of a real arm; fails for one that this program simulates, and where this build has no ROS.
///
/// - `why_real`: what cannot be done with a simulated arm, for the message.
pub fn settings_of_real(robot: &Path, why_real: &str) -> Result<Settings, Failure> {
    let settings = Settings::load(robot).map_err(Failure::environment)?;
    if settings.driver == DriverKind::Simulated {
        return Err(Failure::environment(format!(
            "the arm of `{}` is simulated: {why_real}",
            robot.display()
        )));
    }
    match cfg!(feature = "ros") {
        true => Ok(settings),
        false => Err(Failure::environment(without_ros(robot))),
    }
}

/// Says that this build reaches no real arm.
pub fn without_ros(robot: &Path) -> String {
    format!(
        "`{}` is of a real arm, and this fabc was built without ROS: build it with `--features ros`",
        robot.display()
    )
}

/// Opens the camera over a real table.
///
/// - `robot`: the settings' file, beside which a folder of pictures lies.
/// - `selection`: which picture of that folder to take.
pub fn camera(
    settings: &Settings,
    robot: &Path,
    selection: PictureSelection,
) -> Result<Box<dyn RgbdSource>, String> {
    let camera = &settings.camera;
    let beside = robot.parent().unwrap_or(Path::new("."));
    match (camera.source, &camera.folder) {
        (CameraSource::Directory, Some(folder)) => Ok(Box::new(DirectoryCamera::of(
            &beside.join(folder),
            camera.intrinsics.clone(),
            selection,
        ))),
        (CameraSource::Ros, _) => subscribed(settings),
        _ => Err("a real arm needs the camera `ros`, or `directory` with a folder".to_owned()),
    }
}

#[cfg(feature = "ros")]
fn subscribed(settings: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    let ros = settings
        .ros
        .as_ref()
        .ok_or("the settings have no `[ros]`")?;
    let camera = fab_arm_ros::RosCamera::subscribe(ros, settings.camera.timeout_s);
    Ok(Box::new(camera.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "ros"))]
fn subscribed(_: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    Err("`source = \"ros\"` needs a fabc that was built with `--features ros`".to_owned())
}

/// Connects to the node of an arm.
#[cfg(feature = "ros")]
pub fn port(settings: &Settings) -> Result<Box<dyn Port>, String> {
    Ok(Box::new(ros(settings)?))
}

#[cfg(feature = "ros")]
fn ros(settings: &Settings) -> Result<fab_arm_ros::RosPort, String> {
    let ros = settings
        .ros
        .as_ref()
        .ok_or("the settings have no `[ros]`")?;
    let connected = fab_arm_ros::connect(ros, &settings.model, settings.camera.timeout_s);
    connected.map_err(|error| error.to_string())
}

/// Connects to the node of an arm, and drives it as its settings say; `guard` checks every motion before it is sent.
#[cfg(feature = "ros")]
pub fn arm(settings: &Settings, guard: Guard) -> Result<Box<dyn Arm>, String> {
    use fab_arm::driver::PortArm;

    let port = ros(settings)?;
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    Ok(match settings.driver {
        DriverKind::Trajectory => {
            Box::new(PortArm::by_trajectories(port, guard, fingers, tolerance))
        }
        _ => Box::new(PortArm::by_poses(port, guard, fingers, tolerance)),
    })
}

/// Connects to nothing.
#[cfg(not(feature = "ros"))]
pub fn port(_: &Settings) -> Result<Box<dyn Port>, String> {
    Err(NONE.to_owned())
}

/// Drives nothing.
#[cfg(not(feature = "ros"))]
pub fn arm(_: &Settings, _: Guard) -> Result<Box<dyn Arm>, String> {
    Err(NONE.to_owned())
}

#[cfg(not(feature = "ros"))]
const NONE: &str = "this fabc was built without ROS: build it with `--features ros`";

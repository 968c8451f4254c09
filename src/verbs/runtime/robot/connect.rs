//! Connects to a real arm and its camera, as the settings say.
//!
//! In: settings with `[ros]` or `[ros2]`. Out: the arm's port, its driver, its camera; else why there is none. Connecting
//! moves nothing. A build connects to the arms of the features that it has: `ros`, `ros2`.

use crate::exit::Failure;
use fab_arm::directory::{DirectoryCamera, PictureSelection};
use fab_arm::driver::{Arm, PortArm};
use fab_arm::guard::Guard;
use fab_arm::port::Port;
use fab_arm::rgbd::RgbdSource;
use fab_arm::settings::{CameraSource, DriverKind, Settings};
use std::path::Path;

/// Loads the settings of a real arm; fails for one that this program simulates, and where this build has no connection
/// to it.
///
/// - `why_real`: what cannot be done with a simulated arm, for the message.
pub fn settings_of_real(robot: &Path, why_real: &str) -> Result<Settings, Failure> {
    let settings = Settings::load(robot)?;
    if settings.driver == DriverKind::Simulated {
        return Err(Failure::environment(format!(
            "the arm of `{}` is simulated: {why_real}",
            robot.display()
        )));
    }
    check_built(&settings, robot).map_err(Failure::environment)?;
    Ok(settings)
}

/// Fails if this build has no connection to the arm of these settings.
pub fn check_built(settings: &Settings, robot: &Path) -> Result<(), String> {
    let (ros, feature, is_built) = match settings.driver {
        DriverKind::Simulated => return Ok(()),
        DriverKind::Kinova | DriverKind::Trajectory => ("ROS", "ros", cfg!(feature = "ros")),
        DriverKind::Ros2 => ("ROS 2", "ros2", cfg!(feature = "ros2")),
    };
    if is_built {
        return Ok(());
    }
    Err(format!(
        "`{}` is of a real arm, and this fabc was built without {ros}: build it with `--features {feature}`",
        robot.display()
    ))
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
        (CameraSource::Ros, _) => ros_camera(settings),
        (CameraSource::Ros2, _) => ros2_camera(settings),
        _ => Err(
            "a real arm needs the camera `ros` or `ros2`, or `directory` with a folder".to_owned(),
        ),
    }
}

/// Connects to the node of an arm.
///
/// - `timeout_s`: the longest to wait for it, seconds.
pub fn port(settings: &Settings, timeout_s: f64) -> Result<Box<dyn Port>, String> {
    match settings.driver {
        DriverKind::Kinova | DriverKind::Trajectory => ros_port(settings, timeout_s),
        DriverKind::Ros2 => ros2_port(settings, timeout_s),
        DriverKind::Simulated => Err("an arm that this program simulates has no node".to_owned()),
    }
}

/// Connects to the node of an arm, and drives it as its settings say; `guard` checks every motion before it is sent.
pub fn arm(settings: &Settings, guard: Guard) -> Result<Box<dyn Arm>, String> {
    let port = port(settings, settings.camera.timeout_s)?;
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    Ok(Box::new(match settings.driver {
        DriverKind::Kinova => PortArm::by_poses(port, guard, fingers, tolerance),
        _ => PortArm::by_trajectories(port, guard, fingers, tolerance),
    }))
}

#[cfg(feature = "ros")]
fn ros_port(settings: &Settings, timeout_s: f64) -> Result<Box<dyn Port>, String> {
    let ros = settings
        .ros
        .as_ref()
        .ok_or("the settings have no `[ros]`")?;
    let connected = fab_arm_ros::connect(ros, &settings.model, timeout_s);
    Ok(Box::new(connected.map_err(|error| error.to_string())?))
}

#[cfg(feature = "ros")]
fn ros_camera(settings: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    let ros = settings
        .ros
        .as_ref()
        .ok_or("the settings have no `[ros]`")?;
    let camera = fab_arm_ros::subscribe(ros, settings.camera.timeout_s);
    Ok(Box::new(camera.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "ros"))]
fn ros_port(_: &Settings, _: f64) -> Result<Box<dyn Port>, String> {
    Err("this fabc was built without ROS: build it with `--features ros`".to_owned())
}

#[cfg(not(feature = "ros"))]
fn ros_camera(_: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    Err("`source = \"ros\"` needs a fabc that was built with `--features ros`".to_owned())
}

#[cfg(feature = "ros2")]
fn ros2_port(settings: &Settings, timeout_s: f64) -> Result<Box<dyn Port>, String> {
    let ros2 = settings
        .ros2
        .as_ref()
        .ok_or("the settings have no `[ros2]`")?;
    let connected =
        fab_arm_ros2::connect(ros2, settings.chain(), settings.fingers.count, timeout_s);
    Ok(Box::new(connected.map_err(|error| error.to_string())?))
}

#[cfg(feature = "ros2")]
fn ros2_camera(settings: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    let ros2 = settings
        .ros2
        .as_ref()
        .ok_or("the settings have no `[ros2]`")?;
    let camera = fab_arm_ros2::subscribe(ros2, settings.camera.timeout_s);
    Ok(Box::new(camera.map_err(|error| error.to_string())?))
}

#[cfg(not(feature = "ros2"))]
fn ros2_port(_: &Settings, _: f64) -> Result<Box<dyn Port>, String> {
    Err("this fabc was built without ROS 2: build it with `--features ros2`".to_owned())
}

#[cfg(not(feature = "ros2"))]
fn ros2_camera(_: &Settings) -> Result<Box<dyn RgbdSource>, String> {
    Err("`source = \"ros2\"` needs a fabc that was built with `--features ros2`".to_owned())
}

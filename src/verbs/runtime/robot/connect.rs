//! Connects to a real arm and its camera, as the settings say.
//!
//! In: settings with `[ros]` or `[ros2]`. Out: the arm's port, its driver, its camera; else why there is none. Connecting
//! moves nothing. A build connects to the arms of the features that it has: `ros`, `ros2`.

use crate::exit::Failure;
use fab_arm::directory::{DirectoryCamera, PictureSelection};
use fab_arm::driver::{Commands, PortArm};
use fab_arm::port::Port;
use fab_arm::rgbd::RgbdSource;
use fab_arm::settings::{CameraSource, DriverKind, Settings};
use std::path::Path;

/// Loads the settings of an arm to which this build can connect; `why_real` says what a simulated one cannot do.
pub fn settings_of_real(robot: &Path, why_real: &str) -> Result<Settings, Failure> {
    let settings = Settings::load(robot)?;
    if settings.driver == DriverKind::Simulated {
        return Err(Failure::environment(format!(
            "the arm of `{}` is simulated: {why_real}",
            robot.display()
        )));
    }
    check_built(&settings).map_err(Failure::environment)?;
    Ok(settings)
}

/// Fails if this build has no connection to the arm of these settings.
pub fn check_built(settings: &Settings) -> Result<(), String> {
    let (ros, feature, is_built) = match settings.driver {
        DriverKind::Simulated => return Ok(()),
        DriverKind::Kinova | DriverKind::Trajectory => ("ROS", "ros", cfg!(feature = "ros")),
        DriverKind::Ros2 => ("ROS 2", "ros2", cfg!(feature = "ros2")),
    };
    if is_built {
        return Ok(());
    }
    Err(format!(
        "the arm `{}` is a real one, and this fabc was built without {ros}: build it with `--features {feature}`",
        settings.name
    ))
}

/// Opens the camera over a real table; `robot` is the settings' file, beside which a folder of pictures lies.
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
        #[cfg(feature = "ros")]
        (CameraSource::Ros, _) => {
            let ros = settings.ros.as_ref().ok_or(NO_ROS)?;
            let camera = fab_arm_ros::subscribe(ros, camera.timeout_s);
            Ok(Box::new(camera.map_err(|error| error.to_string())?))
        }
        #[cfg(feature = "ros2")]
        (CameraSource::Ros2, _) => {
            let ros2 = settings.ros2.as_ref().ok_or(NO_ROS2)?;
            let camera = fab_arm_ros2::subscribe(ros2, camera.timeout_s);
            Ok(Box::new(camera.map_err(|error| error.to_string())?))
        }
        #[cfg(not(feature = "ros"))]
        (CameraSource::Ros, _) => Err(camera_needs("ros")),
        #[cfg(not(feature = "ros2"))]
        (CameraSource::Ros2, _) => Err(camera_needs("ros2")),
        _ => Err(
            "a real arm needs the camera `ros` or `ros2`, or `directory` with a folder".to_owned(),
        ),
    }
}

#[cfg(not(all(feature = "ros", feature = "ros2")))]
fn camera_needs(feature: &str) -> String {
    format!("`source = \"{feature}\"` needs a fabc that was built with `--features {feature}`")
}

#[cfg(feature = "ros")]
const NO_ROS: &str = "the settings have no `[ros]`";
#[cfg(feature = "ros2")]
const NO_ROS2: &str = "the settings have no `[ros2]`";

/// Connects to the node of an arm within `timeout_s` seconds.
#[cfg_attr(
    not(any(feature = "ros", feature = "ros2")),
    expect(unused_variables, reason = "without ROS there is nothing to wait for")
)]
pub fn port(settings: &Settings, timeout_s: f64) -> Result<Box<dyn Port>, String> {
    check_built(settings)?;
    #[cfg(feature = "ros")]
    if let DriverKind::Kinova | DriverKind::Trajectory = settings.driver {
        let ros = settings.ros.as_ref().ok_or(NO_ROS)?;
        let connected = fab_arm_ros::connect(ros, &settings.model, timeout_s);
        return Ok(Box::new(connected.map_err(|error| error.to_string())?));
    }
    #[cfg(feature = "ros2")]
    if settings.driver == DriverKind::Ros2 {
        let ros2 = settings.ros2.as_ref().ok_or(NO_ROS2)?;
        let (chain, n_fingers) = (settings.chain(), settings.fingers.count);
        let connected = fab_arm_ros2::connect(ros2, chain, n_fingers, timeout_s);
        return Ok(Box::new(connected.map_err(|error| error.to_string())?));
    }
    Err("an arm that this program simulates has no node".to_owned())
}

/// Connects to the node of an arm, and drives it as its settings say.
pub fn arm(settings: &Settings) -> Result<PortArm<dyn Port>, String> {
    let port = port(settings, settings.camera.timeout_s)?;
    let commands = match settings.driver {
        DriverKind::Kinova => Commands::Poses,
        _ => Commands::Trajectories,
    };
    Ok(PortArm::new(
        port,
        commands,
        settings.fingers,
        settings.tolerance,
    ))
}

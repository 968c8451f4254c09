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
    match settings.driver {
        DriverKind::Kinova | DriverKind::Trajectory if !cfg!(feature = "ros") => Err(lacks("ros")),
        DriverKind::Ros2 if !cfg!(feature = "ros2") => Err(lacks("ros2")),
        _ => Ok(()),
    }
}

fn lacks(feature: &str) -> String {
    format!(
        "this fabc was built without the connection to a real arm or its camera: build it with `--features {feature}`"
    )
}

/// Returns a part that the settings' check requires.
fn part<'s, T>(part: &'s Option<T>, name: &str) -> Result<&'s T, String> {
    part.as_ref()
        .ok_or_else(|| format!("the settings have no `{name}`"))
}

/// Opens the camera over a real table; `robot` is the settings' file, beside which a folder of pictures lies.
pub fn camera(
    settings: &Settings,
    robot: &Path,
    selection: PictureSelection,
) -> Result<Box<dyn RgbdSource>, String> {
    let camera = &settings.camera;
    Ok(match camera.source {
        CameraSource::Directory => {
            let folder = part(&camera.folder, "camera.folder")?;
            let folder = robot.parent().unwrap_or(Path::new(".")).join(folder);
            let intrinsics = camera.intrinsics.clone();
            Box::new(DirectoryCamera::of(&folder, intrinsics, selection))
        }
        #[cfg(feature = "ros")]
        CameraSource::Ros => {
            let camera = fab_arm_ros::subscribe(part(&settings.ros, "ros")?, camera.timeout_s);
            Box::new(camera.map_err(|error| error.to_string())?)
        }
        #[cfg(feature = "ros2")]
        CameraSource::Ros2 => {
            let camera = fab_arm_ros2::subscribe(part(&settings.ros2, "ros2")?, camera.timeout_s);
            Box::new(camera.map_err(|error| error.to_string())?)
        }
        source => return Err(lacks(source.name())),
    })
}

/// Connects to the node of an arm within `timeout_s` seconds.
#[cfg_attr(
    not(any(feature = "ros", feature = "ros2")),
    expect(unused_variables, reason = "without ROS there is nothing to wait for")
)]
pub fn port(settings: &Settings, timeout_s: f64) -> Result<Box<dyn Port>, String> {
    check_built(settings)?;
    #[cfg(feature = "ros")]
    if let DriverKind::Kinova | DriverKind::Trajectory = settings.driver {
        let ros = part(&settings.ros, "ros")?;
        let port = fab_arm_ros::connect(ros, &settings.model, timeout_s);
        return Ok(Box::new(port.map_err(|error| error.to_string())?));
    }
    #[cfg(feature = "ros2")]
    if settings.driver == DriverKind::Ros2 {
        let (ros2, chain) = (part(&settings.ros2, "ros2")?, settings.chain());
        let port = fab_arm_ros2::connect(ros2, chain, settings.fingers.count, timeout_s);
        return Ok(Box::new(port.map_err(|error| error.to_string())?));
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
    let (fingers, tolerance) = (settings.fingers, settings.tolerance);
    Ok(PortArm::new(port, commands, fingers, tolerance))
}

//! The settings of one arm over one table: a TOML file that its owner writes once.
//!
//! In: text. Out: [`Settings`], every number checked; an error names the key, its value and what would be right. Ranges
//! and defaults are in one table (`keys`), what one key requires of another in `check`. The camera's pose is measured,
//! and stored in its own file (`fabc calibrate`).

mod check;
mod keys;

use super::description::ArmDescription;
use super::kinematics::chain::Chain;
use super::rgbd::Intrinsics;
use fab_base::files;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The longest settings file accepted.
const MAX_BYTES: u64 = 256 << 10;

/// One arm over one table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// A name for reports, e.g. `lab_jaco`.
    pub name: String,
    /// The arm's model: `j2n6s200`, `j2n6s300` or `j2s6s200`; the name in its URDF for an arm that `arm` describes.
    #[serde(default)]
    pub model: String,
    /// An arm of another kind.
    pub arm: Option<ArmDescription>,
    /// Its joints and shapes; only [`Settings::load`] and [`Settings::parse`] find them.
    #[serde(skip)]
    chain: Chain,
    /// The driver that moves it.
    pub driver: DriverKind,
    /// The file that `fabc calibrate` wrote, relative to this one.
    pub calibration: PathBuf,
    /// The pose of the table.
    pub table: Table,
    /// The limits of the tool's position.
    pub workspace: Workspace,
    /// How a pick and place is executed.
    pub motion: MotionSettings,
    /// What finger positions mean.
    pub fingers: FingerSettings,
    /// When a goal counts as reached, and its time limits.
    pub tolerance: Tolerance,
    /// The source of pictures.
    pub camera: CameraSettings,
    /// The connection to the arm's node; needed for the drivers `kinova` and `trajectory`.
    pub ros: Option<RosSettings>,
    /// The connection over ROS 2; needed for the driver and the camera `ros2`.
    pub ros2: Option<Ros2Settings>,
    /// The arm and table of the driver `simulated`.
    pub simulated: SimulatedSettings,
}

/// A driver of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DriverKind {
    /// The node of kinova-ros, with Cartesian goals.
    Kinova,
    /// A `FollowJointTrajectory` controller, with joint trajectories from this crate's inverse kinematics.
    Trajectory,
    /// A `FollowJointTrajectory` controller and a gripper's action of ROS 2, with joint trajectories likewise.
    Ros2,
    /// An arm that this program simulates, over a simulated cloth.
    Simulated,
}

/// The pose of the table in the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Its middle, which is the origin of the world frame; metres, base frame. The height is that of the tool pose at
    /// which the fingertips touch the table.
    pub center_m: [f64; 3],
    /// Rotation of the world frame about z relative to the base frame, degrees.
    pub turn_deg: f64,
}

/// The limits of the tool's position.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Workspace {
    /// The least x, y and z of the tool, metres, base frame.
    pub min_m: [f64; 3],
    /// The largest.
    pub max_m: [f64; 3],
    /// Boxes that neither the tool nor its path may enter.
    pub keep_out: Vec<KeepOut>,
    /// Where the tool waits while pictures are taken, out of the camera's view; metres, base frame.
    pub rest_m: [f64; 3],
    /// The highest speed of the tool, m/s.
    pub max_speed_m_s: f64,
    /// The longest single segment, metres.
    pub max_step_m: f64,
}

/// A box that the tool may not enter.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeepOut {
    /// The obstacle's name.
    pub name: String,
    /// Its least corner, metres, base frame.
    pub min_m: [f64; 3],
    /// Its largest.
    pub max_m: [f64; 3],
}

/// How a pick and place is executed; heights are above the pick or place point.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionSettings {
    /// Height at which the hand arrives over the pick, metres (paper: 5 mm).
    pub pre_pick_m: f64,
    /// Height at which the fingers close, metres.
    pub grasp_m: f64,
    /// Height to which the cloth is lifted, metres (paper: 5 mm).
    pub lift_m: f64,
    /// Height at which the fingers open, metres.
    pub release_m: f64,
    /// Height to which the hand rises after the release, metres.
    pub retreat_m: f64,
    /// Height above the table at which the empty hand travels, metres.
    pub travel_m: f64,
    /// Speed of the tool, m/s. The node behind the driver `kinova` uses its own speed; for it this only determines a
    /// motion's time limit.
    pub speed_m_s: f64,
    /// The largest acceleration of a joint, degrees/s².
    pub acceleration_deg_s2: f64,
    /// The largest jerk of a joint, degrees/s³.
    pub jerk_deg_s3: f64,
    /// Rotation of the hand about the vertical, degrees in the base frame.
    pub hand_turn_deg: f64,
}

/// The simulated arm and table of the driver `simulated`, which needs no real hardware.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulatedSettings {
    /// Height of the simulated camera above the table, metres.
    pub camera_height_m: f64,
    /// Offset of the camera from the middle of the table, metres along the table's x and y.
    pub camera_offset_m: [f64; 2],
    /// Rotation of the camera about the vertical, degrees.
    pub camera_turn_deg: f64,
    /// Field of view across the picture's shorter side, degrees.
    pub camera_fov_deg: f64,
    /// Side of the camera's square picture, pixels.
    pub camera_px: u32,
    /// Largest distance between a commanded position and where the tool comes to rest, metres.
    pub repeatability_m: f64,
    /// Seeds everything random about the arm.
    pub seed: u64,
}

impl SimulatedSettings {
    /// Returns the camera's pose above the table, world frame, without its height. It looks down, with y up in the picture.
    pub fn world_from_camera(&self) -> Isometry3<f64> {
        let [x, y] = self.camera_offset_m;
        Isometry3::from_parts(
            Translation3::new(x, y, 0.0),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.camera_turn_deg.to_radians()),
        )
    }

    /// Returns the camera's projection.
    pub fn intrinsics(&self) -> Intrinsics {
        let half_px = f64::from(self.camera_px) / 2.0;
        let focal_px = half_px / (self.camera_fov_deg.to_radians() / 2.0).tan();
        Intrinsics {
            size_px: [self.camera_px; 2],
            focal_px: [focal_px; 2],
            middle_px: [half_px; 2],
            distortion: Vec::new(),
        }
    }
}

/// The meaning of finger positions; the vendor's documents disagree about the units, so they are measured.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerSettings {
    /// How many fingers: 2 or 3.
    pub count: usize,
    /// Position at which they are open, in the node's units.
    pub open: f64,
    /// Position at which they are closed with nothing between them.
    pub closed: f64,
    /// Least distance from `closed` at which they stop if cloth is between them; without it, nothing is concluded from
    /// their position.
    pub cloth: Option<f64>,
    /// How close to a position counts as there.
    pub tolerance: f64,
}

/// When a goal counts as reached, and its time limits.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// How far the tool may be from its target, metres. The arm's node itself accepts 10 mm.
    pub position_m: f64,
    /// How far it may be rotated from its target, degrees. The arm's node itself accepts 2 degrees.
    pub angle_deg: f64,
    /// How often a goal is re-sent if the node reports it as reached but the tool is not there.
    pub corrections: u32,
    /// The longest that a segment may take beyond its nominal duration, seconds.
    pub settle_s: f64,
    /// The largest age of a reading, seconds.
    pub stale_s: f64,
    /// The longest time without a heartbeat, after which the watchdog stops the arm, seconds.
    pub watchdog_s: f64,
}

/// The source of pictures.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSettings {
    /// The source.
    pub source: CameraSource,
    /// For `directory`: the folder, relative to this file.
    pub folder: Option<PathBuf>,
    /// The square of the picture that tasks see: its left, top and side, pixels of the camera's own picture.
    pub window_px: [u32; 3],
    /// The camera's projection, if it does not report it itself.
    pub intrinsics: Option<Intrinsics>,
    /// The camera's own picture of the flat cloth, whole and alone on the table, relative to this file; coverage is
    /// measured against it.
    pub flat: Option<PathBuf>,
    /// The longest to wait for a picture, seconds.
    pub timeout_s: f64,
}

/// A kind of camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CameraSource {
    /// Topics with `sensor_msgs` messages.
    Ros,
    /// The same over ROS 2.
    Ros2,
    /// Pictures that another program writes into a folder, `NAME.png` with `NAME.depth.png`: each time a new one.
    Directory,
    /// The simulator's camera; with the driver `simulated` only.
    Simulated,
}

/// The connection to the arm's node and the camera over ROS 1.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RosSettings {
    /// Address of the master, e.g. `http://localhost:11311`.
    pub master: String,
    /// This machine's name for the other nodes (`ROS_IP`, `ROS_HOSTNAME`).
    pub host: Option<String>,
    /// Namespace of kinova-ros's node, e.g. `/j2n6s200_driver`.
    pub arm: String,
    /// The controller's action, for the driver `trajectory`.
    pub trajectory: Option<String>,
    /// The joints' names in a trajectory, from the base to the hand.
    pub joints: Vec<String>,
    /// Topic of the colour picture.
    pub color: Option<String>,
    /// Topic of the aligned depth picture: 16 bits, millimetres, 0 for no reading.
    pub depth: Option<String>,
    /// Topic of the camera's `CameraInfo`.
    pub info: Option<String>,
}

/// The connection to an arm's controllers and the camera over ROS 2.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ros2Settings {
    /// The DDS domain (`ROS_DOMAIN_ID`).
    pub domain: u16,
    /// The middleware of the other nodes (`RMW_IMPLEMENTATION`), which decides how services are asked.
    pub rmw: Rmw,
    /// The IPv4 address of this machine's one network interface to use; all of them without it.
    pub interface: Option<String>,
    /// The topic of the joints' states.
    pub joint_states: String,
    /// The joints' names, from the base to the hand.
    pub joints: Vec<String>,
    /// The controller's action.
    pub trajectory: Option<String>,
    /// The gripper's action.
    pub gripper: Option<String>,
    /// The type of that action.
    pub gripper_action: GripperAction,
    /// The joints whose positions tell where the fingers are: one for each, or one for all.
    pub gripper_joints: Vec<String>,
    /// The largest effort of a gripper's goal, in its own units; 0 leaves it to the controller.
    pub gripper_effort: f64,
    /// A service that stops the arm (`std_srvs/Trigger`).
    pub stop: Option<String>,
    /// Topic of the colour picture.
    pub color: Option<String>,
    /// Topic of the aligned depth picture.
    pub depth: Option<String>,
    /// Topic of the camera's `CameraInfo`.
    pub info: Option<String>,
}

fab_base::named! {
    /// A middleware of ROS 2.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    pub enum Rmw {
        /// `rmw_fastrtps_cpp`, the default of Humble, Jazzy and Kilted.
        Fastrtps = "fastrtps",
        /// `rmw_cyclonedds_cpp`.
        Cyclonedds = "cyclonedds",
    }
}

/// The type of a gripper's action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GripperAction {
    /// `control_msgs/GripperCommand`.
    GripperCommand,
    /// `control_msgs/ParallelGripperCommand`.
    ParallelGripperCommand,
}

/// Why settings cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{file}` cannot be used as an arm's settings: {why}")]
pub struct SettingsError {
    /// The file.
    pub file: String,
    /// What is wrong.
    pub why: String,
}

impl Settings {
    /// Reads a settings file and checks every number.
    pub fn load(path: &Path) -> Result<Settings, SettingsError> {
        let wrong = |why: String| SettingsError {
            file: path.display().to_string(),
            why,
        };
        let text = files::read_text(path, MAX_BYTES).map_err(wrong)?;
        let beside = path.parent().unwrap_or(Path::new(""));
        Settings::parse_in(beside, &text).map_err(wrong)
    }

    /// Reads settings from text that names no other file, and checks every number; fails with all faults, one per line.
    pub fn parse(text: &str) -> Result<Settings, String> {
        Settings::parse_in(Path::new(""), text)
    }

    /// Likewise.
    ///
    /// - `folder`: the folder of the files that the text names.
    fn parse_in(folder: &Path, text: &str) -> Result<Settings, String> {
        let document = keys::read(text)?;
        let settings = document.try_into();
        let mut settings: Settings =
            settings.map_err(|error: toml::de::Error| error.to_string())?;
        settings.chain = check::check(&settings, folder)?;
        settings.model = settings.chain.model().to_owned();
        if let Some(ros) = &mut settings.ros
            && ros.joints.is_empty()
        {
            ros.joints = settings.chain.names().to_vec();
        }
        if let Some(ros2) = &mut settings.ros2
            && ros2.joints.is_empty()
        {
            ros2.joints = settings.chain.names().to_vec();
        }
        Ok(settings)
    }

    /// Returns the arm's joints and shapes.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }
}

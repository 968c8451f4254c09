//! The settings of one arm over one table: a TOML file that its owner writes once.
//!
//! In: text. Out: [`Settings`], every number checked; an error names the key, its value and what would be right. Each key is
//! declared once, with its range, default and reason (`declare`); what one key requires of another is in `check`. The
//! camera's pose is measured, and stored in its own file (`fabc calibrate`).

mod check;
pub(crate) mod declare;

use super::description::ArmDescription;
use super::kinematics::chain::Chain;
use super::rgbd::Intrinsics;
use declare::{ANGLE, MAX_SIDE_PX, Values, from, named_settings, section};
use fab_base::files;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

/// The longest settings file accepted.
const MAX_BYTES: u64 = 256 << 10;

/// A place in the base frame: the largest arm of this kind reaches less than 2 m, and the table is within its reach.
const PLACE: Values = from(-3.0, 3.0);

/// The field of view of the simulated camera, radians: about that of a depth camera across its shorter side.
pub const CAMERA_FOV_RAD: f64 = PI / 4.0;

/// Heights above a point of the table.
const HEIGHT: Values = from(0.0, 0.5);

section! {
    /// One arm over one table.
    pub struct Settings {
        /// A name for reports.
        name: String;
        /// The arm's model, if it is a shipped one: `j2n6s200`, `j2n6s300` or `j2s6s200`. Another arm has a section
        /// `[arm]`, and the name in its URDF.
        model: String = "";
        /// `kinova`: the vendor's node, tool poses. `trajectory`: a `FollowJointTrajectory` controller beside the
        /// vendor's node. `ros2`: such a controller of ROS 2, and a gripper. `simulated`: an arm that `fabc` simulates.
        driver: DriverKind;
        /// The file that `fabc calibrate` writes, relative to the settings.
        calibration: PathBuf;
        /// An arm with six or seven joints that a URDF file describes, with the keys below; in place of `model`.
        arm: Option<ArmDescription>;
        /// The pose of the table in the base frame.
        table: Table;
        /// The limits of the tool's position.
        workspace: Workspace;
        /// How a pick and place is executed.
        motion: MotionSettings;
        /// What finger positions mean.
        fingers: FingerSettings;
        /// When a goal counts as reached, and its time limits.
        tolerance: Tolerance;
        /// The source of pictures.
        camera: CameraSettings;
        /// The connection over ROS 1, with the keys below; needed for the drivers `kinova` and `trajectory`, and for
        /// the camera `ros`.
        ros: Option<RosSettings>;
        /// The connection over ROS 2, with the keys below; needed for the driver and the camera `ros2`.
        ros2: Option<Ros2Settings>;
        /// The arm, table and camera of the driver `simulated`.
        simulated: SimulatedSettings;
    }
    with {
        /// Its joints and shapes; only [`Settings::load`] and [`Settings::parse`] find them.
        chain: Chain
    }

    /// The pose of the table in the base frame.
    #[derive(Copy)]
    pub struct Table {
        /// The tool's position when the closed fingertips touch the table's middle, base frame; inside of the
        /// workspace's x and y.
        center_m: [f64; 3], PLACE;
        /// Rotation of the table's axes about the vertical, against the base.
        turn_deg: f64 = 0.0, ANGLE;
    }

    /// The limits of the tool's position.
    pub struct Workspace {
        /// The least x, y and z of the tool, base frame. z is that at the table's middle, the floor follows a tilted
        /// table, and it lies `tolerance.position_m` to 10 mm below `table.center_m`: a deeper one would let the hand
        /// go below the table, a higher one keep it from touching.
        min_m: [f64; 3], PLACE;
        /// The largest; z leaves room for `motion.travel_m`.
        max_m: [f64; 3], PLACE;
        /// Where the hand waits while pictures are taken, out of the camera's view, base frame; inside of the workspace
        /// and outside of every keep-out zone by `tolerance.position_m`, and at least `motion.retreat_m` above the
        /// table, so that it does not drag the cloth.
        rest_m: [f64; 3], PLACE;
        /// The highest speed of the tool; the arm is stopped at 1.5 times of it. In a quarter of a second a tool at 0.5
        /// m/s moves 125 mm.
        max_speed_m_s: f64 = 0.2, from(0.005, 0.5);
        /// Boxes that no part of hand and arm may enter, each with the keys below.
        keep_out: Vec<KeepOut> = [];
    }

    /// A box that no part of hand and arm may enter.
    pub struct KeepOut {
        /// The obstacle's name, for messages.
        name: String;
        /// Its least corner, base frame.
        min_m: [f64; 3], PLACE;
        /// Its largest.
        max_m: [f64; 3], PLACE;
    }

    /// How a pick and place is executed; heights are above the pick or place point.
    #[derive(Copy)]
    pub struct MotionSettings {
        /// Height over the pick point at which the hand arrives (the paper's 5 mm); above `grasp_m` by more than
        /// `tolerance.position_m`, or a motion down that never happened would count as done.
        pre_pick_m: f64 = 0.005, HEIGHT;
        /// Height over the pick point at which the fingers close.
        grasp_m: f64 = 0.0, HEIGHT;
        /// Height to which the cloth is lifted (the paper's 5 mm); above `grasp_m` by more than `tolerance.position_m`.
        lift_m: f64 = 0.005, HEIGHT;
        /// Height over the place point at which the fingers open.
        release_m: f64 = 0.0, HEIGHT;
        /// Height to which the hand rises after that; above `release_m` by more than `tolerance.position_m`.
        retreat_m: f64 = 0.05, HEIGHT;
        /// Height over the table at which the empty hand travels; no less than the other heights.
        travel_m: f64 = 0.10, HEIGHT;
        /// Speed of the tool, at most `workspace.max_speed_m_s`; where a joint would exceed its own speed, the tool is
        /// slower. A tool slower than 5 mm/s looks like one at rest. The vendor's node uses its own speed: with
        /// `kinova` this only limits how long a motion may take.
        speed_m_s: f64 = 0.10, from(0.005, 0.5);
        /// The largest acceleration of a joint. The vendor of the Jaco states none; where none is stated, planners
        /// commonly take 1 rad/s². The vendor's node uses its own.
        acceleration_deg_s2: f64 = 60.0, from(10.0, 1000.0);
        /// The largest jerk of a joint: with the default, full acceleration builds up in a tenth of a second, so that
        /// arm and cloth do not swing.
        jerk_deg_s3: f64 = 600.0, from(100.0, 100_000.0);
        /// Rotation of the hand about the vertical, base frame.
        hand_turn_deg: f64 = 0.0, ANGLE;
    }

    /// The meaning of finger positions; the vendor's documents disagree about the units, so they are measured.
    #[derive(Copy)]
    pub struct FingerSettings {
        /// How many fingers the hand has.
        count: usize, from(2.0, 3.0);
        /// Their position when they are open; the vendor's documents disagree about the units, so it is measured.
        open: f64, from(-1e5, 1e5);
        /// Their position when they are closed with nothing between them.
        closed: f64, from(-1e5, 1e5);
        /// The least distance from `closed` at which they stop with cloth between them; more than `tolerance`, less
        /// than half of the way from open to closed. Without it nothing is concluded from where they stop.
        cloth: Option<f64>, from(1e-6, 1e5);
        /// How close to a position counts as there; at most a tenth of the way from open to closed, or fingers that did
        /// not move would count as moved.
        tolerance: f64, from(1e-6, 1e5);
    }

    /// When a goal counts as reached, and its time limits.
    #[derive(Copy)]
    pub struct Tolerance {
        /// How far from its target the tool may come to rest; 10 mm is what the arm's own node accepts. Less than the
        /// differences between `motion`'s heights, or a miss would count as done.
        position_m: f64 = 0.003, from(1e-4, 0.01);
        /// How far the hand may be rotated from its target; the arm's own node accepts 2.
        angle_deg: f64 = 3.0, from(0.1, 10.0);
        /// The largest age of a reading. Readings come ten times a second; at 0.5 m/s an arm that reports nothing moves
        /// a metre in 2 s.
        stale_s: f64 = 1.0, from(0.2, 2.0);
        /// How long the watchdog waits for a heartbeat, which comes every quarter of a second, before it stops the arm.
        watchdog_s: f64 = 1.0, from(0.5, 5.0);
    }

    /// The source of pictures.
    pub struct CameraSettings {
        /// `ros`, `ros2`: topics. `directory`: a folder into which another program writes pictures. `simulated`: with
        /// the driver `simulated` alone.
        source: CameraSource;
        /// For `directory`: the folder, relative to the settings.
        folder: Option<PathBuf>;
        /// The square that tasks see: its left, top and side in the camera's own picture.
        window_px: [u32; 3], from(0.0, MAX_SIDE_PX);
        /// A picture of the flat cloth, whole and alone on the table, relative to the settings; coverage is measured
        /// against it.
        flat: Option<PathBuf>;
        /// How long a picture is waited for, with the arm at rest.
        timeout_s: f64 = 5.0, from(0.1, 60.0);
        /// The camera's projection, if it does not report it itself, with the keys below, as in
        /// `sensor_msgs/CameraInfo`.
        intrinsics: Option<Intrinsics>;
    }

    /// The connection to the arm's node and the camera over ROS 1.
    pub struct RosSettings {
        /// The master's address, e.g. `http://localhost:11311`.
        master: String;
        /// This machine's name for the other nodes, as `ROS_IP` or `ROS_HOSTNAME`; without it they are read.
        host: Option<String>;
        /// The namespace of the vendor's node, e.g. `/j2n6s200_driver`.
        arm: String;
        /// For `trajectory`: the controller's action.
        trajectory: Option<String>;
        /// For `trajectory`: the joints' names, from the base to the hand; without them those of the arm's URDF.
        joints: Vec<String> = [];
        /// For the camera `ros`: the topic of the colour picture.
        color: Option<String>;
        /// The topic of the depth picture, aligned with it, in whole millimetres, 0 for no reading.
        depth: Option<String>;
        /// The topic of the camera's `CameraInfo`.
        info: Option<String>;
    }

    /// The connection to an arm's controllers and the camera over ROS 2.
    pub struct Ros2Settings {
        /// The DDS domain of the other nodes, their `ROS_DOMAIN_ID`; a higher one has no port.
        domain: u16 = 0, from(0.0, 232.0);
        /// The middleware of the other nodes, their `RMW_IMPLEMENTATION`: each has its own way to ask services.
        /// `fastrtps` is the default of Humble, Jazzy and Kilted.
        rmw: Rmw = "fastrtps";
        /// The IPv4 address of this machine's one network interface to use, e.g. `127.0.0.1` for nodes on this machine;
        /// without it all.
        interface: Option<String>;
        /// The topic of the joints' states.
        joint_states: String = "/joint_states";
        /// The joints' names in states and trajectories, from the base to the hand; without them those of the arm's
        /// URDF.
        joints: Vec<String> = [];
        /// The controller's action, e.g. `/joint_trajectory_controller/follow_joint_trajectory`; needed for the driver
        /// `ros2`.
        trajectory: Option<String>;
        /// The gripper's action, e.g. `/gripper_controller/gripper_cmd`; needed for the driver `ros2`.
        gripper: Option<String>;
        /// Its type of `control_msgs`.
        gripper_action: GripperAction = "gripper_command";
        /// The joints whose positions tell where the fingers are: one for each finger, or one that all follow; needed
        /// for the driver `ros2`. With `parallel_gripper_command` these are moved.
        gripper_joints: Vec<String> = [];
        /// The largest effort of a gripper's goal; 0 leaves it to the controller.
        gripper_effort: f64 = 0.0, from(0.0, 1e4);
        /// A service of the type `std_srvs/Trigger` that stops the arm, called before all goals are cancelled; without
        /// it they are only cancelled.
        stop: Option<String>;
        /// For the camera `ros2`: the topic of the colour picture.
        color: Option<String>;
        /// The topic of the depth picture, aligned with it, in whole millimetres (`16UC1`) or in metres (`32FC1`).
        depth: Option<String>;
        /// The topic of the camera's `CameraInfo`.
        info: Option<String>;
    }

    /// The simulated arm and table of the driver `simulated`, which needs no real hardware.
    pub struct SimulatedSettings {
        /// Height of the simulated camera above the table.
        camera_height_m: f64 = 1.0, from(0.1, 3.0);
        /// Its offset from the table's middle, along the table's x and y.
        camera_offset_m: [f64; 2] = [0.0, 0.0], from(-3.0, 3.0);
        /// Its rotation about the vertical.
        camera_turn_deg: f64 = 0.0, ANGLE;
        /// The side of its square picture.
        camera_px: u32 = 720, from(16.0, 4096.0);
    }
}

fab_base::named! {
    /// A driver of the arm.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    pub enum DriverKind {
        /// The node of kinova-ros, with Cartesian goals.
        Kinova = "kinova",
        /// A `FollowJointTrajectory` controller, with joint trajectories from this crate's inverse kinematics.
        Trajectory = "trajectory",
        /// A `FollowJointTrajectory` controller and a gripper's action of ROS 2, with joint trajectories likewise.
        Ros2 = "ros2",
        /// An arm that this program simulates, over a simulated cloth.
        Simulated = "simulated",
    }
}

fab_base::named! {
    /// A kind of camera.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    pub enum CameraSource {
        /// Topics with `sensor_msgs` messages.
        Ros = "ros",
        /// The same over ROS 2.
        Ros2 = "ros2",
        /// Pictures that another program writes into a folder, `NAME.png` with `NAME.depth.png`: each time a new one.
        Directory = "directory",
        /// The simulator's camera; with the driver `simulated` only.
        Simulated = "simulated",
    }
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

fab_base::named! {
    /// The type of a gripper's action.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
    pub enum GripperAction {
        /// `control_msgs/GripperCommand`.
        GripperCommand = "gripper_command",
        /// `control_msgs/ParallelGripperCommand`.
        ParallelGripperCommand = "parallel_gripper_command",
    }
}

named_settings!(DriverKind, CameraSource, Rmw, GripperAction);

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
        let focal_px = half_px / (CAMERA_FOV_RAD / 2.0).tan();
        Intrinsics {
            size_px: [self.camera_px; 2],
            focal_px: [focal_px; 2],
            middle_px: [half_px; 2],
            distortion: Vec::new(),
        }
    }
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

    /// Reads settings from text.
    ///
    /// - `folder`: the folder of the files that the text names.
    fn parse_in(folder: &Path, text: &str) -> Result<Settings, String> {
        let mut settings: Settings = declare::read(text)?;
        let document = toml::from_str(text).map_err(|error| error.to_string())?;
        settings.chain = check::check(&settings, &document, folder)?;
        settings.model = settings.chain.model().to_owned();
        let named = [
            settings.ros.as_mut().map(|ros| &mut ros.joints),
            settings.ros2.as_mut().map(|ros2| &mut ros2.joints),
        ];
        for joints in named.into_iter().flatten().filter(|it| it.is_empty()) {
            *joints = settings.chain.names().to_vec();
        }
        Ok(settings)
    }

    /// Returns the arm's joints and shapes.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }
}

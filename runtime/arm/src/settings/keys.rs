//! Every key of a settings file: its unit, the values accepted, its default, and why. One table.
//!
//! In: the text of a settings file. Out: a document in which every key is known and every value accepted, with the
//! defaults filled in; else all faults. A test prints `docs/arm-settings.md` from the same rows. What one key requires
//! of another is left to `check`.

use fab_program::nearest::nearest;
use std::fmt::Write as _;
use toml::{Table, Value};

/// A key of a settings file.
pub(super) struct Key {
    /// Its sections and its name, e.g. `workspace.max_step_m`.
    pub name: &'static str,
    /// The values accepted.
    pub accepts: Accepts,
    /// What applies if it is absent.
    pub absent: Absent,
    /// What it is, and why these values.
    pub why: &'static str,
}

/// The values that a key accepts.
pub(super) enum Accepts {
    /// A text that begins like this, and is not blank.
    Text(&'static str),
    /// Texts, none blank.
    Texts,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A number.
    Number(Range),
    /// So many numbers.
    Numbers(usize, Range),
    /// Any count of numbers.
    AnyNumbers(Range),
    /// A whole number.
    Whole(i64, i64),
    /// So many whole numbers.
    Wholes(usize, i64, i64),
    /// A section that may be left out.
    Section,
    /// A list of sections.
    Sections,
}

/// A range of numbers; the largest is included.
#[derive(Clone, Copy)]
pub(super) struct Range {
    least: f64,
    most: f64,
    /// Whether the least is included.
    is_closed: bool,
}

/// What applies if a key is absent.
pub(super) enum Absent {
    /// The file is refused.
    Refused,
    /// Nothing.
    Nothing,
    /// This value, as TOML.
    Is(&'static str),
}

use Absent::{Is, Nothing, Refused};
use Accepts::{AnyNumbers, Number, Numbers, OneOf, Section, Sections, Text, Texts, Whole, Wholes};

const fn from(least: f64, most: f64) -> Range {
    Range {
        least,
        most,
        is_closed: true,
    }
}

const fn above(least: f64, most: f64) -> Range {
    Range {
        least,
        most,
        is_closed: false,
    }
}

const fn key(name: &'static str, accepts: Accepts, absent: Absent, why: &'static str) -> Key {
    Key {
        name,
        accepts,
        absent,
        why,
    }
}

/// A place in the base frame: the largest arm of this kind reaches less than 2 m, and the table is within its reach.
const PLACE: Accepts = Numbers(3, from(-3.0, 3.0));
const ANGLE: Range = from(-360.0, 360.0);
/// Heights above a point of the table.
const HEIGHT: Accepts = Number(from(0.0, 0.5));
/// The most faults that one message lists.
const MAX_FAULTS: usize = 20;
const MAX_SIDE_PX: i64 = 16_384;

/// How the name of a key ends, and the unit of its numbers; the first one that fits.
const UNITS: &[(&str, &str)] = &[
    ("_deg_s3", "deg/s³"),
    ("_deg_s2", "deg/s²"),
    ("_deg_s", "deg/s"),
    ("_m_s", "m/s"),
    ("_deg", "deg"),
    ("_px", "px"),
    ("_s", "s"),
    ("_m", "m"),
    ("fingers.open", "the node's"),
    ("fingers.closed", "the node's"),
    ("fingers.cloth", "the node's"),
    ("fingers.tolerance", "the node's"),
    ("ros2.gripper_effort", "the gripper's"),
];

/// The keys, section by section.
pub(super) const KEYS: &[Key] = &[
    key("name", Text(""), Refused, "a name for reports"),
    key(
        "model",
        Text(""),
        Nothing,
        "the arm's model, if it is a built-in one: `j2n6s200`, `j2n6s300` or `j2s6s200`. Another arm has a section `[arm]`",
    ),
    key(
        "driver",
        OneOf(&["kinova", "trajectory", "ros2", "simulated"]),
        Refused,
        "`kinova`: the vendor's node, tool poses. `trajectory`: a `FollowJointTrajectory` \
         controller beside the vendor's node. `ros2`: such a controller of ROS 2, and a gripper. `simulated`: an arm that `fabc` simulates",
    ),
    key(
        "calibration",
        Text(""),
        Refused,
        "the file that `fabc calibrate` writes, relative to the settings",
    ),
    key(
        "arm",
        Section,
        Nothing,
        "an arm with six or seven joints that a URDF file describes, with the keys below; in place of `model`",
    ),
    key(
        "arm.urdf",
        Text(""),
        Refused,
        "the URDF file, relative to the settings, with xacro expanded. Meshes are `.stl` or `.obj`; a package is a \
         folder of its name above the file",
    ),
    key(
        "arm.base_link",
        Text(""),
        Refused,
        "the link whose frame is the base frame; its z points up",
    ),
    key(
        "arm.tip_link",
        Text(""),
        Refused,
        "the link that carries the hand; between the two turn six or seven joints, and no other moves",
    ),
    key(
        "arm.tool_xyz_m",
        Numbers(3, from(-1.0, 1.0)),
        Is("[0.0, 0.0, 0.0]"),
        "the tool's place in the frame of `tip_link`: between the fingertips",
    ),
    key(
        "arm.tool_rpy_deg",
        Numbers(3, ANGLE),
        Is("[0.0, 0.0, 0.0]"),
        "its rotation there about fixed x, y, z; the tool's z points out of the hand",
    ),
    key(
        "arm.home_deg",
        AnyNumbers(from(-720.0, 720.0)),
        Refused,
        "the joints' angles in a posture over the table with the hand down; of several postures the one nearest to it is \
         taken",
    ),
    key(
        "arm.joint",
        Sections,
        Is("[]"),
        "limits of joints that the URDF lacks, or tighter ones; looser ones are refused",
    ),
    key(
        "arm.joint.name",
        Text(""),
        Refused,
        "the joint's name in the URDF",
    ),
    key(
        "arm.joint.min_deg",
        Number(from(-720.0, 720.0)),
        Nothing,
        "the least angle",
    ),
    key(
        "arm.joint.max_deg",
        Number(from(-720.0, 720.0)),
        Nothing,
        "the largest",
    ),
    key(
        "arm.joint.max_speed_deg_s",
        Number(above(0.0, 720.0)),
        Nothing,
        "the highest speed",
    ),
    key(
        "arm.shape",
        Sections,
        Is("[]"),
        "capsules that contain a link, in place of its collision shapes in the URDF; a link without any shape is refused, \
         because nothing would keep it off the table",
    ),
    key(
        "arm.shape.link",
        Text(""),
        Refused,
        "the link's name in the URDF",
    ),
    key(
        "arm.shape.from_m",
        Numbers(3, from(-2.0, 2.0)),
        Refused,
        "one end of the capsule's line, in the link's frame",
    ),
    key(
        "arm.shape.to_m",
        Numbers(3, from(-2.0, 2.0)),
        Refused,
        "the other",
    ),
    key(
        "arm.shape.radius_m",
        Number(from(0.005, 0.5)),
        Refused,
        "its radius",
    ),
    key(
        "arm.hand",
        Sections,
        Is("[]"),
        "capsules that contain hand and fingers in every opening, in place of the shapes that the URDF has behind the \
         last joint; needed if it has none there, or if fingers turn",
    ),
    key(
        "arm.hand.from_m",
        Numbers(3, from(-1.0, 1.0)),
        Refused,
        "one end of the capsule's line, in the tool frame",
    ),
    key(
        "arm.hand.to_m",
        Numbers(3, from(-1.0, 1.0)),
        Refused,
        "the other",
    ),
    key(
        "arm.hand.radius_m",
        Number(from(0.005, 0.5)),
        Refused,
        "its radius",
    ),
    key(
        "table.center_m",
        PLACE,
        Refused,
        "the tool's position when the closed fingertips touch the table's middle, base frame; \
         inside of the workspace's x and y",
    ),
    key(
        "table.turn_deg",
        Number(ANGLE),
        Is("0.0"),
        "rotation of the table's axes about the vertical, against the base",
    ),
    key(
        "workspace.min_m",
        PLACE,
        Refused,
        "the least x, y and z of the tool, base frame. z is that at the table's middle, the \
         floor follows a tilted table, and it lies `tolerance.position_m` to 10 mm below \
         `table.center_m`: a deeper one would let the hand go below the table, a higher one \
         keep it from touching",
    ),
    key(
        "workspace.max_m",
        PLACE,
        Refused,
        "the largest; z leaves room for `motion.travel_m`",
    ),
    key(
        "workspace.rest_m",
        PLACE,
        Refused,
        "where the hand waits while pictures are taken, out of the camera's view, base frame; \
         inside of the workspace and outside of every keep-out zone by \
         `tolerance.position_m`, and at least `motion.retreat_m` above the table, so that it \
         does not drag the cloth",
    ),
    key(
        "workspace.max_speed_m_s",
        Number(above(0.0, 0.5)),
        Is("0.2"),
        "the highest speed of the tool; the arm is stopped at 1.5 times of it. In a quarter of a \
         second a tool at 0.5 m/s moves 125 mm",
    ),
    key(
        "workspace.max_step_m",
        Number(above(0.0, 2.0)),
        Is("0.9"),
        "the longest motion at once; a longer one is a mistake in a place",
    ),
    key(
        "workspace.keep_out",
        Sections,
        Is("[]"),
        "boxes that no part of hand and arm may enter, each with the keys below; one that \
         does not reach into the workspace is refused, because it would keep the tool from \
         nothing",
    ),
    key(
        "workspace.keep_out.name",
        Text(""),
        Refused,
        "the obstacle's name, for messages",
    ),
    key(
        "workspace.keep_out.min_m",
        PLACE,
        Refused,
        "its least corner, base frame",
    ),
    key("workspace.keep_out.max_m", PLACE, Refused, "its largest"),
    key(
        "motion.pre_pick_m",
        HEIGHT,
        Is("0.005"),
        "height over the pick point at which the hand arrives (the paper's 5 mm); above \
         `grasp_m` by more than `tolerance.position_m`, or a motion down that never happened \
         would count as done",
    ),
    key(
        "motion.grasp_m",
        HEIGHT,
        Is("0.0"),
        "height over the pick point at which the fingers close",
    ),
    key(
        "motion.lift_m",
        HEIGHT,
        Is("0.005"),
        "height to which the cloth is lifted (the paper's 5 mm); above `grasp_m` by more than \
         `tolerance.position_m`, and not below `release_m`",
    ),
    key(
        "motion.release_m",
        HEIGHT,
        Is("0.0"),
        "height over the place point at which the fingers open",
    ),
    key(
        "motion.retreat_m",
        HEIGHT,
        Is("0.05"),
        "height to which the hand rises after that; above `release_m` by more than \
         `tolerance.position_m`",
    ),
    key(
        "motion.travel_m",
        HEIGHT,
        Is("0.10"),
        "height over the table at which the empty hand travels; no less than the other \
         heights",
    ),
    key(
        "motion.speed_m_s",
        Number(from(0.005, 0.5)),
        Is("0.10"),
        "speed of the tool, at most `workspace.max_speed_m_s`; where a joint would exceed its own \
         speed, the tool is slower. A tool slower than 5 mm/s looks like one at rest. The vendor's \
         node uses its own speed: with `kinova` this only limits how long a motion may take",
    ),
    key(
        "motion.acceleration_deg_s2",
        Number(from(10.0, 1000.0)),
        Is("60.0"),
        "the largest acceleration of a joint. The vendor of the Jaco states none; where none is \
         stated, planners commonly take 1 rad/s². The vendor's node uses its own",
    ),
    key(
        "motion.jerk_deg_s3",
        Number(from(100.0, 100_000.0)),
        Is("600.0"),
        "the largest jerk of a joint: with the default, full acceleration builds up in a tenth of \
         a second, so that arm and cloth do not swing",
    ),
    key(
        "motion.hand_turn_deg",
        Number(ANGLE),
        Is("0.0"),
        "rotation of the hand about the vertical, base frame",
    ),
    key(
        "fingers.count",
        Whole(2, 3),
        Refused,
        "how many fingers the hand has",
    ),
    key(
        "fingers.open",
        Number(from(-1e5, 1e5)),
        Refused,
        "their position when they are open; the vendor's documents disagree about the units, \
         so it is measured",
    ),
    key(
        "fingers.closed",
        Number(from(-1e5, 1e5)),
        Refused,
        "their position when they are closed with nothing between them",
    ),
    key(
        "fingers.cloth",
        Number(above(0.0, 1e5)),
        Nothing,
        "the least distance from `closed` at which they stop with cloth between them; more \
         than `tolerance`, less than half of the way from open to closed. Without it nothing \
         is concluded from where they stop",
    ),
    key(
        "fingers.tolerance",
        Number(above(0.0, 1e5)),
        Refused,
        "how close to a position counts as there; at most a tenth of the way from open to \
         closed, or fingers that did not move would count as moved",
    ),
    key(
        "tolerance.position_m",
        Number(above(0.0, 0.01)),
        Is("0.003"),
        "how far from its target the tool may come to rest; 10 mm is what the arm's own node \
         accepts. Less than the differences between `motion`'s heights, or a miss would count \
         as done",
    ),
    key(
        "tolerance.angle_deg",
        Number(above(0.0, 10.0)),
        Is("3.0"),
        "how far the hand may be rotated from its target; the arm's own node accepts 2",
    ),
    key(
        "tolerance.corrections",
        Whole(0, 10),
        Is("2"),
        "how often a target is sent again when the node says that it was reached and it was \
         not",
    ),
    key(
        "tolerance.settle_s",
        Number(above(0.0, 30.0)),
        Is("5.0"),
        "how long a motion may take beyond its time; an arm that stalls is noticed only after \
         that",
    ),
    key(
        "tolerance.stale_s",
        Number(from(0.2, 2.0)),
        Is("1.0"),
        "the largest age of a reading. Readings come ten times a second; at 0.5 m/s an arm \
         that reports nothing moves a metre in 2 s",
    ),
    key(
        "tolerance.watchdog_s",
        Number(from(0.5, 5.0)),
        Is("1.0"),
        "how long the watchdog waits for a heartbeat, which comes every quarter of a second, \
         before it stops the arm",
    ),
    key(
        "camera.source",
        OneOf(&["ros", "ros2", "directory", "simulated"]),
        Refused,
        "`ros`, `ros2`: topics. `directory`: a folder into which another program writes pictures. \
         `simulated`: with the driver `simulated` alone",
    ),
    key(
        "camera.folder",
        Text(""),
        Nothing,
        "for `directory`: the folder, relative to the settings",
    ),
    key(
        "camera.window_px",
        Wholes(3, 0, MAX_SIDE_PX),
        Refused,
        "the square that tasks see: its left, top and side in the camera's own picture",
    ),
    key(
        "camera.intrinsics",
        Section,
        Nothing,
        "the camera's projection, if it does not report it itself, with the keys below, as in \
         `sensor_msgs/CameraInfo`",
    ),
    key(
        "camera.intrinsics.size_px",
        Wholes(2, 1, MAX_SIDE_PX),
        Refused,
        "width and height of its picture; the window lies inside",
    ),
    key(
        "camera.intrinsics.focal_px",
        Numbers(2, above(0.0, 1e6)),
        Refused,
        "focal lengths along columns and rows",
    ),
    key(
        "camera.intrinsics.middle_px",
        Numbers(2, from(0.0, MAX_SIDE_PX as f64)),
        Refused,
        "where the optical axis meets the picture; the middle of the pixel in column 3 is at \
         3.5",
    ),
    key(
        "camera.intrinsics.distortion",
        AnyNumbers(from(-1e6, 1e6)),
        Is("[]"),
        "coefficients of the model `plumb_bob`: k1, k2, t1, t2, k3",
    ),
    key(
        "camera.flat",
        Text(""),
        Nothing,
        "a picture of the flat cloth, whole and alone on the table, relative to the settings; \
         coverage is measured against it",
    ),
    key(
        "camera.timeout_s",
        Number(above(0.0, 60.0)),
        Is("5.0"),
        "how long a picture is waited for, with the arm at rest",
    ),
    key(
        "ros",
        Section,
        Nothing,
        "the connection over ROS 1, with the keys below; needed for the drivers `kinova` and \
         `trajectory`, and for the camera `ros`",
    ),
    key(
        "ros.master",
        Text("http://"),
        Refused,
        "the master's address, e.g. `http://localhost:11311`",
    ),
    key(
        "ros.host",
        Text(""),
        Nothing,
        "this machine's name for the other nodes, as `ROS_IP` or `ROS_HOSTNAME`; without it \
         they are read",
    ),
    key(
        "ros.arm",
        Text("/"),
        Refused,
        "the namespace of the vendor's node, e.g. `/j2n6s200_driver`",
    ),
    key(
        "ros.trajectory",
        Text("/"),
        Nothing,
        "for `trajectory`: the controller's action",
    ),
    key(
        "ros.joints",
        Texts,
        Is("[]"),
        "for `trajectory`: the joints' names, from the base to the hand; without them the \
         vendor's",
    ),
    key(
        "ros.color",
        Text("/"),
        Nothing,
        "for the camera `ros`: the topic of the colour picture",
    ),
    key(
        "ros.depth",
        Text("/"),
        Nothing,
        "the topic of the depth picture, aligned with it, in whole millimetres, 0 for no \
         reading",
    ),
    key(
        "ros.info",
        Text("/"),
        Nothing,
        "the topic of the camera's `CameraInfo`",
    ),
    key(
        "ros2",
        Section,
        Nothing,
        "the connection over ROS 2, with the keys below; needed for the driver and the camera \
         `ros2`",
    ),
    key(
        "ros2.domain",
        Whole(0, 232),
        Is("0"),
        "the DDS domain of the other nodes, their `ROS_DOMAIN_ID`; a higher one has no port",
    ),
    key(
        "ros2.rmw",
        OneOf(&["fastrtps", "cyclonedds"]),
        Is("\"fastrtps\""),
        "the middleware of the other nodes, their `RMW_IMPLEMENTATION`: each has its own way to \
         ask services. `fastrtps` is the default of Humble, Jazzy and Kilted",
    ),
    key(
        "ros2.interface",
        Text(""),
        Nothing,
        "the IPv4 address of this machine's one network interface to use, e.g. `127.0.0.1` for \
         nodes on this machine; without it all",
    ),
    key(
        "ros2.joint_states",
        Text("/"),
        Is("\"/joint_states\""),
        "the topic of the joints' states",
    ),
    key(
        "ros2.joints",
        Texts,
        Is("[]"),
        "the joints' names in states and trajectories, from the base to the hand; needed for \
         the driver `ros2`, except with `[arm]`, whose URDF names them",
    ),
    key(
        "ros2.trajectory",
        Text("/"),
        Nothing,
        "the controller's action, e.g. `/joint_trajectory_controller/follow_joint_trajectory`; \
         needed for the driver `ros2`",
    ),
    key(
        "ros2.gripper",
        Text("/"),
        Nothing,
        "the gripper's action, e.g. `/gripper_controller/gripper_cmd`; needed for the driver \
         `ros2`",
    ),
    key(
        "ros2.gripper_action",
        OneOf(&["gripper_command", "parallel_gripper_command"]),
        Is("\"gripper_command\""),
        "its type of `control_msgs`",
    ),
    key(
        "ros2.gripper_joints",
        Texts,
        Is("[]"),
        "the joints whose positions tell where the fingers are: one for each finger, or one \
         that all follow; needed for the driver `ros2`. With `parallel_gripper_command` these \
         are moved",
    ),
    key(
        "ros2.gripper_effort",
        Number(from(0.0, 1e4)),
        Is("0.0"),
        "the largest effort of a gripper's goal; 0 leaves it to the controller",
    ),
    key(
        "ros2.stop",
        Text("/"),
        Nothing,
        "a service of the type `std_srvs/Trigger` that stops the arm, called before all goals \
         are cancelled; without it they are only cancelled",
    ),
    key(
        "ros2.color",
        Text("/"),
        Nothing,
        "for the camera `ros2`: the topic of the colour picture",
    ),
    key(
        "ros2.depth",
        Text("/"),
        Nothing,
        "the topic of the depth picture, aligned with it, in whole millimetres (`16UC1`) or in \
         metres (`32FC1`)",
    ),
    key(
        "ros2.info",
        Text("/"),
        Nothing,
        "the topic of the camera's `CameraInfo`",
    ),
    key(
        "simulated.camera_height_m",
        Number(from(0.1, 3.0)),
        Is("1.0"),
        "height of the simulated camera above the table",
    ),
    key(
        "simulated.camera_offset_m",
        Numbers(2, from(-3.0, 3.0)),
        Is("[0.0, 0.0]"),
        "its offset from the table's middle, along the table's x and y",
    ),
    key(
        "simulated.camera_turn_deg",
        Number(ANGLE),
        Is("0.0"),
        "its rotation about the vertical",
    ),
    key(
        "simulated.camera_fov_deg",
        Number(from(1.0, 170.0)),
        Is("45.0"),
        "its field of view across the shorter side",
    ),
    key(
        "simulated.camera_px",
        Whole(16, 4096),
        Is("720"),
        "the side of its square picture",
    ),
    key(
        "simulated.repeatability_m",
        Number(from(0.0, 0.1)),
        Is("0.001"),
        "how far from its target the simulated tool comes to rest at most",
    ),
    key(
        "simulated.seed",
        Whole(0, i64::MAX),
        Is("0"),
        "seeds everything random about the simulated arm",
    ),
];

/// Reads a settings file's keys by the table; fails with all faults, one per line.
pub(super) fn read(text: &str) -> Result<Table, String> {
    let mut document: Table = toml::from_str(text).map_err(|error| error.to_string())?;
    let mut faults = Vec::new();
    section(&mut document, "", "", &mut faults);
    match faults.len() {
        0 => Ok(document),
        1..=MAX_FAULTS => Err(faults.join("\n")),
        all => Err(format!(
            "{}\nand {} faults more",
            faults[..MAX_FAULTS].join("\n"),
            all - MAX_FAULTS
        )),
    }
}

/// Checks the keys of a section, and fills in defaults.
///
/// - `prefix`: its name with a dot, or nothing; `shown`: the same, as messages show it.
fn section(table: &mut Table, prefix: &str, shown: &str, faults: &mut Vec<String>) {
    let names = names_in(prefix);
    for unknown in table.keys().filter(|name| !names.contains(&name.as_str())) {
        faults.push(unknown_key(unknown, prefix, shown));
    }
    for name in names {
        let path = format!("{prefix}{name}");
        let full = format!("{shown}{name}");
        let below = |faults: &mut Vec<String>, table: &mut Table| {
            section(table, &format!("{path}."), &format!("{full}."), faults);
        };
        let row = KEYS.iter().find(|key| key.name == path);
        let Some(row) = row else {
            // A section without a row of its own: its keys say whether it may be absent.
            let inner = table.entry(name).or_insert(Value::Table(Table::new()));
            match inner {
                Value::Table(inner) => below(faults, inner),
                other => faults.push(format!(
                    "`{full}` is `{other}`; expected a section `[{full}]`"
                )),
            }
            continue;
        };
        match (table.get_mut(name), &row.absent) {
            (None, Refused) => faults.push(format!("`{full}` is missing: {}", row.why)),
            (None, Nothing) => {}
            (None, Is(default)) => {
                table.insert(name.to_owned(), value_of(default));
            }
            (Some(Value::Table(inner)), _) if matches!(row.accepts, Section) => {
                below(faults, inner);
            }
            (Some(Value::Array(all)), _) if matches!(row.accepts, Sections) => {
                for (index, one) in all.iter_mut().enumerate() {
                    let shown = format!("{full}[{index}].");
                    match one {
                        Value::Table(inner) => section(inner, &format!("{path}."), &shown, faults),
                        other => faults.push(format!(
                            "`{full}[{index}]` is `{other}`; expected a section"
                        )),
                    }
                }
            }
            (Some(value), _) => {
                if !row.accepts.takes(value) {
                    let expected = row.expected();
                    faults.push(format!(
                        "`{full}` is `{value}`; expected {expected}: {}",
                        row.why
                    ));
                }
            }
        }
    }
}

fn value_of(default: &str) -> Value {
    let mut table: Table =
        toml::from_str(&format!("it = {default}")).expect("a test reads every default");
    table.remove("it").expect("it stands there")
}

/// Returns the names that may stand in a section, in the order of the table.
fn names_in(prefix: &str) -> Vec<&'static str> {
    let mut names = Vec::new();
    for key in KEYS {
        if let Some(rest) = key.name.strip_prefix(prefix) {
            let name = rest.split('.').next().unwrap_or(rest);
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Words the fault of an unknown key, with the name that was probably meant.
fn unknown_key(found: &str, prefix: &str, shown: &str) -> String {
    let here = names_in(prefix);
    let elsewhere = KEYS
        .iter()
        .find(|key| key.name.rsplit('.').next() == Some(found))
        .map(|key| key.name.to_owned());
    let near = nearest(found, here.iter().copied()).map(|name| format!("{shown}{name}"));
    let mut text = format!("`{shown}{found}` is not a setting");
    match elsewhere.or(near) {
        Some(meant) => _ = write!(text, "; did you mean `{meant}`?"),
        None => _ = write!(text, "; here may stand {}", fab_base::wording::quoted(here)),
    }
    text
}

impl Range {
    fn holds(self, value: &Value) -> bool {
        let number = match value {
            Value::Float(number) => *number,
            Value::Integer(number) => *number as f64,
            _ => return false,
        };
        // NaN must be refused.
        (self.least < number || self.is_closed && self.least == number) && number <= self.most
    }

    fn text(self) -> String {
        match self.is_closed {
            true => format!("{} to {}", self.least, self.most),
            false => format!("above {} and at most {}", self.least, self.most),
        }
    }
}

impl Accepts {
    fn takes(&self, value: &Value) -> bool {
        let is_text = |value: &Value, begins: &str| {
            value
                .as_str()
                .is_some_and(|text| text.starts_with(begins) && !text.trim().is_empty())
        };
        let is_whole = |value: &Value, least: i64, most: i64| {
            value
                .as_integer()
                .is_some_and(|number| (least..=most).contains(&number))
        };
        let are = |count: Option<usize>, holds: &dyn Fn(&Value) -> bool| {
            value.as_array().is_some_and(|all| {
                count.is_none_or(|count| all.len() == count) && all.iter().all(holds)
            })
        };
        match self {
            Text(begins) => is_text(value, begins),
            Texts => are(None, &|one| is_text(one, "")),
            OneOf(words) => value.as_str().is_some_and(|word| words.contains(&word)),
            Number(range) => range.holds(value),
            Numbers(count, range) => are(Some(*count), &|one| range.holds(one)),
            AnyNumbers(range) => are(None, &|one| range.holds(one)),
            Whole(least, most) => is_whole(value, *least, *most),
            Wholes(count, least, most) => are(Some(*count), &|one| is_whole(one, *least, *most)),
            Section | Sections => false,
        }
    }
}

impl Key {
    /// Returns the unit of its numbers; empty for none.
    fn unit(&self) -> &'static str {
        let mut units = UNITS.iter();
        let unit = units.find(|(end, _)| self.name.ends_with(end));
        unit.map_or("", |(_, unit)| unit)
    }

    /// Words the values that it accepts.
    fn expected(&self) -> String {
        let unit = match self.unit() {
            "" => String::new(),
            unit if unit.starts_with("the ") => format!(" in {unit} units"),
            unit => format!(" {unit}"),
        };
        let whole = |least: i64, most: i64| match most {
            i64::MAX => format!("{least} or more"),
            most => format!("{least} to {most}"),
        };
        match &self.accepts {
            Text("") => "a text".to_owned(),
            Text(begins) => format!("a text that begins with `{begins}`"),
            Texts => "a list of texts".to_owned(),
            OneOf(words) => {
                let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
                words.join(", ")
            }
            Number(range) => format!("{}{unit}", range.text()),
            Numbers(count, range) => format!("{count} numbers, {}{unit}", range.text()),
            AnyNumbers(range) => format!("a list of numbers, {}{unit}", range.text()),
            Whole(least, most) => format!("a whole number, {}{unit}", whole(*least, *most)),
            Wholes(count, least, most) => {
                format!("{count} whole numbers, {}{unit}", whole(*least, *most))
            }
            Section => "a section".to_owned(),
            Sections => "a list of sections".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests;

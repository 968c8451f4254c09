//! A node over Cyclone DDS for each test, in a DDS domain of its own, ended with it.

use fab_arm::driver::{Commands, PortArm};
use fab_arm::kinematics::chain::Chain;
use fab_arm::port::{GoalId, GoalState, Port};
use fab_arm::settings::{GripperAction, Rmw, Ros2Settings, Settings};
use fab_arm_ros2::Ros2Port;
use std::fs::File;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU16, Ordering};
use tempfile::TempDir;

/// The arm that the node plays.
pub const MODEL: &str = "j2n6s200";

/// Its controller's and its gripper's actions.
pub const TRAJECTORY: &str = "/controller/follow_joint_trajectory";
pub const GRIPPER: &str = "/gripper/gripper_cmd";

/// How long a program may take to start on a busy machine, seconds.
pub const PATIENCE_S: f64 = 30.0;

/// What the node of a test does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driver {
    /// It has a `GripperCommand`.
    Gripper,
    /// It has a `ParallelGripperCommand`.
    ParallelGripper,
    /// It refuses trajectories.
    Refuses,
    /// It accepts trajectories and does nothing.
    Ignores,
}

/// A node, ended when dropped.
pub struct Ros {
    node: Child,
    pub domain: u16,
    driver: Driver,
    folder: TempDir,
}

impl Ros {
    /// Starts a node that plays an arm, which may not be ready yet.
    pub fn with_arm(driver: Driver) -> Ros {
        Ros::with_arm_of(driver, Vec::new())
    }

    /// Does the same with arguments for the program that simulates the arm.
    pub fn with_arm_of(driver: Driver, engine_arguments: Vec<String>) -> Ros {
        let python =
            std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
        let engine =
            std::env::var("FABC_PEER_ARM_ENGINE").expect("make test-all sets FABC_PEER_ARM_ENGINE");
        let folder = tempfile::tempdir().unwrap();
        let options = match driver {
            Driver::Gripper => r#"{"gripper": "GripperCommand"}"#,
            Driver::ParallelGripper => r#"{"gripper": "ParallelGripperCommand"}"#,
            Driver::Refuses => r#"{"refuse": true}"#,
            Driver::Ignores => r#"{"ignore": true}"#,
        };
        let domain = free_domain();
        let node = Command::new(python)
            .arg(project("tests/peers/ros2_node.py"))
            .args([&domain.to_string(), options, &engine])
            .args(engine_arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(File::create(folder.path().join("complaints.log")).unwrap())
            .process_group(0)
            .spawn()
            .unwrap();
        Ros {
            node,
            domain,
            driver,
            folder,
        }
    }

    /// Ends the node, and the arm with it, like `kill -9`.
    pub fn kill_node(&mut self) {
        signal("KILL", &format!("-{}", self.node.id()));
        let _ = self.node.wait();
    }

    /// Returns settings for the driver `ros2`.
    pub fn settings(&self) -> Ros2Settings {
        let names =
            |part: &str, count: usize| (1..=count).map(|at| format!("{part}_{at}")).collect();
        Ros2Settings {
            domain: self.domain,
            rmw: Rmw::Cyclonedds,
            interface: Some("127.0.0.1".to_owned()),
            joint_states: "/joint_states".to_owned(),
            joints: names("joint", 6),
            trajectory: Some(TRAJECTORY.to_owned()),
            gripper: Some(GRIPPER.to_owned()),
            gripper_action: match self.driver {
                Driver::ParallelGripper => GripperAction::ParallelGripperCommand,
                _ => GripperAction::GripperCommand,
            },
            gripper_joints: names("finger", 2),
            gripper_effort: 5.0,
            stop: None,
            color: Some("/camera/color/image_raw".to_owned()),
            depth: Some("/camera/aligned_depth_to_color/image_raw".to_owned()),
            info: Some("/camera/color/camera_info".to_owned()),
        }
    }

    /// Connects as soon as the node is ready.
    pub fn connect(&self) -> Ros2Port {
        connect(&self.settings(), PATIENCE_S).unwrap()
    }

    /// Drives the arm as its settings say.
    pub fn arm(&self, settings: &Settings) -> PortArm<Ros2Port> {
        PortArm::new(
            Box::new(self.connect()),
            Commands::Trajectories,
            settings.fingers,
            settings.tolerance,
        )
    }

    /// Returns the settings for `fabc`, without the camera's place.
    pub fn robot(&self, driver: Driver, common: &str, camera: &str) -> String {
        let gripper = match driver {
            Driver::ParallelGripper => "parallel_gripper_command",
            _ => "gripper_command",
        };
        let domain = self.domain;
        format!(
            "driver = 'ros2'\n{common}
            [camera]\nsource = 'ros2'\n{camera}
            [ros2]\ndomain = {domain}\nrmw = 'cyclonedds'\ninterface = '127.0.0.1'
            joints = ['joint_1', 'joint_2', 'joint_3', 'joint_4', 'joint_5', 'joint_6']
            trajectory = '{TRAJECTORY}'
            gripper = '{GRIPPER}'\ngripper_action = '{gripper}'
            gripper_joints = ['finger_1', 'finger_2']
            color = '/camera/color/image_raw'
            depth = '/camera/aligned_depth_to_color/image_raw'
            info = '/camera/color/camera_info'\n"
        )
    }
}

impl Drop for Ros {
    /// Shows the node's error output if a test failed.
    fn drop(&mut self) {
        self.kill_node();
        if std::thread::panicking() {
            let log = std::fs::read_to_string(self.folder.path().join("complaints.log"));
            eprintln!("the node said:\n{}", log.unwrap_or_default());
        }
    }
}

/// Connects to a two-fingered arm.
pub fn connect(
    settings: &Ros2Settings,
    timeout_s: f64,
) -> Result<Ros2Port, fab_arm_ros2::Ros2Error> {
    fab_arm_ros2::connect(settings, &Chain::of_model(MODEL).unwrap(), 2, timeout_s)
}

/// Waits until the goal ends; `None` if it does not within some seconds.
pub fn outcome(port: &mut Ros2Port, goal: &GoalId) -> Option<fab_arm::port::Ending> {
    let deadline_s = port.now_s() + 20.0;
    while port.now_s() < deadline_s {
        if let GoalState::Ended(ending) = port.goal(goal) {
            return Some(ending);
        }
        port.wait(0.02);
    }
    None
}

/// Waits until a goal that was sent is active.
pub fn until_active(port: &mut Ros2Port, id: GoalId) -> GoalId {
    let deadline_s = port.now_s() + 10.0;
    while port.goal(&id) != GoalState::Active {
        assert!(port.now_s() < deadline_s, "{:?}", port.goal(&id));
        port.wait(0.02);
    }
    id
}

/// Sends a signal to a process, or with a leading minus to a process group.
pub fn signal(name: &str, process: &str) {
    let sent = Command::new("kill")
        .args([&format!("-{name}"), "--", process])
        .stderr(Stdio::null())
        .status();
    assert!(sent.is_ok(), "there is no program `kill`");
}

/// Returns a domain that no other test of this process uses, and hardly one of another.
///
/// A participant takes the ports 7400 + 250 * domain and some more, and Linux gives those from 32768 on to anybody; so
/// domains are below 100.
fn free_domain() -> u16 {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    let first = (std::process::id() % 80) as u16;
    10 + (first + NEXT.fetch_add(1, Ordering::Relaxed)) % 80
}

fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

//! A separate master and arm node for each test, both ended with it.

use fab_arm::driver::{Commands, PortArm};
use fab_arm::port::{GoalId, GoalState, Port};
use fab_arm::settings::{RosSettings, Settings};
use fab_arm_ros::RosPort;
use std::fs::OpenOptions;
use std::net::{TcpListener, TcpStream};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The arm that the node simulates.
pub const MODEL: &str = "j2n6s200";

/// The name of its joint trajectory server.
pub const TRAJECTORY: &str = "/j2n6s200/follow_joint_trajectory";

/// Debian's Python, the only one with the ROS modules.
pub const PYTHON: &str = "/usr/bin/python3";

/// Error output of the programs.
const LOG: &str = "complaints.log";

/// How long a program may take to start on a busy machine, seconds.
pub const PATIENCE_S: f64 = 30.0;

/// The driver of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driver {
    Kinova,
    Trajectory,
}

/// A program with its child processes; ended when dropped.
struct Program(Child);

impl Program {
    fn start(command: &mut Command) -> Program {
        Program(
            command
                .stdin(Stdio::null())
                .process_group(0)
                .spawn()
                .unwrap(),
        )
    }

    fn end(&mut self) {
        signal("KILL", &format!("-{}", self.0.id()));
        let _ = self.0.wait();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        self.end();
    }
}

/// A master, and an arm's node if started.
pub struct Ros {
    node: Option<Program>,
    /// Arguments of the program that simulates the arm.
    engine_arguments: Vec<String>,
    _master: Program,
    port: u16,
    folder: TempDir,
}

impl Ros {
    /// Starts a master, and waits until it answers.
    pub fn master() -> Ros {
        let folder = tempfile::tempdir().unwrap();
        let port = free_port();
        let mut command = Command::new(PYTHON);
        command.args(["/usr/bin/rosmaster", "--core", "-p", &port.to_string()]);
        let ros = Ros {
            node: None,
            engine_arguments: Vec::new(),
            _master: Program::start(surroundings(&mut command, folder.path(), port)),
            port,
            folder,
        };
        let deadline = Instant::now() + Duration::from_secs_f64(PATIENCE_S);
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(Instant::now() < deadline, "rosmaster does not start");
            std::thread::sleep(Duration::from_millis(50));
        }
        ros
    }

    /// Starts a master and the arm's node, which may not be ready yet.
    pub fn with_arm() -> Ros {
        Ros::with_arm_of(Driver::Kinova, Vec::new())
    }

    /// Does the same with arguments for the program that simulates the arm; its node serves every driver.
    pub fn with_arm_of(_: Driver, engine_arguments: Vec<String>) -> Ros {
        let mut ros = Ros::master();
        ros.engine_arguments = engine_arguments;
        generate(&ros.modules(), &[]);
        ros.start_node();
        ros
    }

    /// Starts the arm's node.
    pub fn start_node(&mut self) {
        let engine =
            std::env::var("FABC_PEER_ARM_ENGINE").expect("make test-all sets FABC_PEER_ARM_ENGINE");
        let mut command = Command::new(PYTHON);
        command.arg(project("tests/peers/arm_node.py"));
        command
            .arg(self.modules())
            .args([MODEL, TRAJECTORY, &engine])
            .args(&self.engine_arguments);
        self.node = Some(Program::start(surroundings(
            &mut command,
            self.folder.path(),
            self.port,
        )));
    }

    /// Ends the arm's node, and the arm with it, like `kill -9`.
    pub fn kill_node(&mut self) {
        self.node = None;
    }

    /// Halts the arm's node, like a machine that hangs; the arm itself continues.
    pub fn halt_node(&mut self) {
        let node = self.node.as_ref().map(|node| node.0.id().to_string());
        signal("STOP", &node.unwrap());
    }

    /// Returns the address of the master.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    /// Returns settings with this master, for the driver of Cartesian goals.
    pub fn settings(&self) -> RosSettings {
        RosSettings {
            master: self.address(),
            host: None,
            arm: format!("/{MODEL}_driver"),
            trajectory: None,
            joints: Vec::new(),
            color: Some("/camera/color/image_raw".to_owned()),
            depth: Some("/camera/aligned_depth_to_color/image_raw".to_owned()),
            info: Some("/camera/color/camera_info".to_owned()),
        }
    }

    /// Connects to the arm's node as soon as it is ready.
    pub fn connect(&self) -> RosPort {
        fab_arm_ros::connect(&self.settings(), MODEL, PATIENCE_S).unwrap()
    }

    /// Drives the arm as its settings say.
    pub fn arm(&self, settings: &Settings) -> PortArm<RosPort> {
        PortArm::new(
            Box::new(self.connect()),
            Commands::Poses,
            settings.fingers,
            settings.tolerance,
        )
    }

    /// Returns the settings for `fabc`, without the camera's place.
    pub fn robot(&self, driver: Driver, common: &str, camera: &str) -> String {
        let (driver, controller) = match driver {
            Driver::Kinova => ("kinova", String::new()),
            Driver::Trajectory => ("trajectory", format!("trajectory = '{TRAJECTORY}'")),
        };
        let address = self.address();
        format!(
            "driver = '{driver}'\n{common}
            [camera]\nsource = 'ros'\n{camera}
            [ros]\nmaster = '{address}'\narm = '/{MODEL}_driver'\n{controller}
            color = '/camera/color/image_raw'
            depth = '/camera/aligned_depth_to_color/image_raw'
            info = '/camera/color/camera_info'\n"
        )
    }

    fn modules(&self) -> PathBuf {
        self.folder.path().join("modules")
    }
}

impl Drop for Ros {
    /// Shows the programs' error output if a test failed; actionlib itself complains of each server's first goal.
    fn drop(&mut self) {
        if std::thread::panicking() {
            let log = std::fs::read_to_string(self.folder.path().join(LOG)).unwrap_or_default();
            eprintln!("the programs of ROS said:\n{log}");
        }
    }
}

/// Generates Python modules of our messages; returns `TYPE SUM` for each of `types`, one per line.
pub fn generate(modules: &Path, types: &[&str]) -> String {
    let output = Command::new(PYTHON)
        .arg(project("tests/peers/ros_messages.py"))
        .arg(project("runtime/arm-ros/src/msgs"))
        .arg(modules)
        .args(types)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Waits until the goal ends; `None` if it does not within some seconds.
pub fn outcome(port: &mut RosPort, goal: &GoalId) -> Option<fab_arm::port::Ending> {
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
pub fn until_active(port: &mut RosPort, id: GoalId) -> GoalId {
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

/// Returns a port on which nothing listens.
pub fn free_port() -> u16 {
    TcpListener::bind(("127.0.0.1", 0))
        .unwrap()
        .local_addr()
        .unwrap()
        .port()
}

/// Sets the files and addresses that ROS programs read from the environment, all of them this test's own.
fn surroundings<'a>(command: &'a mut Command, folder: &Path, port: u16) -> &'a mut Command {
    let log = OpenOptions::new()
        .create(true)
        .append(true)
        .open(folder.join(LOG))
        .unwrap();
    command
        .env("ROS_MASTER_URI", format!("http://127.0.0.1:{port}"))
        .env("ROS_IP", "127.0.0.1")
        .env_remove("ROS_HOSTNAME")
        .env("ROS_HOME", folder)
        .env("ROS_LOG_DIR", folder)
        .stdout(Stdio::null())
        .stderr(log)
}

fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

//! A simulated arm over a simulated cloth behind ROS, with a camera at an undisclosed place, and `fabc` beside it.
//!
//! In: a driver, a seed. Out: a [`Lab`] to calibrate and run tasks in, and the true state, without going through ROS:
//! where the tool was, whether the arm is stopped, where the cloth lies.

use super::fault::FaultKind;
use super::nodes::{Driver, PATIENCE_S, Ros};
use fab_agent::record::RECORD_FILE;
use fab_arm::journal::ARM_FILE;
use fab_arm::settings::Settings;
use fab_base::chance::Chance;
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// The longest duration of a run on a busy machine.
pub const LONG: Duration = Duration::from_secs(240);

/// Side of the camera's picture, pixels.
const SIDE_PX: u32 = 480;

/// The camera's settings, but for its source.
fn camera() -> String {
    format!("window_px = [0, 0, {SIDE_PX}]\ntimeout_s = 10.0\n")
}

/// Settings shared by the arm and the program that simulates it.
const COMMON: &str = "
name = 'lab'
model = 'j2n6s200'
calibration = 'lab.calibration.toml'
table = { center_m = [0.45, 0.0, 0.02] }
fingers = { count = 2, open = 0.0, closed = 6400.0, cloth = 200.0, tolerance = 100.0 }
# The paper's 5 mm push a simulated cloth together instead of folding it; the simulated world's picker is as fast.
# It runs in real time, so it speeds up at once.
motion = { lift_m = 0.05, travel_m = 0.08, speed_m_s = 0.4, acceleration_deg_s2 = 1000.0, jerk_deg_s3 = 100000.0 }
# A machine that tests run on is busier than one beside an arm.
tolerance = { stale_s = 1.5, watchdog_s = 1.5 }

[workspace]
min_m = [0.15, -0.525, 0.01]
max_m = [0.75, 0.525, 0.45]
rest_m = [0.30, -0.40, 0.25]
max_speed_m_s = 0.5
";

/// The corners of the tool's box, metres, base frame; the same as in the settings above.
pub const BOX_M: [[f64; 3]; 2] = [[0.15, -0.525, 0.01], [0.75, 0.525, 0.45]];

/// The number of labs; each has four programs that must run in real time.
static LABS: Mutex<u32> = Mutex::new(0);
static ONE_LESS: Condvar = Condvar::new();
const MOST_LABS: u32 = 2;

/// One of the labs that may exist at a time.
struct Place;

impl Place {
    fn wait() -> Place {
        let labs = LABS.lock().unwrap_or_else(PoisonError::into_inner);
        let free = ONE_LESS.wait_while(labs, |labs| *labs >= MOST_LABS);
        *free.unwrap_or_else(PoisonError::into_inner) += 1;
        Place
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        *LABS.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        ONE_LESS.notify_one();
    }
}

/// An arm, its table and its camera.
pub struct Lab {
    pub ros: Ros,
    pub chance: Chance,
    asked: UnixStream,
    answers: BufReader<UnixStream>,
    folder: TempDir,
    /// The last field, so that it is dropped after everything above.
    _place: Place,
}

impl Lab {
    /// Sets everything up and waits until the arm answers; the table is empty.
    ///
    /// - `seed`: determines the camera's place and all other random values.
    pub fn new(driver: Driver, seed: u64) -> Lab {
        let place = Place::wait();
        let folder = tempfile::tempdir().unwrap();
        let mut chance = Chance::seeded(seed);
        let mut within = |most: f64| (2.0 * chance.fraction() - 1.0) * most;
        let played = format!(
            "driver = 'simulated'\n{COMMON}
            [camera]\nsource = 'simulated'\nwindow_px = [0, 0, {SIDE_PX}]
            [simulated]\ncamera_px = {SIDE_PX}\ncamera_height_m = {}\ncamera_offset_m = [{}, {}]\ncamera_turn_deg = {}\n",
            1.0 + within(0.03),
            within(0.02),
            within(0.02),
            within(4.0),
        );
        std::fs::write(folder.path().join("played.toml"), played).unwrap();
        let control = folder.path().join("control");
        let plan = json!({
            "robot": folder.path().join("played.toml"),
            "seed": seed,
            "cloth": [50, 50, 0.00625],
            "control": control,
        });
        let ros = Ros::with_arm_of(driver, vec![plan.to_string()]);
        std::fs::write(
            folder.path().join("robot.toml"),
            ros.robot(driver, COMMON, &camera()),
        )
        .unwrap();
        let asked = connected(&control);
        let answers = BufReader::new(asked.try_clone().unwrap());
        Lab {
            ros,
            chance,
            asked,
            answers,
            folder,
            _place: place,
        }
    }

    /// The settings file that `fabc` gets.
    pub fn robot(&self) -> PathBuf {
        self.folder().join("robot.toml")
    }

    pub fn settings(&self) -> Settings {
        Settings::load(&self.robot()).unwrap()
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Asks the simulating program directly, without ROS.
    pub fn ask(&mut self, request: &Value) -> Value {
        writeln!(self.asked, "{request}").unwrap();
        let mut line = String::new();
        self.answers.read_line(&mut line).unwrap();
        let answer: Value = serde_json::from_str(&line).unwrap();
        assert!(answer["error"].is_null(), "{request}: {answer}");
        answer
    }

    pub fn truth(&mut self) -> Truth {
        let told = self.ask(&json!({ "ask": "truth" }));
        serde_json::from_value(told).unwrap()
    }

    /// Starts a fault.
    pub fn fail(&mut self, kind: FaultKind) {
        self.ask(&json!({ "ask": "fail", "kind": kind }));
    }

    /// Lays the cloth.
    pub fn lay(&mut self) {
        self.ask(&json!({ "ask": "lay" }));
    }

    /// The command, beside the settings.
    pub fn fabc(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_fabc"));
        command
            .current_dir(self.folder())
            .env("NO_COLOR", "1")
            .env("FABC_CACHE_DIR", cache_folder())
            .stdin(Stdio::null());
        command
    }

    /// Starts a Double Triangle fold.
    pub fn run(&self) -> Run {
        self.run_from(Stdio::null(), &[])
    }

    /// Does the same with a given stdin and more arguments.
    pub fn run_from(&self, stdin: Stdio, more: &[&str]) -> Run {
        let folder = self.folder().join("run");
        let said = |name: &str| File::create(self.folder().join(name)).unwrap();
        let task = project("tasks/real/double_triangle.fab");
        let mut command = self.fabc();
        command
            .args(["run", &task, "--world", "jaco", "--robot"])
            .arg(self.robot())
            .args(["--confirm", "none", "--json", "--out"])
            .arg(&folder)
            .args(more)
            .stdin(stdin)
            .stdout(said("stdout"))
            .stderr(said("stderr"));
        Run {
            child: command.spawn().unwrap(),
            folder,
            beside: self.folder().to_owned(),
        }
    }
}

/// The true state of an arm and its cloth.
#[derive(Clone, Debug, serde::Deserialize)]
pub struct Truth {
    pub tool_m: [f64; 3],
    /// The least and the largest coordinates that the tool ever had.
    pub extent_m: [[f64; 3]; 2],
    pub is_stopped: bool,
    pub moved_after_stop_m: Option<f64>,
    pub particles_m: Vec<[f32; 3]>,
}

/// A running `fabc run`; killed when dropped.
pub struct Run {
    pub child: Child,
    pub folder: PathBuf,
    beside: PathBuf,
}

/// How a run ended.
#[derive(Debug)]
pub struct Ended {
    /// `None` if a signal ended it.
    pub code: Option<i32>,
    /// The report; null if there is none.
    pub report: Value,
    /// Why the last step was not completed, from the run's journal; empty if it was.
    pub why: String,
    /// The arm's journal.
    pub journal: String,
    pub stderr: String,
}

impl Run {
    /// Waits until a segment, e.g. `over_pick`, begins for the first time; fails if the run ends before.
    pub fn until(&mut self, segment: &str) {
        let wanted = format!("\"segment\":\"{segment}\"");
        let deadline = Instant::now() + LONG;
        loop {
            let journal = self.journal();
            if journal.contains(&wanted) {
                return;
            }
            let ended = self.child.try_wait().unwrap();
            assert!(
                ended.is_none() && Instant::now() < deadline,
                "`{segment}` does not begin: {ended:?}\n{journal}\n{}",
                self.said("stderr")
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Returns the part of the arm's journal that is written so far.
    pub fn journal(&self) -> String {
        std::fs::read_to_string(self.folder.join(ARM_FILE)).unwrap_or_default()
    }

    pub fn signal(&self, name: &str) {
        super::nodes::signal(name, &self.child.id().to_string());
    }

    /// Waits until it ends.
    pub fn end(mut self) -> Ended {
        let deadline = Instant::now() + LONG;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(
                Instant::now() < deadline,
                "it does not end:\n{}\n{}",
                self.journal(),
                self.said("stderr")
            );
            std::thread::sleep(Duration::from_millis(20));
        };
        Ended {
            code: status.code(),
            report: serde_json::from_str(&self.said("stdout")).unwrap_or_default(),
            why: self.why(),
            journal: self.journal(),
            stderr: self.said("stderr"),
        }
    }

    fn why(&self) -> String {
        let steps = std::fs::read_to_string(self.folder.join(RECORD_FILE)).unwrap_or_default();
        let lines = steps
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok());
        let mut whys = lines.filter_map(|line: Value| Some(line["stopped"].as_str()?.to_owned()));
        whys.next_back().unwrap_or_default()
    }

    fn said(&self, name: &str) -> String {
        std::fs::read_to_string(self.beside.join(name)).unwrap_or_default()
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn connected(control: &Path) -> UnixStream {
    let deadline = Instant::now() + Duration::from_secs_f64(PATIENCE_S);
    loop {
        match UnixStream::connect(control) {
            Ok(stream) => {
                let patience = Duration::from_secs_f64(PATIENCE_S);
                stream.set_read_timeout(Some(patience)).unwrap();
                return stream;
            }
            Err(error) => assert!(Instant::now() < deadline, "no arm is played: {error}"),
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// A cache that all tests share.
pub fn cache_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("target/test-cache")
}

/// A path below the project's root, as text.
pub fn project(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    path.display().to_string()
}

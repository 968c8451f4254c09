//! Simulates an arm and a camera over standard input and output, for the ROS node of the tests
//! (`tests/peers/arm_node.py`).
//!
//! In: requests, and optionally a [`scene`] as an argument. Out: one answer to each, in real time. A frame is the
//! length of its JSON in four bytes, little-endian; the JSON; then as many bytes as its `blobs` name. Without a scene
//! it simulates [`straight::Arm`], which has no kinematics and no cloth. A test sends its own requests over a socket
//! that the scene names, a line of JSON each way.

mod ask;
mod control;
#[path = "../../src/tests/fault.rs"]
mod fault;
#[path = "../../src/tests/faulty.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod faulty;
#[path = "../../src/tests/kinova/mod.rs"]
mod kinova;
mod scene;
mod straight;

use ::fab_arm as arm;
use ask::{Request, answer};
use fab_arm::port::Port;
use fab_arm::rgbd::RgbdSource;
use fault::FaultKind;
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// The longest request accepted.
const MAX_BYTES: u32 = 1 << 20;

/// A step of the clock.
const STEP: Duration = Duration::from_millis(10);

/// The simulated setup: an arm, a camera, and messages lost in transit.
trait Stage: Port + RgbdSource {
    /// Returns whether a message of a kind named by the node is lost: `goal`, `result`, `cancel`, `stop` or `reading`.
    fn loses(&mut self, _message: &str) -> bool {
        false
    }

    /// Injects a fault from now on; fails with the reason.
    fn fail(&mut self, kind: FaultKind) -> Result<(), String> {
        Err(format!("nothing goes wrong here, and not `{kind:?}`"))
    }

    /// Lays the scene's cloth; fails with the reason.
    fn lay(&mut self) -> Result<(), String> {
        Err("there is no cloth here".to_owned())
    }

    /// Returns the true state, which no node reports.
    fn truth(&self) -> Value {
        json!({})
    }

    /// Returns the pixel at which the camera sees a point of the base frame, metres.
    fn pixel(&self, _point_m: [f64; 3]) -> Option<[f64; 2]> {
        None
    }
}

/// A request with its reply channel.
enum Asked {
    Node(io::Result<Request>),
    Test(Request, Sender<Value>),
}

fn main() -> io::Result<()> {
    let (sender, receiver) = mpsc::channel();
    let mut stage: Box<dyn Stage> = match std::env::args().nth(1) {
        None => Box::new(straight::Arm::default()),
        Some(text) => {
            let plan: scene::Plan = serde_json::from_str(&text).map_err(io::Error::other)?;
            let scene = scene::Scene::new(&plan).map_err(io::Error::other)?;
            control::listen(&plan.control, sender.clone())?;
            Box::new(scene)
        }
    };
    std::thread::spawn(move || {
        let mut requests = io::stdin().lock();
        while sender
            .send(Asked::Node(read_request(&mut requests)))
            .is_ok()
        {}
    });
    let (answers, to_write) = mpsc::channel();
    // A hanging node reads no answers, but the arm must keep moving.
    std::thread::spawn(move || {
        let mut stdout = io::stdout().lock();
        to_write
            .into_iter()
            .try_for_each(|answered| reply(&mut stdout, answered))
    });
    let (mut last, mut owed) = (Instant::now(), Duration::ZERO);
    loop {
        let asked = receiver.recv_timeout(STEP);
        let passed = last.elapsed();
        last += passed;
        owed += passed;
        // Only whole steps: rounding many short waits up to a step each would make the clock run ahead.
        let n_steps = (owed.as_micros() / STEP.as_micros()) as u32;
        if n_steps > 0 {
            owed -= STEP * n_steps;
            stage.wait((STEP * n_steps).as_secs_f64());
        }
        match asked {
            // The node or the test may have exited meanwhile.
            Ok(Asked::Node(Ok(request))) => {
                let _ = answers.send(answer(stage.as_mut(), request));
            }
            Ok(Asked::Test(request, replies)) => {
                let _ = replies.send(answer(stage.as_mut(), request).0);
            }
            // The node has closed its end.
            Ok(Asked::Node(Err(error))) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Ok(());
            }
            Ok(Asked::Node(Err(error))) => return Err(error),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

fn reply(answers: &mut impl Write, (mut answer, blobs): (Value, Vec<Vec<u8>>)) -> io::Result<()> {
    answer["blobs"] = blobs.iter().map(Vec::len).collect();
    let text = answer.to_string();
    answers.write_all(&(text.len() as u32).to_le_bytes())?;
    answers.write_all(text.as_bytes())?;
    blobs.iter().try_for_each(|blob| answers.write_all(blob))?;
    answers.flush()
}

fn read_request(requests: &mut impl Read) -> io::Result<Request> {
    let mut length = [0; 4];
    requests.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length);
    if length > MAX_BYTES {
        return Err(io::Error::other(format!(
            "a request has {length} bytes, and {MAX_BYTES} is the most"
        )));
    }
    let mut text = vec![0; length as usize];
    requests.read_exact(&mut text)?;
    serde_json::from_slice(&text).map_err(io::Error::other)
}

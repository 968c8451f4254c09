//! Serves an arm and a camera over standard input and output, for the ROS node of the tests (`tests/peers/arm_node.py`).
//!
//! In: requests. Out: one answer to each, while time passes as it does outside. A frame is the length of its JSON in four
//! bytes, the least first; the JSON; then as many bytes as its `blobs` name. Anything that is a `Port` and an `RgbdSource`
//! can be served; here that is [`straight::Arm`], which has no kinematics and no cloth.

mod straight;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use runtime::arm::port::{Ending, Goal, GoalId, GoalState, Port, Waypoint};
use runtime::arm::rgbd::RgbdSource;
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// The longest request that is read.
const MAX_BYTES: u32 = 1 << 20;

/// How often time passes while nobody asks.
const STEP: Duration = Duration::from_millis(10);

#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum Request {
    /// Metres, and a quaternion x, y, z, w.
    ToolPose {
        position: [f64; 3],
        turn: [f64; 4],
    },
    JointAngles {
        radians: Vec<f64>,
    },
    Fingers {
        positions: Vec<f64>,
    },
    /// Each point is seconds, then radians.
    Trajectory {
        points: Vec<(f64, Vec<f64>)>,
    },
    State {
        goal: String,
    },
    Cancel {
        goal: String,
    },
    Stop,
    Start,
    Readings,
    /// Answered with colour, 3 bytes a pixel, and depth, 2 bytes a pixel, millimetres.
    Picture,
}

fn main() -> io::Result<()> {
    let (mut arm, mut camera) = (straight::Arm::default(), straight::Camera);
    serve(&mut arm, &mut camera, io::stdin(), io::stdout().lock())
}

fn serve(
    port: &mut dyn Port,
    camera: &mut dyn RgbdSource,
    mut requests: impl Read + Send + 'static,
    mut answers: impl Write,
) -> io::Result<()> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || while sender.send(read_request(&mut requests)).is_ok() {});
    let mut last = Instant::now();
    loop {
        let request = match receiver.recv_timeout(STEP) {
            Ok(Ok(request)) => Some(request),
            // The node has closed its end.
            Ok(Err(error)) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
            Ok(Err(error)) => return Err(error),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        let passed = last.elapsed();
        last += passed;
        port.wait(passed.as_secs_f64());
        if let Some(request) = request {
            let (mut answer, blobs) = answer(port, camera, request);
            answer["blobs"] = blobs.iter().map(Vec::len).collect();
            let text = answer.to_string();
            answers.write_all(&(text.len() as u32).to_le_bytes())?;
            answers.write_all(text.as_bytes())?;
            blobs.iter().try_for_each(|blob| answers.write_all(blob))?;
            answers.flush()?;
        }
    }
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

fn answer(
    port: &mut dyn Port,
    camera: &mut dyn RgbdSource,
    request: Request,
) -> (Value, Vec<Vec<u8>>) {
    let goal = match request {
        Request::State { goal } => {
            return (
                json!({ "state": state(&port.state(&GoalId(goal))) }),
                vec![],
            );
        }
        Request::Cancel { goal } => return (done(port.cancel(&GoalId(goal))), vec![]),
        Request::Stop => return (done(port.stop()), vec![]),
        Request::Start => return (done(port.start()), vec![]),
        Request::Readings => return (readings(port), vec![]),
        Request::Picture => return picture(camera),
        Request::ToolPose {
            position: [x, y, z],
            turn: [i, j, k, w],
        } => {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
            Goal::ToolPose(Isometry3::from_parts(Translation3::new(x, y, z), turn))
        }
        Request::JointAngles { radians } => Goal::JointAngles(radians),
        Request::Fingers { positions } => Goal::Fingers(positions),
        Request::Trajectory { points } => {
            let points = points.into_iter();
            Goal::Trajectory(
                points
                    .map(|(at_s, joints_rad)| Waypoint { joints_rad, at_s })
                    .collect(),
            )
        }
    };
    match port.send(&goal) {
        Ok(id) => (json!({ "goal": id.0 }), vec![]),
        Err(error) => (json!({ "error": error.to_string() }), vec![]),
    }
}

fn done(result: Result<(), impl ToString>) -> Value {
    match result {
        Ok(()) => json!({}),
        Err(error) => json!({ "error": error.to_string() }),
    }
}

fn state(state: &GoalState) -> &'static str {
    match state {
        GoalState::Sent => "sent",
        GoalState::Active => "active",
        GoalState::Ended(Ending::Succeeded) => "succeeded",
        GoalState::Ended(Ending::Preempted) => "preempted",
        GoalState::Ended(Ending::Aborted) => "aborted",
        GoalState::Ended(Ending::Rejected) => "rejected",
    }
}

fn readings(port: &mut dyn Port) -> Value {
    let readings = port.readings();
    let tool = readings.tool.map(|tool| {
        let turn = tool.value.rotation.coords;
        json!({
            "position": tool.value.translation.vector.as_slice(),
            "turn": [turn.x, turn.y, turn.z, turn.w],
        })
    });
    json!({
        "tool": tool,
        "joints": readings.joints_rad.map(|joints| joints.value),
        "fingers": readings.fingers.map(|fingers| fingers.value),
    })
}

fn picture(camera: &mut dyn RgbdSource) -> (Value, Vec<Vec<u8>>) {
    let shot = match camera.shoot() {
        Ok(shot) => shot,
        Err(error) => return (json!({ "error": error.to_string() }), vec![]),
    };
    let size = [shot.rgb.width(), shot.rgb.height()];
    let millimetres = |depth_m: &f32| ((depth_m * 1000.0).round() as u16).to_le_bytes();
    let depth = shot.depth_m.as_raw().iter().flat_map(millimetres).collect();
    (
        json!({ "size": size, "intrinsics": shot.intrinsics }),
        vec![shot.rgb.into_raw(), depth],
    )
}

//! Requests to the engine, from the node or from a test, and its answers.
//!
//! In: requests. Out: JSON, with the bytes of pictures beside it. The stage executes them.

use super::Stage;
use super::fault::FaultKind;
use fab_arm::port::{Ending, GoalId, GoalState, PortError, Waypoint};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::Deserialize;
use serde_json::{Value, json};

#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
pub enum Request {
    /// Metres, and a quaternion x, y, z, w.
    ToolPose {
        position: [f64; 3],
        turn: [f64; 4],
    },
    Fingers {
        positions: Vec<f64>,
    },
    /// Each point is seconds, then radians, rad/s and rad/s².
    Trajectory {
        points: Vec<(f64, [Vec<f64>; 3])>,
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
    /// Whether a message of this kind gets lost.
    Loses {
        message: String,
    },
    /// Sent only by tests, like the following ones.
    Fail {
        kind: FaultKind,
    },
    Lay,
    Truth,
    /// Metres, base frame.
    Pixel {
        position: [f64; 3],
    },
}

/// Executes a request; returns the answer, and the bytes that go with it.
pub fn answer(stage: &mut dyn Stage, request: Request) -> (Value, Vec<Vec<u8>>) {
    let value = match request {
        Request::State { goal } => json!({ "state": state(&stage.goal(&GoalId(goal))) }),
        Request::Cancel { goal } => done(stage.cancel(&GoalId(goal))),
        Request::Stop => done(stage.stop()),
        Request::Start => done(stage.start()),
        Request::Readings => readings(stage),
        Request::Picture => return picture(stage),
        Request::Loses { message } => json!({ "loses": stage.loses(&message) }),
        Request::Fail { kind } => done(stage.fail(kind)),
        Request::Lay => done(stage.lay()),
        Request::Truth => stage.truth(),
        Request::Pixel { position } => json!({ "pixel": stage.pixel(position) }),
        Request::ToolPose {
            position: [x, y, z],
            turn: [i, j, k, w],
        } => {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
            let pose = Isometry3::from_parts(Translation3::new(x, y, z), turn);
            sent(stage.send_pose(&pose))
        }
        Request::Fingers { positions } => sent(stage.send_fingers(&positions)),
        Request::Trajectory { points } => {
            let points = points.into_iter();
            let points =
                points.map(
                    |(at_s, [joints_rad, speeds_rad_s, accelerations_rad_s2])| Waypoint {
                        joints_rad,
                        speeds_rad_s,
                        accelerations_rad_s2,
                        at_s,
                    },
                );
            sent(stage.send_trajectory(&points.collect::<Vec<_>>()))
        }
    };
    (value, Vec::new())
}

fn sent(sent: Result<GoalId, PortError>) -> Value {
    match sent {
        Ok(id) => json!({ "goal": id.0 }),
        Err(error) => json!({ "error": error.to_string() }),
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

fn readings(stage: &mut dyn Stage) -> Value {
    let readings = stage.state();
    let tool_json = readings.tool.as_ref().map(|tool| {
        let turn = tool.value.rotation.coords;
        json!({
            "position": tool.value.translation.vector.as_slice(),
            "turn": [turn.x, turn.y, turn.z, turn.w],
        })
    });
    json!({
        "taken_s": readings.tool.as_ref().map(|tool| tool.at_s),
        "tool": tool_json,
        "joints": readings.joints_rad.map(|joints| joints.value),
        "fingers": readings.fingers.map(|fingers| fingers.value),
        "loses": stage.loses("reading"),
    })
}

fn picture(stage: &mut dyn Stage) -> (Value, Vec<Vec<u8>>) {
    let shot = match stage.shoot() {
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

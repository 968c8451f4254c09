//! Tests of messages: bytes of any message are read back or refused, and are those of `rosbags`.

#![allow(clippy::unwrap_used)]

use super::*;
use proptest::prelude::*;
use rustdds::cdr_encoding::{from_bytes, to_vec};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

/// What begins every message on the wire: plain CDR, lowest byte first.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

type LittleEndian = byteorder::LittleEndian;

fn bytes_of<T: Serialize>(message: &T) -> Vec<u8> {
    let mut bytes = ENCAPSULATION.to_vec();
    bytes.extend(to_vec::<T, LittleEndian>(message).unwrap());
    bytes
}

/// Returns whether bytes are read as the message.
type Check = dyn Fn(&[u8]) -> bool;

/// A message, and a check of what the other program made of it.
struct Sample {
    name: &'static str,
    bytes: Vec<u8>,
    fields: Value,
    reads_back: Box<Check>,
}

fn sample<T>(name: &'static str, message: T) -> Sample
where
    T: Serialize + DeserializeOwned + PartialEq + 'static,
{
    Sample {
        name,
        bytes: bytes_of(&message),
        fields: serde_json::to_value(&message).unwrap(),
        reads_back: Box::new(move |bytes| {
            let read = from_bytes::<T, LittleEndian>(&bytes[ENCAPSULATION.len()..]);
            read.is_ok_and(|(read, _)| read == message)
        }),
    }
}

fn header() -> Header {
    Header {
        stamp: Time {
            sec: 1_700_000_000,
            nanosec: 123_456_789,
        },
        frame_id: "base".to_owned(),
    }
}

fn uuid() -> Uuid {
    Uuid {
        uuid: std::array::from_fn(|at| 200 - at as u8),
    }
}

fn joint_state() -> JointState {
    JointState {
        header: header(),
        name: vec!["a".to_owned(), "joint_2".to_owned()],
        position: vec![1.5, -2.25],
        velocity: vec![0.5],
        effort: vec![],
    }
}

fn info() -> GoalInfo {
    GoalInfo {
        goal_id: uuid(),
        stamp: Time {
            sec: -3,
            nanosec: 4,
        },
    }
}

fn trajectory() -> FollowJointTrajectoryGoal {
    FollowJointTrajectoryGoal {
        trajectory: JointTrajectory {
            header: header(),
            joint_names: vec!["joint".to_owned()],
            points: vec![
                JointTrajectoryPoint {
                    positions: vec![0.1],
                    velocities: vec![0.2],
                    accelerations: vec![0.3],
                    effort: vec![0.4],
                    time_from_start: Duration { sec: 5, nanosec: 6 },
                },
                JointTrajectoryPoint::default(),
            ],
        },
        path_tolerance: vec![JointTolerance {
            name: "joint".to_owned(),
            position: 1.0,
            velocity: 2.0,
            acceleration: 3.0,
        }],
        goal_time_tolerance: Duration { sec: 7, nanosec: 8 },
        ..FollowJointTrajectoryGoal::default()
    }
}

fn samples() -> Vec<Sample> {
    let command = GripperCommand {
        position: 0.04,
        max_effort: 20.0,
    };
    vec![
        sample("sensor_msgs/msg/JointState", joint_state()),
        sample(
            "sensor_msgs/msg/Image",
            Image {
                header: header(),
                height: 1,
                width: 2,
                encoding: "rgb8".to_owned(),
                is_bigendian: 1,
                step: 6,
                data: ByteBuf::from(vec![1, 2, 3, 4, 5, 6]),
            },
        ),
        sample(
            "sensor_msgs/msg/CameraInfo",
            CameraInfo {
                header: header(),
                height: 480,
                width: 640,
                distortion_model: "plumb_bob".to_owned(),
                d: vec![0.1, 0.2, 0.3],
                k: std::array::from_fn(|at| at as f64),
                r: std::array::from_fn(|at| 10.0 + at as f64),
                p: std::array::from_fn(|at| 20.0 + at as f64),
                binning_x: 1,
                binning_y: 2,
                roi: RegionOfInterest {
                    x_offset: 3,
                    y_offset: 4,
                    height: 5,
                    width: 6,
                    do_rectify: true,
                },
            },
        ),
        sample(
            "action_msgs/msg/GoalStatusArray",
            GoalStatusArray {
                status_list: vec![
                    GoalStatus {
                        goal_info: info(),
                        status: 4,
                    },
                    GoalStatus::default(),
                ],
            },
        ),
        sample(
            "action_msgs/srv/CancelGoal_Request",
            CancelGoalRequest { goal_info: info() },
        ),
        sample(
            "action_msgs/srv/CancelGoal_Response",
            CancelGoalResponse {
                return_code: -2,
                goals_canceling: vec![info(), GoalInfo::default()],
            },
        ),
        sample(
            "control_msgs/action/FollowJointTrajectory_SendGoal_Request",
            SendGoalRequest {
                goal_id: uuid(),
                goal: trajectory(),
            },
        ),
        sample(
            "control_msgs/action/FollowJointTrajectory_SendGoal_Response",
            SendGoalResponse {
                accepted: true,
                stamp: Time {
                    sec: 9,
                    nanosec: 10,
                },
            },
        ),
        sample(
            "control_msgs/action/FollowJointTrajectory_GetResult_Request",
            GetResultRequest { goal_id: uuid() },
        ),
        sample(
            "control_msgs/action/FollowJointTrajectory_GetResult_Response",
            GetResultResponse {
                status: 6,
                result: FollowJointTrajectoryResult {
                    error_code: -4,
                    error_string: "path".to_owned(),
                },
            },
        ),
        sample(
            "control_msgs/action/GripperCommand_SendGoal_Request",
            SendGoalRequest {
                goal_id: uuid(),
                goal: GripperCommandGoal { command },
            },
        ),
        sample(
            "control_msgs/action/GripperCommand_GetResult_Response",
            GetResultResponse {
                status: 4,
                result: GripperCommandResult {
                    position: 0.01,
                    effort: 0.02,
                    stalled: true,
                    reached_goal: false,
                },
            },
        ),
        sample(
            "control_msgs/action/ParallelGripperCommand_SendGoal_Request",
            SendGoalRequest {
                goal_id: uuid(),
                goal: ParallelGripperCommandGoal {
                    command: joint_state(),
                },
            },
        ),
        sample(
            "control_msgs/action/ParallelGripperCommand_GetResult_Response",
            GetResultResponse {
                status: 5,
                result: ParallelGripperCommandResult {
                    state: joint_state(),
                    stalled: false,
                    reached_goal: true,
                },
            },
        ),
        sample("std_srvs/srv/Trigger_Request", TriggerRequest::default()),
        sample(
            "std_srvs/srv/Trigger_Response",
            TriggerResponse {
                success: true,
                message: "stopped".to_owned(),
            },
        ),
    ]
}

/// Every message reads alike in another program, field by field, and its bytes read alike here.
#[test]
#[ignore = "needs rosbags"]
fn peer_ros2_messages_have_the_bytes_that_others_read_and_write() {
    let python = std::env::var("FABC_PEER_PYTHON").expect("make test-all sets FABC_PEER_PYTHON");
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/peers/ros2_messages.py"
    );
    let mut child = Command::new(python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let samples = samples();
    let hexadecimal = |bytes: &[u8]| -> String {
        let digits = bytes.iter().map(|byte| format!("{byte:02x}"));
        digits.collect()
    };
    let mut input = child.stdin.take().unwrap();
    for sample in &samples {
        let line = json!({ "type": sample.name, "bytes": hexadecimal(&sample.bytes) });
        writeln!(input, "{line}").unwrap();
    }
    drop(input);
    let output = child.wait_with_output().unwrap();
    let lines: Vec<Value> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), samples.len(), "a message could not be read");
    for (sample, said) in samples.iter().zip(lines) {
        assert_eq!(said["fields"], sample.fields, "{}", sample.name);
        let text = said["bytes"].as_str().unwrap();
        let written: Vec<u8> = (0..text.len() / 2)
            .map(|at| u8::from_str_radix(&text[2 * at..2 * at + 2], 16).unwrap())
            .collect();
        assert!((sample.reads_back)(&written), "{}", sample.name);
    }
}

proptest! {
    /// Any bytes are a message or an error, never a panic.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = from_bytes::<JointState, LittleEndian>(&bytes);
        let _ = from_bytes::<Image, LittleEndian>(&bytes);
        let _ = from_bytes::<CameraInfo, LittleEndian>(&bytes);
        let _ = from_bytes::<GoalStatusArray, LittleEndian>(&bytes);
        let _ = from_bytes::<CancelGoalResponse, LittleEndian>(&bytes);
        let _ = from_bytes::<GetResultResponse<ParallelGripperCommandResult>, LittleEndian>(&bytes);
    }
}

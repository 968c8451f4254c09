//! Receives the arm's readings from its topics.
//!
//! In: messages. Out: [`Readings`], each value with the time at which it was taken: by its stamp, so that a repeated pose
//! is not fresh. Positions of fingers have no stamp, and count from their receipt. An invalid message is dropped, and the
//! reason kept for the error if no reading arrives.

use super::messages::geometry_msgs::PoseStamped;
use super::messages::kinova_msgs::FingerPosition;
use super::messages::sensor_msgs::JointState;
use super::messages::std_msgs::Header;
use fab_arm::port::{Reading, Readings, Stamps};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use roslibrust::RosMessageType;
use roslibrust::ros1::{NodeError, NodeHandle};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// How far the norm of a quaternion may be from 1.
const UNIT_TOLERANCE: f64 = 0.01;

/// The names of an arm's parts in messages.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// The frame of the base.
    pub(super) base_frame: String,
    /// The joints from the base to the hand.
    pub(super) joints: Vec<String>,
    /// How many fingers.
    pub(super) n_fingers: usize,
}

/// What the topics have delivered.
#[derive(Default)]
struct Received {
    readings: Readings,
    /// Why the last message of a topic was dropped.
    faults: BTreeMap<&'static str, String>,
}

/// The arm's topics.
pub(super) struct Topics {
    received: Arc<Mutex<Received>>,
}

impl Topics {
    /// Subscribes to the topics under `arm`; times are counted from `clock`.
    pub(super) async fn open(
        node: &NodeHandle,
        arm: &str,
        names: &Names,
        clock: Instant,
    ) -> Result<Topics, NodeError> {
        let received = Arc::new(Mutex::new(Received::default()));
        let subscription = Subscription {
            node,
            arm,
            clock,
            received: &received,
        };
        let frame = names.base_frame.clone();
        subscription
            .topic(
                "out/tool_pose",
                move |message: &PoseStamped| {
                    Ok((Some(stamp_s(&message.header)?), tool_pose(message, &frame)?))
                },
                |readings| &mut readings.tool,
            )
            .await?;
        let joints = names.joints.clone();
        subscription
            .topic(
                "out/joint_state",
                move |message: &JointState| {
                    Ok((
                        Some(stamp_s(&message.header)?),
                        joint_angles(message, &joints)?,
                    ))
                },
                |readings| &mut readings.joints_rad,
            )
            .await?;
        let n_fingers = names.n_fingers;
        subscription
            .topic(
                "out/finger_position",
                move |message| Ok((None, fingers(message, n_fingers)?)),
                |readings| &mut readings.fingers,
            )
            .await?;
        Ok(Topics { received })
    }

    /// Returns the last readings.
    pub(super) fn readings(&self) -> Readings {
        lock(&self.received).readings.clone()
    }

    /// Returns why messages were dropped, a sentence each.
    pub(super) fn faults(&self) -> Vec<String> {
        lock(&self.received).faults.values().cloned().collect()
    }
}

/// Common parameters of the subscriptions.
struct Subscription<'a> {
    node: &'a NodeHandle,
    arm: &'a str,
    clock: Instant,
    received: &'a Arc<Mutex<Received>>,
}

impl Subscription<'_> {
    async fn topic<T: RosMessageType, V: Send + 'static>(
        &self,
        name: &'static str,
        read: impl Fn(&T) -> Result<(Option<f64>, V), String> + Send + 'static,
        place: fn(&mut Readings) -> &mut Option<Reading<V>>,
    ) -> Result<(), NodeError> {
        // Only the newest message counts, so no old reading waits in a queue.
        let mut topic = self
            .node
            .subscribe::<T>(&format!("{}/{name}", self.arm), 1)
            .await?;
        let (received, clock) = (Arc::clone(self.received), self.clock);
        tokio::spawn(async move {
            let mut stamps = Stamps::default();
            while let Some(message) = topic.next().await {
                let Ok(message) = message else { continue };
                let heard_s = clock.elapsed().as_secs_f64();
                let mut received = lock(&received);
                match read(&message) {
                    Ok((stamp_s, value)) => {
                        received.faults.remove(name);
                        let taken_s = match stamp_s {
                            Some(stamp_s) => stamps.taken_s(stamp_s, heard_s),
                            None => Some(heard_s),
                        };
                        if let Some(at_s) = taken_s {
                            *place(&mut received.readings) = Some(Reading { value, at_s });
                        }
                    }
                    Err(why) => {
                        received.faults.insert(name, format!("`{name}` {why}"));
                    }
                }
            }
        });
        Ok(())
    }
}

fn lock(received: &Mutex<Received>) -> MutexGuard<'_, Received> {
    received.lock().unwrap_or_else(PoisonError::into_inner)
}

fn tool_pose(message: &PoseStamped, base_frame: &str) -> Result<Isometry3<f64>, String> {
    let frame = message.header.frame_id.trim_start_matches('/');
    if frame != base_frame {
        return Err(format!(
            "is in the frame `{frame}`, and not in `{base_frame}`: is the arm's `model` right?"
        ));
    }
    let (at, turn) = (&message.pose.position, &message.pose.orientation);
    let place = Translation3::new(at.x, at.y, at.z);
    let turn = Quaternion::new(turn.w, turn.x, turn.y, turn.z);
    if !place.vector.iter().all(|value| value.is_finite()) {
        return Err("holds a number that is not finite".to_owned());
    }
    // Also false if the norm is NaN.
    if (turn.norm() - 1.0).abs() < UNIT_TOLERANCE {
        return Ok(Isometry3::from_parts(
            place,
            UnitQuaternion::from_quaternion(turn),
        ));
    }
    Err(format!(
        "has a quaternion of length `{}`, and not 1",
        turn.norm()
    ))
}

/// Returns the stamp of a message, seconds on the sender's clock; ROS writes 0 where there is none.
fn stamp_s(header: &Header) -> Result<f64, String> {
    let stamp_s = f64::from(header.stamp.secs) + f64::from(header.stamp.nsecs) * 1e-9;
    match stamp_s > 0.0 {
        true => Ok(stamp_s),
        false => Err("has no stamp, so that nothing tells how old it is".to_owned()),
    }
}

/// kinova-ros publishes nine positions, but only as many names as there are joints and fingers, so names decide.
fn joint_angles(message: &JointState, joints: &[String]) -> Result<Vec<f64>, String> {
    let angle = |joint: &String| {
        let index = message.name.iter().position(|name| name == joint);
        let angle = index.and_then(|index| message.position.get(index));
        angle
            .copied()
            .filter(|angle| angle.is_finite())
            .ok_or_else(|| format!("gives no angle of the joint `{joint}`"))
    };
    joints.iter().map(angle).collect()
}

fn fingers(message: &FingerPosition, n_fingers: usize) -> Result<Vec<f64>, String> {
    let positions = [message.finger1, message.finger2, message.finger3].map(f64::from);
    if positions.iter().any(|position| !position.is_finite()) {
        return Err("holds a number that is not finite".to_owned());
    }
    Ok(positions.into_iter().take(n_fingers).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use proptest::prelude::*;

    fn pose(frame: &str, turn: [f64; 4]) -> PoseStamped {
        let mut message = PoseStamped::default();
        message.header.frame_id = frame.to_owned();
        message.pose.position.z = 0.5;
        let orientation = &mut message.pose.orientation;
        [orientation.x, orientation.y, orientation.z, orientation.w] = turn;
        message
    }

    #[test]
    fn a_pose_in_another_frame_or_without_a_direction_is_left_out() {
        let half = 0.5_f64.sqrt();
        let read = tool_pose(&pose("/base", [0.0, half, 0.0, half]), "base").unwrap();
        assert!(
            (read * nalgebra::Point3::new(0.0, 0.0, 1.0) - nalgebra::Point3::new(1.0, 0.0, 0.5))
                .norm()
                < 1e-12
        );
        for (frame, turn) in [
            ("other", [0.0, 0.0, 0.0, 1.0]),
            ("base", [0.0; 4]),
            ("base", [f64::NAN, 0.0, 0.0, 1.0]),
        ] {
            assert!(
                tool_pose(&pose(frame, turn), "base").is_err(),
                "{frame} {turn:?}"
            );
        }
    }

    #[test]
    fn joints_are_found_by_name_whatever_their_order() {
        let message = JointState {
            name: ["finger", "b", "a"].map(str::to_owned).to_vec(),
            position: vec![f64::NAN, 2.0, 1.0, 7.0],
            ..JointState::default()
        };
        let joints = |names: [&str; 2]| joint_angles(&message, &names.map(str::to_owned));
        assert_eq!(joints(["a", "b"]), Ok(vec![1.0, 2.0]));
        for missing in ["c", "finger"] {
            assert_eq!(
                joints(["a", missing]),
                Err(format!("gives no angle of the joint `{missing}`"))
            );
        }
    }

    proptest! {
        /// Readings are always finite, and each has its exact number of values.
        #[test]
        fn readings_are_finite(values in prop::array::uniform7(any::<f64>()), n_fingers in 0_usize..5) {
            let [x, y, z, a, b, c, d] = values;
            let mut message = pose("base", [a, b, c, d]);
            (message.pose.position.x, message.pose.position.y, message.pose.position.z) = (x, y, z);
            if let Ok(pose) = tool_pose(&message, "base") {
                prop_assert!(pose.to_homogeneous().iter().all(|value| value.is_finite()));
            }
            let message = FingerPosition { finger1: a as f32, finger2: b as f32, finger3: c as f32 };
            if let Ok(fingers) = fingers(&message, n_fingers) {
                prop_assert!(fingers.len() == n_fingers.min(3) && fingers.iter().all(|value| value.is_finite()));
            }
        }
    }
}

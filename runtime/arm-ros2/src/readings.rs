//! Receives the joints' states, and computes the arm's readings from them.
//!
//! In: `sensor_msgs/JointState`, in which the names decide, whatever their order. Out: [`Readings`], each value with the
//! time at which it was taken: by its stamp, so that a repeated state is not fresh. No topic tells where the tool is,
//! so its pose is computed from the angles by the arm's own chain. Arm and gripper may publish in messages of their
//! own; a message with neither's joints is none of this arm's. An invalid one is dropped, and the reason kept for the
//! error if no reading arrives.

use super::Ros2Error;
use super::link::{Link, Quality, topic_name};
use super::messages::{JointState, Message};
use fab_arm::kinematics::chain::Chain;
use fab_arm::port::{Reading, Readings, Stamps};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// The names of an arm's parts in messages.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    /// The joints from the base to the hand.
    pub(crate) joints: Vec<String>,
    /// The joints of the fingers: one for each, or one for all.
    pub(crate) fingers: Vec<String>,
    /// How many fingers.
    pub(crate) n_fingers: usize,
}

/// What the topic has delivered.
#[derive(Default)]
struct Received {
    readings: Readings,
    fault: Option<String>,
}

/// The joints' states.
pub(crate) struct JointStates {
    topic: String,
    received: Arc<Mutex<Received>>,
}

impl JointStates {
    /// Subscribes; times are counted from `clock`.
    pub(crate) fn open(
        link: &Link,
        topic: &str,
        names: Names,
        chain: Chain,
        clock: Instant,
    ) -> Result<JointStates, Ros2Error> {
        let received = Arc::new(Mutex::new(Received::default()));
        let into = Arc::clone(&received);
        let (mut joint_stamps, mut finger_stamps) = (Stamps::default(), Stamps::default());
        link.listen::<JointState>(
            &topic_name(topic),
            JointState::TYPE,
            Quality::Sensor,
            move |heard| {
                let heard_s = clock.elapsed().as_secs_f64();
                let read = heard.and_then(|(message, _)| read(&message, &names, &chain));
                let mut received = lock(&into);
                let read = match read {
                    Ok(read) => read,
                    Err(why) => {
                        received.fault = Some(why);
                        return;
                    }
                };
                received.fault = None;
                let readings = &mut received.readings;
                if let Some((joints_rad, tool)) = read.arm
                    && let Some(at_s) = joint_stamps.taken_s(read.stamp_s, heard_s)
                {
                    readings.tool = Some(Reading { value: tool, at_s });
                    readings.joints_rad = Some(Reading {
                        value: joints_rad,
                        at_s,
                    });
                }
                if let Some(fingers) = read.fingers
                    && let Some(at_s) = finger_stamps.taken_s(read.stamp_s, heard_s)
                {
                    readings.fingers = Some(Reading {
                        value: fingers,
                        at_s,
                    });
                }
            },
        )?;
        Ok(JointStates {
            topic: topic.to_owned(),
            received,
        })
    }

    /// Returns the topic's name.
    pub(crate) fn topic(&self) -> &str {
        &self.topic
    }

    /// Returns the last readings.
    pub(crate) fn readings(&self) -> Readings {
        lock(&self.received).readings.clone()
    }

    /// Returns why the last message was dropped, if it was.
    pub(crate) fn fault(&self) -> Option<String> {
        lock(&self.received).fault.clone()
    }
}

fn lock(received: &Mutex<Received>) -> MutexGuard<'_, Received> {
    received.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a message says of the arm.
#[derive(Debug, PartialEq)]
struct Read {
    stamp_s: f64,
    arm: Option<(Vec<f64>, nalgebra::Isometry3<f64>)>,
    fingers: Option<Vec<f64>>,
}

fn read(message: &JointState, names: &Names, chain: &Chain) -> Result<Read, String> {
    let joints_rad = positions(message, &names.joints)?;
    let fingers = positions(message, &names.fingers)?;
    let nanoseconds = message.header.stamp.nanoseconds();
    if nanoseconds <= 0 && (joints_rad.is_some() || fingers.is_some()) {
        return Err("has no stamp, so that nothing tells how old it is".to_owned());
    }
    let arm = match joints_rad {
        Some(joints_rad) => {
            let tool = chain.base_from_tool(&joints_rad);
            Some((joints_rad, tool.map_err(|error| error.to_string())?))
        }
        None => None,
    };
    Ok(Read {
        stamp_s: nanoseconds as f64 / 1e9,
        arm,
        fingers: fingers.map(|positions| match positions[..] {
            // Fingers that mimic one joint.
            [one] => vec![one; names.n_fingers],
            _ => positions,
        }),
    })
}

/// Returns the positions of these joints in their order; `None` if it names none of them.
fn positions(message: &JointState, joints: &[String]) -> Result<Option<Vec<f64>>, String> {
    let at = |joint: &String| message.name.iter().position(|name| name == joint);
    if joints.iter().all(|joint| at(joint).is_none()) {
        return Ok(None);
    }
    let position = |joint: &String| {
        let position = at(joint).and_then(|index| message.position.get(index));
        let position = position.copied().filter(|position| position.is_finite());
        position.ok_or_else(|| format!("gives no position of the joint `{joint}`"))
    };
    joints
        .iter()
        .map(position)
        .collect::<Result<Vec<f64>, String>>()
        .map(Some)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use proptest::prelude::*;

    fn chain() -> Chain {
        Chain::of_model("j2n6s200").unwrap()
    }

    fn names() -> Names {
        Names {
            joints: (1..=6).map(|joint| format!("joint_{joint}")).collect(),
            fingers: vec!["finger".to_owned()],
            n_fingers: 2,
        }
    }

    fn message(names: &[&str], position: &[f64]) -> JointState {
        let mut message = JointState {
            name: names.iter().map(|name| (*name).to_owned()).collect(),
            position: position.to_vec(),
            ..JointState::default()
        };
        message.header.stamp.sec = 7;
        message.header.stamp.nanosec = 500_000_000;
        message
    }

    const ALL: [&str; 7] = [
        "finger", "joint_6", "joint_5", "joint_4", "joint_3", "joint_2", "joint_1",
    ];

    #[test]
    fn joints_are_found_by_name_whatever_their_order() {
        let said = message(&ALL, &[0.5, 1.3, 1.4, 4.2, 1.0, 2.9, 4.8]);
        let read = read(&said, &names(), &chain()).unwrap();
        let (joints_rad, tool) = read.arm.unwrap();
        assert_eq!(joints_rad, [4.8, 2.9, 1.0, 4.2, 1.4, 1.3]);
        assert_eq!(tool, chain().base_from_tool(&joints_rad).unwrap());
        assert_eq!(read.fingers, Some(vec![0.5, 0.5]));
        assert_eq!(read.stamp_s, 7.5);
    }

    #[test]
    fn a_message_of_other_joints_is_passed_over_and_half_an_arm_is_not() {
        let other = read(&message(&["lift"], &[1.0]), &names(), &chain()).unwrap();
        assert_eq!((other.arm, other.fingers), (None, None));
        let hand = read(&message(&["finger"], &[1.0]), &names(), &chain()).unwrap();
        assert_eq!((hand.arm, hand.fingers), (None, Some(vec![1.0, 1.0])));
        let mut unstamped = message(&ALL, &[0.0; 7]);
        unstamped.header.stamp.sec = 0;
        unstamped.header.stamp.nanosec = 0;
        for (said, expected) in [
            (
                message(&ALL[1..6], &[0.0; 5]),
                "gives no position of the joint `joint_1`",
            ),
            (
                message(&ALL, &[0.0; 6]),
                "gives no position of the joint `joint_1`",
            ),
            (
                message(&ALL, &[f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
                "gives no position of the joint `finger`",
            ),
            (
                unstamped,
                "has no stamp, so that nothing tells how old it is",
            ),
        ] {
            let found = read(&said, &names(), &chain()).unwrap_err();
            assert_eq!(found, expected);
        }
    }

    proptest! {
        /// Readings are always finite, whatever a message holds.
        #[test]
        fn readings_are_finite(values in prop::collection::vec(any::<f64>(), 0..9), secs: i32) {
            let mut said = message(&ALL, &values);
            said.header.stamp.sec = secs;
            if let Ok(read) = read(&said, &names(), &chain()) {
                if let Some((joints_rad, tool)) = read.arm {
                    prop_assert!(joints_rad.iter().all(|angle| angle.is_finite()));
                    prop_assert!(tool.to_homogeneous().iter().all(|value| value.is_finite()));
                }
                prop_assert!(read.fingers.iter().flatten().all(|position| position.is_finite()));
                prop_assert!(read.stamp_s.is_finite());
            }
        }
    }
}

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
#[path = "tests/readings.rs"]
mod tests;

//! Connects to an arm's controllers, and waits until everything that a driver needs was received.
//!
//! In: the settings and the arm's chain. Out: a [`Ros2Port`], or what is missing and what would help.

use super::Ros2Error;
use super::action::ActionClient;
use super::link::{Link, topic_name};
use super::messages::{JointState, Message};
use super::port::{GripperClient, Ros2Port, StopService};
use super::readings::{JointStates, Names};
use super::service::Client;
use fab_arm::kinematics::chain::Chain;
use fab_arm::settings::{GripperAction, Rmw, Ros2Settings};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

const POLL: Duration = Duration::from_millis(20);

/// Connects to the controllers of the settings, and waits until everything that a driver needs was received: the
/// positions of every joint and finger, an answer of the action servers of arm and gripper, and the stop service if
/// one is named. Moves nothing.
///
/// Gives up after `timeout_s` seconds, with a message that names what is missing.
///
/// - `n_fingers`: how many fingers the hand has.
pub fn connect(
    settings: &Ros2Settings,
    chain: &Chain,
    n_fingers: usize,
    timeout_s: f64,
) -> Result<Ros2Port, Ros2Error> {
    let deadline = Instant::now() + Duration::from_secs_f64(timeout_s);
    let setting = |found: usize, key: &str, expected: String| {
        Err(Ros2Error::Setting(format!(
            "`ros2.{key}` has {found} names; expected {expected}"
        )))
    };
    let (n_joints, found) = (chain.joints().len(), settings.joints.len());
    if found != n_joints {
        return setting(found, "joints", format!("{n_joints}, one for each joint"));
    }
    let found = settings.gripper_joints.len();
    if found != 1 && found != n_fingers {
        return setting(
            found,
            "gripper_joints",
            format!("1, or one for each of the {n_fingers} fingers"),
        );
    }
    let names = Names {
        joints: settings.joints.clone(),
        fingers: settings.gripper_joints.clone(),
        n_fingers,
    };
    let (Some(trajectory), Some(gripper)) = (&settings.trajectory, &settings.gripper) else {
        return Err(Ros2Error::Setting(
            "`[ros2]` names no `trajectory` or no `gripper`".to_owned(),
        ));
    };
    let link = Link::open(settings)?;
    let (clock, rmw) = (Instant::now(), settings.rmw);
    let port = Ros2Port {
        joint_states: JointStates::open(
            &link,
            &settings.joint_states,
            names.clone(),
            chain.clone(),
            clock,
        )?,
        trajectory: ActionClient::open(&link, trajectory, rmw)?,
        gripper: match settings.gripper_action {
            GripperAction::GripperCommand => {
                GripperClient::Single(ActionClient::open(&link, gripper, rmw)?)
            }
            GripperAction::ParallelGripperCommand => {
                GripperClient::Parallel(ActionClient::open(&link, gripper, rmw)?)
            }
        },
        stop: match &settings.stop {
            Some(name) => Some(stop_service(&link, name, rmw)?),
            None => None,
        },
        names,
        max_effort: settings.gripper_effort,
        clock,
        link,
    };
    port.wait_for_readings(deadline)?;
    port.wait_for_servers(rmw, deadline)?;
    port.wait_for_stop(deadline)?;
    Ok(port)
}

fn stop_service(link: &Link, name: &str, rmw: Rmw) -> Result<StopService, Ros2Error> {
    let answer = Arc::new(Mutex::new(None));
    let into = Arc::clone(&answer);
    let client = Client::open(link, name, rmw, move |(), response| {
        *into.lock().unwrap_or_else(PoisonError::into_inner) = Some(response);
    })?;
    Ok(StopService {
        name: name.to_owned(),
        client,
        answer,
    })
}

impl Ros2Port {
    fn wait_for_readings(&self, deadline: Instant) -> Result<(), Ros2Error> {
        let topic = self.joint_states.topic();
        loop {
            let readings = self.joint_states.readings();
            let missing: Vec<&String> = [
                (readings.joints_rad.is_none(), &self.names.joints),
                (readings.fingers.is_none(), &self.names.fingers),
            ]
            .into_iter()
            .filter(|(is_missing, _)| *is_missing)
            .flat_map(|(_, names)| names)
            .collect();
            if missing.is_empty() {
                return Ok(());
            }
            if Instant::now() >= deadline {
                let written = self.link.written_as(&topic_name(topic));
                return Err(Ros2Error::Missing(
                    match (self.joint_states.fault(), &written[..]) {
                        (Some(fault), _) => format!("`{topic}` cannot be used: it {fault}"),
                        (None, []) => format!(
                            "nobody publishes `{topic}`: is the driver started, and in the domain of `ros2.domain`?"
                        ),
                        (None, [other, ..]) if other != JointState::TYPE => {
                            format!("`{topic}` is of the type `{other}`, and not of joint states")
                        }
                        (None, _) => {
                            let names: Vec<String> =
                                missing.iter().map(|name| format!("`{name}`")).collect();
                            format!(
                                "`{topic}` does not tell the positions of {}: compare `ros2.joints` and `ros2.gripper_joints` \
                             with its names",
                                names.join(", ")
                            )
                        }
                    },
                ));
            }
            std::thread::sleep(POLL);
        }
    }

    fn wait_for_servers(&self, rmw: Rmw, deadline: Instant) -> Result<(), Ros2Error> {
        for server in self.servers() {
            let name = server.name();
            let other = |why: String| {
                Ros2Error::Missing(format!("the action server `{name}` is another: {why}"))
            };
            while !server.is_found(&self.link).map_err(other)? {
                if Instant::now() >= deadline {
                    return Err(Ros2Error::Missing(format!(
                        "there is no action server `{name}`: is the controller active?"
                    )));
                }
                std::thread::sleep(POLL);
            }
            if !server.wait_until_it_answers(deadline) {
                return Err(Ros2Error::Missing(format!(
                    "the action server `{name}` does not answer: does it use the middleware of `ros2.rmw`, `{}`?",
                    rmw.name()
                )));
            }
        }
        Ok(())
    }

    /// A stop service is only looked for: to ask it would stop the arm.
    fn wait_for_stop(&self, deadline: Instant) -> Result<(), Ros2Error> {
        let Some(stop) = &self.stop else {
            return Ok(());
        };
        let other = |why: String| {
            Ros2Error::Missing(format!("the service `{}` is another: {why}", stop.name))
        };
        while !stop.client.is_found(&self.link).map_err(other)? {
            if Instant::now() >= deadline {
                return Err(Ros2Error::Missing(format!(
                    "there is no service `{}`: is the driver started?",
                    stop.name
                )));
            }
            std::thread::sleep(POLL);
        }
        Ok(())
    }
}

//! Connects to an arm's node, and waits until everything that a driver needs was received.
//!
//! In: the settings and the arm's model. Out: a [`RosPort`], or what is missing and what would help.

use super::RosError;
use super::action::ActionClient;
use super::link::Link;
use super::port::{RosPort, SERVICE_TIMEOUT, Servers};
use super::topics::{Names, Topics};
use fab_arm::settings::RosSettings;
use roslibrust::ros1::{NodeError, NodeHandle};
use std::time::{Duration, Instant};

/// Safety margin after a server was seen to connect to the cancellation topic; its topics connect one after the other,
/// goals first.
const CONNECT_SETTLE: Duration = Duration::from_millis(200);

const POLL: Duration = Duration::from_millis(20);

/// Connects to the node of the arm `model`, e.g. `j2n6s200`, and waits until everything that a driver needs was
/// received.
///
/// That is kinova-ros's servers for poses and fingers, its three topics and `in/stop`; with a `trajectory` in the settings also that
/// server, and then `in/stop` may be missing. Gives up after `timeout_s` seconds, or two more if services do not
/// answer, with a message that names what is missing.
pub fn connect(settings: &RosSettings, model: &str, timeout_s: f64) -> Result<RosPort, RosError> {
    let timeout = Duration::from_secs_f64(timeout_s);
    let deadline = Instant::now() + timeout;
    let names = names(settings, model)?;
    let arm = settings.arm.trim_end_matches('/').to_owned();
    let link = Link::open(settings, "arm", timeout)?;
    let (node, clock) = (link.node(), Instant::now());
    let registered = {
        let (names, arm, trajectory) = (names.clone(), arm.clone(), settings.trajectory.clone());
        link.run(deadline.saturating_duration_since(clock), async move {
            register(&node, &arm, trajectory, &names, clock).await
        })
    };
    let refused = |why: String| RosError::Refused {
        what: format!("the topics of `{arm}` could not be registered"),
        why,
    };
    let (servers, topics) = match registered {
        Some(registered) => registered.map_err(|error| refused(error.to_string()))?,
        None => return Err(refused(format!("no answer within {timeout:?}"))),
    };
    let mut port = RosPort {
        has_stop: false,
        track: Default::default(),
        arm,
        names,
        clock,
        servers,
        topics,
        stop: None,
        link,
    };
    port.wait_for_topics(deadline)?;
    port.wait_for_servers(deadline)?;
    // A driver that publishes has already advertised it.
    let stop = format!("{}/in/stop", port.arm);
    let offered = port.link.offers(&stop, SERVICE_TIMEOUT);
    // A missing answer about the stop must not be taken for an arm without a stop.
    let offered = offered.ok_or_else(|| {
        RosError::Missing(format!(
            "the master does not say whether there is a service `{stop}`"
        ))
    });
    port.has_stop = offered?;
    if port.has_stop {
        port.stop = port.service("in/stop").ok();
    } else if port.servers.trajectory.is_none() {
        return Err(RosError::Missing(format!(
            "the node `{}` has no service `in/stop`: is the driver started?",
            port.arm
        )));
    }
    Ok(port)
}

fn names(settings: &RosSettings, model: &str) -> Result<Names, RosError> {
    let setting = |message: String| Err(RosError::Setting(message));
    if !settings.arm.starts_with('/') {
        return setting(format!(
            "`arm` is `{}`; expected `/{model}_driver`",
            settings.arm
        ));
    }
    // kinova-ros reads the digits at the same positions.
    let digit = |at: usize| {
        model
            .chars()
            .nth(at)
            .and_then(|character| character.to_digit(10))
    };
    let (Some(n_joints @ 4..=7), Some(n_fingers @ 2..=3)) = (digit(3), digit(5)) else {
        return setting(format!("the model `{model}` is not of the form `j2n6s200`"));
    };
    let joints = match &settings.joints[..] {
        [] => (1..=n_joints)
            .map(|joint| format!("{model}_joint_{joint}"))
            .collect(),
        named if named.len() == n_joints as usize => named.to_vec(),
        named => {
            return setting(format!(
                "`joints` names {} joints, and `{model}` has {n_joints}",
                named.len()
            ));
        }
    };
    Ok(Names {
        base_frame: format!("{model}_link_base"),
        joints,
        n_fingers: n_fingers as usize,
    })
}

async fn register(
    node: &NodeHandle,
    arm: &str,
    trajectory: Option<String>,
    names: &Names,
    clock: Instant,
) -> Result<(Servers, Topics), NodeError> {
    let servers = Servers {
        pose: ActionClient::open(node, &format!("{arm}/pose_action/tool_pose")).await?,
        fingers: ActionClient::open(node, &format!("{arm}/fingers_action/finger_positions"))
            .await?,
        trajectory: match trajectory {
            Some(name) => Some(ActionClient::open(node, &name).await?),
            None => None,
        },
    };
    Ok((servers, Topics::open(node, arm, names, clock).await?))
}

impl RosPort {
    fn wait_for_topics(&self, deadline: Instant) -> Result<(), RosError> {
        loop {
            let readings = self.topics.readings();
            let missing: Vec<&str> = [
                ("`out/tool_pose`", readings.tool.is_none()),
                ("`out/joint_state`", readings.joints_rad.is_none()),
                ("`out/finger_position`", readings.fingers.is_none()),
            ]
            .into_iter()
            .filter_map(|(topic, is_missing)| is_missing.then_some(topic))
            .collect();
            if missing.is_empty() {
                return Ok(());
            }
            if Instant::now() >= deadline {
                let faults = self.topics.faults();
                return Err(RosError::Missing(match faults.is_empty() {
                    true => {
                        let missing = missing.join(", ");
                        format!(
                            "the node `{}` does not publish {missing}: is the driver started?",
                            self.arm
                        )
                    }
                    false => format!(
                        "the node `{}` cannot be used: {}",
                        self.arm,
                        faults.join("; ")
                    ),
                }));
            }
            std::thread::sleep(POLL);
        }
    }

    fn wait_for_servers(&self, deadline: Instant) -> Result<(), RosError> {
        for server in self.servers.all() {
            if server.wait_until_connected(deadline) {
                continue;
            }
            let name = server.name();
            return Err(RosError::Missing(match server.silent_for() {
                None => format!("there is no action server `{name}`: is the driver started?"),
                Some(_) => format!(
                    "the action server `{name}` does not hear this program, which it looks for at `{}`: set \
                     ROS_HOSTNAME or ROS_IP to what the arm's machine can reach",
                    self.link.host()
                ),
            }));
        }
        std::thread::sleep(CONNECT_SETTLE);
        Ok(())
    }
}

//! An arm behind ROS: the node of kinova-ros, and if the settings name one, a joint trajectory controller.
//!
//! In: goals, cancellations, stops. Out: the state of each goal, and the arm's readings. The driver decides what a
//! silence or an ending means; only a goal for a silent server is refused here, because nothing would accept it.

use super::action::{Action, ActionClient, Client};
use super::link::Link;
use super::messages::actionlib_msgs::GoalID;
use super::messages::kinova_msgs::{Start, StartRequest, Stop, StopRequest};
use super::servers::{self, Fingers, ToolPose, Trajectory};
use super::topics::{Names, Topics};
use fab_arm::port::{Ending, GoalId, GoalState, Port, PortError, Readings, Track, Waypoint};
use nalgebra::{Isometry3, Vector3};
use roslibrust::RosServiceType;
use roslibrust::ros1::ServiceClient;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a server may be silent before it counts as gone; actionlib's servers publish their status five times a
/// second.
const SILENCE: Duration = Duration::from_secs(1);

/// Time limit of one service call.
pub(super) const SERVICE_TIMEOUT: Duration = Duration::from_secs(1);

/// How long goals may take to end after a stop: their servers take a tenth of a second, and more on a busy machine.
const STOP_SETTLE: Duration = Duration::from_millis(1500);

/// The longest transit time of a cancellation.
const CANCEL_SETTLE: Duration = Duration::from_millis(100);

/// Interval between two repeated stops.
const POLL: Duration = Duration::from_millis(20);

/// A connection to an arm's node.
pub struct RosPort {
    pub(super) arm: String,
    pub(super) names: Names,
    pub(super) clock: Instant,
    pub(super) servers: Servers,
    pub(super) topics: Topics,
    /// Kept open, so that a stop does not need the master; `None` if the node has no such service, or it failed.
    pub(super) stop: Option<Arc<ServiceClient<Stop>>>,
    pub(super) has_stop: bool,
    pub(super) track: Track,
    /// Dropped last, because everything above lives on its threads.
    pub(super) link: Link,
}

/// The clients of the arm's action servers.
pub(super) struct Servers {
    pub(super) pose: ActionClient<ToolPose>,
    pub(super) fingers: ActionClient<Fingers>,
    pub(super) trajectory: Option<ActionClient<Trajectory>>,
}

impl Servers {
    pub(super) fn all(&self) -> Vec<&dyn Client> {
        let mut all: Vec<&dyn Client> = vec![&self.pose, &self.fingers];
        all.extend(self.trajectory.iter().map(|client| client as &dyn Client));
        all
    }
}

impl RosPort {
    pub(super) fn service<T: RosServiceType>(
        &self,
        name: &str,
    ) -> Result<Arc<ServiceClient<T>>, String> {
        let (node, name) = (self.link.node(), format!("{}/{name}", self.arm));
        let client = self.link.run(SERVICE_TIMEOUT, async move {
            node.service_client::<T>(&name).await
        });
        match client {
            Some(Ok(client)) => Ok(Arc::new(client)),
            Some(Err(error)) => Err(format!(
                "it cannot be reached ({error}): is the driver still running?"
            )),
            None => Err(format!("it cannot be reached within {SERVICE_TIMEOUT:?}")),
        }
    }

    fn call<T: RosServiceType>(
        &self,
        client: &Arc<ServiceClient<T>>,
        request: T::Request,
    ) -> Result<(), String> {
        let client = Arc::clone(client);
        match self.link.run(SERVICE_TIMEOUT, async move {
            client.call(&request).await.map(drop)
        }) {
            Some(Ok(())) => Ok(()),
            Some(Err(error)) => Err(error.to_string()),
            None => Err(format!("no answer within {SERVICE_TIMEOUT:?}")),
        }
    }

    /// Stops through the open connection, or else a new one.
    fn call_stop(&mut self) -> Result<(), String> {
        if let Some(client) = self.stop.take()
            && self.call(&client, StopRequest {}).is_ok()
        {
            self.stop = Some(client);
            return Ok(());
        }
        let client = self.service::<Stop>("in/stop")?;
        self.call(&client, StopRequest {})?;
        self.stop = Some(client);
        Ok(())
    }

    fn open_goals(&self) -> Vec<(&dyn Client, String)> {
        let open = |server: &dyn Client| server.open_goals();
        let servers = self.servers.all().into_iter();
        servers
            .flat_map(|server| open(server).into_iter().map(move |id| (server, id)))
            .collect()
    }

    fn cancel_open_goals(&self) -> Result<(), String> {
        self.open_goals()
            .into_iter()
            .try_for_each(|(server, id)| server.cancel(&id))?;
        self.empty_controller()
    }

    /// Waits until every goal has ended, which acknowledges its cancellation.
    fn wait_for_ends(&self) -> Result<(), String> {
        let begun = Instant::now();
        while !self.open_goals().is_empty() {
            if begun.elapsed() >= STOP_SETTLE {
                return Err(format!(
                    "no server reports within {STOP_SETTLE:?} that its goal was cancelled"
                ));
            }
            std::thread::sleep(POLL);
        }
        Ok(())
    }

    /// Cancels every trajectory, whoever sent it: `in/stop` only holds the joints, and the controller would resume once
    /// the arm is enabled. Only this server is addressed, because a cancellation makes the others enable a stopped arm.
    fn empty_controller(&self) -> Result<(), String> {
        let trajectory = self.servers.trajectory.as_ref();
        trajectory.map_or(Ok(()), ActionClient::cancel_all)
    }
}

impl Port for RosPort {
    fn now_s(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    fn wait(&mut self, seconds: f64) {
        std::thread::sleep(Duration::try_from_secs_f64(seconds).unwrap_or_default());
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        self.track = Track::default();
        let Some(client) = &self.servers.trajectory else {
            return Err(PortError {
                what: "a trajectory".to_owned(),
                why: "the settings name no `trajectory` under `[ros]`".to_owned(),
            });
        };
        send(client, servers::trajectory(points, &self.names.joints))
    }

    fn send_pose(&mut self, tool: &Isometry3<f64>) -> Result<GoalId, PortError> {
        self.track = Track::default();
        let message = servers::tool_pose(tool, &self.names.base_frame);
        send(&self.servers.pose, message)
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        self.track = Track::default();
        send(&self.servers.fingers, servers::fingers(positions))
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        let servers = self.servers.all().into_iter();
        let state = servers.filter_map(|server| server.state(&goal.0)).next();
        // A goal of another port was never sent to this one's servers.
        state.unwrap_or(GoalState::Ended(Ending::Rejected))
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        self.track.end();
        let servers = self.servers.all();
        let owner = servers
            .iter()
            .find(|server| server.state(&goal.0).is_some());
        let sent = match owner {
            Some(server) => server.cancel(&goal.0),
            None => Err("it was not sent from here".to_owned()),
        };
        sent.map_err(|why| PortError {
            what: format!("the end of the goal `{}`", goal.0),
            why,
        })
    }

    /// Stops repeatedly until every goal has ended, and once more: kinova-ros handles a cancelled or preempted goal
    /// with a stop and a start, which would release a stop that came in between. For the same reason goals are
    /// cancelled only if the service is not available.
    fn stop(&mut self) -> Result<(), PortError> {
        let what = match self.has_stop {
            true => format!("the service `{}/in/stop`", self.arm),
            false => "the cancellation of every goal".to_owned(),
        };
        let failed = |why| PortError { what, why };
        if !self.has_stop {
            let cancelled = self.cancel_open_goals().and_then(|()| self.wait_for_ends());
            return cancelled.map_err(failed);
        }
        let emptied = self.empty_controller();
        let begun = Instant::now();
        let settle = match self.servers.trajectory {
            // Some versions of the controller also enable the arm on a cancellation.
            Some(_) => CANCEL_SETTLE,
            None => Duration::ZERO,
        };
        loop {
            let are_over = self.open_goals().is_empty() && begun.elapsed() >= settle;
            if let Err(why) = self.call_stop() {
                // The best that is possible without the service; the arm stays enabled, so this is a failure.
                let _ = self.cancel_open_goals();
                return Err(failed(why));
            }
            if are_over || begun.elapsed() >= STOP_SETTLE {
                return emptied.map_err(failed);
            }
            std::thread::sleep(POLL);
        }
    }

    /// Re-sends the arm's pose, which kinova-ros takes at any time and aborts while the arm is stopped.
    fn probe(&mut self) -> Result<Option<GoalId>, PortError> {
        if !self.has_stop {
            return Ok(None);
        }
        let here = self.topics.readings().tool.ok_or_else(|| PortError {
            what: "a goal that shows whether the arm is stopped".to_owned(),
            why: "the arm has not reported where its tool is".to_owned(),
        })?;
        let message = servers::tool_pose(&here.value, &self.names.base_frame);
        send(&self.servers.pose, message).map(Some)
    }

    fn start(&mut self) -> Result<(), PortError> {
        if !self.has_stop {
            return Ok(());
        }
        let client = self.service::<Start>("in/start");
        let started = client.and_then(|client| self.call(&client, StartRequest {}));
        started.map_err(|why| PortError {
            what: format!("the service `{}/in/start`", self.arm),
            why,
        })
    }

    fn state(&mut self) -> Readings {
        let readings = self.topics.readings();
        if let Some(tool) = &readings.tool {
            self.track.record(tool.at_s, tool.value.translation.vector);
        }
        readings
    }

    fn moved_until_s(&mut self, rest: Option<&Vector3<f64>>) -> Option<f64> {
        self.track.moved_until_s(rest)
    }
}

/// Sends a goal to a server that is there.
fn send<A: Action>(
    client: &ActionClient<A>,
    message: impl FnOnce(GoalID) -> A::Goal,
) -> Result<GoalId, PortError> {
    let sent = check_alive(client).and_then(|()| client.send(message));
    sent.map(GoalId).map_err(|why| PortError {
        what: format!("a goal for `{}`", client.name()),
        why,
    })
}

fn check_alive(server: &dyn Client) -> Result<(), String> {
    match server.silent_for() {
        None => Err("its server was never heard: is the driver started?".to_owned()),
        Some(silence) if silence > SILENCE => Err(format!(
            "its server has been silent for {:.1} s: is the driver still running?",
            silence.as_secs_f64()
        )),
        Some(_) => Ok(()),
    }
}

//! An arm behind ROS 2: a joint trajectory controller and a gripper.
//!
//! In: goals, cancellations, stops. Out: the state of each goal, and the arm's readings. The driver decides what a
//! silence or an ending means; only a goal for a silent arm is refused here, because nothing would watch it.

use super::action::{ActionClient, Server};
use super::goals::{self, Gripper, ParallelGripper, Trajectory};
use super::link::Link;
use super::messages::{TriggerRequest, TriggerResponse};
use super::readings::{JointStates, Names};
use super::service::{Client, Service};
use fab_arm::port::{Ending, GoalId, GoalState, Port, PortError, Readings, Waypoint};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long the joints may be silent before the arm counts as gone: no `tolerance.stale_s` allows more.
const SILENCE_S: f64 = 2.0;

/// How long a service may take to answer.
const SERVICE_TIMEOUT: Duration = Duration::from_secs(1);

/// How long goals may take to end after a stop, and the joints to come to rest.
const STOP_SETTLE: Duration = Duration::from_millis(1500);

/// Interval between two cancellations of everything: a goal may have been under way when the first one arrived.
const CANCEL_EVERY: Duration = Duration::from_millis(250);

/// Joints that move less than this between two readings are at rest, radians.
const REST_RAD: f64 = 0.001;

/// Time between those two readings, seconds.
const REST_S: f64 = 0.2;

const POLL: Duration = Duration::from_millis(20);

/// `std_srvs/Trigger`.
pub(crate) struct Trigger;

impl Service for Trigger {
    const TYPE: &'static str = "std_srvs::srv::dds_::Trigger";
    type Request = TriggerRequest;
    type Response = TriggerResponse;
}

/// A service that stops the arm, with its last answer.
pub(crate) struct StopService {
    pub(crate) name: String,
    pub(crate) client: Client<Trigger, ()>,
    pub(crate) answer: Arc<Mutex<Option<TriggerResponse>>>,
}

/// The action of a gripper.
pub(crate) enum GripperClient {
    Single(ActionClient<Gripper>),
    Parallel(ActionClient<ParallelGripper>),
}

/// A connection to an arm's controllers.
pub struct Ros2Port {
    pub(crate) names: Names,
    pub(crate) max_effort: f64,
    pub(crate) clock: Instant,
    pub(crate) trajectory: ActionClient<Trajectory>,
    pub(crate) gripper: GripperClient,
    pub(crate) joint_states: JointStates,
    pub(crate) stop: Option<StopService>,
    /// Dropped last, because everything above lives on its threads.
    pub(crate) link: Link,
}

impl Ros2Port {
    pub(crate) fn servers(&self) -> [&dyn Server; 2] {
        let gripper: &dyn Server = match &self.gripper {
            GripperClient::Single(client) => client,
            GripperClient::Parallel(client) => client,
        };
        [&self.trajectory, gripper]
    }

    /// Fails if the arm reports nothing, or the server is gone.
    fn check_alive(&self, server: &dyn Server) -> Result<(), String> {
        let last = self.joint_states.readings().joints_rad;
        let silent_s = last.map_or(f64::INFINITY, |joints| self.now_s() - joints.at_s);
        if silent_s > SILENCE_S {
            return Err(format!(
                "`{}` has been silent for {silent_s:.1} s: is the driver still running?",
                self.joint_states.topic()
            ));
        }
        match server.is_found(&self.link)? {
            true => Ok(()),
            false => Err("its server is gone: is the controller still active?".to_owned()),
        }
    }

    /// Calls the service that stops the arm.
    fn call_stop(&self, stop: &StopService) -> Result<(), String> {
        let answer = || stop.answer.lock().unwrap_or_else(PoisonError::into_inner);
        *answer() = None;
        stop.client.send(TriggerRequest::default(), ())?;
        let deadline = Instant::now() + SERVICE_TIMEOUT;
        loop {
            match answer().take() {
                Some(TriggerResponse { success: true, .. }) => return Ok(()),
                Some(TriggerResponse { message, .. }) => {
                    return Err(format!(
                        "the service `{}` answers that it failed: `{message}`",
                        stop.name
                    ));
                }
                None if Instant::now() >= deadline => {
                    return Err(format!(
                        "the service `{}` does not answer within {SERVICE_TIMEOUT:?}",
                        stop.name
                    ));
                }
                None => std::thread::sleep(POLL),
            }
        }
    }

    /// Cancels every goal of both servers, whoever sent it, until none is active.
    fn cancel_everything(&self) -> Result<(), String> {
        let begun = Instant::now();
        loop {
            let asked = Instant::now();
            for server in self.servers() {
                server.cancel_all(asked + SERVICE_TIMEOUT)?;
            }
            while asked.elapsed() < CANCEL_EVERY {
                std::thread::sleep(POLL);
            }
            let is_any = |state: GoalState| {
                let servers = self.servers();
                servers.iter().any(|it| it.has_goals(state.clone()))
            };
            let is_active = is_any(GoalState::Active);
            let is_late = begun.elapsed() >= STOP_SETTLE;
            if is_active && is_late {
                return Err(format!(
                    "no server reports within {STOP_SETTLE:?} that its goal was cancelled"
                ));
            }
            // A goal that was not accepted by now never arrived.
            if !is_active && (is_late || !is_any(GoalState::Sent)) {
                return Ok(());
            }
        }
    }

    /// Waits until two readings of the joints agree.
    fn wait_for_rest(&self) -> Result<(), String> {
        let begun = Instant::now();
        let mut before = self.joint_states.readings().joints_rad;
        while begun.elapsed() < STOP_SETTLE {
            std::thread::sleep(POLL);
            let now = self.joint_states.readings().joints_rad;
            let (Some(then), Some(now)) = (&before, now) else {
                break;
            };
            if now.at_s - then.at_s < REST_S {
                continue;
            }
            let pairs = now.value.iter().zip(&then.value);
            if pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < REST_RAD {
                return Ok(());
            }
            before = Some(now);
        }
        Err(format!(
            "`{}` does not show within {STOP_SETTLE:?} that the joints are at rest",
            self.joint_states.topic()
        ))
    }
}

impl Port for Ros2Port {
    fn now_s(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    fn wait(&mut self, seconds: f64) {
        std::thread::sleep(Duration::try_from_secs_f64(seconds).unwrap_or_default());
    }

    fn send_trajectory(&mut self, points: &[Waypoint]) -> Result<GoalId, PortError> {
        let goal = goals::trajectory(points, &self.names.joints);
        let sent = self.check_alive(&self.trajectory);
        let sent = sent.and_then(|()| self.trajectory.send(goal));
        named(sent, self.trajectory.name())
    }

    fn send_fingers(&mut self, positions: &[f64]) -> Result<GoalId, PortError> {
        let [_, server] = self.servers();
        let (effort, joints) = (self.max_effort, &self.names.fingers);
        // A gripper's fingers move together.
        let position = positions.first().copied().unwrap_or_default();
        let sent = self.check_alive(server).and_then(|()| match &self.gripper {
            GripperClient::Single(client) => client.send(goals::gripper(position, effort)),
            GripperClient::Parallel(client) => {
                client.send(goals::parallel_gripper(position, joints, effort))
            }
        });
        named(sent, server.name())
    }

    fn goal(&mut self, goal: &GoalId) -> GoalState {
        let servers = self.servers().into_iter();
        let state = servers.filter_map(|server| server.state(&goal.0)).next();
        // A goal of another port was never sent to this one's servers.
        state.unwrap_or(GoalState::Ended(Ending::Rejected))
    }

    fn cancel(&mut self, goal: &GoalId) -> Result<(), PortError> {
        let servers = self.servers();
        let owner = servers.iter().find(|it| it.state(&goal.0).is_some());
        let sent = match owner {
            Some(server) => server.cancel(&goal.0),
            None => Err("it was not sent from here".to_owned()),
        };
        sent.map_err(|why| PortError {
            what: format!("the end of the goal `{}`", goal.0),
            why,
        })
    }

    /// Calls the stop service if the settings name one, and cancels every goal in any case; then both must have been
    /// answered, no goal be active, and the joints be at rest.
    fn stop(&mut self) -> Result<(), PortError> {
        let called = self.stop.as_ref().map(|stop| self.call_stop(stop));
        let cancelled = self.cancel_everything();
        let stopped = called.unwrap_or(Ok(())).and(cancelled);
        let stopped = stopped.and_then(|()| self.wait_for_rest());
        stopped.map_err(|why| PortError {
            what: match self.stop {
                Some(_) => "the stop and the cancellation of every goal".to_owned(),
                None => "the cancellation of every goal".to_owned(),
            },
            why,
        })
    }

    /// Does nothing: a cancellation leaves nothing to be undone, and what a stop service switched off is switched on
    /// with the arm's own means.
    fn start(&mut self) -> Result<(), PortError> {
        Ok(())
    }

    fn state(&mut self) -> Readings {
        self.joint_states.readings()
    }
}

fn named(sent: Result<String, String>, server: &str) -> Result<GoalId, PortError> {
    sent.map(GoalId).map_err(|why| PortError {
        what: format!("a goal for `{server}`"),
        why,
    })
}

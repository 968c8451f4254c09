//! A client of an action server, over actionlib's five topics.
//!
//! In: goals and cancellations. Out: the state of each goal, from the server's `status` and `result`. `feedback` is not
//! used: kinova-ros publishes none, and poses come from topics. Nothing here waits for an answer.

use super::ledger::Ledger;
use super::link::{at_once, unique_number};
use super::messages::actionlib_msgs::{GoalID, GoalStatus, GoalStatusArray};
use fab_arm::port::GoalState;
use roslibrust::RosMessageType;
use roslibrust::ros1::{NodeError, NodeHandle, Publisher, Subscriber};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The most messages of a topic that wait before the oldest is dropped.
const QUEUE: usize = 16;

/// Interval at which a server is probed until it receives from this client.
const ASK_EVERY: Duration = Duration::from_millis(100);

/// The messages of one action.
pub(super) trait Action: Send + Sync + 'static {
    /// The message that carries a goal, `…ActionGoal`.
    type Goal: RosMessageType;
    /// The message that carries a result, `…ActionResult`.
    type Result: RosMessageType;
    /// Returns the status in a result.
    fn status(result: &Self::Result) -> &GoalStatus;
}

/// What has been received from a server.
#[derive(Default)]
struct ServerState {
    ledger: Ledger,
    last_message: Option<Instant>,
}

/// A connection to an action server.
pub(super) struct ActionClient<A: Action> {
    name: String,
    goals: Publisher<A::Goal>,
    cancels: Publisher<GoalID>,
    server: Arc<Mutex<ServerState>>,
}

impl<A: Action> ActionClient<A> {
    /// Registers the topics of the action `name`; whether a server is there shows later.
    pub(super) async fn open(node: &NodeHandle, name: &str) -> Result<Self, NodeError> {
        let server = Arc::new(Mutex::new(ServerState::default()));
        let lists = node
            .subscribe::<GoalStatusArray>(&format!("{name}/status"), QUEUE)
            .await?;
        let results = node
            .subscribe::<A::Result>(&format!("{name}/result"), QUEUE)
            .await?;
        listen(lists, Arc::clone(&server), |server, list| {
            server.ledger.update_from_list(list)
        });
        listen(results, Arc::clone(&server), |server, result| {
            server.ledger.update(A::status(result))
        });
        // Not latched: a restarted node must not be handed an old goal.
        let goals = node
            .advertise::<A::Goal>(&format!("{name}/goal"), QUEUE, false)
            .await?;
        let cancels = node
            .advertise::<GoalID>(&format!("{name}/cancel"), QUEUE, false)
            .await?;
        Ok(ActionClient {
            name: name.to_owned(),
            goals,
            cancels,
            server,
        })
    }

    /// Sends a goal, which `message` makes from its id; returns the id.
    pub(super) fn send(&self, message: impl FnOnce(GoalID) -> A::Goal) -> Result<String, String> {
        let id = format!("fabc_{}", unique_number());
        lock(&self.server).ledger.add(&id);
        publish(&self.goals, &message(goal_id(&id)))?;
        Ok(id)
    }

    /// Requests the cancellation of every goal of the server, whoever sent it: in actionlib, a cancellation without an
    /// id.
    pub(super) fn cancel_all(&self) -> Result<(), String> {
        publish(&self.cancels, &GoalID::default())
    }
}

/// What all action clients have in common, whatever their messages.
pub(super) trait Client: Send + Sync {
    /// Returns the action's name, e.g. `/j2n6s200_driver/pose_action/tool_pose`.
    fn name(&self) -> &str;
    /// Returns the time since the server's last message; `None` if there was none.
    fn silent_for(&self) -> Option<Duration>;
    /// Returns the state of a goal that was sent by this client.
    fn state(&self, id: &str) -> Option<GoalState>;
    /// Returns the goals that are not over.
    fn open_goals(&self) -> Vec<String>;
    /// Requests the cancellation of a goal.
    fn cancel(&self, id: &str) -> Result<(), String>;
    /// Waits until the server exists and receives from this client; `false` if the deadline comes first.
    ///
    /// A server lists the cancellation of a goal that it never got, which has no other effect. This is the only
    /// response by which a client of this library can tell that the server has connected to it.
    fn wait_until_connected(&self, deadline: Instant) -> bool;
}

impl<A: Action> Client for ActionClient<A> {
    fn name(&self) -> &str {
        &self.name
    }

    fn silent_for(&self) -> Option<Duration> {
        lock(&self.server).last_message.map(|at| at.elapsed())
    }

    fn state(&self, id: &str) -> Option<GoalState> {
        lock(&self.server).ledger.state(id)
    }

    fn open_goals(&self) -> Vec<String> {
        lock(&self.server).ledger.open()
    }

    fn cancel(&self, id: &str) -> Result<(), String> {
        publish(&self.cancels, &goal_id(id))
    }

    fn wait_until_connected(&self, deadline: Instant) -> bool {
        let id = format!("fabc_hello_{}", unique_number());
        lock(&self.server).ledger.add(&id);
        let is_connected = loop {
            if self.state(&id) != Some(GoalState::Sent) {
                break true;
            }
            if Instant::now() >= deadline || self.cancel(&id).is_err() {
                break false;
            }
            std::thread::sleep(ASK_EVERY);
        };
        lock(&self.server).ledger.remove(&id);
        is_connected
    }
}

/// The server replaces a zero stamp by its own time, so two machines' clocks need not agree.
fn goal_id(id: &str) -> GoalID {
    GoalID {
        id: id.to_owned(),
        ..GoalID::default()
    }
}

/// Publishing only queues a message.
fn publish<T: RosMessageType>(publisher: &Publisher<T>, message: &T) -> Result<(), String> {
    match at_once(publisher.publish(message)) {
        Some(Ok(())) => Ok(()),
        Some(Err(error)) => Err(error.to_string()),
        None => Err("the message could not be queued".to_owned()),
    }
}

/// Passes every message of a topic to `take`, until the topic is closed.
fn listen<T: RosMessageType>(
    mut topic: Subscriber<T>,
    server: Arc<Mutex<ServerState>>,
    take: impl Fn(&mut ServerState, &T) + Send + 'static,
) {
    tokio::spawn(async move {
        while let Some(message) = topic.next().await {
            // An error is a message that came too fast or cannot be read; losing any single message is tolerated.
            let Ok(message) = message else { continue };
            let mut server = lock(&server);
            server.last_message = Some(Instant::now());
            take(&mut server, &message);
        }
    });
}

fn lock(server: &Mutex<ServerState>) -> MutexGuard<'_, ServerState> {
    server.lock().unwrap_or_else(PoisonError::into_inner)
}

//! A client of an action server, by actionlib's protocol of five topics.
//!
//! In: goals and cancellations. Out: the state of each goal, from the server's `status` and `result`; `feedback` is left
//! alone, since kinova-ros publishes none and poses come from topics. Nothing here waits for an answer.

use super::ledger::Ledger;
use super::link::{at_once, unique_number};
use super::messages::actionlib_msgs::{GoalID, GoalStatus, GoalStatusArray};
use fab_arm::port::GoalState;
use roslibrust::RosMessageType;
use roslibrust::ros1::{NodeError, NodeHandle, Publisher, Subscriber};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How many messages of a topic wait, at the most, before the oldest is dropped.
const QUEUE: usize = 16;

/// How often a server is asked whether it hears this client.
const ASK_EVERY: Duration = Duration::from_millis(100);

/// The messages of one action.
pub(super) trait Action: Send + Sync + 'static {
    /// The message that carries a goal, `…ActionGoal`.
    type Goal: RosMessageType;
    /// The message that carries a result, `…ActionResult`.
    type Result: RosMessageType;
    /// Returns what a result says of its goal.
    fn status(result: &Self::Result) -> &GoalStatus;
}

/// What has been heard of a server.
#[derive(Default)]
struct Heard {
    ledger: Ledger,
    last: Option<Instant>,
}

/// A connection to an action server.
pub(super) struct ActionClient<A: Action> {
    name: String,
    goals: Publisher<A::Goal>,
    cancels: Publisher<GoalID>,
    heard: Arc<Mutex<Heard>>,
}

impl<A: Action> ActionClient<A> {
    /// Registers the topics of the action `name`; whether a server is there shows later.
    pub(super) async fn open(node: &NodeHandle, name: &str) -> Result<Self, NodeError> {
        let heard = Arc::new(Mutex::new(Heard::default()));
        let lists = node
            .subscribe::<GoalStatusArray>(&format!("{name}/status"), QUEUE)
            .await?;
        let results = node
            .subscribe::<A::Result>(&format!("{name}/result"), QUEUE)
            .await?;
        listen(lists, Arc::clone(&heard), |heard, list| {
            heard.ledger.hear_list(list)
        });
        listen(results, Arc::clone(&heard), |heard, result| {
            heard.ledger.hear(A::status(result))
        });
        // Not latched: a node that starts anew must not be handed an old goal.
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
            heard,
        })
    }

    /// Sends a goal, which `message` makes from its name; returns the name.
    pub(super) fn send(&self, message: impl FnOnce(GoalID) -> A::Goal) -> Result<String, String> {
        let id = format!("fabc_{}", unique_number());
        lock(&self.heard).ledger.note(&id);
        publish(&self.goals, &message(goal_id(&id)))?;
        Ok(id)
    }

    /// Asks to give every goal of the server up, whoever sent it: to actionlib that is a cancellation without a name.
    pub(super) fn cancel_everything(&self) -> Result<(), String> {
        publish(&self.cancels, &GoalID::default())
    }
}

/// What all action clients have in common, whatever their messages.
pub(super) trait Client: Send + Sync {
    /// Returns the action's name, e.g. `/j2n6s200_driver/pose_action/tool_pose`.
    fn name(&self) -> &str;
    /// Returns how long ago the server was last heard; `None` if never.
    fn silent_for(&self) -> Option<Duration>;
    /// Returns the state of a goal that was sent by this client.
    fn state(&self, id: &str) -> Option<GoalState>;
    /// Returns the goals that are not over.
    fn open_goals(&self) -> Vec<String>;
    /// Asks to give a goal up.
    fn cancel(&self, id: &str) -> Result<(), String>;
    /// Waits until the server is there and hears this client; `false` if the deadline comes first.
    ///
    /// A server lists a cancellation of a goal that it never got, which changes nothing else: that is the only answer
    /// by which a client of this library can tell that the server has connected to it.
    fn meet(&self, deadline: Instant) -> bool;
}

impl<A: Action> Client for ActionClient<A> {
    fn name(&self) -> &str {
        &self.name
    }

    fn silent_for(&self) -> Option<Duration> {
        lock(&self.heard).last.map(|last| last.elapsed())
    }

    fn state(&self, id: &str) -> Option<GoalState> {
        lock(&self.heard).ledger.state(id)
    }

    fn open_goals(&self) -> Vec<String> {
        lock(&self.heard).ledger.open()
    }

    fn cancel(&self, id: &str) -> Result<(), String> {
        publish(&self.cancels, &goal_id(id))
    }

    fn meet(&self, deadline: Instant) -> bool {
        let id = format!("fabc_hello_{}", unique_number());
        lock(&self.heard).ledger.note(&id);
        let is_met = loop {
            if self.state(&id) != Some(GoalState::Sent) {
                break true;
            }
            if Instant::now() >= deadline || self.cancel(&id).is_err() {
                break false;
            }
            std::thread::sleep(ASK_EVERY);
        };
        lock(&self.heard).ledger.forget(&id);
        is_met
    }
}

/// A stamp of zero is replaced by the server's own time, so that two machines' clocks need not agree.
fn goal_id(id: &str) -> GoalID {
    GoalID {
        id: id.to_owned(),
        ..GoalID::default()
    }
}

/// Publishing only puts a message into a queue.
fn publish<T: RosMessageType>(publisher: &Publisher<T>, message: &T) -> Result<(), String> {
    match at_once(publisher.publish(message)) {
        Some(Ok(())) => Ok(()),
        Some(Err(error)) => Err(error.to_string()),
        None => Err("the message could not be queued".to_owned()),
    }
}

/// Hands every message of a topic to `take`, until the topic is closed.
fn listen<T: RosMessageType>(
    mut topic: Subscriber<T>,
    heard: Arc<Mutex<Heard>>,
    take: impl Fn(&mut Heard, &T) + Send + 'static,
) {
    tokio::spawn(async move {
        while let Some(message) = topic.next().await {
            // An error is a message that came too fast or cannot be read, and any message may be lost.
            let Ok(message) = message else { continue };
            let mut heard = lock(&heard);
            heard.last = Some(Instant::now());
            take(&mut heard, &message);
        }
    });
}

fn lock(heard: &Mutex<Heard>) -> MutexGuard<'_, Heard> {
    heard.lock().unwrap_or_else(PoisonError::into_inner)
}
